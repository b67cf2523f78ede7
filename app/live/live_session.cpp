#include "app/live/live_session.h"

#include "app/case_model.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"

namespace planlight {

/// Passes everything to the simulated projector and keeps the newest picture for the projector window.
class LiveSession::LightTap final : public Projector {
public:
    LightTap(Projector& simulated, LiveSession& session) : simulated_(simulated), session_(session) {}
    int width() const override { return simulated_.width(); }
    int height() const override { return simulated_.height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        if (session_.dark_wanted_) {
            go_dark();
            return simulated_.show(RgbImage(width(), height()), valid_until);
        }
        const Instant lit_from = simulated_.show(picture, valid_until);
        keep(std::make_shared<RgbImage>(picture));
        return lit_from;
    }
    void go_dark() noexcept override {
        simulated_.go_dark();
        keep(nullptr);
    }

private:
    void keep(std::shared_ptr<const RgbImage> picture) noexcept {
        const std::lock_guard lock(session_.mutex_);
        session_.light_.picture = std::move(picture);
        ++session_.light_.number;
    }
    Projector& simulated_;
    LiveSession& session_;
};

LiveSession::LiveSession(const Volume& volume, const Case& the_case, const CaseDrawing& drawing,
                         const LiveSettings& settings)
    : case_(the_case), drawing_(drawing), settings_(settings), model_(model_of_case(the_case, drawing)) {
    set_status(StatusKind::ready, "The simulated room is being made.");
    thread_ = std::thread([this, &volume] {
        try {
            run(volume, settings_);
        } catch (const std::exception& fault) {
            const std::lock_guard lock(mutex_);
            fault_ = fault.what();
            light_ = {nullptr, light_.number + 1};
        }
        projecting_ = false;
    });
}

LiveSession::~LiveSession() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

void LiveSession::post(OperatorAction action) {
    if (action == OperatorAction::none) return;
    {
        const std::lock_guard lock(mutex_);
        if (action == OperatorAction::dark || action == OperatorAction::stop) {
            actions_.clear();
            dark_wanted_ = true;
            light_ = {nullptr, light_.number + 1};
        }
        actions_.push_back(action);
    }
    wake_.notify_all();
}

void LiveSession::post_find_patient(std::vector<PointPair> landmarks) {
    {
        const std::lock_guard lock(mutex_);
        landmarks_ = std::move(landmarks);
    }
    post(OperatorAction::do_register);
}

OperatorModel LiveSession::model() const {
    const std::lock_guard lock(mutex_);
    return model_;
}

LiveSession::Light LiveSession::light() const {
    const std::lock_guard lock(mutex_);
    return light_;
}

bool LiveSession::projecting() const {
    return projecting_;
}

std::string LiveSession::fault() const {
    const std::lock_guard lock(mutex_);
    return fault_;
}

void LiveSession::set_status(StatusKind kind, const std::string& headline, std::vector<std::string> details) {
    change_model([&](OperatorModel& m) { m.status = {kind, headline, std::move(details)}; });
}

/// Steps before the active one are done, later ones wait.
void LiveSession::set_steps(int active, StepState state) {
    change_model([&](OperatorModel& m) {
        for (int i = 0; i < static_cast<int>(m.steps.size()); ++i)
            m.steps[static_cast<std::size_t>(i)] = i < active    ? StepState::done
                                                   : i == active ? state
                                                                 : StepState::waiting;
    });
}

OperatorAction LiveSession::next_action(bool wait) {
    std::unique_lock lock(mutex_);
    if (wait) wake_.wait(lock, [&] { return ending_ || !actions_.empty(); });
    if (ending_) return OperatorAction::quit;
    if (actions_.empty()) return OperatorAction::none;
    const OperatorAction action = actions_.front();
    actions_.pop_front();
    return action;
}

void LiveSession::run(const Volume& volume, const LiveSettings& settings) {
    simulation::RoomSettings room;
    room.preset = settings.preset;
    room.seed = settings.seed;
    simulation::SimulatedRig rig(volume, points_of(case_.plan), room);
    LightTap tap(rig.projector(), *this);
    SessionSettings session_settings;
    session_settings.while_computing = [&rig] { rig.wait(std::chrono::milliseconds(10)); };
    Session session(case_, drawing_, rig.calibration(), tap, rig.cameras(), rig.clock(), session_settings);
    set_steps(2);
    set_status(StatusKind::ready, "Ready to scan.", {"The projector is dark."});
    change_model([](OperatorModel& m) {
        m.scan = {true, {}};
        m.do_register = {false, "scan first"};
        m.track = {false, "register first"};
        m.stop = {false, "nothing runs"};
    });
    for (;;) {
        const OperatorAction action = next_action(!following_);
        if (action == OperatorAction::quit) return;
        try {
            act(action, session, rig);
        } catch (const Error& refusal) {
            following_ = projecting_ = false;
            session.go_dark();
            set_status(StatusKind::refused, std::string(refusal.what()) + ".", {refusal.remedy});
        }
    }
}

void LiveSession::act(OperatorAction action, Session& session, simulation::SimulatedRig& rig) {
    switch (action) {
        case OperatorAction::scan:
            following_ = projecting_ = dark_wanted_ = false;
            if (moving_) rig.set_motion({0, rig.clock().now()});
            moving_ = false;
            scan(session);
            return;
        case OperatorAction::do_register:
        case OperatorAction::use_landmarks:
            find_patient(session, newest_landmarks());
            return;
        case OperatorAction::track:
            dark_wanted_ = false;
            following_ = true;
            if (!moving_) rig.set_motion({settings_.speed_mm_s, rig.clock().now()});
            moving_ = true;
            set_steps(5);
            break;
        case OperatorAction::confirm:
            confirm(session);
            return;
        case OperatorAction::dark:
        case OperatorAction::stop:
            following_ = projecting_ = false;
            session.go_dark();
            set_status(StatusKind::dark, "Dark: no light on the patient.", {"Press Track to show the plan again."});
            change_model([](OperatorModel& m) {
                m.scene.light = nullptr;
                m.stop = {false, "nothing runs"};
            });
            return;
        case OperatorAction::none:
        case OperatorAction::quit:
            break;
    }
    if (following_) follow(session, rig);
}

}  // namespace planlight
