#include "app/report/html_page.h"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
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
.muted{color:#5a6673}table{border-collapse:collapse;margin:10px 0;width:100%}tr{break-inside:avoid}
th,td{padding:5px 10px;border-bottom:1px solid #d5dbe2;text-align:right}
th:first-child,td:first-child{text-align:left}th{color:#5a6673;font-weight:500}
.good{color:#0b7a43}.look{color:#8a5300}.stop{color:#b3261e}
.facts{display:flex;flex-wrap:wrap;gap:2px 26px;margin:0 0 14px;padding:8px 0;border-top:2px solid #1b232c;border-bottom:1px solid #d5dbe2}
.facts div{white-space:nowrap}.facts span{color:#5a6673;margin-right:6px}
.verdict{border:2px solid;border-radius:8px;padding:10px 16px;font-size:18px;margin:14px 0;break-inside:avoid}
.row{display:grid;gap:16px;margin:12px 0}
figure{margin:0;border:1px solid #d5dbe2;border-radius:6px;overflow:hidden;display:flex;flex-direction:column;break-inside:avoid}
figure.wide{grid-column:1/-1}figure.wide img{max-height:460px}
figure img{width:100%;flex:1;object-fit:contain;display:block;background:#fff}figcaption{padding:8px 12px;font-size:14px}
figcaption b{display:block}
footer{margin-top:28px;padding-top:8px;border-top:1px solid #d5dbe2;color:#5a6673;font-size:13px}
.key{display:flex;flex-wrap:wrap;gap:2px 18px;margin:6px 0;font-size:14px}.key i{display:inline-block;width:14px;height:14px;margin-right:6px;vertical-align:-2px}
.scale{display:block;width:100%;max-width:460px;margin:10px 0}
.sign{display:grid;grid-template-columns:5fr 3fr 6fr;gap:0 24px;margin-top:44px;break-inside:avoid}
.sign span{border-top:1px solid #1b232c;font-size:13px;color:#5a6673;padding-top:2px}
/* 184 mm of content is what A4 and Letter both hold within these margins. */
@page{margin:12mm 13mm}
@media print{main{width:184mm;max-width:100%;padding:0}figure img{max-height:220mm}body{font-size:10.5pt;-webkit-print-color-adjust:exact;print-color-adjust:exact}})";

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

std::string smaller_jpeg(const RgbImage& picture) {
    std::string jpeg = jpeg_bytes(picture);
    return jpeg.size() < png_bytes(picture).size() ? jpeg : std::string();
}

std::string embedded_picture(const RgbImage& picture, bool exact) {
    const std::string jpeg = exact ? std::string() : smaller_jpeg(picture);
    return jpeg.empty() ? embedded_png(picture) : "data:image/jpeg;base64," + base64(jpeg);
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

std::string program_name() {
    return std::string("Planlight ") + PLANLIGHT_VERSION;
}

std::string lines_to_sign(const std::vector<std::string>& who) {
    std::string html;
    for (const std::string& one : who)
        html += fmt::format("<div class=\"sign\"><span>{}</span><span>Date, time</span><span>Signature</span></div>",
                            xml_escaped(one));
    return html;
}

namespace {

/// Of the style: "good", "look", "stop".
const char* class_of(PageVerdict::Kind kind) {
    constexpr const char* kClasses[] = {"good", "look", "stop"};
    return kClasses[static_cast<std::size_t>(kind)];
}

std::string verdict_frame(const PageVerdict& verdict) {
    if (verdict.words.empty()) return {};
    return fmt::format("<div class=\"verdict {}\">{} {}</div>", class_of(verdict.kind), sign_of(verdict.kind),
                       xml_escaped(verdict.words));
}

std::string verdict_html(const PageVerdict& verdict) {
    std::string html = verdict_frame(verdict);
    for (const std::string& reason : verdict.reasons)
        html += fmt::format("<p class=\"{}\">{}</p>", class_of(verdict.kind), xml_escaped(reason));
    return html;
}

std::string facts_html(const ReportFacts& facts) {
    std::string about;
    for (const auto& [name, value] : with_program(facts))
        if (!value.empty()) about += fmt::format("<div><span>{}</span>{}</div>", xml_escaped(name), xml_escaped(value));
    return "<div class=\"facts\">" + about + "</div>";
}

}  // namespace

const char* sign_of(PageVerdict::Kind kind) {
    constexpr const char* kSigns[] = {"✓", "⚠", "✗"};
    return kSigns[static_cast<std::size_t>(kind)];
}

std::string verdict_as_list(const PageVerdict& verdict) {
    std::string html = verdict_frame(verdict);
    if (verdict.reasons.empty()) return html;
    html += "<ul>";
    for (const std::string& reason : verdict.reasons) html += "<li>" + xml_escaped(reason) + "</li>";
    return html + "</ul>";
}

ReportFacts with_program(ReportFacts facts) {
    const auto add = [&](const char* name, const std::string& value) {
        const bool named =
            std::any_of(facts.begin(), facts.end(), [&](const auto& fact) { return fact.first == name; });
        if (!named) facts.emplace_back(name, value);
    };
    add("Operator", operator_name());  // whoever prints a page of somebody's session is not who operated
    add("Program", program_name());
    add("This page made", now());
    return facts;
}

std::string html_page(const std::string& title, const PageVerdict& verdict, const ReportFacts& facts,
                      const std::string& body, const std::vector<std::string>& signed_by) {
    return fmt::format(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title><style>{}</style></head>"
        "<body><main><h1>{}</h1>{}{}{}{}<footer>{}. For research; not a medical "
        "device.</footer></main></body></html>\n",
        xml_escaped(title), kStyle, xml_escaped(title), verdict_html(verdict), facts_html(facts), body,
        lines_to_sign(signed_by), program_name());
}

}  // namespace planlight
