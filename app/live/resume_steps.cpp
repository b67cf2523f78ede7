// What a live session does to go on with the match of an earlier one, or with its own after its projector was away.
#include <fmt/format.h>

#include "app/case_model.h"
#include "app/console.h"
#include "app/live/live_session.h"
#include "app/live/scene_of_session.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// "2026-03-14T09:30:00Z" -> "09:30".
std::string time_of_day(const std::string& utc) {
    return utc.size() >= 16 ? utc.substr(11, 5) : "earlier";
}

}  // namespace

void LiveSession::offer_to_resume() {
    if (!offer_) return;
    if (offer_->at_once) {
        post(OperatorAction::confirm);
        return;
    }
    change_model([&](OperatorModel& m) {
        m.confirm = true;
        m.confirm_words = "Go on: match of " + time_of_day(offer_->match.made_utc);
        m.status.details.push_back(
            fmt::format("Or go on with the match of {} UTC: a short scan looks whether markers, rig and skin are as "
                        "they were; nothing else is lit before.",
                        time_of_day(offer_->match.made_utc)));
    });
}

/// Light only when markers, rig and skin agree with the match; what does not is said by whoever catches it.
void LiveSession::resume(Session& session) {
    const KeptMatch match = offer_->match;
    change_model([&](OperatorModel& m) {  // stays so where it is refused
        m.confirm = true;
        m.confirm_words = "Try again: match of " + time_of_day(match.made_utc);
        m.check_skin = false;
        m.track = {false, "try again, or scan"};
    });
    set_steps(3);
    set_status(StatusKind::scanning, "Looking whether all is as it was: keep the patient still.");
    const ResumeCheck check = session.resume(match, [&](int done, int of) {
        if (!light_permitted()) throw CheckFailedError("The short scan was ended by DARK", "Press the button again.");
        set_status(StatusKind::scanning, fmt::format("Looking whether all is as it was: picture {} of {}.", done, of),
                   {"Keep the patient still."});
    });
    const RegistrationResult& found = *session.registration();
    OperatorModel shown = model();
    show_match(case_, found, nullptr, shown);
    shown.scene.markers = markers_in_ct(session.tracker(), found.patient_from_ct.inverse());
    shown.scene.plan = std::make_shared<PlanDrawing>(session.drawing());
    shown.scene.light = nullptr;
    shown.confirm = found.verdict == Verdict::ask && !match.confirmed;
    shown.confirm_words = "It fits: use it";
    shown.check_skin = false;
    shown.stop = {false, "nothing runs"};
    shown.track = {!shown.confirm, shown.confirm ? "look at the fit first" : ""};
    shown.evidence.insert(
        shown.evidence.begin(),
        fmt::format("The match of {} UTC is used again: {} markers within {:.2f} mm, the plan's skin within {:.1f} mm "
                    "of where they put it.",
                    time_of_day(match.made_utc), check.markers, check.marker_off_mm, check.skin_off_mm));
    change_model([&](OperatorModel& m) { m = std::move(shown); });
    gate_.new_match();
    landmark_ = -1;
    offer_.reset();
    set_steps(4);
    set_status(StatusKind::ready, "Markers, rig and skin agree with the match.",
               {"Press Track, and look at the light on two landmarks before you use it."});
}

void LiveSession::look_before_light() {
    look_first_ = true;
}

/// After the projector was away: it, or the patient, may have been moved meanwhile.
void LiveSession::look_again(Session& session) {
    if (!look_first_.exchange(false)) return;
    auto match = session.kept_match();
    if (!match) return;
    match->made_utc = today();
    offer_ = ResumeOffer{std::move(*match), {}, false};
    resume(session);
}

}  // namespace planlight
