#include "app/live/live_session.h"

#include <array>

#include "app/case_model.h"
#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {
namespace {

constexpr auto kLostPause = std::chrono::milliseconds(100);
// For an observer, in the order of their enumerations.
constexpr std::array kActions{"none", "scan", "register", "track",         "stop",
                              "dark", "quit", "confirm",  "use landmarks", "check skin"};
constexpr std::array kStatusKinds{"ready", "scanning", "matching", "aligned", "check", "refused", "dark", "waiting"};

}  // namespace

/// Passes everything to the room's projector and keeps the newest picture for the windows.
class LiveSession::LightTap final : public Projector {
public:
    LightTap(Projector& projector, LiveSession& session) : projector_(projector), session_(session) {}
    int width() const override { return projector_.width(); }
    int height() const override { return projector_.height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        session_.show_alive();
        if (!keep(std::make_shared<RgbImage>(picture))) {
            projector_.go_dark();
            return projector_.show(RgbImage(width(), height()), valid_until);
        }
        return projector_.show(picture, valid_until);
    }
    void go_dark() noexcept override {
        session_.show_alive();
        projector_.go_dark();
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
    Projector& projector_;
    LiveSession& session_;
};

namespace {

Status dark_status() {
    return {StatusKind::dark, "Dark: no light on the patient.", {"Press Track to show the plan again."}};
}

}  // namespace

LiveSession::LiveSession(MakeRoom make_room, const Case& the_case, const CaseDrawing& drawing,
                         std::filesystem::path keep_matches_in, SessionObserver* observer,
                         std::optional<ResumeOffer> offer)
    : case_(the_case),
      drawing_(drawing),
      keep_matches_in_(std::move(keep_matches_in)),
      observer_(observer),
      model_(model_of_case(the_case, drawing)),
      gate_(observer),
      offer_(std::move(offer)) {
    set_status(StatusKind::waiting, "The room is being made ready.", {"This takes some seconds."});
    show_alive();
    thread_ = std::thread([this, make_room = std::move(make_room)] {
        try {
            run(make_room);
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
    if (observer_) observer_->pressed(kActions.at(static_cast<std::size_t>(action)));
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

UpdateLatency LiveSession::latency() const {
    const std::lock_guard lock(mutex_);
    return latency_;
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
    if (observer_) observer_->said(kStatusKinds.at(static_cast<std::size_t>(kind)), headline, details);
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

void LiveSession::run(const MakeRoom& make_room) {
    const std::unique_ptr<Room> room = make_room();
    LightTap tap(room->projector(), *this);
    SessionSettings session_settings = settings_for(room->markers());
    session_settings.observer = observer_;
    if (observer_)
        observer_->room_entered(
            {room->name(), room->simulated(), room->markers(), room->rig(), room->notes(), room->clock().now()});
    session_settings.while_computing = [&room] { room->computing(); };
    Session session(case_, drawing_, room->rig(), tap, room->cameras(), room->clock(), session_settings);
    set_steps(2);
    std::vector<std::string> details{"The projector is dark."};
    const std::vector<std::string> notes = room->notes();
    details.insert(details.end(), notes.begin(), notes.end());
    set_status(StatusKind::ready, "Ready to scan.", std::move(details));
    change_model([&](OperatorModel& m) {
        if (room->simulated())
            m.case_title = "SIMULATED ROOM: " + m.case_title;
        else
            m.case_subtitle = room->name() + " · " + m.case_subtitle;
        m.scan = {true, {}};
        m.do_register = {false, "scan first"};
        m.track = {false, "register first"};
        m.stop = {false, "nothing runs"};
    });
    offer_to_resume();
    for (;;) {
        const Press press = next_press(!following_);
        show_alive();
        if (press.action == OperatorAction::quit) return;
        try {
            act(press, session, *room);
        } catch (const DeviceError& lost) {
            // What is lost comes back by itself: the patient is still where the scan and the match say.
            projecting_ = false;
            session.go_dark();
            set_status(StatusKind::dark, std::string("Dark: ") + lost.what() + ".",
                       {lost.remedy, following_ ? "The light comes back by itself." : "Press the button again."});
            if (following_) std::this_thread::sleep_for(kLostPause);
        } catch (const Error& refusal) {
            following_ = projecting_ = false;
            session.go_dark();
            set_status(StatusKind::refused, std::string(refusal.what()) + ".", {refusal.remedy});
        }
    }
}

void LiveSession::act(const Press& press, Session& session, Room& room) {
    switch (press.action) {
        case OperatorAction::scan:
            offer_.reset();
            look_first_ = false;
            following_ = projecting_ = false;
            permit_light(press);
            room.let_patient_move(false);
            scan(session);
            return;
        case OperatorAction::do_register:
        case OperatorAction::use_landmarks:
            find_patient(session, newest_landmarks());
            return;
        case OperatorAction::check_skin:
            permit_light(press);
            room.let_patient_move(false);  // was asked to lie still
            check_skin(session);
            room.let_patient_move(following_);
            break;
        case OperatorAction::track:
            permit_light(press);
            look_again(session);
            gate_.restart();
            end_verification(session);
            following_ = true;
            room.let_patient_move(true);
            break;
        case OperatorAction::confirm:
            permit_light(press);
            if (offer_)
                resume(session);
            else
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
                m.confirm = offer_.has_value();
                m.check_skin = false;
                m.stop = {false, "nothing runs"};
            });
            return;
        case OperatorAction::none:
        case OperatorAction::quit:
            break;
    }
    if (following_) follow(session, room);
}

}  // namespace planlight
