#include "app/report/html_page.h"

#include <fmt/format.h>

#include "planning_io/files/image_file.h"

namespace planlight {
namespace {

constexpr const char* kStyle = R"(
body{margin:0;background:#0d1117;color:#dfe5ec;font:16px/1.5 Inter,"DejaVu Sans",sans-serif}
main{max-width:1180px;margin:0 auto;padding:32px 24px}
h1{font-size:30px;margin:0 0 4px}h2{font-size:21px;margin:40px 0 8px}p{max-width:860px}
.muted{color:#8b98a8}table{border-collapse:collapse;margin:12px 0;width:100%}
th,td{padding:7px 12px;border-bottom:1px solid #232b36;text-align:right}
th:first-child,td:first-child{text-align:left}th{color:#8b98a8;font-weight:500}
.yes{color:#36d68a}.no{color:#ff6b5e}
.verdict{border:2px solid;border-radius:12px;padding:14px 20px;font-size:20px;margin:18px 0}
.grid{display:grid;grid-template-columns:repeat(auto-fit,minmax(480px,1fr));gap:20px}
figure{margin:0;background:#11161d;border:1px solid #232b36;border-radius:10px;overflow:hidden}
figure img{width:100%;display:block;background:#000}figcaption{padding:10px 14px}
figcaption b{display:block})";

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

}  // namespace

std::string embedded_png(const RgbImage& picture) {
    return "data:image/png;base64," + base64(png_bytes(picture));
}

std::string html_escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

std::string html_figures(const std::vector<ReportPicture>& pictures, int columns) {
    std::string html =
        columns == 0 ? "<div class=\"grid\">"
                     : fmt::format("<div class=\"grid\" style=\"grid-template-columns:repeat({},1fr)\">", columns);
    for (const auto& p : pictures)
        html +=
            fmt::format("<figure><img alt=\"{}\" src=\"{}\"><figcaption><b>{}</b>{}</figcaption></figure>",
                        html_escaped(p.title), embedded_png(p.picture), html_escaped(p.title), html_escaped(p.caption));
    return html + "</div>";
}

std::string html_page(const std::string& title, const std::string& body) {
    return fmt::format(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title><style>{}</style></head>"
        "<body><main><h1>{}</h1>{}</main></body></html>\n",
        html_escaped(title), kStyle, html_escaped(title), body);
}

}  // namespace planlight
