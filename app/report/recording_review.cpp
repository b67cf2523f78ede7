#include "app/report/recording_review.h"
#include "app/json_text.h"
#include "app/local_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>

#include "app/report/chart.h"
#include "app/report/operation_report.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

using Json = nlohmann::ordered_json;

Rgb colour_of(LightTrust trust) {
    return trust == LightTrust::aligned ? Rgb{0x14, 0x66, 0x3a}
           : trust == LightTrust::look  ? Rgb{0xd0, 0x87, 0x00}
                                        : Rgb{0x3a, 0x3f, 0x47};
}

/// Neighbours of one colour as one, so that hours make no long page.
void add_bands(const RecordingTimeLine& line, double unit_s, Chart& chart) {
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
Chart::Points worst_of(const RecordingTimeLine& line, double unit_s, double RecordingTimeLine::Stretch::*figure,
                       double most) {
    constexpr std::size_t kMostPlaces = 600;
    const std::size_t join = line.stretches.size() / kMostPlaces + 1;
    Chart::Points points;
    for (std::size_t i = 0; i < line.stretches.size(); i += join) {
        double worst = -1;
        for (std::size_t k = i; k < std::min(i + join, line.stretches.size()); ++k)
            worst = std::max(worst, line.stretches[k].*figure);
        if (worst >= 0) points.emplace_back(line.stretches[i].from_s / unit_s, std::min(worst, most));
    }
    return points;
}

/// When the light was measured farthest aside; empty where it never was.
std::string worst_in_words(const RecordingTimeLine& line) {
    const RecordingTimeLine::Stretch* worst = nullptr;
    for (const auto& stretch : line.stretches)
        if (stretch.off_mm >= 0 && (!worst || stretch.off_mm > worst->off_mm)) worst = &stretch;
    return worst ? fmt::format(
                       "At worst the cameras measured the light {:.2f} mm beside the plan (95 % of it), {:.1f} s after "
                       "the room was entered.",
                       worst->off_mm, worst->from_s)
                 : std::string();
}

/// For how long the light was what.
std::string followed_in_words(const RecordingTimeLine& line) {
    if (line.stretches.empty()) return "The plan was not followed: there was no light of it.";
    double seconds_of[3] = {0, 0, 0};
    for (const auto& stretch : line.stretches)
        seconds_of[static_cast<std::size_t>(stretch.trust)] += stretch.to_s - stretch.from_s;
    const auto of = [&](LightTrust trust) { return seconds_of[static_cast<std::size_t>(trust)]; };
    return fmt::format("The plan was followed for {}: aligned for {}, to be looked at for {}, dark for {}.",
                       duration_text(of(LightTrust::aligned) + of(LightTrust::look) + of(LightTrust::dark)),
                       duration_text(of(LightTrust::aligned)), duration_text(of(LightTrust::look)),
                       duration_text(of(LightTrust::dark)));
}

/// The verdict of the report on the same recording, and what only a time line tells. Until that is known nothing is
/// said to be good.
PageVerdict verdict_of(const RecordingTimeLine& line, const std::optional<PageVerdict>& judged) {
    PageVerdict verdict;
    if (judged) {
        verdict = *judged;
        verdict.reasons.push_back(followed_in_words(line));
    } else {
        verdict.kind = PageVerdict::Kind::look;
        verdict.words = followed_in_words(line);
        verdict.reasons.push_back("The recording has not been read through yet, and nothing of it is judged.");
    }
    if (const std::string worst = worst_in_words(line); !worst.empty()) verdict.reasons.push_back(worst);
    if (!line.ended.empty() &&
        std::find(verdict.reasons.begin(), verdict.reasons.end(), line.ended) == verdict.reasons.end())
        verdict.reasons.push_back(line.ended);
    if (line.damaged || line.damaged_pictures) verdict.kind = PageVerdict::Kind::stop;
    return verdict;
}

}  // namespace

std::string review_page(const RecordingTimeLine& line, const std::optional<PageVerdict>& judged,
                        const std::vector<std::pair<std::string, std::string>>& pictures, const std::string& more) {
    constexpr double kMost_mm = 3;
    constexpr std::size_t kMostEvents = 400;
    const bool long_one = line.lasted_s > 300;
    const double unit_s = long_one ? 60 : 1, end = std::max(1.0, line.lasted_s / unit_s);
    const std::string clock = long_one ? "minutes since the room was entered" : "seconds since the room was entered";
    Chart gate({0, end, clock, 10}, {0, 1.05, "", 1}, 1100, 130);
    add_bands(line, unit_s, gate);
    Chart errors({0, end, clock, 10}, {0, kMost_mm, "mm, 95 %", 6}, 1100, 300);
    errors.line({{0, kOperationLook_mm}, {end, kOperationLook_mm}}, Rgb{0xd0, 0x87, 0x00}, 1);
    errors.line({{0, kOperationStop_mm}, {end, kOperationStop_mm}}, Rgb{0xa3, 0x12, 0x1f}, 1);
    errors.dots(worst_of(line, unit_s, &RecordingTimeLine::Stretch::predicted_mm, kMost_mm), Rgb{0x9a, 0x5b, 0xb0});
    errors.dots(worst_of(line, unit_s, &RecordingTimeLine::Stretch::off_mm, kMost_mm), Rgb{0x15, 0x40, 0x6b});
    std::string body;
    body +=
        "<h2>What the light was</h2>" + gate.svg() +
        "<p>High and green: aligned. Middle and amber: to be looked at. Low and dark: no light. Nothing: the plan was "
        "not followed.</p><h2>How far off it was</h2>" +
        errors.svg() +
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
    return html_page("Session: " + line.head.case_title, verdict_of(line, judged),
                     {{"Operator", line.head.operator_name.empty() ? "left out" : operator_text(line.head)},
                      {"Began", utc_and_local_time(line.head.began_utc)},
                      {"Room clock 0:00:00", utc_and_local_time(line.room_entered_utc)},
                      {"Lasted", duration_text(line.lasted_s)},
                      {"Frames kept", std::to_string(line.frames_s.size())}},
                     body);
}

/// What the session was told to do; null where its program did not keep it.
Json settings_of(const RecordingHead& head) {
    return head.settings.empty() ? Json() : Json::parse(head.settings);
}

std::string review_json(const RecordingTimeLine& line) {
    constexpr const char* kTrusts[] = {"dark", "look", "aligned"};
    const auto known = [](double mm) { return mm >= 0 ? Json(mm) : Json(); };
    Json json{{"format", kReviewFormat},
              {"version", 1},
              {"case", line.head.case_code},
              {"operator", line.head.operator_name},
              {"settings", settings_of(line.head)},
              {"began", line.head.began_utc},
              {"room_entered", line.room_entered_utc},
              {"lasted_s", line.lasted_s},
              {"ended", line.ended},
              {"stretches", Json::array()},
              {"events", Json::array()},
              {"frames_s", line.frames_s}};
    for (const auto& s : line.stretches)
        json["stretches"].push_back(
            {s.from_s, s.to_s, kTrusts[static_cast<std::size_t>(s.trust)], known(s.off_mm), known(s.predicted_mm)});
    for (const auto& event : line.events) json["events"].push_back({event.at_s, event.what});
    return json_line(json) + "\n";
}

void write_review(RecordingTimeLine& line, const std::filesystem::path& folder,
                  const std::function<void(ReviewedMoment&)>& show,
                  const std::function<PageVerdict(RecordingTimeLine&)>& look) {
    ReviewedMoment moment;
    std::optional<PageVerdict> judged;
    const auto write_page = [&] {
        write_safely(folder / "index.html", review_page(line, judged, moment.pictures, moment.more), ReadableBy::owner);
    };
    const auto write_figures = [&] { write_safely(folder / "review.json", review_json(line), ReadableBy::owner); };
    write_page();
    write_figures();
    std::exception_ptr fault;
    try {
        show(moment);
    } catch (const Error&) {  // that a moment cannot be shown is not all that is to be said of the recording
        fault = std::current_exception();
    }
    if (!moment.pictures.empty()) write_page();
    judged = look(line);
    write_page();
    if (line.damaged_pictures) write_figures();
    if (fault) std::rethrow_exception(fault);
}

}  // namespace planlight
