// What a recording tells of an operation.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "app/recording/match_fate.h"
#include "app/recording/recording_head.h"
#include "app/recording/session_events.h"
#include "app/report/clearance_json.h"
#include "app/report/operation_report.h"
#include "app/without_numbers.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kLongestStep_s = 1;  // between two updates that follow each other
constexpr double kPressBeside_s = 2;  // a press may wait for the picture that is being made
constexpr double kBreak_s = 0.5;      // of light that is the same showing still

/// Null is not known, never 0.
std::optional<double> number(const Json& value) {
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

/// Moments come from a file: of two that lie too far from each other the difference is none in whole nanoseconds.
double seconds_from(Instant origin, Instant to) {
    return seconds(to) - seconds(origin);
}

/// Goes through the events in their order.
class Teller {
public:
    Teller(OperationFacts& facts, const fs::path& recording) : facts_(facts), matches_(recording) {}

    void take(const RecordingChunk& chunk) {
        at_s_ = facts_.room_entered ? seconds_from(origin_, chunk.at) : 0;
        if (chunk.type == chunk_types::kRoom)
            enter_room(Json::parse(chunk.payload), chunk.at);
        else if (chunk.type == chunk_types::kEvent)
            take_event(Json::parse(chunk.payload), chunk);
        else if (chunk.type == chunk_types::kMatch)
            matches_.take(chunk);
        else if (chunk.type == chunk_types::kFrame)
            ++facts_.kept_frames, frame_ = chunk;
        else if (chunk.type == chunk_types::kPicture)
            picture_ = chunk;
        else if (chunk.type == chunk_types::kLost)
            facts_.lost_chunks += Json::parse(chunk.payload).value("chunks", std::uint64_t{0});
        else if (chunk.type == chunk_types::kDone)
            facts_.lost_chunks =
                std::max(facts_.lost_chunks, Json::parse(chunk.payload).value("dropped_chunks", std::uint64_t{0}));
        if (facts_.room_entered) facts_.lasted_s = std::max(facts_.lasted_s, at_s_);
    }

    /// The pictures of the best moment that was kept.
    void unpack_moment(const fs::path& file) {
        if (!moment_frame_) return;
        OperationMoment moment;
        moment.at_s = moment_at_s_;
        moment.trust = moment_trust_;
        StereoFrame frame = unpack_frame(moment_frame_->payload, file);
        moment.left = std::move(frame.left), moment.right = std::move(frame.right);
        if (moment_picture_) moment.light = unpack_picture(moment_picture_->payload, file);
        facts_.moment = std::move(moment);
    }

private:
    void enter_room(const Json& room, Instant at) {
        facts_.room_entered = true;
        origin_ = at;
        at_s_ = 0;
        facts_.room = room.value("name", "");
        facts_.room_entered_utc = room.value("utc", "");
        facts_.room_kind = session_events::room_kind_of(room);
        facts_.rig_hash = room.value("rig_hash", "");
        facts_.rig_made_on = room.at("rig").value("made_on", "");
        for (const char* device : {"left_camera", "right_camera", "projector"})
            facts_.serials.push_back(room.at("rig").value(device, Json::object()).value("serial", ""));
    }

    void say(const std::string& what, const Json& event, bool grave = false) {
        facts_.said.push_back({at_s_, event.value("utc", ""), what, grave});
    }

    /// What a person says is right has its press beside it: before it, or, as the two are noted by two threads, at once
    /// after it. Else the program said it of itself (`--autoplay`).
    void say_by(const std::string& what, const Json& event, bool verified = false) {
        by_program_ = {facts_.said.size(), at_s_, what, verified};
        say("By the program itself, without a press, " + what, event);
        if (press_at_s_ && at_s_ - *press_at_s_ <= kPressBeside_s) take_confirming_press();
    }

    void take_confirming_press() {
        press_at_s_ = at_s_;
        if (by_program_.what.empty() || at_s_ - by_program_.at_s > kPressBeside_s) return;
        const RecordingHead& head = facts_.head;
        facts_.said[by_program_.place].what =
            "By a press " + (head.operator_named ? "(" + head.operator_name + ") " : "") + by_program_.what;
        if (by_program_.verified) --facts_.verified_by_program;
        by_program_ = {}, press_at_s_.reset();
    }

    void take_event(const Json& event, const RecordingChunk& chunk) {
        const std::string what = event.value("what", "");
        if (what == "updated") take_update(event);
        if (what == "gate") take_ruling(event);
        if (what == "matched") take_match(event);
        if (what == "resumed") take_resumption(event);
        if (what == "asked") take_call(event);
        if (what == "pressed" && event.value("action", "") == "confirm") take_confirming_press();
        if (what == "pressed" && event.value("action", "") == "dark") say("DARK was pressed.", event);
        if (what == "pressed" && event.value("action", "") == "projector_lost") {
            ++facts_.projector_lost;
            facts_.refusals.push_back({at_s_, "", "The projector was lost, and the session made dark.", true});
        }
        if (what == "refused")
            facts_.refusals.push_back({at_s_, "", event.value("call", "") + ": " + event.value("why", ""), false});
        if (what == "skin_checked") take_skin_check(event);
        const int stood = matches_.times_stood();
        matches_.take(chunk);
        if (matches_.times_stood() > stood) use_match();
    }

    void take_skin_check(const Json& event) {
        if (event.value("elsewhere", false))
            return say("The skin was checked: it does not lie where the markers put it.", event, true);
        const std::optional<double> off_mm = event.value("known", false) ? number(event.at("off_mm")) : std::nullopt;
        if (!off_mm) return say("The skin was checked, without an answer: " + event.value("why_not", "") + ".", event);
        facts_.skin_off_mm = std::max(facts_.skin_off_mm.value_or(0), *off_mm);
        say(fmt::format("The skin was checked: the plan's points lie within {:.1f} mm of where the markers put them.",
                        *off_mm),
            event, *off_mm > kOperationLook_mm);
    }

    void take_call(const Json& event) {
        const std::string call = event.value("call", "");
        if (call == "find_patient") utc_of_match_ = event.value("utc", "");
        if (call == "confirm") say_by("the match was said to fit.", event);
        if (call == "light_landmark") landmark_ = event.value("which", -1);
        take_hiding(call, event);
        if (call != "update") following_ = false;
    }

    /// What a person hid is not lit: who reads that the plan was on the skin must know.
    void take_hiding(const std::string& call, const Json& event) {
        const int which = event.value("which", -1);
        if (call == "show_item" && which < 0) {
            hidden_.clear();
            return say("The whole plan was shown again.", event);
        }
        if (which < 0 || static_cast<std::size_t>(which) >= now_.size()) return;
        const auto item = static_cast<std::size_t>(which);
        const std::string name = "\"" + facts_.items[now_[item]].name + "\"";
        if (call == "hide_item" && hidden_.insert(item).second) say(name + " was hidden: it was not lit.", event);
        if ((call == "show_item" || call == "light_item") && hidden_.erase(item) > 0)
            say(name + " was shown again.", event);
    }

    void take_match(const Json& event) {
        hidden_.clear();
        OperationMatch match{at_s_,
                             utc_of_match_,
                             event.value("verdict", ""),
                             {},
                             number(event.at("residual_rms_mm")),
                             event.value("points", std::size_t{0})};
        for (const Json& reason : event.at("reasons")) match.reasons.push_back(reason.get<std::string>());
        facts_.matches.push_back(match);
        take_items(event);
    }

    /// A match of an earlier session that this one went on with.
    void take_resumption(const Json& event) {
        say(fmt::format(
                "The match of an earlier session was gone on with: {} markers, and the plan's skin within {:.1f} "
                "mm of where they put it.",
                event.value("markers", 0), number(event.at("skin_off_mm")).value_or(0)),
            event);
        take_items(event);
    }

    void take_items(const Json& event) {
        landmark_ = -1;
        now_.clear();
        predicted_.clear();
        std::map<std::string, int> met;  // two items of a name are told apart by their order
        for (std::size_t i = 0; i < event.at("items").size(); ++i) {
            const std::string name = event["items"][i].get<std::string>();
            now_.push_back(item_of(name, met[name]++));
            predicted_.push_back(i < event.at("predicted_mm").size() ? number(event["predicted_mm"][i]) : std::nullopt);
            if (event.contains("risk") && i < event["risk"].size())
                facts_.items[now_.back()].risk = clearances_from(event["risk"][i]);
            facts_.items[now_.back()].code = event.contains("codes") && i < event["codes"].size()
                                                 ? event["codes"][i].get<std::string>()
                                                 : std::string();
        }
        reached_.assign(now_.size(), false);
        forget_showing();
    }

    /// The n-th of that name, from 0, among the items of all matches.
    std::size_t item_of(const std::string& name, int n) {
        for (std::size_t i = 0; i < facts_.items.size(); ++i)
            if (facts_.items[i].name == name && n-- == 0) return i;
        facts_.items.push_back({name, {}, 0, {}, {}, false, {}, {}});
        return facts_.items.size() - 1;
    }

    /// A match that is refused, or doubtful and not confirmed, leaves standing what was predicted of the one before.
    void use_match() {
        for (OperationItem& item : facts_.items) item.predicted_mm.reset();
        for (std::size_t i = 0; i < now_.size(); ++i) facts_.items[now_[i]].predicted_mm = predicted_[i];
    }

    void take_update(const Json& event) {
        ++facts_.updates;
        frame_at_ = Instant(event.at("at_ns").get<std::int64_t>());
        const double at_s = seconds_from(origin_, frame_at_);
        step_s_ = following_ ? std::clamp(at_s - update_at_s_, 0.0, kLongestStep_s) : 0;
        following_ = true;
        update_at_s_ = at_s;
        facts_.lasted_s = std::max(facts_.lasted_s, at_s);
        const Json& light = event.at("light");
        lit_ = light.value("lit", false);
        light_seen_ = false;
        if (const auto check = event.find("check"); check != event.end() && landmark_ < 0) take_check(*check);
        plan_lit_ = lit_ && landmark_ < 0;
        if (!plan_lit_) forget_showing();
        if (plan_lit_) {
            facts_.lit_s += step_s_;
            show_items(at_s);
        }
        if (lit_) return dark_.clear();
        const std::string reason = without_numbers(light.value("dark", ""));
        auto& [times, for_s] = facts_.dark[reason];
        times += reason != dark_;
        for_s += step_s_;
        dark_ = reason;
    }

    void take_check(const Json& check) {
        // All light found as one farther aside: what was seen near its place then is other light, or none.
        const auto far_mm = check.contains("far_mm") ? number(check.at("far_mm")) : std::nullopt;
        light_seen_ = far_mm || check.value("seen", 0) > 0;
        if (light_seen_)
            if (const auto off_mm = number(check.at("off_mm")))
                facts_.light_off_mm.push_back(off_mm_ = std::max(*off_mm, far_mm.value_or(0)));
        const Json& items = check.at("items");
        for (std::size_t i = 0; i < std::min(items.size(), now_.size()); ++i) {
            OperationItem& item = facts_.items[now_[i]];
            item.looked_at = true;
            reached_[i] = items[i].at(0).get<bool>();
            const int segments = items[i].at(1).get<int>(), seen = items[i].at(2).get<int>();
            if (seen == 0 || 2 * seen < segments) continue;  // what little is seen does not stand for all of it
            if (const auto off_mm = number(items[i].at(3)))
                item.measured_mm.push_back(std::max(*off_mm, far_mm.value_or(0)));
        }
        looked_ = true;
    }

    /// Which items the light reaches is told by the first CHECK of a showing: what came before it waits for that.
    void show_items(double at_s) {
        unlooked_.emplace_back(at_s, step_s_);
        if (!looked_) return;
        for (std::size_t i = 0; i < now_.size(); ++i)
            for (const auto& [time_s, for_s] : unlooked_)
                if (reached_[i]) show(facts_.items[now_[i]], time_s, for_s);
        unlooked_.clear();
    }

    static void show(OperationItem& item, double at_s, double for_s) {
        item.shown_s += for_s;
        if (item.shown.empty() || at_s - item.shown.back().second > kBreak_s)
            item.shown.emplace_back(at_s, at_s);
        else
            item.shown.back().second = at_s;
    }

    void forget_showing() {
        looked_ = false;
        unlooked_.clear();
    }

    void take_ruling(const Json& event) {
        const std::string call = event.value("call", "");
        if (call == "verify") {
            ++facts_.verified, ++facts_.verified_by_program;
            say_by("the light on landmarks was said to be right.", event, true);
        }
        if (call != "step" && call != "forbids") return;
        const std::string trust = event.value("trust", "");
        if (plan_lit_ && trust == "aligned") facts_.aligned_s += step_s_;
        if (plan_lit_ && trust == "look") facts_.look_s += step_s_;
        if (plan_lit_) note_course(trust == "aligned");
        if (event.value("stop", false)) {
            ++facts_.stops;
            say("The light was stopped: " + event.value("headline", ""), event, true);
        }
        choose_moment(trust);
    }

    void note_course(bool aligned) {
        constexpr double kEvery_s = 0.5;
        if (facts_.course.empty() || update_at_s_ - facts_.course.back().at_s >= kEvery_s ||
            facts_.course.back().aligned != aligned)
            facts_.course.push_back({update_at_s_, aligned, -1});
        facts_.course.back().off_mm = std::max(facts_.course.back().off_mm, std::exchange(off_mm_, -1));
    }

    /// The first whose light the cameras saw, and that was aligned; before that, what comes next to it.
    void choose_moment(const std::string& trust) {
        if (!plan_lit_ || !frame_ || frame_->at != frame_at_) return;
        // Light is in a frame's pictures where the cameras saw it: in the first frame after darkness it is not yet.
        const bool fresh = picture_ && picture_->at >= frame_at_;
        const int worth = (light_seen_ ? 2 : 0) + (trust == "aligned" ? 2 : 0) + (fresh ? 1 : 0);
        if (moment_frame_ && worth <= moment_worth_) return;
        moment_worth_ = worth;
        moment_frame_ = frame_, moment_trust_ = trust, moment_at_s_ = update_at_s_;
        moment_picture_ = fresh ? picture_ : std::nullopt;
    }

    OperationFacts& facts_;
    FateOfMatches matches_;
    Instant origin_{}, frame_at_{};
    double at_s_ = 0, update_at_s_ = 0, step_s_ = 0, off_mm_ = -1;
    bool following_ = false, lit_ = false;
    bool plan_lit_ = false;  ///< not a landmark
    int landmark_ = -1;
    std::string dark_, utc_of_match_;
    std::set<std::size_t> hidden_;  ///< items of the last match, by their place in the plan
    std::vector<std::size_t> now_;  ///< items of the last match, by their place in `facts_`
    std::vector<std::optional<double>> predicted_;
    std::vector<bool> reached_;                        ///< by the light, as the last CHECK told of each of them
    bool looked_ = false;                              ///< CHECK has told since there is light
    std::vector<std::pair<double, double>> unlooked_;  ///< updates with light before that: when, for how long
    std::optional<RecordingChunk> frame_, picture_, moment_frame_, moment_picture_;
    std::string moment_trust_;
    int moment_worth_ = 0;
    bool light_seen_ = false;  ///< in the last frame
    /// The last word that has no press beside it yet: its place in `facts_.said`, when, and what.
    struct Unpressed {
        std::size_t place = 0;
        double at_s = 0;
        std::string what;
        bool verified = false;
    } by_program_;
    std::optional<double> press_at_s_;  ///< of a press that has no word beside it yet
    double moment_at_s_ = 0;
};

}  // namespace

OperationFacts facts_of_operation(const fs::path& recording, const std::function<void()>& go_on) {
    OperationFacts facts;
    RecordingReader reader(recording);
    auto chunk = reader.next();
    if (!chunk || chunk->type != chunk_types::kHead)
        throw DamagedFileError(recording, "does not say whose it is", "There is nothing in it to report.");
    facts.head = head_of(chunk->payload, recording);
    Teller teller(facts, recording);
    try {
        while ((chunk = reader.next())) {
            teller.take(*chunk);
            if (go_on) go_on();
        }
    } catch (const nlohmann::json::exception&) {
        throw DamagedFileError(recording, "holds an event that cannot be understood", "Copy the file again.");
    }
    teller.unpack_moment(recording);
    facts.recording_hash = content_hash_of(recording, go_on);
    facts.file = recording.filename().string();
    facts.chunks = reader.chunks(), facts.bytes = reader.bytes();
    facts.ended = reader.sentence();
    facts.damaged = may_be_damaged(reader.end());
    return facts;
}

}  // namespace planlight
