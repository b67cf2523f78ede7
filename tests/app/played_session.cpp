#include "tests/app/played_session.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "app/live/simulated_room.h"
#include "app/prepare_case.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/volume/read_volume.h"
#include "tests/app/room_with.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using namespace std::chrono_literals;

/// Counts the updates on the way to the observer that is meant, and the time that it takes.
class Counting final : public SessionObserver {
public:
    Counting(SessionObserver* next, std::string doubt) : next_(next), doubt_(std::move(doubt)) {}
    int updates() const { return updates_; }
    int skin_checks() const { return skin_checks_; }  ///< with an answer or without
    int doubted() const { return doubted_; }
    const std::vector<double>& told_ms() const { return told_ms_; }

    void room_entered(const RoomFacts& room) noexcept override {
        pass([&](SessionObserver& next) { next.room_entered(room); });
    }
    /// From another thread: not timed.
    void pressed(const std::string& action) noexcept override {
        if (next_) next_->pressed(action);
    }
    void said(const std::string& kind, const std::string& headline,
              const std::vector<std::string>& details) noexcept override {
        if (next_) next_->said(kind, headline, details);
        if (doubt_.empty()) return;
        const auto holds = [&](const std::string& words) { return words.find(doubt_) != std::string::npos; };
        doubted_ += holds(headline) || std::any_of(details.begin(), details.end(), holds);
    }
    void asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept override {
        pass([&](SessionObserver& next) { next.asked(call, landmarks, which); });
    }
    void clock_read(Instant now) noexcept override {
        pass([&](SessionObserver& next) { next.clock_read(now); });
    }
    void frame_taken(const StereoFrame& frame) noexcept override {
        pass([&](SessionObserver& next) { next.frame_taken(frame); });
    }
    void picture_shown(const RgbImage& picture, Instant valid_until, Instant lit_from) noexcept override {
        pass([&](SessionObserver& next) { next.picture_shown(picture, valid_until, lit_from); });
    }
    void went_dark() noexcept override {
        pass([&](SessionObserver& next) { next.went_dark(); });
    }
    void cameras_doubted(const std::string& doubt) noexcept override {
        pass([&](SessionObserver& next) { next.cameras_doubted(doubt); });
    }
    void device_failed(const Error& fault) noexcept override {
        pass([&](SessionObserver& next) { next.device_failed(fault); });
    }
    void stopped(const Error& why) noexcept override {
        pass([&](SessionObserver& next) { next.stopped(why); });
    }
    void scanned(const Session& session) noexcept override {
        pass([&](SessionObserver& next) { next.scanned(session); });
    }
    void matched(const Session& session) noexcept override {
        pass([&](SessionObserver& next) { next.matched(session); });
        told_ = {};
    }
    void updated(const Session& session, const Session::Update& update) noexcept override {
        pass([&](SessionObserver& next) { next.updated(session, update); });
        told_ms_.push_back(1e3 * seconds(told_));
        told_ = {};
        ++updates_;
    }
    void skin_checked(const SkinCheck& check) noexcept override {
        pass([&](SessionObserver& next) { next.skin_checked(check); });
        told_ = {};
        ++skin_checks_;
    }
    void refused(SessionCall call, const std::exception& why) noexcept override {
        pass([&](SessionObserver& next) { next.refused(call, why); });
    }
    void gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept override {
        pass([&](SessionObserver& next) { next.gate(call, at, off_mm, ruling); });
    }

private:
    template <class Tell>
    void pass(const Tell& tell) noexcept {
        if (!next_) return;
        const auto began = std::chrono::steady_clock::now();
        tell(*next_);
        told_ += std::chrono::steady_clock::now() - began;
    }
    SessionObserver* next_;
    std::string doubt_;
    std::atomic<int> updates_{0}, doubted_{0}, skin_checks_{0};
    Instant told_{};               ///< since the last update
    std::vector<double> told_ms_;  ///< of each update
};

/// Cameras that doubt themselves in every second dozen of frames.
class Doubtful final : public StereoCamera {
public:
    Doubtful(StereoCamera& cameras, std::string doubt) : cameras_(cameras), doubt_(std::move(doubt)) {}
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override {
        return cameras_.grab(not_before, patience);
    }
    StereoFrame newest(Instant not_before, std::chrono::milliseconds patience) override {
        ++frames_;
        return cameras_.newest(not_before, patience);
    }
    std::string doubt() const override { return frames_ / 12 % 2 == 1 ? doubt_ : ""; }

private:
    StereoCamera& cameras_;
    std::string doubt_;
    int frames_ = 0;
};

void press_when_free(LiveSession& session, OperatorAction action, ButtonState OperatorModel::*button,
                     const char* name) {
    wait_for(session, name, [&](const OperatorModel& m) { return (m.*button).enabled; });
    session.post(action);
}

/// Says that the light is right on each landmark that is lit, as far as it is asked.
void verify(LiveSession& session, const Counting& counting, int until) {
    std::string confirmed;
    wait_for(session, "the updates", [&](const OperatorModel& model) {
        if (counting.updates() >= until) return true;
        if (model.confirm && model.confirm_words != confirmed) {
            confirmed = model.confirm_words;
            session.post(OperatorAction::confirm);
        }
        return !model.stop.enabled && model.status.kind == StatusKind::refused;  // the gate has stopped the light
    });
}

void hide_and_show(LiveSession& session, const Counting& counting) {
    const auto some_updates = [&] {
        const int until = counting.updates() + 8;
        wait_for(session, "updates", [&](const OperatorModel&) { return counting.updates() >= until; });
    };
    session.post_item(OperatorAction::hide_item, 0);
    some_updates();
    session.post_item(OperatorAction::light_item, 1);
    some_updates();
    session.post_item(OperatorAction::show_item, std::nullopt);
    some_updates();
}

}  // namespace

const ExampleCase& example_case() {
    static const ExampleCase made = [] {
        ExampleCase example;
        if (!example_patient()) return example;
        example.there = true;
        example.volume = read_volume(*example_patient());
        example.prepared =
            prepare_case(example.volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"),
                         {}, {}, "2001-10-14")
                .prepared;
        return example;
    }();
    return made;
}

PlayedResult play_session(const PlayedSession& how, const ExampleCase& patient, SessionObserver* observer) {
    Counting counting(observer, how.doubt);
    simulation::RoomSettings room;
    room.preset = simulation::Preset::paper;
    room.seed = how.seed;
    CaseDrawing drawing(patient.prepared);
    drawing.settings.card = how.card;
    PlayedResult result;
    {
        LiveSession session(
            [&](const RoomProgress&) -> std::unique_ptr<Room> {
                auto simulated = std::make_unique<SimulatedRoom>(patient.volume, patient.prepared.plan, room,
                                                                 how.speed_mm_s, how.fault);
                if (how.doubt.empty()) return simulated;
                return std::make_unique<RoomWith<Doubtful>>(std::move(simulated), how.doubt);
            },
            patient.prepared, drawing, {}, &counting);
        press_when_free(session, OperatorAction::scan, &OperatorModel::scan, "Scan");
        if (how.dark_in_scan) {
            wait_for(session, "the scan", [](const OperatorModel& m) { return m.status.kind == StatusKind::scanning; });
            std::this_thread::sleep_for(300ms);
            session.post(OperatorAction::dark);
            wait_for(session, "DARK", [](const OperatorModel& m) { return m.status.kind == StatusKind::dark; });
            session.post(OperatorAction::scan);
        }
        wait_for(session, "the end of the scan",
                 [](const OperatorModel& m) { return m.do_register.enabled && m.status.kind != StatusKind::scanning; });
        if (how.landmarks)
            session.post_find_patient({{"nose", {0, 0, 0}, {0, 0, 900}}, {"chin", {0, 10, -60}, {0, 60, 900}}});
        else
            session.post(OperatorAction::do_register);
        wait_for(session, "the match", [](const OperatorModel& m) {
            return m.track.enabled || m.confirm || m.status.kind == StatusKind::refused;
        });
        if (session.model().confirm) session.post(OperatorAction::confirm);
        result.headline = session.model().status.headline;
        if (session.model().status.kind == StatusKind::refused) return result;
        press_when_free(session, OperatorAction::track, &OperatorModel::track, "Track");
        verify(session, counting, how.updates * 2 / 3);
        if (how.check_skin) {
            session.post(OperatorAction::check_skin);
            wait_for(session, "the check of the skin",
                     [&](const OperatorModel&) { return counting.skin_checks() > 0; });
        }
        if (how.hide_items) hide_and_show(session, counting);
        session.post(OperatorAction::dark);
        wait_for(session, "DARK", [](const OperatorModel& m) { return !m.stop.enabled; });
        session.post(OperatorAction::track);
        verify(session, counting, how.updates);
        result.headline = session.model().status.headline;
    }
    result.updates = counting.updates();
    result.doubted = counting.doubted();
    result.told_ms = counting.told_ms();
    return result;
}

PlayedResult record_session(const PlayedSession& how, const ExampleCase& patient, RecordMode mode,
                            const std::filesystem::path& file) {
    DrawingSettings drawing;
    drawing.card = how.card;
    SessionRecorder recorder(std::make_unique<RecordingFile>(file),
                             recording_head(patient.prepared, file.parent_path(), mode, drawing));
    return play_session(how, patient, &recorder);
}

}  // namespace planlight::test
