#include "app/live/session_states.h"

namespace planlight {
namespace {

using S = SessionState;
using A = OperatorAction;
using H = SessionHappening;

constexpr const char* kOpening = "the room is being made";
constexpr const char* kScanning = "wait for the scan";
constexpr const char* kMatching = "wait for the match";
constexpr const char* kChecking = "wait for the check";
constexpr const char* kNothing = "no light is on";

// In the order of SessionState.
constexpr SessionView kViews[] = {
    {"Opening", StatusKind::waiting, "The room is being made ready.", "The projector is dark.",  //
     kOpening, kOpening, kOpening, kOpening, A::none, false, false, 1, StepState::active, false, false, false},
    {"Ready", StatusKind::ready, "Ready to scan.", "The projector is dark. Press Scan.",  //
     nullptr, "scan first", "register first", kNothing, A::scan, false, false, 2, StepState::active, false, false,
     false},
    {"Scanning", StatusKind::scanning, "Scanning: keep the patient still.", "Stop and DARK end it.",  //
     "is running", kScanning, "register first", nullptr, A::none, false, false, 2, StepState::active, false, false,
     true},
    {"Scanned", StatusKind::ready, "The skin is scanned.", "Press Register to find the patient in the scan.",  //
     nullptr, nullptr, "register first", kNothing, A::do_register, false, false, 3, StepState::active, true, false,
     false},
    {"Matching", StatusKind::matching, "Finding the patient.", "The projector is dark.",  //
     kMatching, "is running", kMatching, kNothing, A::none, false, false, 3, StepState::active, true, false, false},
    {"Not found", StatusKind::refused, "The patient was not found.",
     "Press Scan to scan again, or click landmarks and use them.",  //
     nullptr, nullptr, "no match", kNothing, A::scan, false, false, 3, StepState::attention, true, false, false},
    {"Unsure", StatusKind::check, "Not sure: look whether the scan fits the skin.",
     "If it fits, say so. If it does not, press Scan.",  //
     nullptr, nullptr, "look at the fit first", kNothing, A::none, true, false, 3, StepState::attention, true, true,
     false},
    {"Found", StatusKind::ready, "The patient is found.", "Look at the scan on the skin, then press Track.",  //
     nullptr, nullptr, nullptr, kNothing, A::track, false, false, 4, StepState::active, true, true, false},
    {"Following", StatusKind::check, "The light is being made.", "It is judged before it may be trusted.",  //
     nullptr, nullptr, "is running", nullptr, A::none, true, true, 4, StepState::attention, true, true, true},
    {"Verifying", StatusKind::check, "A ring of light falls on a landmark.",
     "If it lies elsewhere on the patient, press Stop, and scan again.",  //
     nullptr, nullptr, "is running", nullptr, A::none, true, true, 4, StepState::attention, true, true, true},
    {"Checking the skin", StatusKind::scanning, "Checking the skin: keep the patient still.", "Stop and DARK end it.",
     kChecking, kChecking, "is running", nullptr, A::none, false, false, 4, StepState::attention, true, true, true},
    {"Offered", StatusKind::ready, "Ready to scan, or to go on with the last match.",
     "A short scan looks first whether markers, rig and skin are as they were; else press Scan.",  //
     nullptr, "scan first", "go on, or scan", kNothing, A::none, true, false, 2, StepState::active, false, false,
     false},
    {"Looking again", StatusKind::scanning, "Looking whether all is as it was: keep the patient still.",
     "Stop and DARK end it.",  //
     kChecking, kChecking, kChecking, nullptr, A::none, false, false, 3, StepState::active, false, false, true},
};
static_assert(std::size(kViews) == kSessionStates.size());

const char* label_of(A press) {
    switch (press) {
        case A::scan:
            return "Scan";
        case A::do_register:
            return "Register";
        case A::use_landmarks:
            return "Use landmarks";
        case A::track:
            return "Track";
        case A::stop:
            return "Stop";
        case A::confirm:
            return "Yes";
        case A::check_skin:
            return "Check skin";
        case A::light_item:
            return "Only this";
        case A::hide_item:
            return "Hide";
        case A::show_item:
            return "Show";
        default:
            return "";
    }
}

/// Why Register is not enabled; null: it is.
const char* no_register(const SessionView& view, bool scan_there) {
    return view.no_register == nullptr && !scan_there ? "scan first" : view.no_register;
}

const char* obstacle(S state, A press, bool scan_there) {
    const SessionView& view = view_of(state);
    switch (press) {
        case A::scan:
            return view.no_scan;
        case A::do_register:
        case A::use_landmarks:
            return no_register(view, scan_there);
        case A::track:
            return view.no_track;
        case A::stop:
            return view.no_stop;
        case A::confirm:
            return view.confirm ? nullptr : "there is nothing to say yes to";
        case A::check_skin:
            return view.check_skin ? nullptr : "the light does not follow the patient";
        case A::light_item:
        case A::hide_item:
        case A::show_item:
            return view.has_match ? nullptr : "no match";
        default:
            return nullptr;
    }
}

/// The light goes out, and what was being made of it is given up.
S after_dark(S state) {
    if (state == S::scanning) return S::ready;
    if (state == S::looking_again) return S::offered;
    return state == S::following || state == S::verifying || state == S::checking_skin ? S::found : state;
}

}  // namespace

const SessionView& view_of(SessionState state) {
    return kViews[static_cast<std::size_t>(state)];
}

std::optional<SessionState> after_press(SessionState state, OperatorAction press, bool scan_there) {
    if (press == A::dark || press == A::stop) return after_dark(state);
    if (obstacle(state, press, scan_there) != nullptr) return std::nullopt;
    switch (press) {
        case A::scan:
            return S::scanning;
        case A::do_register:
        case A::use_landmarks:
            return S::matching;
        case A::track:
            return S::following;
        case A::confirm:
            return state == S::unsure ? S::found : state == S::offered ? S::looking_again : S::verifying;
        case A::check_skin:
            return S::checking_skin;
        default:
            return state;
    }
}

std::string why_not(SessionState state, OperatorAction press, bool scan_there) {
    const char* const reason = obstacle(state, press, scan_there);
    return reason == nullptr ? std::string{} : std::string(label_of(press)) + " is not possible now: " + reason + ".";
}

SessionState after(SessionState state, SessionHappening happening) {
    switch (happening) {
        case H::room_made:
            return state == S::opening ? S::ready : state;
        case H::scan_done:
            return state == S::scanning ? S::scanned : state;
        case H::match_found:
            return state == S::matching ? S::found : state;
        case H::match_unsure:
            return state == S::matching ? S::unsure : state;
        case H::match_refused:
            return state == S::matching ? S::not_found : state;
        case H::landmarks_seen:
            return state == S::verifying ? S::following : state;
        case H::skin_checked:
            return state == S::checking_skin ? S::following : state;
        case H::match_offered:
            return state == S::ready ? S::offered : state;
        case H::match_resumed:
            return state == S::looking_again ? S::found : state;
        case H::failed:
            return state == S::matching ? S::scanned : after_dark(state);
    }
    return state;
}

void show_no_light(OperatorModel& model) {
    if (model.confirm && model.next == OperatorAction::confirm) model.next = OperatorAction::none;
    model.confirm = false;
    model.figures = {};
    model.scene.light = nullptr;
    for (PlanRow& row : model.rows) row.light_off_mm.reset();
}

Status dark_status(SessionState state, bool scan_there) {
    const SessionView& view = view_of(state);
    const bool wants_scan = view.no_register == nullptr && !scan_there && !view.has_match;
    return {StatusKind::dark,
            "Dark: no light on the patient.",
            {wants_scan ? "Press Scan to begin again." : view.what_next},
            {}};
}

Status light_stays_status() {
    return {StatusKind::refused,
            "The light does not go out: cover the projector's lens.",
            {"The cameras see it on the skin, though it was put out.",
             "Its picture is frozen (Freeze on its remote control), or the video link hangs on an old one."},
            {}};
}

void enter(SessionState state, const OperatorModel& blank, OperatorModel& model, bool scan_there) {
    const SessionView& view = view_of(state);
    const auto button = [](const char* no) { return ButtonState{no == nullptr, no == nullptr ? "" : no}; };
    model.status = {view.kind, view.headline, {view.what_next}, {}};
    model.scan = button(view.no_scan);
    model.do_register = button(no_register(view, scan_there));
    model.track = button(view.no_track);
    model.stop = button(view.no_stop);
    model.next = view.next;
    model.confirm = view.confirm && !view.lights;  // of light it is asked when there is light to look at
    model.confirm_words = state == SessionState::offered ? "Go on with the last match" : "It fits: use it";
    model.check_skin = view.check_skin;
    model.may_light_item = view.has_match;
    model.light_on = view.lights;  // a scan's stripes, too
    for (int i = 0; i < static_cast<int>(model.steps.size()); ++i)
        model.steps[static_cast<std::size_t>(i)] = i < view.step    ? StepState::done
                                                   : i == view.step ? view.step_state
                                                                    : StepState::waiting;
    if (!view.lights || !view.has_match || view.kind == StatusKind::scanning) {  // dark, or stripes
        model.look_at = std::nullopt;
        model.figures = {};
        model.scene.light = nullptr;
        for (PlanRow& row : model.rows) row.light_off_mm = std::nullopt;
    }
    if (!view.has_match) {
        model.rows = blank.rows;
        model.evidence = blank.evidence;
        model.fit = std::nullopt;
        model.item_of_moment = std::nullopt;
        model.projector_view = std::nullopt;
        model.scene = blank.scene;
    }
    if (!view.has_scan || !scan_there) model.landmarks = std::nullopt;
    if (state == SessionState::scanning) model.left.refused = model.right.refused = std::nullopt;
}

}  // namespace planlight
