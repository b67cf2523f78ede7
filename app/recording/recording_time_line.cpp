#include "app/recording/recording_time_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "app/recording/recording_head.h"
#include "app/without_numbers.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kSame_s = 1e-6;

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

    void enter_room(const RecordingChunk& chunk) {
        origin_ = chunk.at;
        const Json room = Json::parse(chunk.payload, nullptr, false);
        if (room.is_object()) line_.room_entered_utc = room.value("utc", "");
    }
    double since_room_s(Instant at) const { return origin_ ? seconds(at) - seconds(*origin_) : 0; }

    void take_frame(Instant at, std::uint64_t place) {
        if (!frames_.empty() && frames_.back().second.frame == place) return;
        frames_.push_back({since_room_s(at), {place, 0, 0, match_}});
    }
    /// What the projector was given after a frame.
    void take_picture(Instant at, std::uint64_t place) {
        constexpr double kWithin_s = 0.5;
        if (frames_.empty() || since_room_s(at) - frames_.back().first > kWithin_s) return;
        if (frames_.back().second.light == 0) frames_.back().second.light = place;
    }
    void take_match(std::uint64_t place) {
        match_ = place;
        asked_ = {};
        note_lit();
    }

    void take(const RecordingChunk& chunk, std::uint64_t place) {
        const double at_s = since_room_s(chunk.at);
        line_.lasted_s = std::max(line_.lasted_s, at_s);
        const std::string& text = chunk.payload;
        if (begins(text, R"({"what":"updated")"))
            take_update(text, place);
        else if (begins(text, R"({"what":"gate","call":"step")"))
            take_ruling(text);
        else if (begins(text, R"({"what":"gate","call":"forbids")"))
            take_forbidden(text, at_s);
        else if (!begins(text, R"({"what":"said")") && !begins(text, R"({"what":"asked","call":"update")"))
            take_seldom(Json::parse(text, nullptr, false), at_s);
    }

    /// Frames and events by their time: frames before an event are written after it, and a ruling bears the time of its
    /// frame.
    void finish() {
        const auto earlier = [](const auto& a, const auto& b) { return a.first < b.first; };
        std::stable_sort(frames_.begin(), frames_.end(), earlier);
        std::stable_sort(line_.events.begin(), line_.events.end(),
                         [](const auto& a, const auto& b) { return a.at_s < b.at_s; });
        for (auto& [at_s, places] : frames_) {
            if (!line_.frames_s.empty() && line_.frames_s.back() == at_s) continue;
            const auto update = std::lower_bound(updates_.begin(), updates_.end(), Update{at_s - kSame_s, {}}, earlier);
            if (update != updates_.end() && update->first < at_s + kSame_s)
                places.updated = update->second.first, places.lit = update->second.second;
            line_.frames_s.push_back(at_s);
            line_.places.push_back(places);
        }
    }

private:
    /// When it was, where it stands, and under which light its frame was taken.
    using Update = std::pair<double, std::pair<std::uint64_t, std::size_t>>;

    void take_update(const std::string& text, std::uint64_t place) {
        const auto at_ns = number_after(text, "\"at_ns\":");
        if (!at_ns || !origin_) return;
        at_s_ = (*at_ns - static_cast<double>(origin_->count())) / 1e9;
        line_.lasted_s = std::max(line_.lasted_s, at_s_);
        lit_ = text.find(R"("lit":true)") != std::string::npos;
        const auto bound_mm = number_after(text, "\"bound_95_mm\":");
        predicted_mm_ = match_mm_ && bound_mm ? std::hypot(*match_mm_, *bound_mm) : -1;
        measured_ = text.find(R"("check":)") != std::string::npos;
        updates_.push_back({at_s_, {place, line_.lit.size() - 1}});  // its own picture came later
        asked_.light = lit_;
        note_lit();
    }

    void note_lit() {
        if (line_.lit.back() != asked_) line_.lit.push_back(asked_);
    }

    /// What is lit by a person's wish counts from the next update on; darkness at once.
    void take_call(const std::string& call, const Json& event) {
        if (call == "light_landmark") landmark_ = event.value("which", -1);
        if (call == "light_landmark" || call == "light_item" || call == "hide_item" || call == "show_item")
            return asked_.asked.push_back({call, event.value("which", -1)});
        if (call == "confirm") return;
        RecordingTimeLine::Lit dark = line_.lit.back();
        dark.light = asked_.light = false;
        if (line_.lit.back() != dark) line_.lit.push_back(std::move(dark));
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
        if (measured_ && landmark_ < 0)  // a landmark's light is none of the plan
            all.back().off_mm = std::max(all.back().off_mm, number_after(text, "\"off_mm\":").value_or(-1));
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
            const std::string within =
                match_mm_ ? fmt::format(", the worst item within {:.1f} mm (95 %).", *match_mm_) : ".";
            say((what == "matched" ? "Match: " + event.value("verdict", "") : "Went on with an earlier match") +
                within);
        }
        if (what == "asked") take_call(call, event);
        if (what == "scanned") say(fmt::format("Scanned: {} points.", event.value("points", 0)));
        if (what == "refused") say("Refused, " + call + ": " + event.value("why", "") + ".");
        if (what == "pressed") {
            const std::string action = event.value("action", "");
            say(action == "projector_lost" ? "The projector was lost, and the session made dark."
                                           : "Pressed: " + action + ".");
        }
        if (what == "skin_checked")
            say(event.value("elsewhere", false) ? "Skin checked: it does not lie where the markers put it."
                : event.value("known", false) ? fmt::format("Skin checked: {:.1f} mm off.", event.value("off_mm", 0.0))
                                              : "Skin checked, without an answer: " + event.value("why_not", "") + ".");
        if (what == "gate" && call == "verify") say("The light on landmarks was said to be right.");
    }

    RecordingTimeLine& line_;
    std::optional<Instant> origin_;
    std::optional<double> match_mm_;
    double at_s_ = 0, predicted_mm_ = -1;
    bool lit_ = false, measured_ = false;
    int landmark_ = -1;        ///< that is lit in place of the plan; -1: none
    std::string reason_;       ///< of the last ruling, without its numbers
    std::uint64_t match_ = 0;  ///< where the last one stands
    std::vector<std::pair<double, RecordingTimeLine::Places>> frames_;
    std::vector<Update> updates_;
    RecordingTimeLine::Lit asked_;  ///< for the next update to light
};

}  // namespace

void look_at_pictures(RecordingTimeLine& line, const fs::path& recording) {
    if (line.damaged) return;
    RecordingReader reader(recording);
    while (reader.next()) {
    }
    if (!may_be_damaged(reader.end())) return;
    line.damaged_pictures = true;
    line.ended =
        fmt::format("The recording is damaged among its pictures, at byte {}; what happened is shown to its end.",
                    reader.bytes_read());
}

RecordingTimeLine time_line_of(const fs::path& recording) {
    RecordingTimeLine line;
    RecordingReader reader(recording);
    TimeLineMaker maker(line);
    reader.want_only([&](const ChunkType& type, Instant at) {
        if (type == chunk_types::kFrame) maker.take_frame(at, reader.place());
        if (type == chunk_types::kPicture) maker.take_picture(at, reader.place());
        if (type == chunk_types::kMatch) maker.take_match(reader.place());
        return type == chunk_types::kHead || type == chunk_types::kRoom || type == chunk_types::kEvent;
    });
    bool headed = false;
    try {
        while (const auto chunk = reader.next()) {
            if (chunk->type == chunk_types::kHead) {
                line.head = head_of(chunk->payload, recording);
                headed = true;
            } else if (chunk->type == chunk_types::kRoom) {
                maker.enter_room(*chunk);
            } else {
                maker.take(*chunk, reader.place());
            }
        }
    } catch (const Json::exception&) {
        throw DamagedFileError(recording, "holds an event that cannot be understood", "Copy the file again.");
    }
    if (!headed) throw DamagedFileError(recording, "does not say whose it is", "There is nothing in it to look at.");
    maker.finish();
    line.ended = reader.sentence();
    line.damaged = may_be_damaged(reader.end());
    return line;
}

}  // namespace planlight
