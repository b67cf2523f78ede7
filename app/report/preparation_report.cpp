#include "app/report/preparation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/report/plan_facts.h"
#include "app/report/preparation_json.h"
#include "app/windows/distance_colours.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/files/header_text.h"
#include "planning_io/files/safe_write.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

constexpr std::size_t kPiecesListed = 5;

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

PageVerdict verdict_of(const std::vector<std::string>& warnings) {
    if (warnings.empty())
        return {PageVerdict::Kind::good,
                "Prepared without a warning. The pictures below decide whether it may be used.",
                {}};
    return {PageVerdict::Kind::look,
            fmt::format("Prepared with {}. Look at each before this is used.",
                        counted(static_cast<long long>(warnings.size()), "warning")),
            warnings};
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
    return fmt::format("{} {}, {}", threshold_text(done.threshold),
                       done.volume.is_hu ? "HU" : "(stored values, not HU)",
                       done.threshold_given ? "given by hand" : "found automatically");
}

std::string cut_sides_of(const SkinJudgement& skin) {
    std::string words;
    for (const CutSide& side : skin.cut_sides)
        words += fmt::format("{}{}, {:.0f} cm²", words.empty() ? "" : "; ", side.name, side.area_cm2);
    return words;
}

/// A chin that is cut off shows its end from below alone.
bool is_cut_below(const SkinJudgement& skin) {
    return std::ranges::any_of(skin.cut_sides, [](const CutSide& side) { return side.name == "chin"; });
}

std::string series_of(const CaseNames& names) {
    if (names.series_date.empty()) return names.series;
    return names.series.empty() ? "of " + names.series_date : names.series + ", " + names.series_date;
}

ReportFacts facts_of_plan(const Preparation& done, const std::string& operator_name) {
    const Case& c = done.prepared;
    return {{"Patient", c.names.patient.empty() ? "not named" : c.names.patient},
            {"Title", c.names.title},
            {"Plan", c.names.plan.empty() ? "not named" : c.names.plan},
            {"Version of the plan", c.names.plan_version},
            {"It holds", contents_of(c.plan)},
            {"Risk structures", risk_structures_of(c.plan)},
            {"Case", c.code},
            {"Prepared", time_in_words(c.created)},
            {"Operator", operator_name},
            {"Program", program_name()},
            {"Body", done.on_given_surface ? "" : fmt::format("{:.0f} ml", done.body_ml)},
            {"Cut off by the volume", cut_sides_of(done.judgement)}};
}

ReportFacts facts_of_volume(const Preparation& done) {
    const Case& c = done.prepared;
    const VolumeFacts& v = done.volume;
    return {{"Source", c.source},
            {"Series", series_of(c.names)},
            {"Modality",
             v.modality.empty() ? "not said" : v.modality + (v.modality == "CT" && !v.is_hu ? ", not in HU" : "")},
            {"Voxels", fmt::format("{} x {} x {} of {:.2f} x {:.2f} x {:.2f} mm", v.size[0], v.size[1], v.size[2],
                                   v.voxel_mm.x(), v.voxel_mm.y(), v.voxel_mm.z())},
            {"Skin threshold", done.on_given_surface ? "" : threshold_of(done)},
            {"Evened out",
             done.brightness_ratio > 1 ? fmt::format("{:.1f} : 1 across the head", done.brightness_ratio) : ""},
            {"The skin's edge",
             c.skin_edge_sigma_mm > 0 ? fmt::format("uncertain by {:.2f} mm (1 sigma)", c.skin_edge_sigma_mm) : ""},
            {"Fat is drawn aside", done.judgement.fat_shift_mm > 0
                                       ? fmt::format("{:.1f} mm along {} (chemical shift)", done.judgement.fat_shift_mm,
                                                     done.judgement.fat_shift_along)
                                       : ""}};
}

void add_slices(const PreparationPictures& pictures, bool on_given_surface, std::vector<DocumentBlock>& blocks) {
    blocks.push_back(DocumentHeading{"Through the middle of the head"});
    blocks.push_back(figures_of(pictures.middle_slices, 3));
    if (!pictures.plan_slices.empty()) {
        blocks.push_back(DocumentHeading{"Through the plan"});
        blocks.push_back(figures_of(pictures.plan_slices, 3));
    }
    blocks.push_back(DocumentText{
        on_given_surface
            ? "Green: the surface that was given. Pink: the plan within 3 mm of the slice. Blue: risk "
              "structures. The green line must follow the bone, or what else the surface is of, everywhere."
            : "Green: the skin as found. Amber: lids over openings. Grey line: ends of the scan. Pink: the "
              "plan within 3 mm of the slice. Blue: risk structures. The green line must follow the skin "
              "wherever there is skin.",
        Tone::quiet});
}

/// Large things in front of the head were skin more often than they were a table.
bool may_be_face(const RemovedPiece& piece, const Eigen::Vector3d& middle_in_ct) {
    const Eigen::Vector3d away = piece.middle_in_ct - middle_in_ct;
    return piece.ml > 10 && -away.y() > 0.6 * away.norm();
}

DocumentText piece_in_words(const RemovedPiece& piece, const Eigen::Vector3d& middle_in_ct) {
    const Eigen::Vector3d size = piece.high_in_ct - piece.low_in_ct;
    const bool face = may_be_face(piece, middle_in_ct);
    return {fmt::format("{:.{}f} ml, {:.0f} x {:.0f} x {:.0f} mm, {}{}", piece.ml, piece.ml < 10 ? 1 : 0, size.x(),
                        size.y(), size.z(), place_in_words(piece.middle_in_ct, middle_in_ct),
                        face ? " ⚠ is this the face?" : ""),
            face ? Tone::stop : Tone::plain};
}

/// The view from above and beside it what was thrown away.
DocumentFigures second_row(const PreparationPictures& pictures, const RemovedPieces& removed) {
    DocumentFigures row{{}, 4};
    if (pictures.views.size() > 4) row = figures_of({pictures.views[4]}, 4);
    for (const auto& picture : removed.pictures)
        row.figures.push_back({"Thrown away", picture.title + ": red", picture.picture});
    if (removed.pieces.empty()) {
        row.beside = {{"Nothing as dense as skin was thrown away."}};
        return row;
    }
    row.beside = {{"(table, head holder, wires?). Look whether none of it is the patient.", Tone::plain,
                   fmt::format("{} as dense as skin thrown away, {:.0f} ml in all",
                               counted(static_cast<long long>(removed.pieces.size()), "piece"), removed.ml())}};
    row.table_beside = DocumentTable{{{""}, {""}}, {}, true};
    for (std::size_t i = 0; i < std::min(kPiecesListed, removed.pieces.size()); ++i)
        row.table_beside->rows.push_back(
            {{std::to_string(i + 1)}, piece_in_words(removed.pieces[i], removed.body_middle_in_ct)});
    return row;
}

/// Which colour in the views is which structure.
DocumentKey key_of_risks(const Plan& plan) {
    DocumentKey key{"Seen through the skin:", {}};
    for (std::size_t i = 0; i < plan.risk_structures.size(); ++i)
        key.colours.emplace_back(risk_colour(i), plan.risk_structures[i].name);
    return key;
}

void add_views(const Preparation& done, const PreparationPictures& pictures, const RemovedPieces& removed,
               std::vector<DocumentBlock>& blocks) {
    const bool drawn = pictures.views.size() >= 4;
    blocks.push_back(DocumentHeading{"The skin with the plan, and what was thrown away"});
    if (drawn) {
        std::vector<ReportPicture> views(pictures.views.begin(), pictures.views.begin() + 4);
        if (is_cut_below(done.judgement) && pictures.views.size() > 5) views.push_back(pictures.views[5]);
        blocks.push_back(figures_of(views, static_cast<int>(views.size())));
    } else {
        blocks.push_back(DocumentText{pictures.no_views, Tone::look});
    }
    if (drawn && !done.prepared.plan.risk_structures.empty()) blocks.push_back(key_of_risks(done.prepared.plan));
    if (!cut_sides_of(done.judgement).empty())
        blocks.push_back(
            DocumentText{"Grey on the skin: where the scan ends within the head; that is no skin.", Tone::quiet});
    if (!done.on_given_surface) {
        blocks.push_back(second_row(pictures, removed));
        return;
    }
    if (pictures.views.size() > 4) blocks.push_back(figures_of({pictures.views[4]}, 4));
    blocks.push_back(DocumentText{"The surface was given: nothing was thrown away here."});
}

/// A figure and its unit stay on one line.
std::string unbroken(std::string text) {
    for (std::size_t at = text.find(' '); at != std::string::npos; at = text.find(' ', at))
        text.replace(at, 1, "\u00a0");
    return text;
}

std::string number(const std::optional<double>& value, int digits, const char* unit) {
    return value ? fmt::format("{:.{}f}{}", *value, digits, unit) : std::string("–");
}

Tone tone_of(Gravity gravity) {
    return gravity == Gravity::stop ? Tone::stop : gravity == Gravity::look ? Tone::look : Tone::plain;
}

DocumentText risk_of(const Clearances& clearances) {
    std::string words = risk_in_words(clearances);
    static const std::string kUnit = " mm to ", kUnbroken = "\u00a0mm to ";
    for (std::size_t at = words.find(kUnit); at != std::string::npos; at = words.find(kUnit, at))
        words.replace(at, kUnit.size(), kUnbroken);
    return {words, tone_of(gravity_of(clearances))};
}

/// `with_risk`: the plan holds risk structures, and the kind stands below the name, so that all columns have room.
std::vector<DocumentText> row_of(const PlanFact& fact, bool with_risk) {
    constexpr double kDegrees = 57.29577951308232;
    std::vector<DocumentText> row{{fact.name.empty() ? "without a name" : fact.name, Tone::plain, fact.lit,
                                   with_risk ? fact.kind : std::string()}};
    if (!with_risk) row.push_back({unbroken(fact.kind)});
    for (const std::string& figure :
         {fact.left_of_middle_mm ? side_in_words(*fact.left_of_middle_mm) : "–",
          number(fact.depth_mm ? fact.depth_mm : fact.length_mm, 1, " mm"), number(fact.diameter_mm, 1, " mm"),
          fact.tilt ? fmt::format("{:.0f}°", kDegrees * *fact.tilt) : "–"})
        row.push_back({unbroken(figure)});
    row.push_back({fact.inwards_in_ct ? direction_in_words(*fact.inwards_in_ct) : "–"});
    row.push_back({unbroken(number(fact.over_bone_mm, 1, " mm"))});
    row.push_back({fact.distance, tone_of(fact.gravity)});
    if (with_risk) row.push_back(risk_of(fact.clearances));
    return row;
}

DocumentTable table_of(const std::vector<PlanFact>& facts, bool with_risk) {
    using Kind = DocumentTable::Kind;
    DocumentTable table{{{"Name", Kind::name}}, {}, true};
    if (!with_risk) table.columns.push_back({"Kind", Kind::figure});
    for (const char* figure :
         {"Side of its middle", "Depth or length", "Diameter", "Tilt from the skin's perpen\u00addicular"})
        table.columns.push_back({figure, Kind::figure});
    table.columns.push_back({"Direction inwards"});
    table.columns.push_back({"Soft tissue over bone", Kind::figure});
    table.columns.push_back({"Its points lie"});
    if (with_risk) table.columns.push_back({"Next risk structure"});
    for (const PlanFact& fact : facts) table.rows.push_back(row_of(fact, with_risk));
    return table;
}

void add_plan(const std::vector<PlanFact>& facts, std::vector<DocumentBlock>& blocks) {
    blocks.push_back(DocumentHeading{"The plan"});
    if (facts.empty()) {
        blocks.push_back(DocumentText{"It holds nothing."});
        return;
    }
    const auto any = [&](auto of) { return std::any_of(facts.begin(), facts.end(), of); };
    const bool with_risk = any([](const PlanFact& fact) { return !fact.clearances.empty(); });
    blocks.push_back(table_of(facts, with_risk));
    if (with_risk)
        blocks.push_back(DocumentText{
            "Distances to risk structures are those of the plan, from the instrument's, the drill's or the "
            "cut's own surface, rounded down. They do not hold how far off the light, the hand or the "
            "drawing of the structure may be.",
            Tone::quiet});
    if (any([](const PlanFact& fact) { return !fact.lit.empty(); }))
        blocks.push_back(DocumentText{"In bold: the code that the light has in place of the name.", Tone::quiet});
}

DocumentText figures_in_words(const Preparation& done) {
    const Case& c = done.prepared;
    const std::string times = done.on_given_surface ? fmt::format("table {:.2f} s", done.lut_s)
                                                    : fmt::format("skin {:.2f} s, surface {:.2f} s, table {:.2f} s",
                                                                  done.segment_s, done.triangulate_s, done.lut_s);
    return {
        fmt::format("Skin mesh: {} triangles, {} vertices. Table: {} x {} x {} voxels of {:.2f} mm, {} skin voxels. "
                    "Times: {}. Volume {}, plan {}.",
                    c.skin.triangles.size(), c.skin.vertices_in_ct.size(), c.lut.size[0], c.lut.size[1], c.lut.size[2],
                    c.lut.voxel_mm, c.lut.skin.size(), times, c.volume_hash, c.plan_hash),
        Tone::quiet};
}

}  // namespace

PreparationReport preparation_report(const Preparation& done, const PlanDrawing& drawing, const RemovedPieces& removed,
                                     const PreparationPictures& pictures, const std::string& operator_name) {
    const Case& c = done.prepared;
    const SkinSurface skin(c.skin);
    const std::vector<PlanFact> facts = plan_facts(c.plan, drawing, c.lut, find_mid_plane(skin), &skin);
    Document document{"Preparation: " + title_of(c), "Report of preparation. Research software, not a medical device."};
    document.made_of_sheets = true;
    document.verdict = verdict_of(gathered(c.warnings, drawing));
    document.facts = facts_of_plan(done, operator_name);
    const ReportFacts of_volume = facts_of_volume(done);
    document.facts.insert(document.facts.end(), of_volume.begin(), of_volume.end());
    add_slices(pictures, done.on_given_surface, document.blocks);
    document.blocks.push_back(NewSheet{});
    add_views(done, pictures, removed, document.blocks);
    add_plan(facts, document.blocks);
    document.blocks.push_back(figures_in_words(done));
    document.signed_by = {"Prepared by", "Skin, plan and patient checked by"};
    const std::string title = title_of(c);
    document.foot =
        fmt::format("{}{} · prepared {}", title, title.find(c.code) == std::string::npos ? " · case " + c.code : "",
                    time_in_words(c.created));
    return {std::move(document), preparation_json(done, drawing, facts, removed)};
}

void write_preparation_report(const PreparationReport& report, const std::filesystem::path& folder) {
    write_safely(folder / "report.html", html_of(report.document));
    write_safely(folder / "report.json", report.json);
}

}  // namespace planlight
