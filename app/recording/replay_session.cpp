#include "app/recording/replay_session.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/recording/recorded_devices.h"
#include "app/recording/recording_head.h"
#include "app/recording/session_events.h"
#include "app/session_observers.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/json_value.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Kind = RecordedInput::Kind;

/// The names under which two objects of JSON differ, with both values, shortened.
std::string difference_of(const Json& recorded, const Json& now, const std::string& place) {
    constexpr std::size_t kLong = 80;
    if (recorded.is_object() && now.is_object()) {
        for (const auto& [name, value] : now.items())
            if (!recorded.contains(name)) return place + name + " was not there";
        for (const auto& [name, value] : recorded.items()) {
            if (!now.contains(name)) return place + name + " is not there now";
            if (value != now[name]) return difference_of(value, now[name], place + name + ".");
        }
    }
    if (recorded.is_array() && now.is_array() && recorded.size() == now.size())
        for (std::size_t i = 0; i < now.size(); ++i)
            if (recorded[i] != now[i]) return difference_of(recorded[i], now[i], fmt::format("{}{}.", place, i));
    return fmt::format("{}: {} recorded, {} now", place.empty() ? place : place.substr(0, place.size() - 1),
                       recorded.dump().substr(0, kLong), now.dump().substr(0, kLong));
}

/// Compares what comes of it with the recording.
class Comparer final : public SessionObserver {
public:
    Comparer(RecordingCursor& cursor, ReplayResult& result) : cursor_(cursor), result_(result) {}

    void scanned(const Session& session) noexcept override {
        compare([&] { return session_events::scanned(session); }, result_.scans);
    }
    void matched(const Session& session) noexcept override {
        compare([&] { return session_events::matched(session); }, result_.matches);
    }
    void updated(const Session& session, const Session::Update& update) noexcept override {
        compare([&] { return session_events::updated(session, update); }, result_.updates);
    }
    void skin_checked(const SkinCheck& check) noexcept override {
        compare([&] { return session_events::skin_checked(check); }, result_.skin_checks);
    }
    void resumed(const Session& session, const ResumeCheck& check) noexcept override {
        compare([&] { return session_events::resumed(session, check); }, result_.resumptions);
    }
    void refused(SessionCall call, const std::exception& why) noexcept override {
        told_ = true;
        const int before = result_.refusals;
        compare([&] { return session_events::refused(call, why); }, result_.refusals);
        if (call == SessionCall::update) refused_updates_ += result_.refusals - before;
    }
    /// Whether the session told of the fault that it threw; asked once.
    bool was_told() { return std::exchange(told_, false); }
    int refused_updates() const { return refused_updates_; }  ///< alike
    /// Throws what was found.
    void rethrow() {
        if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
    }
    template <class Make>
    void compare(const Make& make, int& alike) noexcept {
        if (fault_) return;
        try {
            const std::string now = make();
            const auto next = cursor_.take();
            if (!next.event)
                throw ReplayDiffers{
                    fmt::format("the order of things: the session came to {}, where the recording has {}",
                                now.substr(0, 120), words_of(next))};
            if (*next.event != now)
                throw ReplayDiffers{difference_of(Json::parse(*next.event, nullptr, false), Json::parse(now), {})};
            ++alike;
        } catch (...) {
            fault_ = std::current_exception();
        }
    }

private:
    RecordingCursor& cursor_;
    ReplayResult& result_;
    std::exception_ptr fault_;
    bool told_ = false;
    int refused_updates_ = 0;
};

std::vector<PointPair> landmarks_of(const Json& event) {
    std::vector<PointPair> landmarks;
    const auto vector = [](const Json& v) {
        return Eigen::Vector3d(v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>());
    };
    for (const Json& pair : event.at("landmarks"))
        landmarks.push_back({pair.at("name").get<std::string>(), vector(pair.at("in_ct")), vector(pair.at("in_rig"))});
    return landmarks;
}

/// A session that is asked what the recorded one was asked.
class Replay {
public:
    /// `watcher`: null, or told of all of it as the recorded session's observers were, after it was compared.
    Replay(RecordingCursor& cursor, const Case& the_case, const CaseDrawing& drawing, const RoomFacts& room,
           ReplayResult& result, SessionObserver* watcher)
        : cursor_(cursor),
          result_(result),
          watcher_(watcher),
          comparer_(cursor, result),
          devices_(cursor, room.rig.projector.width, room.rig.projector.height),
          session_(the_case, drawing, room.rig, devices_, devices_, devices_, settings(room.markers)) {
        if (watcher_) watcher_->room_entered(room);
    }

    /// To the end of the recording or the first difference.
    void run(const std::function<void(double)>& progress) {
        try {
            for (;;) {
                one_event();
                comparer_.rethrow();
                const RecordingReader& reader = cursor_.reader();
                if (progress) progress(static_cast<double>(reader.bytes_read()) / static_cast<double>(reader.bytes()));
            }
        } catch (const ReplayEnds& end) {
            result_.ended = end.why;
        } catch (const nlohmann::json::exception&) {
            throw DamagedFileError(cursor_.reader().file(), "what was asked cannot be understood",
                                   "Copy the file again from where it was written.");
        } catch (const ReplayDiffers& differs) {
            const bool within = result_.updates + comparer_.refused_updates() < updates_asked_;
            result_.difference = {devices_.given().last_number, devices_.given().last_at,
                                  within ? updates_asked_ : result_.updates, differs.what};
        }
        const RecordedDevices::Given& given = devices_.given();
        result_.pictures = given.pictures, result_.frames = given.frames;
        result_.began = given.first_at;
        result_.recorded_s = seconds(given.last_at - given.first_at);
    }

private:
    SessionSettings settings(const MarkerDesign& markers) {
        observers_.add(&comparer_);
        observers_.add(watcher_);
        SessionSettings settings = settings_for(markers);
        settings.observer = observers_.all();
        return settings;
    }

    void one_event() {
        auto next = cursor_.take();
        // The last darkness is that of the session's end, which nobody asks for.
        while (next.input && next.input->kind == Kind::dark) next = cursor_.take();
        if (!next.event)
            throw ReplayDiffers{"the order of things: the session asks for nothing, where the recording has " +
                                words_of(next)};
        const Json event = Json::parse(*next.event, nullptr, false);
        const std::string what = event.is_object() ? event.value("what", "") : "";
        SessionCall call{};
        GateCall gate_call{};
        if (what == "asked" && session_events::from_word(event.value("call", ""), call))
            ask(call, event);
        else if (what == "gate" && session_events::from_word(event.value("call", ""), gate_call))
            ask_gate(gate_call, event, *next.event);
        else
            throw ReplayDiffers{"what came of it: nothing now, where the recording has " + next.event->substr(0, 120)};
    }

    void ask(SessionCall call, const Json& event) {
        const auto go_on = [&](int, int) { devices_.stop_if_stopped(); };
        try {
            switch (call) {
                case SessionCall::scan:
                    session_.scan(go_on);
                    break;
                case SessionCall::find_patient:
                    session_.find_patient(landmarks_of(event));
                    break;
                case SessionCall::confirm:
                    session_.confirm();
                    break;
                case SessionCall::update:
                    ++updates_asked_;
                    last_ = session_.update();
                    break;
                case SessionCall::check_skin:
                    session_.check_skin(go_on);
                    break;
                case SessionCall::resume:
                    if (!cursor_.match()) throw ReplayEnds{"the match that was gone on with was not kept"};
                    session_.resume(kept_match_of(cursor_.match()->payload, cursor_.reader().file()), go_on);
                    break;
                case SessionCall::light_landmark: {
                    const int which = event.value("which", -1);
                    session_.light_landmark(which < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(which)));
                    break;
                }
                case SessionCall::light_item: {
                    const int which = event.value("which", -1);
                    session_.light_item(which < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(which)));
                    break;
                }
                case SessionCall::hide_item:
                    session_.hide_item(event.value("which", std::size_t{0}));
                    break;
                case SessionCall::show_item: {
                    const int which = event.value("which", -1);
                    session_.show_item(which < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(which)));
                    break;
                }
                case SessionCall::go_dark:
                    session_.go_dark();
                    break;
            }
        } catch (const std::exception&) {
            // Of whatever kind: the comparer has it, and the recording must have the same.
            if (!comparer_.was_told()) throw;
        }
    }

    void ask_gate(GateCall call, const Json& event, const std::string& recorded) {
        const Instant at(event.value("at_ns", std::int64_t{0}));
        if (watcher_ && call != GateCall::step && call != GateCall::forbids)
            watcher_->gate(call, at, session_events::skin_off_mm(event), nullptr);
        switch (call) {
            case GateCall::verify:
                gate_.verify(at);
                return;
            case GateCall::skin_checked:
                gate_.skin_checked(session_events::skin_off_mm(event));
                return;
            case GateCall::new_match:
                gate_.new_match();
                return;
            case GateCall::restart:
                gate_.restart();
                return;
            case GateCall::other_light:
                gate_.other_light();
                return;
            case GateCall::forbids: {
                const auto forbidden = gate_.forbids();
                if (!forbidden) throw ReplayDiffers{"the gate's decision: it forbids no light now"};
                expect_ruling(call, at, *forbidden, event, recorded);
                return;
            }
            case GateCall::step: {
                const auto ruling = gate_.step(last_.frame.at, last_.overlay.lit, last_.light, last_.causes,
                                               last_.pose.external_reliability_mm);
                expect_ruling(call, last_.frame.at, ruling, event, recorded);
                return;
            }
        }
    }

    void expect_ruling(GateCall call, Instant at, const LightGate::Ruling& ruling, const Json& event,
                       const std::string& recorded) {
        const std::string now = session_events::gate(call, at, 0, &ruling);
        if (now != recorded) throw ReplayDiffers{"the gate's decision, " + difference_of(event, Json::parse(now), {})};
        ++result_.rulings;
        if (watcher_) watcher_->gate(call, at, 0, &ruling);
    }

    RecordingCursor& cursor_;
    ReplayResult& result_;
    SessionObserver* watcher_;
    Comparer comparer_;
    SessionObservers observers_;
    RecordedDevices devices_;
    Session session_;
    LightGate gate_;
    Session::Update last_;
    int updates_asked_ = 0;
};

void check_belongs(const RecordingHead& head, const Case& the_case, const fs::path& recording) {
    const CaseName name = name_of(the_case);
    if (head.volume_hash == name.volume_hash && head.mesh_hash == name.mesh_hash &&
        head.plan_hash == the_case.plan_hash)
        return;
    throw InputError(recording,
                     fmt::format("is of the case {}, and this is the case {}{}", head.case_code, name.code,
                                 head.case_code == name.code ? ", whose skin or plan is another" : ""),
                     "Name the case that was used: `planlight replay --case CASE`.");
}

void check_holds_frames(const RecordingHead& head, const fs::path& recording) {
    if (head.mode == RecordMode::all) return;
    throw InputError(
        recording, fmt::format("was recorded in the way \"{}\", which does not keep every frame", word_of(head.mode)),
        "What is to be replayed is recorded by `planlight session --record all`; `planlight report` needs no frames.");
}

/// Never guessed: other markers are found elsewhere, and would differ without a reason.
MarkerDesign markers_of(const Json& room, const fs::path& recording) {
    const JsonValue root(room, recording);
    const double disc_mm = root.at("disc_mm").number(0.1, 1000);
    return {disc_mm, root.at("sticker_mm").number(disc_mm, 1000)};
}

}  // namespace

RecordingHead head_of_recording(const fs::path& recording) {
    RecordingCursor cursor(recording);
    cursor.begin();
    if (!cursor.head())
        throw DamagedFileError(recording, "does not say whose it is",
                               "It ends before its first chunk: there is nothing in it.");
    return head_of(cursor.head()->payload, recording);
}

ReplayResult replay_session(const fs::path& recording, const Case& the_case,
                            const std::function<void(double)>& progress, SessionObserver* watcher) {
    ReplayResult result;
    result.head = head_of_recording(recording);
    check_belongs(result.head, the_case, recording);
    check_holds_frames(result.head, recording);
    RecordingCursor cursor(recording);
    cursor.begin();
    if (!cursor.room()) {
        result.ended = "The session ended before there was a room. " + cursor.reader().sentence();
        return result;
    }
    const Json room = Json::parse(cursor.room()->payload, nullptr, false);
    if (!room.is_object() || !room.contains("rig"))
        throw DamagedFileError(recording, "does not say in which room it was made", "Copy the file again.");
    DrawingSettings how;
    how.up_in_ct = result.head.up_in_ct;
    how.card = result.head.card;
    const CaseDrawing drawing(the_case, how);
    RoomFacts facts;
    try {
        facts.name = room.value("name", "");
        facts.kind = session_events::room_kind_of(room);
    } catch (const Json::exception&) {
        throw DamagedFileError(recording, "does not say in which room it was made", "Copy the file again.");
    }
    facts.markers = markers_of(room, recording);
    facts.rig = rig_of_text(room["rig"].dump(), recording);
    facts.now = cursor.room()->at;
    Replay(cursor, the_case, drawing, facts, result, watcher).run(progress);
    result.end = cursor.reader().end();
    result.other_program = recording_head(the_case, {}, RecordMode::all, {}).program_hash != result.head.program_hash;
    return result;
}

}  // namespace planlight
