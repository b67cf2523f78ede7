// The thread of a live session: it makes the room, looks at what was pressed, and at the cameras in between.
#include <algorithm>

#include "app/live/live_session.h"
#include "app/live/scene_of_session.h"
#include "planning_io/types/error.h"
#include "registration/tracking/find_markers.h"

namespace planlight {
namespace {

constexpr auto kLostPause = std::chrono::milliseconds(100);
constexpr auto kOldAfter = std::chrono::milliseconds(1500);  // a picture is not called live any more

bool asks_for_light(OperatorAction action) {
    return action == OperatorAction::scan || action == OperatorAction::check_skin || action == OperatorAction::track ||
           action == OperatorAction::confirm;
}

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
        const Instant lit = projector_.show(picture, valid_until);
        if (!session_.light_permitted()) go_dark();  // DARK was pressed while it was handed over
        return lit;
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

/// A picture for the window while nothing else is made of it; what a camera lacks is said in its place.
void LiveSession::look(Session& session, Room& room) {
    constexpr auto kPatience = std::chrono::milliseconds(250);
    view_.expect_found(true);
    try {
        const StereoFrame frame = CameraTap(room.cameras(), view_).newest(room.clock().now() - kPatience, kPatience);
        const auto found = [&](const GrayImage& picture) {
            std::vector<FoundMarker> shown;
            for (const auto& marker : find_markers(picture, session.tracking_settings().markers))
                shown.push_back({marker.pixel, marker.radius_px, FoundMarker::Pairing::not_asked});
            return shown;
        };
        view_.found(frame.at, found(frame.left), found(frame.right));
        say_whether_light_stays(session.light_stays(frame));
    } catch (const DeviceError& fault) {
        view_.failed(std::string(fault.what()) + ". " + fault.remedy);
    }
}

/// Made while the window says what is being made.
std::unique_ptr<Room> LiveSession::make(const MakeRoom& make_room) {
    std::unique_ptr<Room> room = make_room([this](const std::string& doing, std::optional<double> share) {
        show_alive();
        change_model([&](OperatorModel& m) {
            if (state_ == SessionState::opening) m.status.headline = doing, m.status.share = share;
        });
    });
    view_.set_old_after(std::max<Instant>(kOldAfter, 3 * room->look_interval()));
    if (observer_)
        observer_->room_entered(
            {room->name(), room->kind(), room->markers(), room->rig(), room->notes(), room->clock().now()});
    return room;
}

void LiveSession::enter_room(const Room& room) {
    const std::vector<std::string> notes = room.notes();
    happened(SessionHappening::room_made, [&](OperatorModel& m) {
        m.status.details.insert(m.status.details.end(), notes.begin(), notes.end());
        m.room_kind = room.kind();
        m.case_subtitle += " \u00b7 " + room.name();  // the case's code comes first: it stays where there is no room
    });
}

void LiveSession::run(const MakeRoom& make_room) {
    const std::unique_ptr<Room> room = make(make_room);
    LightTap tap(room->projector(), *this);
    CameraTap cameras(room->cameras(), view_);
    SessionSettings session_settings = settings_for(room->markers());
    session_settings.observer = observer_;
    session_settings.while_computing = [&room] { room->computing(); };
    Session session(case_, drawing_, room->rig(), tap, cameras, room->clock(), session_settings);
    enter_room(*room);
    offer_to_resume();
    for (;;) {
        const Press press = next_press(following_ ? Instant{} : room->look_interval());
        show_alive();
        if (press.action == OperatorAction::quit) return;
        if (press.action == OperatorAction::none && !following_) {
            room->resting(room->look_interval());
            look(session, *room);
            continue;
        }
        try {
            act(press, session, *room);
        } catch (const DeviceError& lost) {
            device_lost(press, session, lost);
        } catch (const Error& refusal) {
            refused(press, session, refusal);
        }
    }
}

/// What is lost comes back by itself: the patient is still where the scan and the match say.
void LiveSession::device_lost(const Press& press, Session& session, const DeviceError& lost) {
    projecting_ = false;
    session.go_dark();
    view_.failed(lost.what());
    landmark_lit_from_.reset();
    checks_.restart();
    if (following_) gate_.other_light(seen_at_);  // what was measured was before
    happened(following_ ? SessionHappening::skin_checked : SessionHappening::failed, [&](OperatorModel& m) {
        const auto of_check = [](const Press& p) { return p.action == OperatorAction::check_skin; };
        // The light comes back, and must not look as if it was checked: one that still waits is given up, too.
        if (of_check(press) || std::ranges::any_of(presses_, of_check))
            say_of_skin(std::string("The skin was not checked: ") + lost.what() + "; check it again.", m);
        m.status = {StatusKind::dark,
                    std::string("Dark: ") + lost.what() + ".",
                    {lost.remedy, following_ ? "The light comes back by itself." : "Press the button again."}};
        show_no_light(m);
    });
    if (following_) std::this_thread::sleep_for(kLostPause);
}

void LiveSession::refused(const Press& press, Session& session, const Error& refusal) {
    following_ = projecting_ = false;
    session.go_dark();
    if (landmark_ >= 0) end_verification(session);
    if (press.darks != darks_now()) return;  // it was ended by DARK: that has been said, and led on
    happened(SessionHappening::failed, [&](OperatorModel& m) {
        if (press.action == OperatorAction::scan) show_refused_scan(session, m);
        m.status = {StatusKind::refused, std::string(refusal.what()) + ".", {refusal.remedy}};
    });
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
        case OperatorAction::track:  // and the skin is to be checked right after
            return state_ == SessionState::following || state_ == SessionState::checking_skin;
        case OperatorAction::confirm:
            return (state_ == SessionState::found && press.from == SessionState::unsure) ||
                   state_ == SessionState::verifying || state_ == SessionState::looking_again;
        case OperatorAction::light_item:
        case OperatorAction::hide_item:
        case OperatorAction::show_item:
            return view_of(state_).has_match;
        default:
            return true;
    }
}

/// The words of what begins now; since it was pressed what ran before it may have said something else.
void LiveSession::begin(const Press& press) {
    if (press.action == OperatorAction::none || press.action == OperatorAction::confirm || is_of_items(press.action))
        return;
    change_model([&](OperatorModel& m) {
        if (press.darks == darks_) enter(state_, blank_, m, scan_there_);
    });
}

void LiveSession::act(const Press& press, Session& session, Room& room) {
    if (!still_wanted(press)) return;
    begin(press);
    // A scan's pictures are stripes, in which nobody looks for markers.
    view_.expect_found(press.action != OperatorAction::scan && press.action != OperatorAction::check_skin);
    if (asks_for_light(press.action)) {
        permit_light(press);
        say_whether_light_stays(false);  // what is seen from now on is asked for
    }
    switch (press.action) {
        case OperatorAction::scan:
            begin_anew(session, room);
            return;
        case OperatorAction::do_register:
        case OperatorAction::use_landmarks:
            if (scan_holds()) {
                find_patient(session, newest_landmarks());
            } else {
                following_ = projecting_ = false;
                session.go_dark();
            }
            return;
        case OperatorAction::check_skin:
            room.let_patient_move(false);  // was asked to lie still
            check_skin(session, press.by);
            room.let_patient_move(following_);
            break;
        case OperatorAction::track:
            begin_to_follow(session, room);
            break;
        case OperatorAction::confirm:
            if (offer_)
                resume(session);
            else
                confirm(session);
            return;
        case OperatorAction::light_item:
        case OperatorAction::hide_item:
        case OperatorAction::show_item:
            light_items(press, session);
            break;
        case OperatorAction::dark:
        case OperatorAction::stop:
            answer_dark(press, session);
            return;
        case OperatorAction::none:
        case OperatorAction::quit:
            break;
    }
    if (following_) follow(session, room);
}

/// False, and said, where a check of the skin ended after Register was pressed, and found that the scan is true no
/// more.
bool LiveSession::scan_holds() {
    {
        const std::lock_guard lock(mutex_);
        if (scan_there_) return true;
    }
    happened(SessionHappening::match_refused, [](OperatorModel& m) {
        m.status = {StatusKind::refused,
                    "The skin does not lie where the markers put it.",
                    {"The markers have moved on the patient, or the patient under them: fix them, and scan again."}};
    });
    return false;
}

void LiveSession::begin_anew(Session& session, Room& room) {
    offer_.reset();
    away_.reset();
    looked_ = looks_asked_;
    following_ = projecting_ = false;
    room.let_patient_move(false);
    scan(session);
}

void LiveSession::begin_to_follow(Session& session, Room& room) {
    if (look_first()) room.let_patient_move(false);  // was asked to lie still
    look_again(session);
    checks_.restart();
    gate_.restart();
    end_verification(session);
    following_ = true;
    room.let_patient_move(true);
}

void LiveSession::answer_dark(const Press& press, Session& session) {
    following_ = projecting_ = false;
    session.go_dark();
    if (landmark_ >= 0) end_verification(session);
    const auto forbidden = gate_.stopped();  // found while DARK waited: what is wrong is still said
    change_model([&](OperatorModel& m) {
        darks_answered_ = press.darks;
        m.scene.light = nullptr;
        if (view_of(state_).lights) return;
        m.status = dark_status(state_, scan_there_);
        if (!forbidden) return;
        m.status = {StatusKind::refused, forbidden->headline, forbidden->details};
        m.next = OperatorAction::scan;
    });
    said();
}

}  // namespace planlight
