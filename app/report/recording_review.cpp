#include "app/report/recording_review.h"
#include "app/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/report/html_page.h"
#include "app/report/operation_report.h"
#include "app/report/svg_chart.h"

namespace planlight {
namespace {

using Json = nlohmann::ordered_json;

const char* colour_of(LightTrust trust) {
    return trust == LightTrust::aligned ? "#14663a" : trust == LightTrust::look ? "#d08700" : "#3a3f47";
}

/// Neighbours of one colour as one, so that hours make no long page.
void add_bands(const RecordingTimeLine& line, double unit_s, SvgChart& chart) {
    const auto& all = line.stretches;
    for (std::size_t i = 0; i < all.size();) {
        std::size_t end = i + 1;
        while (end < all.size() && all[end].trust == all[i].trust && all[end].from_s - all[end - 1].to_s < 0.1) ++end;
        const double height = all[i].trust == LightTrust::aligned ? 1 : all[i].trust == LightTrust::look ? 0.66 : 0.33;
        chart.bar(all[i].from_s / unit_s, all[end - 1].to_s / unit_s, height, colour_of(all[i].trust));
        i = end;
    }
}

/// The worst of as many stretches as one place of the chart has.
SvgChart::Points worst_of(const RecordingTimeLine& line, double unit_s, double RecordingTimeLine::Stretch::*figure,
                          double most) {
    constexpr std::size_t kMostPlaces = 600;
    const std::size_t join = line.stretches.size() / kMostPlaces + 1;
    SvgChart::Points points;
    for (std::size_t i = 0; i < line.stretches.size(); i += join) {
        double worst = -1;
        for (std::size_t k = i; k < std::min(i + join, line.stretches.size()); ++k)
            worst = std::max(worst, line.stretches[k].*figure);
        if (worst >= 0) points.emplace_back(line.stretches[i].from_s / unit_s, std::min(worst, most));
    }
    return points;
}

}  // namespace

std::string review_page(const RecordingTimeLine& line, const std::vector<std::pair<std::string, std::string>>& pictures,
                        const std::string& more) {
    constexpr double kMost_mm = 3;
    constexpr std::size_t kMostEvents = 400;
    const bool long_one = line.lasted_s > 300;
    const double unit_s = long_one ? 60 : 1, end = std::max(1.0, line.lasted_s / unit_s);
    const std::string clock = long_one ? "minutes since the room was entered" : "seconds since the room was entered";
    SvgChart gate({0, end, clock, 10}, {0, 1.05, "", 1}, 1100, 130);
    add_bands(line, unit_s, gate);
    SvgChart errors({0, end, clock, 10}, {0, kMost_mm, "mm, 95 %", 6}, 1100, 300);
    errors.line({{0, kOperationLook_mm}, {end, kOperationLook_mm}}, "#d08700", 1);
    errors.line({{0, kOperationStop_mm}, {end, kOperationStop_mm}}, "#a3121f", 1);
    errors.dots(worst_of(line, unit_s, &RecordingTimeLine::Stretch::predicted_mm, kMost_mm), "#9a5bb0");
    errors.dots(worst_of(line, unit_s, &RecordingTimeLine::Stretch::off_mm, kMost_mm), "#15406b");
    std::string body;
    if (!line.ended.empty()) body += "<p class=\"no\">" + xml_escaped(line.ended) + "</p>";
    body +=
        "<h2>What the light was</h2>" + gate.text() +
        "<p>High and green: aligned. Middle and amber: to be looked at. Low and dark: no light. Nothing: the plan was "
        "not followed.</p><h2>How far off it was</h2>" +
        errors.text() +
        "<p>Blue: measured by the cameras. Purple: predicted for the worst item, by match and pose. Each point is the "
        "worst of its stretch; lines at 1 mm (not trusted) and 2 mm (goes out); what is above 3 mm stands at 3.</p>";
    for (const auto& [file, caption] : pictures)
        body += fmt::format("<figure><img style=\"width:100%\" src=\"{}\"><figcaption>{}</figcaption></figure>",
                            xml_escaped(file), xml_escaped(caption));
    body += more;
    body += "<h2>What happened</h2><table><tr><th>s</th><th></th></tr>";
    for (std::size_t i = 0; i < std::min(kMostEvents, line.events.size()); ++i)
        body += fmt::format("<tr><td>{:.2f}</td><td style=\"text-align:left\">{}</td></tr>", line.events[i].at_s,
                            xml_escaped(line.events[i].what));
    body += "</table>";
    if (line.events.size() > kMostEvents)
        body += fmt::format("<p>And {} more, in review.json.</p>", line.events.size() - kMostEvents);
    return html_page("Session: " + line.head.case_title, body,
                     {{"Operator", line.head.operator_name.empty() ? "left out" : line.head.operator_name},
                      {"Began", line.head.began_utc},
                      {"Lasted", duration_text(line.lasted_s)},
                      {"Frames kept", std::to_string(line.frames_s.size())}});
}

std::string review_json(const RecordingTimeLine& line) {
    constexpr const char* kTrusts[] = {"dark", "look", "aligned"};
    const auto known = [](double mm) { return mm >= 0 ? Json(mm) : Json(); };
    Json json{{"format", kReviewFormat},     {"version", 1},
              {"case", line.head.case_code}, {"began", line.head.began_utc},
              {"lasted_s", line.lasted_s},   {"ended", line.ended},
              {"stretches", Json::array()},  {"events", Json::array()},
              {"frames_s", line.frames_s}};
    for (const auto& s : line.stretches)
        json["stretches"].push_back(
            {s.from_s, s.to_s, kTrusts[static_cast<std::size_t>(s.trust)], known(s.off_mm), known(s.predicted_mm)});
    for (const auto& event : line.events) json["events"].push_back({event.at_s, event.what});
    return json_line(json) + "\n";
}

}  // namespace planlight
