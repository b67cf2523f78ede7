#include "app/live/live_session.h"

#include "app/case_model.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {

/// Passes everything to the simulated projector and keeps the newest picture for the projector window.
class LiveSession::LightTap final : public Projector {
public:
    LightTap(Projector& simulated, LiveSession& session) : simulated_(simulated), session_(session) {}
    int width() const override { return simulated_.width(); }
    int height() const override { return simulated_.height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        session_.show_alive();
        if (!keep(std::make_shared<RgbImage>(picture))) {
            simulated_.go_dark();
            return simulated_.show(RgbImage(width(), height()), valid_until);
        }
        return simulated_.show(picture, valid_until);
    }
    void go_dark() noexcept override {
        session_.show_alive();
        simulated_.go_dark();
        keep(nullptr);
    }

private:
    /// Under one lock with the presses of DARK: false, and darkness, when one came after this light was asked for.
    bool keep(std::shared_ptr<const RgbImage> picture) noexcept {
        const std::lock_guard lock(session_.mutex_);
        const bool permitted = session_.permitted_ == session_.darks_;
        session_.light_.picture = permitted ? std::move(picture) : nullptr;
        ++session_.light_.number;
        return permitted;
    }
    Projector& simulated_;
    LiveSession& session_;
};

namespace {

Status dark_status() {
    return {StatusKind::dark, "Dark: no light on the patient.", {"Press Track to show the plan again."}};
}

}  // namespace

LiveSession::LiveSession(const Volume& volume, const Case& the_case, const CaseDrawing& drawing,
                         const LiveSettings& settings)
    : case_(the_case), drawing_(drawing), settings_(settings), model_(model_of_case(the_case, drawing)) {
    set_status(StatusKind::ready, "The simulated room is being made.");
    show_alive();
    thread_ = std::thread([this, &volume] {
        try {
            run(volume, settings_);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            fault_ = std::current_exception();
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
            presses_.clear();
            ++darks_;
            light_ = {nullptr, light_.number + 1};
        }
        presses_.push_back({action, darks_});
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
    if (darks_answered_ == darks_) return model_;
    OperatorModel dark = model_;  // DARK was pressed, and the thread is still at something else
    dark.status = dark_status();
    dark.scene.light = nullptr;
    dark.confirm = dark.check_skin = false;
    return dark;
}

LiveSession::Light LiveSession::light() const {
    const std::lock_guard lock(mutex_);
    return light_;
}

bool LiveSession::projecting() const {
    return projecting_;
}

void LiveSession::rethrow_fault() const {
    const std::lock_guard lock(mutex_);
    if (fault_) std::rethrow_exception(fault_);
}

void LiveSession::show_alive() {
    alive_at_ = SteadyClock().now().count();
}

/// The light of this press may be shown, unless DARK was pressed after it.
void LiveSession::permit_light(const Press& press) {
    const std::lock_guard lock(mutex_);
    permitted_ = press.darks;
}

bool LiveSession::light_permitted() const {
    const std::lock_guard lock(mutex_);
    return permitted_ == darks_;
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

LiveSession::Press LiveSession::next_press(bool wait) {
    std::unique_lock lock(mutex_);
    if (wait) wake_.wait(lock, [&] { return ending_ || !presses_.empty(); });
    if (ending_) return {OperatorAction::quit, darks_};
    if (presses_.empty()) return {OperatorAction::none, darks_};
    const Press press = presses_.front();
    presses_.pop_front();
    return press;
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
        const Press press = next_press(!following_);
        show_alive();
        if (press.action == OperatorAction::quit) return;
        try {
            act(press, session, rig);
        } catch (const Error& refusal) {
            following_ = projecting_ = false;
            session.go_dark();
            set_status(StatusKind::refused, std::string(refusal.what()) + ".", {refusal.remedy});
        }
    }
}

void LiveSession::act(const Press& press, Session& session, simulation::SimulatedRig& rig) {
    switch (press.action) {
        case OperatorAction::scan:
            following_ = projecting_ = false;
            permit_light(press);
            if (moving_) rig.set_motion({0, rig.clock().now()});
            moving_ = false;
            scan(session);
            return;
        case OperatorAction::do_register:
        case OperatorAction::use_landmarks:
            find_patient(session, newest_landmarks());
            return;
        case OperatorAction::check_skin:
            permit_light(press);
            if (moving_) rig.set_motion({0, rig.clock().now()});  // the patient was asked to lie still
            check_skin(session);
            if (moving_) rig.set_motion({settings_.speed_mm_s, rig.clock().now()});
            break;
        case OperatorAction::track:
            permit_light(press);
            gate_.restart();
            end_verification(session);
            following_ = true;
            if (!moving_) rig.set_motion({settings_.speed_mm_s, rig.clock().now()});
            moving_ = true;
            break;
        case OperatorAction::confirm:
            confirm(session);
            return;
        case OperatorAction::dark:
        case OperatorAction::stop:
            following_ = projecting_ = false;
            session.go_dark();
            change_model([&](OperatorModel& m) {
                darks_answered_ = press.darks;
                m.status = dark_status();
                m.scene.light = nullptr;
                m.confirm = m.check_skin = false;
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
