#include "app/report/recording_review.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "app/recording/recording_head.h"
#include "app/report/html_page.h"
#include "app/report/operation_report.h"
#include "app/report/svg_chart.h"
#include "app/windows/camera_picture.h"
#include "app/without_numbers.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The number after a key in a line of JSON as the recorder writes it; empty where it is not there, or null. Hours of
/// updates are gone through in this way, and only what happens seldom is parsed.
std::optional<double> number_after(std::string_view text, std::string_view key, std::size_t from = 0) {
    const std::size_t at = text.find(key, from);
    if (at == std::string_view::npos) return std::nullopt;
    double value = 0;
    const char* begin = text.data() + at + key.size();
    const auto [end, fault] = std::from_chars(begin, text.data() + text.size(), value);
    return fault == std::errc() ? std::optional(value) : std::nullopt;
}

bool begins(const std::string& text, std::string_view with) {
    return std::string_view(text).starts_with(with);
}

class TimeLineMaker {
public:
    explicit TimeLineMaker(RecordingTimeLine& line) : line_(line) {}

    void enter_room(Instant at) { origin_ = at; }
    double since_room_s(Instant at) const { return origin_ ? seconds(at - *origin_) : 0; }

    void take(const RecordingChunk& chunk) {
        const double at_s = since_room_s(chunk.at);
        line_.lasted_s = std::max(line_.lasted_s, at_s);
        const std::string& text = chunk.payload;
        if (begins(text, R"({"what":"updated")"))
            take_update(text);
        else if (begins(text, R"({"what":"gate","call":"step")"))
            take_ruling(text);
        else if (begins(text, R"({"what":"gate","call":"forbids")"))
            take_forbidden(text, at_s);
        else if (!begins(text, R"({"what":"said")") && !begins(text, R"({"what":"asked","call":"update")"))
            take_seldom(Json::parse(text, nullptr, false), at_s);
    }

private:
    void take_update(const std::string& text) {
        const auto at_ns = number_after(text, "\"at_ns\":");
        if (!at_ns || !origin_) return;
        at_s_ = (*at_ns - static_cast<double>(origin_->count())) / 1e9;
        line_.lasted_s = std::max(line_.lasted_s, at_s_);
        lit_ = text.find(R"("lit":true)") != std::string::npos;
        const auto bound_mm = number_after(text, "\"bound_95_mm\":");
        predicted_mm_ = match_mm_ && bound_mm ? std::hypot(*match_mm_, *bound_mm) : -1;
        measured_ = text.find(R"("check":)") != std::string::npos;
    }

    /// The gate was asked before anything was drawn, after a check of the skin say: it is of no update.
    void take_forbidden(const std::string& text, double at_s) {
        at_s_ = at_s;
        lit_ = measured_ = false;
        take_ruling(text);
    }

    void take_ruling(const std::string& text) {
        const std::size_t at = text.find(R"("trust":")");
        LightTrust trust = LightTrust::dark;
        if (at != std::string::npos && lit_)
            trust = text.compare(at + 9, 7, "aligned") == 0 ? LightTrust::aligned
                    : text.compare(at + 9, 4, "look") == 0  ? LightTrust::look
                                                            : LightTrust::dark;
        constexpr double kBreak_s = 1;
        auto& all = line_.stretches;
        const bool anew = all.empty() || all.back().trust != trust || at_s_ - all.back().to_s > kBreak_s ||
                          at_s_ - all.back().from_s >= RecordingTimeLine::kLongest_s;
        if (!all.empty() && anew && at_s_ - all.back().to_s <= kBreak_s) all.back().to_s = at_s_;
        // Another reason at the same trust is another event; one that differs in its numbers alone is none.
        const std::string reason = without_numbers(headline_of(text));
        if (all.empty() || all.back().trust != trust || reason != reason_) tell_of(trust, text);
        reason_ = reason;
        if (anew) {
            all.push_back({at_s_, at_s_, trust, -1, -1});
        }
        all.back().to_s = at_s_;
        if (measured_) all.back().off_mm = std::max(all.back().off_mm, number_after(text, "\"off_mm\":").value_or(-1));
        if (lit_) all.back().predicted_mm = std::max(all.back().predicted_mm, predicted_mm_);
    }

    /// As it stands in the line, not parsed.
    static std::string headline_of(const std::string& text) {
        constexpr std::string_view kBegins = R"("headline":")";
        const std::size_t at = text.find(kBegins);
        if (at == std::string::npos) return {};
        const std::size_t from = at + kBegins.size();
        std::size_t to = from;
        while (to < text.size() && text[to] != '"') to += text[to] == '\\' ? 2 : 1;
        return text.substr(from, to - from);
    }

    void tell_of(LightTrust trust, const std::string& text) {
        const Json event = Json::parse(text, nullptr, false);
        const std::string words = event.is_object() ? event.value("headline", "") : "";
        const char* colour = trust == LightTrust::aligned  ? "Green: "
                             : trust == LightTrust::look   ? "Amber: "
                             : words.starts_with("Dark: ") ? ""
                                                           : "Dark: ";
        line_.events.push_back({at_s_, colour + (words.empty() ? std::string("the light went out.") : words)});
    }

    void take_seldom(const Json& event, double at_s) {
        if (!event.is_object()) return;
        const std::string what = event.value("what", ""), call = event.value("call", "");
        const auto say = [&](const std::string& words) { line_.events.push_back({at_s, words}); };
        if (what == "matched" || what == "resumed") {
            match_mm_.reset();
            if (const auto all = event.find("predicted_mm"); all != event.end() && all->is_array())
                for (const Json& mm : *all)
                    if (mm.is_number()) match_mm_ = std::max(match_mm_.value_or(0), mm.get<double>());
            say((what == "matched" ? "Match: " : "Went on with an earlier match: ") + event.value("verdict", "") +
                (match_mm_ ? fmt::format(", the worst item within {:.1f} mm (95 %)", *match_mm_) : "") + ".");
        }
        if (what == "scanned") say(fmt::format("Scanned: {} points.", event.value("points", 0)));
        if (what == "refused") say("Refused, " + call + ": " + event.value("why", "") + ".");
        if (what == "pressed") say("Pressed: " + event.value("action", "") + ".");
        if (what == "skin_checked")
            say(event.value("known", false) ? fmt::format("Skin checked: {:.1f} mm off.", event.value("off_mm", 0.0))
                                            : "Skin checked, without an answer: " + event.value("why_not", "") + ".");
        if (what == "gate" && call == "verify") say("The light on landmarks was said to be right.");
    }

    RecordingTimeLine& line_;
    std::optional<Instant> origin_;
    std::optional<double> match_mm_;
    double at_s_ = 0, predicted_mm_ = -1;
    bool lit_ = false, measured_ = false;
    std::string reason_;  ///< of the last ruling, without its numbers
};

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

RecordingTimeLine time_line_of(const fs::path& recording) {
    RecordingTimeLine line;
    RecordingReader reader(recording);
    TimeLineMaker maker(line);
    reader.want_only([&](const ChunkType& type, Instant at) {
        if (type == chunk_types::kFrame) {
            const double at_s = maker.since_room_s(at);
            if (line.frames_s.empty() || line.frames_s.back() != at_s) line.frames_s.push_back(at_s);
        }
        return type == chunk_types::kHead || type == chunk_types::kRoom || type == chunk_types::kEvent;
    });
    bool headed = false;
    while (const auto chunk = reader.next()) {
        if (chunk->type == chunk_types::kHead) {
            line.head = head_of(chunk->payload, recording);
            headed = true;
        } else if (chunk->type == chunk_types::kRoom) {
            maker.enter_room(chunk->at);
        } else {
            maker.take(*chunk);
        }
    }
    if (!headed) throw DamagedFileError(recording, "does not say whose it is", "There is nothing in it to look at.");
    line.ended = reader.sentence();
    line.damaged = may_be_damaged(reader.end());
    return line;
}

int for_each_moment(const fs::path& recording, double from_s, double to_s,
                    const std::function<void(const RecordedMoment&)>& take) {
    constexpr double kPictureWithin_s = 0.5;
    RecordingReader reader(recording);
    std::optional<Instant> origin;
    const auto within = [&](Instant at, double more_s) {
        const double at_s = origin ? seconds(at - *origin) : -1;
        return at_s >= from_s - 1e-6 && at_s <= to_s + more_s + 1e-6;
    };
    reader.want_only([&](const ChunkType& type, Instant at) {
        return type == chunk_types::kRoom || (type == chunk_types::kFrame && within(at, 0)) ||
               (type == chunk_types::kPicture && within(at, kPictureWithin_s));
    });
    int given = 0;
    RecordedMoment waiting;  // for the picture that comes after it
    bool waits = false;
    const auto give = [&] {
        if (waits) take(waiting), ++given;
        waits = false;
    };
    while (const auto chunk = reader.next()) {
        if (chunk->type == chunk_types::kRoom) {
            origin = chunk->at;
        } else if (chunk->type == chunk_types::kFrame) {
            give();
            waiting = {seconds(chunk->at - *origin), unpack_frame(chunk->payload, recording), {}};
            waits = true;
        } else if (waits && waiting.light.empty()) {
            waiting.light = unpack_picture(chunk->payload, recording);
        }
    }
    give();
    return given;
}

RgbImage picture_of(const RecordedMoment& moment) {
    const GrayImage left = brightened(moment.frame.left), right = brightened(moment.frame.right);
    const int height = std::max(1, left.height), gap = 8;
    const int light_width = moment.light.height > 0 ? moment.light.width * height / moment.light.height : 0;
    RgbImage all(left.width + gap + right.width + (light_width > 0 ? gap + light_width : 0), height, {24, 26, 30});
    const auto put = [&](const GrayImage& picture, int from) {
        for (int y = 0; y < std::min(height, picture.height); ++y)
            for (int x = 0; x < picture.width; ++x) all.at(from + x, y).fill(picture.at(x, y));
    };
    put(left, 0);
    put(right, left.width + gap);
    const int from = left.width + right.width + 2 * gap;
    for (int y = 0; light_width > 0 && y < height; ++y)
        for (int x = 0; x < light_width; ++x)
            all.at(from + x, y) =
                moment.light.at(x * moment.light.width / light_width, y * moment.light.height / height);
    return all;
}

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
                     {{"Began", line.head.began_utc},
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
    return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace planlight
