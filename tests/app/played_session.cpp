#include "tests/app/played_session.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <thread>

#include "app/live/simulated_fault.h"
#include "app/prepare_case.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
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
    void frame_exposed() noexcept override {
        pass([&](SessionObserver& next) { next.frame_exposed(); });
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
    void match_offered(const KeptMatch& match) noexcept override {
        pass([&](SessionObserver& next) { next.match_offered(match); });
    }
    void resumed(const Session& session, const ResumeCheck& check) noexcept override {
        pass([&](SessionObserver& next) { next.resumed(session, check); });
        told_ = {};
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

/// The simulated room with what can go wrong in it besides: each at a frame, not at a moment of the wall's clock.
class PlayedRoom final : public Room {
public:
    PlayedRoom(const ExampleCase& patient, const PlayedSession& how)
        : rig_(patient.volume, points_of(patient.prepared.plan), settings(how)), how_(how) {}
    std::string name() const override { return "the simulated room"; }
    const RigCalibration& rig() const override { return rig_.calibration(); }
    Projector& projector() override { return projector_; }
    StereoCamera& cameras() override { return cameras_; }
    const Clock& clock() const override { return rig_.clock(); }
    RoomKind kind() const override { return RoomKind::simulated; }
    Instant look_interval() const override { return 2s; }
    void computing() override { rig_.wait(10ms); }
    void let_patient_move(bool moves) override {
        if (moves != moving_) rig_.set_motion({moves ? how_.speed_mm_s : 0, rig_.clock().now()});
        moving_ = moves;
    }
    void begin_fault() override {
        if (how_.fault_after == 0) planlight::begin_fault(how_.fault, rig_);
    }

    void plug_in() { unplugged_ = false; }
    /// Three of the plan's points where the patient truly lies before anything moves, so far aside.
    std::vector<PointPair> landmarks(double aside_mm, const Plan& plan) const {
        const RigidTransform rig_from_ct = rig_.true_rig_from_ct({});
        std::vector<PointPair> pairs;
        for (const Eigen::Vector3d& p_in_ct : points_of(plan)) {
            if (pairs.size() == 3) break;
            pairs.push_back({"point " + std::to_string(pairs.size() + 1), p_in_ct,
                             rig_from_ct * p_in_ct + Eigen::Vector3d(0, aside_mm, 0)});
        }
        return pairs;
    }

private:
    class Cameras final : public StereoCamera {
    public:
        explicit Cameras(PlayedRoom& room) : room_(room) {}
        StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override {
            if (exposed_) return *std::exchange(exposed_, {});
            room_.scanned_one();
            return room_.rig_.cameras().grab(not_before, patience);
        }
        bool wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) override {
            if (room_.how_.exposures_told) exposed_ = grab(not_before, patience);
            return exposed_.has_value();
        }
        StereoFrame newest(Instant not_before, std::chrono::milliseconds patience) override {
            room_.followed_one();
            return room_.rig_.cameras().newest(not_before, patience);
        }
        /// In every second dozen of frames.
        std::string doubt() const override { return room_.followed_ / 12 % 2 == 1 ? room_.how_.doubt : ""; }

    private:
        PlayedRoom& room_;
        std::optional<StereoFrame> exposed_;  ///< and not yet given
    };
    class Light final : public Projector {
    public:
        explicit Light(PlayedRoom& room) : room_(room) {}
        int width() const override { return room_.rig_.projector().width(); }
        int height() const override { return room_.rig_.projector().height(); }
        Instant show(const RgbImage& picture, Instant valid_until) override {
            if (room_.unplugged_) throw DeviceError("Projector", "its cable is unplugged", "Plug it in.");
            return room_.rig_.projector().show(picture, valid_until);
        }
        void go_dark() noexcept override { room_.rig_.projector().go_dark(); }

    private:
        PlayedRoom& room_;
    };

    static simulation::RoomSettings settings(const PlayedSession& how) {
        simulation::RoomSettings room;
        room.preset = how.preset;
        room.seed = how.seed;
        room.things = how.things;
        return room;
    }
    /// A short movement now and then, so that most pictures of a scan are of a head at rest.
    void scanned_one() {
        constexpr int kEvery = 15;
        if (!how_.moves_in_scan || ++scanned_ % kEvery != 0) return;
        rig_.set_motion({30, rig_.clock().now()});
        rig_.wait(100ms);
        rig_.set_motion({0, rig_.clock().now()});
    }
    void followed_one() {
        constexpr int kHandStays = 8, kFailures = 3;
        if (!moving_ || ++followed_ < how_.fault_after || how_.fault_after == 0) return;
        const int since = followed_ - how_.fault_after;
        if (since == 0) planlight::begin_fault(how_.fault, rig_);
        if (how_.fault == "hand-over-markers") {
            std::vector<int> all(rig_.true_markers_in_ct().size());
            std::iota(all.begin(), all.end(), 0);
            if (since == 0) rig_.cover_markers(all);
            if (since == kHandStays) rig_.cover_markers({});
        }
        if (how_.fault == "projector-away" && since == 0) unplugged_ = true;
        if (how_.fault == "camera-away" && since < kFailures)
            throw DeviceError("Left camera", "no frame came in 200 ms", "Look at its cable.");
    }

    simulation::SimulatedRig rig_;
    const PlayedSession how_;
    Cameras cameras_{*this};
    Light projector_{*this};
    bool moving_ = false;
    std::atomic<bool> unplugged_{false};
    int scanned_ = 0, followed_ = 0;
};

void press_when_free(LiveSession& session, OperatorAction action, ButtonState OperatorModel::*button,
                     const char* name) {
    wait_for(session, name, [&](const OperatorModel& m) { return (m.*button).enabled; });
    session.post(action);
}

/// Says that the light is right on each landmark that is lit, as far as it is asked.
void verify(LiveSession& session, const Counting& counting, int until) {
    LandmarkWitness witness(session);
    wait_for(session, "the updates", [&](const OperatorModel& model) {
        if (counting.updates() >= until) return true;
        witness.look(model);
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

/// False: the scan was refused.
bool scan(LiveSession& session, const PlayedSession& how) {
    press_when_free(session, OperatorAction::scan, &OperatorModel::scan, "Scan");
    if (how.dark_in_scan) {
        wait_for(session, "some of the scan", [](const OperatorModel& m) { return m.status.share.value_or(0) > 0.2; });
        session.post(OperatorAction::dark);
        wait_for(session, "DARK", [](const OperatorModel& m) { return m.status.kind == StatusKind::dark; });
        session.post(OperatorAction::scan);
    }
    return wait_for(session, "the end of the scan", [](const OperatorModel& m) {
               return m.status.kind == StatusKind::refused ||
                      (m.do_register.enabled && m.status.kind != StatusKind::scanning);
           }).status.kind != StatusKind::refused;
}

void find(LiveSession& session, const PlayedSession& how, const ExampleCase& patient, const PlayedRoom& room) {
    if (how.landmarks)
        session.post_find_patient({{"nose", {0, 0, 0}, {0, 0, 900}}, {"chin", {0, 10, -60}, {0, 60, 900}}});
    else if (how.look != PlayedSession::Look::not_needed)
        session.post_find_patient(room.landmarks(6, patient.prepared.plan));  // 4 mm: ask; 8 mm: no
    else
        session.post(OperatorAction::do_register);
}

}  // namespace

void begin_to_follow(LiveSession& session) {
    press_when_free(session, OperatorAction::scan, &OperatorModel::scan, "Scan");
    press_when_free(session, OperatorAction::do_register, &OperatorModel::do_register, "the scan");
    press_when_free(session, OperatorAction::track, &OperatorModel::track, "the match");
}

void LandmarkWitness::look(const OperatorModel& model) {
    if (!model.confirm || model.confirm_words == said_) return;
    said_ = model.confirm_words;
    session_.post(OperatorAction::confirm);
}

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

PlayedResult play_session(const PlayedSession& how, const ExampleCase& patient, SessionObserver* observer,
                          const std::optional<ResumeOffer>& offer) {
    Counting counting(observer, how.doubt);
    CaseDrawing drawing(patient.prepared);
    drawing.settings.card = how.card;
    PlayedResult result;
    {
        PlayedRoom* room = nullptr;  // once the session is ready
        LiveSession session(
            [&](const RoomProgress&) {
                auto made = std::make_unique<PlayedRoom>(patient, how);
                room = made.get();
                return made;
            },
            patient.prepared, drawing, {}, &counting, offer);
        if (!offer) {
            if (!scan(session, how)) return result.headline = session.model().status.headline, result;
            find(session, how, patient, *room);
        } else {
            wait_for(session, "the offer", [](const OperatorModel& m) { return m.confirm; });
            session.post(OperatorAction::confirm);
            wait_for(session, "the short scan",
                     [](const OperatorModel& m) { return m.track.enabled || m.status.kind == StatusKind::refused; });
        }
        wait_for(session, "the match", [](const OperatorModel& m) {
            return m.track.enabled || m.confirm || m.status.kind == StatusKind::refused;
        });
        if (how.look == PlayedSession::Look::refused) session.post(OperatorAction::dark);
        if (session.model().confirm) session.post(OperatorAction::confirm);
        result.headline = session.model().status.headline;
        if (session.model().status.kind == StatusKind::refused || how.look == PlayedSession::Look::refused)
            return result;
        press_when_free(session, OperatorAction::track, &OperatorModel::track, "Track");
        verify(session, counting, how.updates * 2 / 3);
        if (how.check_skin) {
            session.post(OperatorAction::check_skin);
            wait_for(session, "the check of the skin",
                     [&](const OperatorModel&) { return counting.skin_checks() > 0; });
        }
        if (how.hide_items) hide_and_show(session, counting);
        const bool away = how.fault == "projector-away";
        if (away) session.look_before_light();
        session.post(OperatorAction::dark, away ? AskedBy::lost_projector : AskedBy::person);
        wait_for(session, "DARK", [](const OperatorModel& m) { return !m.stop.enabled; });
        room->plug_in();
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
