#include <fmt/format.h>

#include <filesystem>

#include "app/evaluation/chain_report.h"
#include "planning_io/image_file.h"
#include "planning_io/safe_write.h"

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

std::string escape(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else out += c;
    }
    return out;
}

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

std::string embedded(const RgbImage& picture, const std::filesystem::path& beside) {
    const auto file = beside.parent_path() / (beside.filename().string() + ".picture.png");
    write_png(picture, file);
    const std::string bytes = read_whole(file);
    std::filesystem::remove(file);
    return "data:image/png;base64," + base64(bytes);
}

std::string preset_section(const PresetSummary& s) {
    const char* mark = s.reached() ? "yes" : "no";
    std::string html = fmt::format(
        "<h2>{} room</h2><div class=\"verdict {}\">{} {} of {} patients found from a random pose, {} refused; "
        "{:.0f} updates a second.</div>",
        s.preset == "paper" ? "The paper's" : "The modern", mark, s.reached() ? "&#10003;" : "&#10007;", s.matched_right, s.rooms,
        s.refused, s.updates_per_s);
    html += "<table><tr><th>Error against the simulator's truth</th><th>median</th><th>95 %</th><th>worst</th><th>count</th>"
            "<th>to reach</th></tr>";
    for (const auto& r : s.rows)
        html += fmt::format("<tr><td>{}</td><td>{:.2f} {}</td><td class=\"{}\">{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{}</td></tr>",
                            escape(r.name), r.found.median, r.unit, r.goal.empty() ? "" : r.reached ? "yes" : "no", r.found.p95,
                            r.found.worst, r.found.count, escape(r.goal));
    html += fmt::format(
        "</table><p>Dark updates while following: {} of {}. One marker covered: lit in {} of {} updates. "
        "Two markers left: lit in {} of {} (must be none).</p>",
        s.dark_updates, s.updates, s.lost_marker_lit, s.lost_marker_updates, s.too_few_lit, s.too_few_updates);
    for (const auto& refusal : s.refusals) html += fmt::format("<p class=\"no\">{}</p>", escape(refusal));
    return html;
}

std::string preparation_section(const Preparation& p) {
    const Case& c = p.prepared;
    std::string html = fmt::format(
        "<h2>Before the operation</h2><p>Skin at {:.0f}; {} pieces ({:.0f} ml: head holder, table, wires) taken away; "
        "{} triangles. LUT {} x {} x {} voxels of {:.1f} mm, each pointing to one of {} skin voxels. "
        "Skin {:.2f} s, surface {:.2f} s, LUT {:.2f} s.</p>",
        p.threshold, p.pieces_removed, p.removed_ml, c.skin.triangles.size(), c.lut.size[0], c.lut.size[1], c.lut.size[2],
        c.lut.voxel_mm, c.lut.skin.size(), p.segment_s, p.triangulate_s, p.lut_s);
    for (const auto& warning : c.warnings) html += fmt::format("<p class=\"no\">{}</p>", escape(warning));
    return html;
}

}  // namespace

void write_report_html(const std::filesystem::path& file, const Preparation& prepared, const std::vector<ChainFigures>& rooms,
                       const std::vector<ReportPicture>& pictures) {
    std::string html = fmt::format(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Planlight report</title><style>{}</style></head>"
        "<body><main><h1>Light on the patient</h1><p class=\"muted\">Case {}. All errors are those of a simulated operating "
        "room with its own optics and the CT field as the true skin; no real projector or camera was measured. "
        "For research; not a medical device.</p>",
        kStyle, escape(prepared.prepared.code));
    for (const auto* preset : {"modern", "paper"})
        if (const auto s = summarise(rooms, preset); s.rooms > 0) html += preset_section(s);
    html += preparation_section(prepared) + "<h2>Step by step</h2><div class=\"grid\">";
    for (const auto& p : pictures)
        html += fmt::format("<figure><img alt=\"{}\" src=\"{}\"><figcaption><b>{}</b>{}</figcaption></figure>", escape(p.title),
                            embedded(p.picture, file), escape(p.title), escape(p.caption));
    html += "</div></main></body></html>\n";
    write_safely(file, html);
}

}  // namespace planlight
