#include "app/report/operation_pdf.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/evaluation/distribution.h"
#include "app/local_time.h"
#include "app/report/document.h"
#include "app/report/plan_facts.h"
#include "app/windows/camera_picture.h"

namespace planlight {
namespace {

ReportFacts facts_of(const OperationFacts& facts) {
    const RecordingHead& head = facts.head;
    return {{"Case", head.case_title},
            {"Code", head.case_code},
            {"Plan", head.plan_name + (head.plan_version.empty() ? "" : ", version " + head.plan_version)},
            {"Room", facts.room},
            {"Rig calibrated", facts.rig_made_on},
            {"Began", head.began_utc},
            {"Lasted", duration_text(facts.lasted_s) + " (room clock)"},
            {"Room clock 0:00:00", utc_and_local_time(facts.room_entered_utc)},
            {"Operator", operator_text(head)},
            {"Computer", head.computer},
            {"Settings", settings_in_words(head)},
            {"Program", "Planlight " + head.program}};
}

Tone tone_of(const std::string& sign) {
    return sign.empty() ? Tone::plain : sign == "⚠" ? Tone::look : Tone::stop;
}

DocumentTable items_of(const OperationFacts& facts) {
    const bool with_risk = any_risk(facts);
    DocumentTable table{{{"Plan item", DocumentTable::Kind::name},
                         {"shown (room clock)"},
                         {"for"},
                         {"predicted, 95 %"},
                         {"measured: median"},
                         {"95 %"},
                         {"worst"},
                         {"times"}},
                        {},
                        true};
    if (with_risk) table.columns.insert(table.columns.begin() + 1, {"next risk structure, as planned"});
    for (const OperationItem& item : facts.items) {
        const Distribution d = distribution_of(item.measured_mm);
        const auto mm = [&](double value) {
            const std::string sign = d.count > 0 ? sign_of(value) : std::string();
            return DocumentText{d.count > 0 ? fmt::format("{:.2f} {}", value, sign) : std::string("-"), tone_of(sign)};
        };
        table.rows.push_back({{named(item)},
                              {shown_text(item, facts)},
                              {duration_text(item.shown_s)},
                              {item.predicted_mm ? fmt::format("{:.2f}", *item.predicted_mm) : "not known"},
                              mm(d.median),
                              mm(d.p95),
                              mm(d.worst),
                              {std::to_string(d.count)}});
        if (with_risk) table.rows.back().insert(table.rows.back().begin() + 1, {risk_in_words(item.risk)});
    }
    return table;
}

void add_items(const OperationFacts& facts, std::vector<DocumentBlock>& blocks) {
    blocks.push_back(DocumentHeading{"What was shown, and how far off it was (mm)"});
    blocks.push_back(items_of(facts));
    if (facts.items.empty()) blocks.push_back(DocumentText{"No match was found: nothing could be shown."});
    blocks.push_back(DocumentText{kWhatIsMeasured, Tone::quiet});
    if (const std::string f2554 = in_terms_of_f2554(facts); !f2554.empty())
        blocks.push_back(DocumentText{f2554, Tone::quiet});
    blocks.push_back(DocumentText{fmt::format("Light for {}: {} of it aligned, {} to be looked at. {} updates.",
                                              duration_text(facts.lit_s), duration_text(facts.aligned_s),
                                              duration_text(facts.look_s), facts.updates)});
}

DocumentTable matches_of(const OperationFacts& facts) {
    DocumentTable table{{{"Room clock"}, {"Verdict"}, {"Points of skin"}, {"Residual"}, {"Why"}}, {}, true};
    for (const OperationMatch& match : facts.matches) {
        std::string why;
        for (const std::string& reason : match.reasons) why += (why.empty() ? "" : " ") + reason;
        table.rows.push_back(
            {{clock_text(match.at_s)},
             {match.verdict},
             {std::to_string(match.points)},
             {match.residual_rms_mm ? fmt::format("{:.2f} mm rms", *match.residual_rms_mm) : "not known"},
             {why}});
    }
    return table;
}

void add_course(const OperationFacts& facts, std::vector<DocumentBlock>& blocks) {
    if (facts.course.size() < 2) return;
    constexpr double kBreak_s = 1.5, kMost_mm = 3;
    constexpr Rgb kAligned{20, 102, 58}, kLook{208, 135, 0}, kStop{163, 18, 31}, kSeen{0x15, 0x40, 0x6b};
    const bool long_one = facts.lasted_s > 300;
    const double unit_s = long_one ? 60 : 1, end = std::max(1.0, facts.lasted_s / unit_s);
    Chart chart({0, end, long_one ? "room clock, minutes" : "room clock, s", 8}, {0, kMost_mm, "mm (95 %)", 5}, 1100,
                300);
    Chart::Points dots;
    for (std::size_t i = 0; i < facts.course.size(); ++i) {
        const auto& sample = facts.course[i];
        const double until_s =
            std::min(i + 1 < facts.course.size() ? facts.course[i + 1].at_s : facts.lasted_s, sample.at_s + kBreak_s);
        chart.bar(sample.at_s / unit_s, until_s / unit_s, sample.aligned ? 0.2 : 0.1,
                  sample.aligned ? kAligned : kLook);
        if (sample.off_mm >= 0) dots.emplace_back(sample.at_s / unit_s, std::min(sample.off_mm, kMost_mm));
    }
    chart.line({{0, kOperationLook_mm}, {end, kOperationLook_mm}}, kLook, 1);
    chart.line({{0, kOperationStop_mm}, {end, kOperationStop_mm}}, kStop, 1);
    chart.dots(dots, kSeen);
    blocks.push_back(DocumentHeading{"The light over time"});
    blocks.push_back(DocumentFigures{{{"How far the light was off its place",
                                       "Bars at the foot: high and green aligned, low and amber to be looked at, none "
                                       "dark. Lines: at 1 mm the light "
                                       "is not trusted, at 2 mm it goes out; what is above 3 mm stands at 3.",
                                       chart}}});
}

void add_moment(const OperationMoment& m, std::vector<DocumentBlock>& blocks) {
    const bool compared = !m.compared[0].empty();
    blocks.push_back(DocumentHeading{"At " + clock_text(m.at_s) + " (room clock), " +
                                     (m.trust == "aligned" ? "aligned" : "to be looked at")});
    DocumentFigures figures{{{"Left camera", "", compared ? m.compared[0] : rgb_of(brightened(m.left))},
                             {"Right camera", "", compared ? m.compared[1] : rgb_of(brightened(m.right))}}};
    if (!m.light.empty()) figures.figures.push_back({"What the projector was given", "", m.light});
    figures.columns = static_cast<int>(figures.figures.size());
    blocks.push_back(figures);
    if (!m.compared_words.empty()) blocks.push_back(DocumentText{(compared ? kWhatCirclesSay : "") + m.compared_words});
}

/// Or "None." below the heading.
void add_table(const std::string& title, DocumentTable table, std::vector<DocumentBlock>& blocks) {
    blocks.push_back(DocumentHeading{title});
    if (table.rows.empty())
        blocks.push_back(DocumentText{"None."});
    else
        blocks.push_back(std::move(table));
}

DocumentTable darkness_of(const OperationFacts& facts) {
    DocumentTable table{{{"Because"}, {"times"}, {"for"}}, {}};
    for (const auto& [reason, how] : facts.dark)
        table.rows.push_back({{reason}, {std::to_string(how.first)}, {duration_text(how.second)}});
    return table;
}

DocumentTable events_of(const std::vector<OperationEvent>& events) {
    DocumentTable table{{{"Room clock"}, {"What"}}, {}, true};
    for (const OperationEvent& event : events) table.rows.push_back({{clock_text(event.at_s)}, {event.what}});
    return table;
}

DocumentTable hashes_of(const OperationFacts& facts) {
    return {{{""}, {""}},
            {{{"Recording"}, {facts.recording_hash}},
             {{"Volume"}, {facts.head.volume_hash}},
             {{"Skin"}, {facts.head.mesh_hash}},
             {{"Plan"}, {facts.head.plan_hash}},
             {{"Rig"}, {facts.rig_hash}},
             {{"Program"}, {facts.head.program_hash}}},
            true};
}

}  // namespace

std::string operation_pdf(const OperationFacts& facts, PaperSize paper) {
    Document document{"Operation: " + facts.head.case_title};
    document.verdict = page_verdict(facts);
    document.facts = facts_of(facts);
    add_items(facts, document.blocks);
    add_course(facts, document.blocks);
    if (facts.moment)
        add_moment(*facts.moment, document.blocks);
    else
        document.blocks.push_back(DocumentText{"No frame with light on the skin was kept."});
    if (!facts.dark.empty()) add_table("Dark by itself", darkness_of(facts), document.blocks);
    add_table("Matches", matches_of(facts), document.blocks);
    add_table("What people said and did", events_of(facts.said), document.blocks);
    add_table("Refused, or failed", events_of(facts.refusals), document.blocks);
    add_table("Hashes (XXH3-128)", hashes_of(facts), document.blocks);
    document.signed_by = {"Name"};
    document.foot = fmt::format("Case {}, {}. Planlight {}. For research; not a medical device.", facts.head.case_code,
                                facts.head.began_utc, facts.head.program);
    return pdf_of(document, paper);
}

}  // namespace planlight
