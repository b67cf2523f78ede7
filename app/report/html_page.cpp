#include "app/report/html_page.h"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <ctime>
#include <opencv2/imgcodecs.hpp>

#include "planning_io/case/case_folder.h"
#include "planning_io/files/image_file.h"

namespace planlight {
namespace {

constexpr const char* kStyle = R"(
body{margin:0;background:#fff;color:#1b232c;font:15px/1.45 Inter,"DejaVu Sans",sans-serif}
main{max-width:1100px;margin:0 auto;padding:28px 24px}
h1{font-size:27px;margin:0 0 6px}h2{font-size:19px;margin:32px 0 6px;break-after:avoid}p{max-width:820px;margin:8px 0}
.muted{color:#5a6673}table{border-collapse:collapse;margin:10px 0;width:100%;break-inside:avoid}
th,td{padding:5px 10px;border-bottom:1px solid #d5dbe2;text-align:right}
th:first-child,td:first-child{text-align:left}th{color:#5a6673;font-weight:500}
.yes{color:#0b7a43}.no{color:#b3261e}
.facts{display:flex;flex-wrap:wrap;gap:2px 26px;margin:0 0 14px;padding:8px 0;border-top:2px solid #1b232c;border-bottom:1px solid #d5dbe2}
.facts div{white-space:nowrap}.facts span{color:#5a6673;margin-right:6px}
.verdict{border:2px solid;border-radius:8px;padding:10px 16px;font-size:18px;margin:14px 0;break-inside:avoid}
.grid{display:grid;grid-template-columns:1fr 1fr;gap:16px}
figure{margin:0;border:1px solid #d5dbe2;border-radius:6px;overflow:hidden;display:flex;flex-direction:column;break-inside:avoid}
figure.wide{grid-column:1/-1}figure.wide img{max-height:460px}
figure img{width:100%;flex:1;object-fit:contain;display:block;background:#fff}figcaption{padding:8px 12px;font-size:14px}
figcaption b{display:block}
footer{margin-top:28px;padding-top:8px;border-top:1px solid #d5dbe2;color:#5a6673;font-size:13px}
@page{margin:14mm}
@media print{main{max-width:none;padding:0}body{font-size:11pt;-webkit-print-color-adjust:exact;print-color-adjust:exact}})";

std::string base64(const std::string& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t k) { return k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u; };
        const unsigned bits = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        out += kDigits[bits >> 18 & 63];
        out += kDigits[bits >> 12 & 63];
        out += i + 1 < bytes.size() ? kDigits[bits >> 6 & 63] : '=';
        out += i + 2 < bytes.size() ? kDigits[bits & 63] : '=';
    }
    return out;
}

std::string jpeg_bytes(const RgbImage& picture) {
    cv::Mat bgr(picture.height, picture.width, CV_8UC3);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const Rgb& c = picture.at(x, y);
            bgr.at<cv::Vec3b>(y, x) = {c[2], c[1], c[0]};
        }
    std::vector<unsigned char> jpeg;
    cv::imencode(".jpg", bgr, jpeg, {cv::IMWRITE_JPEG_QUALITY, 85});
    return {jpeg.begin(), jpeg.end()};
}

/// Drawings are sharp and small as PNG, scenes and photographs as JPEG: whichever is smaller.
std::string embedded(const RgbImage& picture) {
    const std::string png = png_bytes(picture), jpeg = jpeg_bytes(picture);
    return jpeg.size() < png.size() ? "data:image/jpeg;base64," + base64(jpeg) : "data:image/png;base64," + base64(png);
}

bool is_wide(const ReportPicture& p) {
    return p.picture.width > 2 * p.picture.height;
}

std::string figure(const ReportPicture& p, bool wide) {
    return fmt::format("<figure{}><img alt=\"{}\" src=\"{}\"><figcaption><b>{}</b>{}</figcaption></figure>",
                       wide ? " class=\"wide\"" : "", xml_escaped(p.title), embedded(p.picture), xml_escaped(p.title),
                       xml_escaped(p.caption));
}

std::string now() {
    const std::time_t time = std::time(nullptr);
    std::tm local{};
    localtime_r(&time, &local);
    char text[48];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M %Z", &local);
    return text;
}

}  // namespace

std::string operator_name() {
    const passwd* user = getpwuid(getuid());
    if (!user) return "unknown";
    const std::string full = user->pw_gecos ? user->pw_gecos : "", name = full.substr(0, full.find(','));
    return name.empty() ? user->pw_name : name;
}

std::string embedded_png(const RgbImage& picture) {
    return "data:image/png;base64," + base64(png_bytes(picture));
}

ReportFacts facts_of(const Case& the_case) {
    const CaseNames& names = the_case.names;
    std::string plan = names.plan + (names.plan_version.empty() ? "" : ", version " + names.plan_version);
    if (plan.empty()) plan = fmt::format("{} items", the_case.plan.size());
    const std::string title = title_of(the_case);
    return {{"Case", title.find(the_case.code) == std::string::npos ? title : ""},  // else the code says it all
            {"Code", the_case.code + ", prepared " + the_case.created.substr(0, 10)},
            {"Patient", names.patient},
            {"Volume", the_case.source},
            {"Plan", plan}};
}

std::string html_figures(const std::vector<ReportPicture>& pictures, int columns) {
    std::string html =
        columns == 0 || columns == 2
            ? "<div class=\"grid\">"
            : fmt::format("<div class=\"grid\" style=\"grid-template-columns:repeat({},1fr)\">", columns);
    std::size_t in_row = 0;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const bool last_of_row = i + 1 == pictures.size() || (columns != 1 && is_wide(pictures[i + 1]));
        const bool wide = columns < 3 && (is_wide(pictures[i]) || (in_row == 0 && last_of_row));
        html += figure(pictures[i], wide);
        in_row = wide ? 0 : 1 - in_row;
    }
    return html + "</div>";
}

std::string html_page(const std::string& title, const std::string& body, const ReportFacts& facts) {
    std::string about;
    const auto add = [&](const std::string& name, const std::string& value) {
        if (!value.empty()) about += fmt::format("<div><span>{}</span>{}</div>", xml_escaped(name), xml_escaped(value));
    };
    for (const auto& [name, value] : facts) add(name, value);
    // Whoever prints a page of somebody's session is not who operated.
    const bool named =
        std::any_of(facts.begin(), facts.end(), [](const auto& fact) { return fact.first == "Operator"; });
    if (!named) add("Operator", operator_name());
    add("Printed", now());
    return fmt::format(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title><style>{}</style></head>"
        "<body><main><h1>{}</h1><div class=\"facts\">{}</div>{}<footer>Planlight {}. For research; not a medical "
        "device.</footer></main></body></html>\n",
        xml_escaped(title), kStyle, xml_escaped(title), about, body, PLANLIGHT_VERSION);
}

}  // namespace planlight
