#include "app/report/preparation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/report/paper_page.h"
#include "app/report/plan_facts.h"
#include "app/report/preparation_json.h"
#include "app/windows/distance_colours.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/files/header_text.h"
#include "planning_io/files/safe_write.h"

namespace planlight {
namespace {

constexpr std::size_t kPiecesListed = 5;

/// A row of a table of two columns; none where there is nothing to say.
std::string row(const std::string& name, const std::string& value) {
    return value.empty() ? "" : fmt::format("<tr><td>{}</td><td>{}</td></tr>", name, xml_escaped(value));
}

std::string figure(const ReportPicture& p) {
    return fmt::format("<figure><img alt=\"{}\" src=\"{}\"><figcaption><b>{}</b> {}</figcaption></figure>",
                       xml_escaped(p.title), embedded_png(p.picture), xml_escaped(p.title), xml_escaped(p.caption));
}

std::string figures_in_a_row(const std::vector<ReportPicture>& pictures, int columns) {
    std::string html = fmt::format("<div class=\"row\" style=\"grid-template-columns:repeat({},1fr)\">", columns);
    for (const auto& picture : pictures) html += figure(picture);
    return html + "</div>";
}

/// What is said of several items of the plan is said once: "A; B; C: it has no depth".
std::vector<std::string> gathered(const std::vector<std::string>& warnings, const PlanDrawing& drawing) {
    std::vector<std::pair<std::string, std::string>> lines;  // whom it is said of, what
    for (const std::string& warning : warnings) {
        std::string of;
        for (const DrawnItem& item : drawing.items)
            if (!item.name.empty() && item.name.size() > of.size() && warning.starts_with(item.name + ": "))
                of = item.name;
        const std::string what = of.empty() ? warning : warning.substr(of.size());
        const auto said = std::find_if(lines.begin(), lines.end(),
                                       [&](const auto& line) { return !of.empty() && line.second == what; });
        if (said == lines.end())
            lines.emplace_back(of, what);
        else
            said->first += "; " + of;
    }
    std::vector<std::string> result;
    for (const auto& [of, what] : lines) result.push_back(of + what);
    return result;
}

std::string warnings_html(const std::vector<std::string>& warnings) {
    if (warnings.empty())
        return "<div class=\"verdict good\">&#10003; Prepared without a warning. The pictures below decide whether it "
               "may be used.</div>";
    std::string html = fmt::format(
        "<div class=\"verdict look\">&#9888; Prepared with {}. Look at each before this "
        "is used.</div><ul>",
        counted(static_cast<long long>(warnings.size()), "warning"));
    for (const auto& warning : warnings) html += fmt::format("<li>{}</li>", xml_escaped(warning));
    return html + "</ul>";
}

/// Whether the first sheet can be one page, with pictures that are no smaller than can be judged.
bool fit_on_a_page(const std::vector<std::string>& warnings) {
    constexpr std::size_t kLine = 105, kMostLines = 13;
    std::size_t lines = 0;
    for (const auto& warning : warnings) lines += 1 + warning.size() / kLine;
    return lines <= kMostLines;
}

std::string contents_of(const Plan& plan) {
    std::string words;
    const auto add = [&](std::size_t count, const char* noun, const char* several) {
        if (count > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", count, count == 1 ? noun : several);
    };
    add(plan.osteotomy_lines.size(), "osteotomy line", "osteotomy lines");
    add(plan.boreholes.size(), "borehole", "boreholes");
    add(plan.trajectories.size(), "trajectory", "trajectories");
    add(plan.cut_planes.size(), "cut plane", "cut planes");
    return words.empty() ? "nothing" : words;
}

std::string risk_structures_of(const Plan& plan) {
    std::string names;
    for (const auto& structure : plan.risk_structures) names += (names.empty() ? "" : ", ") + structure.name;
    return names;
}

/// "2025-02-01 09:30 UTC" of an ISO 8601 time.
std::string time_in_words(const std::string& iso) {
    if (iso.size() < 16 || iso[10] != 'T') return iso;
    return iso.substr(0, 10) + " " + iso.substr(11, 5) + (iso.ends_with('Z') ? " UTC" : "");
}

std::string threshold_of(const Preparation& done) {
    if (done.on_given_surface) return "none: the surface was given, not segmented here";
    return fmt::format("{:.4g} {}, {}", done.threshold, done.volume.is_hu ? "HU" : "(stored values, not HU)",
                       done.threshold_given ? "given by hand" : "found automatically");
}

std::string cut_sides_of(const SkinJudgement& skin) {
    std::string words;
    for (const CutSide& side : skin.cut_sides)
        words += fmt::format("{}{}, {:.0f} cm²", words.empty() ? "" : "; ", side.name, side.area_cm2);
    return words;
}

std::string series_of(const CaseNames& names) {
    if (names.series_date.empty()) return names.series;
    return names.series.empty() ? "of " + names.series_date : names.series + ", " + names.series_date;
}

std::string identity_html(const Preparation& done) {
    const Case& c = done.prepared;
    const VolumeFacts& v = done.volume;
    const std::string left = row("Patient", c.names.patient.empty() ? "not named" : c.names.patient) +
                             row("Title", c.names.title) +
                             row("Plan", c.names.plan.empty() ? "not named" : c.names.plan) +
                             row("Version of the plan", c.names.plan_version) + row("It holds", contents_of(c.plan)) +
                             row("Risk structures", risk_structures_of(c.plan)) + row("Case", c.code) +
                             row("Prepared", time_in_words(c.created)) +
                             (done.on_given_surface ? "" : row("Body", fmt::format("{:.0f} ml", done.body_ml))) +
                             row("Cut off by the volume", cut_sides_of(done.judgement));
    const std::string right =
        row("Source", c.source) + row("Series", series_of(c.names)) +
        row("Modality",
            v.modality.empty() ? "not said" : v.modality + (v.modality == "CT" && !v.is_hu ? ", not in HU" : "")) +
        row("Voxels", fmt::format("{} x {} x {} of {:.2f} x {:.2f} x {:.2f} mm", v.size[0], v.size[1], v.size[2],
                                  v.voxel_mm.x(), v.voxel_mm.y(), v.voxel_mm.z())) +
        (done.on_given_surface ? "" : row("Skin threshold", threshold_of(done))) +
        (done.brightness_ratio > 1 ? row("Evened out", fmt::format("{:.1f} : 1 across the head", done.brightness_ratio))
                                   : "") +
        (c.skin_edge_sigma_mm > 0
             ? row("The skin's edge", fmt::format("uncertain by {:.2f} mm (1 sigma)", c.skin_edge_sigma_mm))
             : "") +
        (done.judgement.fat_shift_mm > 0
             ? row("Fat is drawn aside", fmt::format("{:.1f} mm along {} (chemical shift)", done.judgement.fat_shift_mm,
                                                     done.judgement.fat_shift_along))
             : "");
    return fmt::format("<div class=\"two\"><table>{}</table><table>{}</table></div>", left, right);
}

std::string slices_html(const PreparationPictures& pictures) {
    std::string html = "<h2>Through the middle of the head</h2>" + figures_in_a_row(pictures.middle_slices, 3);
    if (!pictures.plan_slices.empty()) html += "<h2>Through the plan</h2>" + figures_in_a_row(pictures.plan_slices, 3);
    return html +
           "<p class=\"muted\">Green: the skin as found. Amber: lids over openings. Grey line: ends of the scan. Pink: "
           "the plan within 3 mm of the slice. Blue: risk structures. The green line must follow the skin wherever "
           "there is skin.</p>";
}

/// Large things in front of the head were skin more often than they were a table.
bool may_be_face(const RemovedPiece& piece, const Eigen::Vector3d& middle_in_ct) {
    const Eigen::Vector3d away = piece.middle_in_ct - middle_in_ct;
    return piece.ml > 10 && -away.y() > 0.6 * away.norm();
}

std::string pieces_html(const RemovedPieces& removed) {
    std::string html = fmt::format(
        "<div class=\"small\"><p><b>{} as dense as skin thrown away, {:.0f} ml in all</b> (table, head "
        "holder, wires?). Look whether none of it is the patient.</p><table>",
        counted(static_cast<long long>(removed.pieces.size()), "piece"), removed.ml());
    for (std::size_t i = 0; i < std::min(kPiecesListed, removed.pieces.size()); ++i) {
        const RemovedPiece& piece = removed.pieces[i];
        const Eigen::Vector3d size = piece.high_in_ct - piece.low_in_ct;
        html += fmt::format("<tr><td>{}</td><td>{:.{}f} ml, {:.0f} x {:.0f} x {:.0f} mm, {}{}</td></tr>", i + 1,
                            piece.ml, piece.ml < 10 ? 1 : 0, size.x(), size.y(), size.z(),
                            place_in_words(piece.middle_in_ct, removed.body_middle_in_ct),
                            may_be_face(piece, removed.body_middle_in_ct)
                                ? " <span class=\"stop\">&#9888; is this the face?</span>"
                                : "");
    }
    return html + "</table></div>";
}

/// The view from above and beside it what was thrown away.
std::string second_row(const PreparationPictures& pictures, const RemovedPieces& removed) {
    std::string html = "<div class=\"row\" style=\"grid-template-columns:repeat(4,1fr)\">";
    if (pictures.views.size() > 4) html += figure(pictures.views[4]);
    for (const auto& picture : removed.pictures)
        html += figure({"Thrown away", picture.title + ": red", picture.picture});
    return html + (removed.pieces.empty() ? "<p>Nothing as dense as skin was thrown away.</p>" : pieces_html(removed)) +
           "</div>";
}

/// Which colour in the views is which structure.
std::string legend_of_risks(const Plan& plan) {
    if (plan.risk_structures.empty()) return {};
    std::string html = "<p class=\"muted\">Seen through the skin:";
    for (std::size_t i = 0; i < plan.risk_structures.size(); ++i) {
        const Rgb c = risk_colour(i);
        html += fmt::format("{} <span style=\"color:#{:02x}{:02x}{:02x}\">&#9632;</span>&nbsp;{}", i > 0 ? "," : "",
                            c[0], c[1], c[2], xml_escaped(plan.risk_structures[i].name));
    }
    return html + ".</p>";
}

std::string views_html(const Preparation& done, const PreparationPictures& pictures, const RemovedPieces& removed) {
    std::string html = "<h2>The skin with the plan, and what was thrown away</h2>";
    if (pictures.views.size() >= 4)
        html += figures_in_a_row({pictures.views.begin(), pictures.views.begin() + 4}, 4);
    else
        html += fmt::format("<p class=\"look\">{}</p>", xml_escaped(pictures.no_views));
    if (pictures.views.size() >= 4) html += legend_of_risks(done.prepared.plan);
    if (!cut_sides_of(done.judgement).empty())
        html += "<p class=\"muted\">Grey on the skin: where the scan ends within the head; that is no skin.</p>";
    if (done.on_given_surface)
        return html + (pictures.views.size() > 4 ? figures_in_a_row({pictures.views[4]}, 4) : "") +
               "<p>The surface was given: nothing was thrown away here.</p>";
    return html + second_row(pictures, removed);
}

std::string number(const std::optional<double>& value, int digits, const char* unit) {
    return value ? fmt::format("{:.{}f}{}", *value, digits, unit) : std::string("–");
}

/// `with_risk`: the plan holds risk structures, and the kind stands below the name, so that all columns have room.
std::string fact_html(const PlanFact& fact, bool with_risk) {
    constexpr double kDegrees = 57.29577951308232;
    const auto figure = [](const std::string& text) { return "<td class=\"figure\">" + text + "</td>"; };
    const std::string name = (fact.lit.empty() ? "" : fmt::format("<b>{}</b>&ensp;", xml_escaped(fact.lit))) +
                             xml_escaped(fact.name.empty() ? "without a name" : fact.name) +
                             (with_risk ? fmt::format("<br><span class=\"muted\">{}</span>", fact.kind) : "");
    return fmt::format("<tr><td class=\"name\">{}</td>", name) + (with_risk ? "" : figure(fact.kind)) +
           figure(fact.left_of_middle_mm ? side_in_words(*fact.left_of_middle_mm) : "–") +
           figure(number(fact.depth_mm ? fact.depth_mm : fact.length_mm, 1, " mm")) +
           figure(number(fact.diameter_mm, 1, " mm")) +
           figure(fact.tilt ? fmt::format("{:.0f}°", kDegrees * *fact.tilt) : "–") +
           fmt::format("<td class=\"words\">{}</td>",
                       fact.inwards_in_ct ? direction_in_words(*fact.inwards_in_ct) : "–") +
           figure(number(fact.over_bone_mm, 1, " mm")) +
           fmt::format("<td class=\"words {}\">{}</td>", class_of(fact.gravity), xml_escaped(fact.distance)) +
           (with_risk ? fmt::format("<td class=\"risk\">{}</td>", risk_html(fact.clearances)) : "") + "</tr>";
}

std::string plan_html(const std::vector<PlanFact>& facts) {
    if (facts.empty()) return "<h2>The plan</h2><p>It holds nothing.</p>";
    const bool with_risk =
        std::any_of(facts.begin(), facts.end(), [](const PlanFact& fact) { return !fact.clearances.empty(); });
    std::string html = fmt::format(
        "<h2>The plan</h2><table class=\"plan{}\"><thead><tr><th>Name</th>{}<th>Side of its middle</th><th>Depth or "
        "length</th><th>Diameter</th><th>Tilt from the skin's perpen&shy;dicular</th><th>Direction inwards</th>"
        "<th>Soft tissue over bone</th><th>Its points lie</th>{}</tr></thead>",
        with_risk ? " tight" : "", with_risk ? "" : "<th>Kind</th>", with_risk ? "<th>Next risk structure</th>" : "");
    bool by_code = false;
    for (const auto& fact : facts) html += fact_html(fact, with_risk), by_code = by_code || !fact.lit.empty();
    return html + "</table>" +
           (with_risk
                ? "<p class=\"muted\">Distances to risk structures are those of the plan, from the instrument's, the "
                  "drill's or the cut's own surface, rounded down. They do not hold how far off the light, the hand "
                  "or the drawing of the structure may be.</p>"
                : "") +
           (by_code ? "<p class=\"muted\">In bold: the code that the light has in place of the name.</p>" : "");
}

std::string figures_html(const Preparation& done) {
    const Case& c = done.prepared;
    const std::string times = done.on_given_surface ? fmt::format("table {:.2f} s", done.lut_s)
                                                    : fmt::format("skin {:.2f} s, surface {:.2f} s, table {:.2f} s",
                                                                  done.segment_s, done.triangulate_s, done.lut_s);
    return fmt::format(
        "<p class=\"muted\">Skin mesh: {} triangles, {} vertices. Table: {} x {} x {} voxels of {:.2f} mm, {} skin "
        "voxels. "
        "Times: {}. Volume {}, plan {}.</p>",
        c.skin.triangles.size(), c.skin.vertices_in_ct.size(), c.lut.size[0], c.lut.size[1], c.lut.size[2],
        c.lut.voxel_mm, c.lut.skin.size(), times, c.volume_hash, c.plan_hash);
}

std::string signatures_html() {
    std::string html;
    for (const char* who : {"Prepared by", "Skin, plan and patient checked by"})
        html +=
            fmt::format("<div class=\"sign\"><span>{}</span><span>Date, time</span><span>Signature</span></div>", who);
    return html;
}

}  // namespace

PreparationReport preparation_report(const Preparation& done, const PlanDrawing& drawing, const RemovedPieces& removed,
                                     const PreparationPictures& pictures) {
    const Case& c = done.prepared;
    const SkinSurface skin(c.skin);
    const std::vector<PlanFact> facts = plan_facts(c.plan, drawing, c.lut, find_mid_plane(skin), &skin);
    const std::vector<std::string> warnings = gathered(c.warnings, drawing);
    const std::string first =
        fmt::format(
            "<h1>{}</h1><p class=\"muted\">Report of preparation. Research software, not a medical "
            "device.</p>",
            xml_escaped(title_of(c))) +
        warnings_html(warnings) + identity_html(done) + slices_html(pictures);
    const std::string second =
        views_html(done, pictures, removed) + plan_html(facts) + figures_html(done) + signatures_html();
    const std::string body = fmt::format("<section class=\"sheet{}\">", fit_on_a_page(warnings) ? " fit" : "") + first +
                             "</section><section class=\"sheet\">" + second + "</section>";
    return {paper_page("Preparation: " + title_of(c), body,
                       fmt::format("{} · case {} · prepared {}", title_of(c), c.code, time_in_words(c.created))),
            preparation_json(done, drawing, facts, removed)};
}

void write_preparation_report(const PreparationReport& report, const std::filesystem::path& folder) {
    write_safely(folder / "report.html", report.html);
    write_safely(folder / "report.json", report.json);
}

}  // namespace planlight
