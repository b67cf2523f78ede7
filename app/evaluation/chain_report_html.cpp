#include <fmt/format.h>

#include "app/evaluation/chain_report.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

const char* room_of(const PresetSummary& summary) {
    return summary.preset == "paper" ? "The paper's room" : "The modern room";
}

DocumentTable errors_of(const PresetSummary& summary) {
    DocumentTable table{
        {{"Error against the simulator's truth"}, {"median"}, {"95 %"}, {"worst"}, {"count"}, {"to reach"}}, {}};
    for (const auto& r : summary.rows) {
        const Tone tone = r.goal.empty() ? Tone::plain : r.reached ? Tone::good : Tone::stop;
        table.rows.push_back({{r.name},
                              {fmt::format("{:.2f} {}", r.found.median, r.unit)},
                              {fmt::format("{:.2f}{}", r.found.p95, tone == Tone::stop ? " ✗" : ""), tone},
                              {fmt::format("{:.2f}", r.found.worst)},
                              {std::to_string(r.found.count)},
                              {r.goal}});
    }
    return table;
}

void add_preset(const PresetSummary& s, std::vector<DocumentBlock>& blocks) {
    const std::vector<std::string> missed = s.missed();
    blocks.push_back(DocumentHeading{room_of(s)});
    blocks.push_back(DocumentText{
        fmt::format(
            "{} of {} patients found from a random pose ({} by the program alone, {} after a person's look), {} "
            "refused.{}",
            s.matched_right, s.rooms, s.said_yes, s.said_ask, s.refused,
            missed.empty() ? "" : fmt::format(" Missed: {}.", fmt::join(missed, "; "))),
        missed.empty() ? Tone::good : Tone::stop});
    blocks.push_back(errors_of(s));
    blocks.push_back(DocumentText{fmt::format(
        "Dark updates while following: {} of {}. One marker covered: lit in {} of {} updates. Two markers left: lit in "
        "{} of {} (must be none).",
        s.dark_updates, s.updates, s.lost_marker_lit, s.lost_marker_updates, s.too_few_lit, s.too_few_updates)});
    for (const auto& refusal : s.refusals) blocks.push_back(DocumentText{refusal, Tone::stop});
}

void add_preparation(const Preparation& p, std::vector<DocumentBlock>& blocks) {
    const Case& c = p.prepared;
    blocks.push_back(DocumentHeading{"Before the operation"});
    blocks.push_back(DocumentText{fmt::format(
        "Skin at {}; {} pieces ({:.0f} ml: head holder, table, wires) taken away; {} triangles. LUT {} x {} x {} "
        "voxels of {:.1f} mm, each pointing to one of {} skin voxels. Skin {:.2f} s, surface {:.2f} s, LUT {:.2f} s.",
        threshold_text(p.threshold), p.pieces_removed, p.removed_ml, c.skin.triangles.size(), c.lut.size[0],
        c.lut.size[1], c.lut.size[2], c.lut.voxel_mm, c.lut.skin.size(), p.segment_s, p.triangulate_s, p.lut_s)});
    for (const auto& warning : c.warnings) blocks.push_back(DocumentText{warning, Tone::stop});
}

PageVerdict verdict_of(const std::vector<PresetSummary>& summaries) {
    PageVerdict verdict{PageVerdict::Kind::good, "", {}};
    std::size_t judged = 0;
    for (const PresetSummary& s : summaries) {
        judged += s.rooms;
        if (const auto missed = s.missed(); !missed.empty())
            verdict.reasons.push_back(fmt::format("{}: {}.", room_of(s), fmt::join(missed, "; ")));
    }
    if (judged == 0) return {PageVerdict::Kind::stop, "No room was judged.", {}};
    if (verdict.reasons.empty())
        verdict.words = fmt::format("Every goal was reached in {} simulated room{}.", judged, judged == 1 ? "" : "s");
    else
        verdict.kind = PageVerdict::Kind::stop, verdict.words = "Not every goal was reached.";
    return verdict;
}

}  // namespace

Document chain_document(const Preparation& prepared, const std::vector<ChainFigures>& rooms,
                        const std::vector<ReportPicture>& pictures) {
    std::vector<PresetSummary> summaries;
    for (const auto* preset : {"modern", "paper"})
        if (const auto s = summarise(rooms, preset); s.rooms > 0) summaries.push_back(s);
    Document document{"Light on the patient"};
    document.verdict = verdict_of(summaries);
    ReportFacts facts = facts_of(prepared.prepared);
    facts.emplace_back("Rig", "simulated rooms, one a seed");
    document.facts = with_program(facts);
    for (const PresetSummary& summary : summaries) add_preset(summary, document.blocks);
    document.blocks.push_back(DocumentText{
        "All errors are those of a simulated operating room with its own optics and the CT field as the true skin; no "
        "real projector or camera was measured.",
        Tone::quiet});
    add_preparation(prepared, document.blocks);
    if (!pictures.empty()) {
        document.blocks.push_back(DocumentHeading{"Step by step"});
        document.blocks.push_back(figures_of(pictures));
    }
    document.signed_by = {"Read by"};
    document.foot = foot_of_program();
    return document;
}

}  // namespace planlight
