#include <fmt/format.h>

#include <filesystem>

#include "app/evaluation/chain_report.h"
#include "app/report/html_page.h"
#include "planning_io/files/safe_write.h"

namespace planlight {
namespace {

std::string preset_section(const PresetSummary& s) {
    const std::vector<std::string> missed = s.missed();
    const char* mark = missed.empty() ? "yes" : "no";
    std::string html = fmt::format(
        "<h2>{} room</h2><div class=\"verdict {}\">{} {} of {} patients found from a random pose ({} by the program "
        "alone, {} "
        "after a person's look), {} refused.{}</div>",
        s.preset == "paper" ? "The paper's" : "The modern", mark, missed.empty() ? "&#10003;" : "&#10007;",
        s.matched_right, s.rooms, s.said_yes, s.said_ask, s.refused,
        missed.empty() ? "" : xml_escaped(fmt::format(" Missed: {}.", fmt::join(missed, "; "))));
    html +=
        "<table><tr><th>Error against the simulator's truth</th><th>median</th><th>95 "
        "%</th><th>worst</th><th>count</th>"
        "<th>to reach</th></tr>";
    for (const auto& r : s.rows)
        html += fmt::format(
            "<tr><td>{}</td><td>{:.2f} {}</td><td class=\"{}\">{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{}</td></tr>",
            xml_escaped(r.name), r.found.median, r.unit,
            r.goal.empty() ? ""
            : r.reached    ? "yes"
                           : "no",
            r.found.p95, r.found.worst, r.found.count, xml_escaped(r.goal));
    html += fmt::format(
        "</table><p>Dark updates while following: {} of {}. One marker covered: lit in {} of {} updates. "
        "Two markers left: lit in {} of {} (must be none).</p>",
        s.dark_updates, s.updates, s.lost_marker_lit, s.lost_marker_updates, s.too_few_lit, s.too_few_updates);
    for (const auto& refusal : s.refusals) html += fmt::format("<p class=\"no\">{}</p>", xml_escaped(refusal));
    return html;
}

std::string preparation_section(const Preparation& p) {
    const Case& c = p.prepared;
    std::string html = fmt::format(
        "<h2>Before the operation</h2><p>Skin at {:.0f}; {} pieces ({:.0f} ml: head holder, table, wires) taken away; "
        "{} triangles. LUT {} x {} x {} voxels of {:.1f} mm, each pointing to one of {} skin voxels. "
        "Skin {:.2f} s, surface {:.2f} s, LUT {:.2f} s.</p>",
        p.threshold, p.pieces_removed, p.removed_ml, c.skin.triangles.size(), c.lut.size[0], c.lut.size[1],
        c.lut.size[2], c.lut.voxel_mm, c.lut.skin.size(), p.segment_s, p.triangulate_s, p.lut_s);
    for (const auto& warning : c.warnings) html += fmt::format("<p class=\"no\">{}</p>", xml_escaped(warning));
    return html;
}

}  // namespace

void write_report_html(const std::filesystem::path& file, const Preparation& prepared,
                       const std::vector<ChainFigures>& rooms, const std::vector<ReportPicture>& pictures) {
    std::string html(
        "<p class=\"muted\">All errors are those of a simulated operating room with its own optics and the CT field as "
        "the "
        "true skin; no real projector or camera was measured.</p>");
    for (const auto* preset : {"modern", "paper"})
        if (const auto s = summarise(rooms, preset); s.rooms > 0) html += preset_section(s);
    html += preparation_section(prepared) + "<h2>Step by step</h2>" + html_figures(pictures);
    ReportFacts facts = facts_of(prepared.prepared);
    facts.emplace_back("Rig", "simulated rooms, one a seed");
    write_safely(file, html_page("Light on the patient", html, facts));
}

}  // namespace planlight
