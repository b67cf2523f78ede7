#include "app/report/operation_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/evaluation/distribution.h"
#include "app/local_time.h"
#include "app/report/chart.h"
#include "app/report/html_page.h"
#include "app/report/paper_page.h"
#include "app/report/plan_facts.h"
#include "app/windows/camera_picture.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/types/utf8_prefix.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr double kLook_mm = kOperationLook_mm, kStop_mm = kOperationStop_mm;

/// Cut where a word ends, as far as there is one; what is cut stands in the figures.
std::string short_text(const std::string& text, std::size_t most) {
    if (text.size() <= most) return text;
    std::size_t end = text.rfind(' ', most);
    if (end == std::string::npos || end < most / 2) end = most;
    return std::string(utf8_prefix(text, end)) + " …";
}

/// On one line of the table: names of a plan differ at their beginnings or at their ends.
std::string short_name(const std::string& name) {
    constexpr std::size_t kMost = 27, kFirst = 13, kLast = 11;
    const auto within_letter = [&](std::size_t i) { return (static_cast<unsigned char>(name[i]) & 0xC0) == 0x80; };
    if (name.size() <= kMost) return name;
    std::size_t first = kFirst, last = name.size() - kLast;
    while (within_letter(first)) --first;
    while (last < name.size() && within_letter(last)) ++last;
    return name.substr(0, first) + "…" + name.substr(last);
}

std::string utc_text(const std::string& iso) {
    return iso.size() < 19 ? iso : iso.substr(0, 10) + " " + iso.substr(11, 8) + " UTC";
}

std::string row(const std::string& name, const std::string& value) {
    return value.empty() ? "" : fmt::format("<tr><td>{}</td><td>{}</td></tr>", name, xml_escaped(value));
}

std::string mm(const std::optional<double>& value) {
    return value ? fmt::format("{:.2f} mm", *value) : "not known";
}

std::string marked(double value_mm) {
    const std::string sign = sign_of(value_mm);
    if (sign.empty()) return fmt::format("{:.2f}", value_mm);
    return fmt::format("{:.2f}&nbsp;<span class=\"{}\">{}</span>", value_mm, value_mm > kStop_mm ? "stop" : "look",
                       sign);
}

std::string items_html(const OperationFacts& facts) {
    const bool with_risk = any_risk(facts);
    std::string html = fmt::format(
        "<h2>What was shown, and how far off it was</h2><table class=\"plan{}\"><tr><th>Plan item</th>{}<th>shown "
        "(room clock)</th><th>for</th><th>predicted, 95 %</th><th>measured: median</th><th>95 %</th><th>worst</th>"
        "<th>times</th></tr>",
        with_risk ? " tight" : "", with_risk ? "<th>next risk structure, as planned</th>" : "");
    constexpr std::size_t kMost = 12;  // of which the page has room: where there are more, the worst
    const bool all = facts.items.size() <= kMost;
    const std::vector<const OperationItem*> worst = worst_first(facts.items);
    const auto figure = [](const std::string& text) { return "<td class=\"figure\">" + text + "</td>"; };
    for (std::size_t i = 0; i < std::min(facts.items.size(), kMost); ++i) {
        const OperationItem& item = all ? facts.items[i] : *worst[i];
        const Distribution d = distribution_of(item.measured_mm);
        html += fmt::format("<tr><td class=\"name\">{}</td>", xml_escaped(short_name(named(item)))) +
                (with_risk ? fmt::format("<td class=\"risk\">{}</td>", risk_html(item.risk)) : "") +
                figure(shown_text(item, facts)) + figure(duration_text(item.shown_s)) + figure(mm(item.predicted_mm)) +
                (d.count > 0 ? figure(marked(d.median)) + figure(marked(d.p95)) + figure(marked(d.worst))
                             : std::string("<td colspan=\"3\">too little was seen of it</td>")) +
                fmt::format("<td>{}</td></tr>", d.count);
    }
    if (facts.items.size() > kMost)
        html += fmt::format(
            "<tr><td colspan=\"9\">and {} items more, none of them farther off, in the figures beside this "
            "page</td></tr>",
            facts.items.size() - kMost);
    if (facts.items.empty()) html += "<tr><td colspan=\"9\">No match was found: nothing could be shown.</td></tr>";
    return html + "</table><p class=\"muted\">" + kWhatIsMeasured + " " + in_terms_of_f2554(facts) + "</p>";
}

std::string time_html(const OperationFacts& facts) {
    std::string html = fmt::format(
        "<h2>Light and darkness</h2><p>Light for {}: {} of it aligned (measured where it belongs, and verified), {} to "
        "be "
        "looked at. {} updates.</p>",
        duration_text(facts.lit_s), duration_text(facts.aligned_s), duration_text(facts.look_s), facts.updates);
    if (facts.dark.empty() && facts.projector_lost == 0)
        return html + "<p>While the plan was followed it was never dark by itself.</p>";
    if (facts.dark.empty()) return html;
    std::vector<std::pair<std::string, std::pair<int, double>>> dark(facts.dark.begin(), facts.dark.end());
    std::sort(dark.begin(), dark.end(), [](const auto& a, const auto& b) { return a.second.second > b.second.second; });
    html += "<table><tr><th>Dark by itself, because</th><th>times</th><th>for</th></tr>";
    constexpr std::size_t kMost = 5;
    for (std::size_t i = 0; i < std::min(dark.size(), kMost); ++i)
        html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>", xml_escaped(dark[i].first),
                            dark[i].second.first, duration_text(dark[i].second.second));
    if (dark.size() > kMost)
        html += fmt::format("<tr><td>and {} reasons more</td><td></td><td></td></tr>", dark.size() - kMost);
    return html + "</table>";
}

/// The light over time: how far off it was measured, over bars that say by height and colour whether it was aligned.
std::string course_html(const OperationFacts& facts) {
    if (facts.course.size() < 2) return {};
    constexpr std::size_t kMostPlaces = 400;
    constexpr double kBreak_s = 1.5;
    const bool long_one = facts.lasted_s > 300;
    const double unit_s = long_one ? 60 : 1;
    double most_mm = 2.2;
    for (const auto& sample : facts.course) most_mm = std::max(most_mm, std::min(5.0, sample.off_mm));
    Chart chart({0, std::max(1.0, facts.lasted_s / unit_s), long_one ? "room clock, minutes" : "room clock, s", 8},
                {0, most_mm, "mm off (95 %)", 5}, 1100, 185);
    const std::size_t join = facts.course.size() / kMostPlaces + 1;
    Chart::Points points;
    for (std::size_t i = 0; i < facts.course.size(); i += join) {
        const auto& first = facts.course[i];
        const std::size_t end = std::min(i + join, facts.course.size());
        double off_mm = -1;
        bool aligned = true;
        for (std::size_t k = i; k < end; ++k) {
            off_mm = std::max(off_mm, facts.course[k].off_mm);
            aligned &= facts.course[k].aligned;
        }
        const double until_s = std::min(end < facts.course.size() ? facts.course[end].at_s : facts.lasted_s,
                                        facts.course[end - 1].at_s + kBreak_s);
        chart.bar(first.at_s / unit_s, until_s / unit_s, aligned ? 0.16 : 0.08,
                  aligned ? Rgb{0x14, 0x66, 0x3a} : Rgb{0xd0, 0x87, 0x00});
        if (off_mm >= 0) points.emplace_back(first.at_s / unit_s, std::min(off_mm, most_mm));
    }
    chart.line({{0, kLook_mm}, {facts.lasted_s / unit_s, kLook_mm}}, Rgb{0xd0, 0x87, 0x00}, 1);
    chart.line({{0, kStop_mm}, {facts.lasted_s / unit_s, kStop_mm}}, Rgb{0xa3, 0x12, 0x1f}, 1);
    chart.dots(points, Rgb{0x15, 0x40, 0x6b});
    return "<h2>The light over time</h2>" + chart.svg() +
           "<p class=\"muted\">Points: the worst of half a second or more. Bars at the foot: high and green aligned, "
           "low and "
           "amber to be looked at, none dark. Lines: at 1 mm the light is not trusted, at 2 mm it goes out; what is "
           "above 5 mm stands at 5.</p>";
}

std::string matches_html(const OperationFacts& facts) {
    std::string html = "<h2>Matches</h2>";
    if (facts.matches.empty()) return html + "<p>None.</p>";
    html += "<table><tr><th>Room clock</th><th>Verdict</th><th>Points of skin</th><th>Residual</th><th>Why</th></tr>";
    constexpr std::size_t kMost = 2, kLongest = 110;
    const std::size_t first = facts.matches.size() > kMost ? facts.matches.size() - kMost : 0;
    for (std::size_t i = first; i < facts.matches.size(); ++i) {
        const OperationMatch& match = facts.matches[i];
        std::string why;
        for (const std::string& reason : match.reasons) why += (why.empty() ? "" : " ") + reason;
        html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>", clock_text(match.at_s),
                            xml_escaped(match.verdict), match.points,
                            match.residual_rms_mm ? mm(match.residual_rms_mm) + " rms" : mm({}),
                            xml_escaped(short_text(why, kLongest)));
    }
    if (first > 0) html += fmt::format("<tr><td colspan=\"5\">after {} others</td></tr>", first);
    return html + "</table>";
}

/// As many as there is room for, in their order: of too many the grave ones before all others.
std::vector<const OperationEvent*> chosen_of(const std::vector<OperationEvent>& events, std::size_t most) {
    std::vector<const OperationEvent*> chosen;
    for (const bool grave : {true, false})
        for (const OperationEvent& event : events)
            if (event.grave == grave && chosen.size() < most) chosen.push_back(&event);
    std::sort(chosen.begin(), chosen.end());  // as they lie in `events`
    return chosen;
}

std::string events_html(const std::string& title, const std::vector<OperationEvent>& events, std::size_t most) {
    std::string html = "<h2>" + title + "</h2>";
    if (events.empty()) return html + "<p>None.</p>";
    html += "<table>";
    for (const OperationEvent* event : chosen_of(events, most))
        html += fmt::format("<tr><td style=\"width:16%\">{}</td><td>{}</td></tr>", clock_text(event->at_s),
                            xml_escaped(event->what));
    html += "</table>";
    if (events.size() > most)
        html +=
            fmt::format("<p class=\"muted\">And {} more, in the figures beside this page.</p>", events.size() - most);
    return html;
}

std::string picture_html(const std::string& title, const RgbImage& picture) {
    return fmt::format("<figure><img alt=\"{}\" src=\"{}\"><figcaption>{}</figcaption></figure>", title,
                       embedded_png(picture), title);
}

std::string moment_html(const OperationFacts& facts) {
    if (!facts.moment) return "<h2>Pictures</h2><p>No frame with light on the skin was kept.</p>";
    const OperationMoment& m = *facts.moment;
    std::string html = fmt::format(
        "<h2>At {} (room clock), {}</h2><div class=\"row\" "
        "style=\"grid-template-columns:repeat({},1fr)\">",
        clock_text(m.at_s), m.trust == "aligned" ? "aligned" : "to be looked at", m.light.empty() ? 2 : 3);
    const bool compared = !m.compared[0].empty();
    html += picture_html("Left camera", compared ? m.compared[0] : rgb_of(brightened(m.left)));
    html += picture_html("Right camera", compared ? m.compared[1] : rgb_of(brightened(m.right)));
    if (!m.light.empty()) html += picture_html("What the projector was given", m.light);
    html += "</div>";
    if (m.compared_words.empty()) return html;
    return html + "<p class=\"muted\">" + (compared ? kWhatCirclesSay : "") + xml_escaped(m.compared_words) + "</p>";
}

std::string facts_html(const OperationFacts& facts) {
    const RecordingHead& head = facts.head;
    const bool titled = head.case_title.find(head.case_code) == std::string::npos;
    return "<div class=\"two\"><table>" + row("Case", titled ? head.case_title : "") + row("Code", head.case_code) +
           row("Plan", head.plan_name + (head.plan_version.empty() ? "" : ", version " + head.plan_version)) +
           row("Room", facts.room) + row("Rig calibrated", utc_text(facts.rig_made_on)) +
           row("Settings", settings_in_words(head)) + "</table><table>" + row("Began", utc_text(head.began_utc)) +
           row("Lasted", duration_text(facts.lasted_s) + " (room clock)") +
           row("Room clock 0:00:00", utc_and_local_time(facts.room_entered_utc)) +
           row("Operator", operator_text(head)) + row("Computer", head.computer) +
           row("Program", "Planlight " + head.program) + "</table></div>";
}

std::string hashes_html(const OperationFacts& facts) {
    return "<h2>Hashes (XXH3-128)</h2><p>" + xml_escaped(facts.file + ": " + facts.recording_hash) +
           "</p><div class=\"two\"><table>" + row("Volume", facts.head.volume_hash) +
           row("Skin", facts.head.mesh_hash) + row("Plan", facts.head.plan_hash) + "</table><table>" +
           row("Rig", facts.rig_hash) + row("Program", facts.head.program_hash) + "</table></div>";
}

std::string verdict_html(const OperationVerdict& verdict) {
    std::string html = fmt::format("<div class=\"verdict {}\">{} {}</div>", word_of(verdict.kind),
                                   sign_of(verdict.kind), xml_escaped(verdict.sentence));
    if (verdict.reasons.empty()) return html;
    html += "<ul>";
    for (const std::string& reason : verdict.reasons) html += "<li>" + xml_escaped(reason) + "</li>";
    return html + "</ul>";
}

}  // namespace

void write_operation_report(const OperationFacts& facts, const std::string& json, const fs::path& file) {
    constexpr std::size_t kMostEvents = 5, kMostRefusals = 2;
    const std::string title = "Operation: " + facts.head.case_title;
    const std::string body =
        fmt::format("<section class=\"sheet\"><h1>{}</h1>{}{}{}{}</section>", xml_escaped(title),
                    verdict_html(verdict_of(facts)), facts_html(facts), items_html(facts), time_html(facts)) +
        fmt::format(
            "<section class=\"sheet\">{}{}{}{}{}{}<div class=\"sign\"><span>Name</span><span>Date</span>"
            "<span>Signature</span></div></section>",
            moment_html(facts), course_html(facts), matches_html(facts),
            events_html("What people said and did", facts.said, kMostEvents),
            events_html("Refused, or failed", facts.refusals, kMostRefusals), hashes_html(facts));
    // As the recording is: it shows the patient.
    write_safely(file,
                 paper_page(title, body,
                            fmt::format("Case {}, {}. Planlight {}. For research; not a medical device.",
                                        facts.head.case_code, utc_text(facts.head.began_utc), facts.head.program)),
                 ReadableBy::owner);
    write_safely(fs::path(file).replace_extension(".json"), json, ReadableBy::owner);
}

}  // namespace planlight
