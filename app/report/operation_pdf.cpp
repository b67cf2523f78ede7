#include "app/report/operation_pdf.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/evaluation/distribution.h"
#include "app/report/pdf_page.h"
#include "app/report/plan_facts.h"
#include "app/windows/camera_picture.h"

namespace planlight {
namespace {

void add_facts(PdfPages& pdf, const OperationFacts& facts) {
    const RecordingHead& head = facts.head;
    std::vector<std::vector<std::string>> rows{{"", ""}};
    const auto row = [&](const char* name, const std::string& value) {
        if (!value.empty()) rows.push_back({name, value});
    };
    row("Case", head.case_title);
    row("Code", head.case_code);
    row("Plan", head.plan_name + (head.plan_version.empty() ? "" : ", version " + head.plan_version));
    row("Room", facts.room);
    row("Rig calibrated", facts.rig_made_on);
    row("Began", head.began_utc + ", lasted " + duration_text(facts.lasted_s) + " (room clock)");
    row("Operator, computer", head.operator_name + ", " + head.computer);
    row("Program", "Planlight " + head.program);
    pdf.table(rows, {0.22, 0.78});
}

void add_items(PdfPages& pdf, const OperationFacts& facts) {
    pdf.heading("What was shown, and how far off it was (mm)");
    const bool with_risk = any_risk(facts);
    std::vector<std::vector<std::string>> rows{
        {"Plan item", "shown (room clock)", "for", "predicted, 95 %", "measured: median", "95 %", "worst", "times"}};
    std::vector<double> shares{0.24, 0.18, 0.1, 0.12, 0.12, 0.08, 0.08, 0.08};
    if (with_risk) {
        rows[0].insert(rows[0].begin() + 1, "next risk structure, as planned");
        shares = {0.17, 0.18, 0.17, 0.09, 0.1, 0.09, 0.07, 0.07, 0.06};
    }
    for (const OperationItem& item : facts.items) {
        const Distribution d = distribution_of(item.measured_mm);
        const auto mm = [&](double value) {
            return d.count > 0 ? fmt::format("{:.2f} {}", value, sign_of(value)) : std::string("-");
        };
        rows.push_back({item.name, shown_text(item, facts), duration_text(item.shown_s),
                        item.predicted_mm ? fmt::format("{:.2f}", *item.predicted_mm) : "not known", mm(d.median),
                        mm(d.p95), mm(d.worst), std::to_string(d.count)});
        if (with_risk) rows.back().insert(rows.back().begin() + 1, risk_in_words(item.risk));
    }
    if (facts.items.empty()) rows.push_back({"No match was found: nothing could be shown."});
    pdf.table(rows, shares);
    pdf.paragraph(kWhatIsMeasured);
    if (const std::string f2554 = in_terms_of_f2554(facts); !f2554.empty()) pdf.paragraph(f2554);
}

void add_matches(PdfPages& pdf, const OperationFacts& facts) {
    pdf.heading("Matches");
    if (facts.matches.empty()) {
        pdf.paragraph("None.");
        return;
    }
    std::vector<std::vector<std::string>> rows{{"Room clock", "Verdict", "Points of skin", "Residual", "Why"}};
    for (const OperationMatch& match : facts.matches) {
        std::string why;
        for (const std::string& reason : match.reasons) why += (why.empty() ? "" : " ") + reason;
        rows.push_back({clock_text(match.at_s), match.verdict, std::to_string(match.points),
                        match.residual_rms_mm ? fmt::format("{:.2f} mm rms", *match.residual_rms_mm) : "not known",
                        why});
    }
    pdf.table(rows, {0.12, 0.1, 0.14, 0.16, 0.48});
}

void add_course(PdfPages& pdf, const OperationFacts& facts) {
    if (facts.course.size() < 2) return;
    constexpr double kBreak_s = 1.5, kMost_mm = 3;
    const bool long_one = facts.lasted_s > 300;
    const double unit_s = long_one ? 60 : 1;
    PdfPages::Chart chart;
    chart.to_x = std::max(1.0, facts.lasted_s / unit_s);
    chart.to_y = kMost_mm;
    chart.x_label = long_one ? "room clock, minutes" : "room clock, s";
    chart.y_label = "light off its place (95 %), mm; green: aligned, amber: to be looked at";
    for (std::size_t i = 0; i < facts.course.size(); ++i) {
        const auto& sample = facts.course[i];
        const double until_s =
            std::min(i + 1 < facts.course.size() ? facts.course[i + 1].at_s : facts.lasted_s, sample.at_s + kBreak_s);
        chart.bars.push_back({sample.at_s / unit_s, until_s / unit_s, sample.aligned ? 0.2 : 0.1,
                              sample.aligned ? Rgb{20, 102, 58} : Rgb{208, 135, 0}});
        if (sample.off_mm >= 0) chart.dots.emplace_back(sample.at_s / unit_s, sample.off_mm);
    }
    chart.levels = {{kOperationLook_mm, {208, 135, 0}}, {kOperationStop_mm, {163, 18, 31}}};
    pdf.heading("The light over time", 160);
    pdf.chart(chart);
}

void add_events(PdfPages& pdf, const std::string& title, const std::vector<OperationEvent>& events) {
    pdf.heading(title);
    if (events.empty()) {
        pdf.paragraph("None.");
        return;
    }
    std::vector<std::vector<std::string>> rows{{"Room clock", "What"}};
    for (const OperationEvent& event : events) rows.push_back({clock_text(event.at_s), event.what});
    pdf.table(rows, {0.14, 0.86});
}

}  // namespace

std::string operation_pdf(const OperationFacts& facts) {
    PdfPages pdf("Operation: " + facts.head.case_title,
                 fmt::format("Case {}, {}. Planlight {}. For research; not a medical device.", facts.head.case_code,
                             facts.head.began_utc, facts.head.program));
    const OperationVerdict verdict = verdict_of(facts);
    pdf.heading(sign_of(verdict.kind) + " " + verdict.sentence);
    for (const std::string& reason : verdict.reasons) pdf.paragraph("- " + reason);
    add_facts(pdf, facts);
    add_items(pdf, facts);
    pdf.paragraph(fmt::format("Light for {}: {} of it aligned, {} to be looked at. {} updates.",
                              duration_text(facts.lit_s), duration_text(facts.aligned_s), duration_text(facts.look_s),
                              facts.updates));
    add_course(pdf, facts);
    if (facts.moment) {
        pdf.heading("At " + clock_text(facts.moment->at_s) + " (room clock)", 180);
        const OperationMoment& m = *facts.moment;
        const bool compared = !m.compared[0].empty();
        std::vector<std::pair<std::string, RgbImage>> row{
            {"Left camera", compared ? m.compared[0] : rgb_of(brightened(m.left))},
            {"Right camera", compared ? m.compared[1] : rgb_of(brightened(m.right))}};
        if (!m.light.empty()) row.emplace_back("What the projector was given", m.light);
        pdf.pictures(row);
        if (!m.compared_words.empty()) pdf.paragraph((compared ? kWhatCirclesSay : "") + m.compared_words);
    }
    if (!facts.dark.empty()) {
        pdf.heading("Dark by itself");
        std::vector<std::vector<std::string>> rows{{"Because", "times", "for"}};
        for (const auto& [reason, how] : facts.dark)
            rows.push_back({reason, std::to_string(how.first), duration_text(how.second)});
        pdf.table(rows, {0.7, 0.15, 0.15});
    }
    add_matches(pdf, facts);
    add_events(pdf, "What people said and did", facts.said);
    add_events(pdf, "Refused, or failed", facts.refusals);
    pdf.heading("Hashes (XXH3-128)");
    pdf.table({{"of", ""},
               {"Recording", facts.recording_hash},
               {"Volume", facts.head.volume_hash},
               {"Skin", facts.head.mesh_hash},
               {"Plan", facts.head.plan_hash},
               {"Rig", facts.rig_hash},
               {"Program", facts.head.program_hash}},
              {0.22, 0.78});
    pdf.heading(" ", 30);
    pdf.paragraph("Name  ____________________      Date  ______________      Signature  ____________________");
    return pdf.bytes();
}

}  // namespace planlight
