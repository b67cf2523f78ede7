#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <thread>

#include "app/live/live_session.h"
#include "app/live/simulated_room.h"
#include "planning_io/types/error.h"
#include "tests/app/played_session.h"
#include "tests/app/room_with.h"

namespace planlight {

using namespace std::chrono_literals;
using test::wait_for;

/// Cameras that give no frame while they are held: the session's thread waits, and what is pressed waits with it.
/// After that the first one may be lost.
class HeldCameras final : public StereoCamera {
public:
    HeldCameras(StereoCamera& cameras, std::atomic<bool>& held, std::atomic<bool>& waits, std::atomic<bool>& lost)
        : cameras_(cameras), held_(held), waits_(waits), lost_(lost) {}
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override {
        return cameras_.grab(not_before, patience);
    }
    StereoFrame newest(Instant not_before, std::chrono::milliseconds patience) override {
        for (; held_; std::this_thread::sleep_for(1ms)) waits_ = true;
        waits_ = false;
        if (lost_.exchange(false)) throw DeviceError("left camera", "no frame came", "Look at its cable.");
        return cameras_.newest(not_before, patience);
    }

private:
    StereoCamera& cameras_;
    std::atomic<bool>&held_, &waits_, &lost_;
};

/// Counts the updates since a landmark was lit, and how often the gate forbade light before there was any; hears
/// whether light stays.
class CountsUpdates final : public SessionObserver {
public:
    void asked(SessionCall call, const std::vector<PointPair>&, int) noexcept override {
        if (call == SessionCall::light_landmark) since = 0;
    }
    void updated(const Session&, const Session::Update&) noexcept override { ++since; }
    void gate(GateCall call, Instant, double, const LightGate::Ruling*) noexcept override {
        if (call == GateCall::forbids) ++forbidden;
        if (call == GateCall::other_light) ++other_light;
    }
    void light_stays(bool stays) noexcept override { light_stays_now = stays; }
    std::atomic<int> since{0}, forbidden{0}, other_light{0};
    std::atomic<bool> light_stays_now{false};
};

/// A session in the simulated room, from its first moment.
class LiveSessionTest : public testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "invesalius-examples is not installed";
        room.preset = simulation::Preset::paper;
        session = std::make_unique<LiveSession>(
            [this](const RoomProgress& progress) {
                progress("The room of a test.", 0.25);
                return std::make_unique<test::RoomWith<HeldCameras>>(made_room(), std::ref(held), std::ref(waits),
                                                                     std::ref(lost));
            },
            test::example_case().prepared, drawing(), "/proc/planlight/matches", &counts);  // no disk keeps one there
    }
    void TearDown() override { held = false; }  // its thread is waited for
    virtual std::unique_ptr<Room> made_room() {
        return std::make_unique<SimulatedRoom>(test::example_case().volume, test::example_case().prepared.plan, room,
                                               5);
    }
    static const CaseDrawing& drawing() {
        static const CaseDrawing made = [] {
            CaseDrawing drawn(test::example_case().prepared);
            drawn.settings.card = {"E. M.", "RIGHT"};
            return drawn;
        }();
        return made;
    }
    OperatorModel ready() {
        return wait_for(*session, "ready", [](const OperatorModel& m) { return m.scan.enabled; });
    }
    OperatorModel followed() {
        ready();
        session->post(OperatorAction::scan);
        wait_for(*session, "the scan", [](const OperatorModel& m) { return m.do_register.enabled; });
        session->post(OperatorAction::do_register);
        const OperatorModel matched =
            wait_for(*session, "the match", [](const OperatorModel& m) { return m.track.enabled || m.confirm; });
        if (matched.confirm) session->post(OperatorAction::confirm);
        wait_for(*session, "Track", [](const OperatorModel& m) { return m.track.enabled; });
        session->post(OperatorAction::track);
        return wait_for(*session, "light",
                        [](const OperatorModel& m) { return m.figures.delay_to_light_ms.has_value(); });
    }

    /// Of the light of now; -1: it is dark.
    long bright_pixels() const {
        const auto picture = session->light().picture;
        if (!picture) return -1;
        return static_cast<long>(std::count_if(picture->pixels.begin(), picture->pixels.end(), [](const Rgb& p) {
            return std::max({p[0], p[1], p[2]}) > 120;
        }));
    }

    /// The thread waits for a frame: what is pressed now waits until `held` is over.
    void hold() {
        held = true;
        wait_for(*session, "the cameras", [&](const OperatorModel&) { return waits.load(); });
    }

    simulation::RoomSettings room;
    std::atomic<bool> held{false}, waits{false}, lost{false};
    CountsUpdates counts;
    std::unique_ptr<LiveSession> session;
};

inline bool says(const OperatorModel& model, const std::string& part) {
    return model.status.headline.find(part) != std::string::npos ||
           std::any_of(model.status.details.begin(), model.status.details.end(),
                       [&](const std::string& detail) { return detail.find(part) != std::string::npos; });
}

}  // namespace planlight
