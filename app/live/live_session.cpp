#include "app/live/live_session.h"

#include <algorithm>
#include <array>

#include "app/case_model.h"
#include "app/live/scene_of_session.h"
#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"
#include "registration/tracking/find_markers.h"

namespace planlight {
namespace {

constexpr auto kLostPause = std::chrono::milliseconds(100);
constexpr auto kOldAfter = std::chrono::milliseconds(1500);  // a picture is not called live any more
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

LiveSession::LiveSession(MakeRoom make_room, const Case& the_case, const CaseDrawing& drawing,
                         std::filesystem::path keep_matches_in, SessionObserver* observer,
                         std::optional<ResumeOffer> offer)
    : case_(the_case),
      drawing_(drawing),
      keep_matches_in_(std::move(keep_matches_in)),
      observer_(observer),
      blank_(model_of_case(the_case, drawing)),
      model_(blank_),
      gate_(observer),
      offer_(std::move(offer)) {
    enter(state_, blank_, model_);
    said();
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

/// Under the lock: why the press does nothing now; empty: it is taken.
std::string LiveSession::refused_press(OperatorAction action) const {
    if (const std::string why = why_not(state_, action);
        !why.empty() && action != OperatorAction::stop && action != OperatorAction::dark)
        return why;
    if (action == OperatorAction::confirm && !model_.confirm) return why_not(SessionState::ready, action);
    return {};
}

std::string LiveSession::post(OperatorAction action) {
    if (action == OperatorAction::none) return {};
    {
        const std::lock_guard lock(mutex_);
        if (std::string why = refused_press(action); !why.empty()) return why;
        const bool dark = action == OperatorAction::dark || action == OperatorAction::stop;
        if (dark) {
            presses_.clear();
            ++darks_;
            light_ = {nullptr, light_.number + 1};
        }
        const SessionState next = after_press(state_, action).value_or(state_);
        if (next != state_ && !(next == SessionState::verifying || state_ == SessionState::unsure))
            enter(next, blank_, model_);
        state_ = next;
        if (dark) model_.status = dark_status(state_);
        if (action == OperatorAction::confirm) model_.confirm = false;  // until there is something new to look at
        presses_.push_back({action, darks_});
    }
    wake_.notify_all();
    if (observer_) observer_->pressed(kActions.at(static_cast<std::size_t>(action)));
    return {};
}

std::string LiveSession::post_find_patient(std::vector<PointPair> landmarks) {
    {
        const std::lock_guard lock(mutex_);
        landmarks_ = std::move(landmarks);
    }
    return post(OperatorAction::do_register);
}

void LiveSession::happened(SessionHappening happening, const std::function<void(OperatorModel&)>& change) {
    {
        const std::lock_guard lock(mutex_);
        if (view_of(state_).lights && permitted_ != darks_) return;
        const SessionState next = after(state_, happening);
        if (next == state_) return;
        state_ = next;
        enter(next, blank_, model_);
        if (change) change(model_);
    }
    said();
}

/// Tells the observer what the banner says.
void LiveSession::said() {
    if (!observer_) return;
    const Status status = model().status;
    observer_->said(kStatusKinds.at(static_cast<std::size_t>(status.kind)), status.headline, status.details);
}

OperatorModel LiveSession::model() const {
    const std::lock_guard lock(mutex_);
    OperatorModel now = model_;
    view_.put_into(now);
    if (darks_answered_ == darks_) return now;
    now.status = dark_status(state_);  // DARK was pressed, and the thread is still at something else
    now.scene.light = nullptr;
    now.confirm = now.check_skin = false;
    return now;
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

/// Waits for one, `longest` at most; 0: not at all.
LiveSession::Press LiveSession::next_press(Instant longest) {
    std::unique_lock lock(mutex_);
    if (longest > Instant{}) wake_.wait_for(lock, longest, [&] { return ending_ || !presses_.empty(); });
    if (ending_) return {OperatorAction::quit, darks_};
    if (presses_.empty()) return {OperatorAction::none, darks_};
    const Press press = presses_.front();
    presses_.pop_front();
    return press;
}

/// A picture for the window while nothing else is made of it; what a camera lacks is said in its place.
void LiveSession::look(const Session& session, Room& room) {
    constexpr auto kPatience = std::chrono::milliseconds(250);
    try {
        const StereoFrame frame = CameraTap(room.cameras(), view_).newest(room.clock().now() - kPatience, kPatience);
        const auto found = [&](const GrayImage& picture) {
            std::vector<FoundMarker> shown;
            for (const auto& marker : find_markers(picture, session.tracking_settings().markers))
                shown.push_back({marker.pixel, marker.radius_px});
            return shown;
        };
        view_.found(frame.at, found(frame.left), found(frame.right));
    } catch (const DeviceError& fault) {
        view_.failed(std::string(fault.what()) + ". " + fault.remedy);
    }
}

/// The scan's even pictures with what was found in them, as long as the refusal stands.
void LiveSession::keep_refused_pictures(const Session& session) {
    if (session.capture() == nullptr || session.capture()->left.empty()) return;
    const ScanCapture& capture = *session.capture();
    SeenPicture left{std::make_shared<GrayImage>(capture.left.front()),
                     found_markers(session.tracker().seen_left(), true), true};
    SeenPicture right{std::make_shared<GrayImage>(capture.right.front()),
                      found_markers(session.tracker().seen_right(), true), true};
    change_model([&](OperatorModel& m) {
        m.left.refused = left;
        m.right.refused = right;
    });
}

void LiveSession::run(const MakeRoom& make_room) {
    const std::unique_ptr<Room> room = make_room([this](const std::string& doing, std::optional<double> share) {
        show_alive();
        change_model([&](OperatorModel& m) {
            if (state_ == SessionState::opening) m.status.headline = doing, m.status.share = share;
        });
    });
    LightTap tap(room->projector(), *this);
    CameraTap cameras(room->cameras(), view_);
    view_.set_old_after(std::max<Instant>(kOldAfter, 3 * room->look_interval()));
    SessionSettings session_settings = settings_for(room->markers());
    session_settings.observer = observer_;
    if (observer_)
        observer_->room_entered(
            {room->name(), room->simulated(), room->markers(), room->rig(), room->notes(), room->clock().now()});
    session_settings.while_computing = [&room] { room->computing(); };
    Session session(case_, drawing_, room->rig(), tap, cameras, room->clock(), session_settings);
    const std::vector<std::string> notes = room->notes();
    happened(SessionHappening::room_made, [&](OperatorModel& m) {
        m.status.details.insert(m.status.details.end(), notes.begin(), notes.end());
        m.simulated = room->simulated();
        m.case_subtitle = room->name() + " \u00b7 " + m.case_subtitle;
    });
    offer_to_resume();
    for (;;) {
        const Press press = next_press(following_ ? Instant{} : room->look_interval());
        show_alive();
        if (press.action == OperatorAction::quit) return;
        if (press.action == OperatorAction::none && !following_) {
            look(session, *room);
            continue;
        }
        try {
            act(press, session, *room);
        } catch (const DeviceError& lost) {
            // What is lost comes back by itself: the patient is still where the scan and the match say.
            projecting_ = false;
            session.go_dark();
            view_.failed(lost.what());
            happened(following_ ? SessionHappening::skin_checked : SessionHappening::failed);
            set_status(StatusKind::dark, std::string("Dark: ") + lost.what() + ".",
                       {lost.remedy, following_ ? "The light comes back by itself." : "Press the button again."});
            if (following_) std::this_thread::sleep_for(kLostPause);
        } catch (const Error& refusal) {
            const bool scanning = press.action == OperatorAction::scan;
            following_ = projecting_ = false;
            session.go_dark();
            happened(SessionHappening::failed);
            if (press.darks != darks_now()) continue;  // it was ended by DARK, and that has been said
            if (scanning) keep_refused_pictures(session);
            set_status(StatusKind::refused, std::string(refusal.what()) + ".", {refusal.remedy});
        }
    }
}

std::uint64_t LiveSession::darks_now() const {
    const std::lock_guard lock(mutex_);
    return darks_;
}

/// A press is given up when what it led to has ended before its turn came: the light was stopped, say.
bool LiveSession::still_wanted(const Press& press) const {
    const std::lock_guard lock(mutex_);
    switch (press.action) {
        case OperatorAction::scan:
            return state_ == SessionState::scanning;
        case OperatorAction::do_register:
        case OperatorAction::use_landmarks:
            return state_ == SessionState::matching;
        case OperatorAction::check_skin:
            return state_ == SessionState::checking_skin;
        case OperatorAction::track:
            return state_ == SessionState::following;
        case OperatorAction::confirm:
            return state_ == SessionState::found || state_ == SessionState::verifying ||
                   state_ == SessionState::looking_again;
        default:
            return true;
    }
}

void LiveSession::act(const Press& press, Session& session, Room& room) {
    if (!still_wanted(press)) return;
    switch (press.action) {
        case OperatorAction::scan:
            offer_.reset();
            away_.reset();
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
            if (look_first_) room.let_patient_move(false);  // was asked to lie still
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
                m.scene.light = nullptr;
                if (darks_ == press.darks && !view_of(state_).lights) m.status = dark_status(state_);
            });
            return;
        case OperatorAction::none:
        case OperatorAction::quit:
            break;
    }
    if (following_) follow(session, room);
}

}  // namespace planlight
