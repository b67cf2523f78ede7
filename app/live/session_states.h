#pragma once

#include <array>
#include <optional>
#include <string>

#include "app/windows/operator_model.h"

namespace planlight {

/// Where a live session stands.
enum class SessionState {
    opening,        ///< the room is being made
    ready,          ///< nothing is scanned
    scanning,       ///<
    scanned,        ///< there is a scan and no match
    matching,       ///<
    not_found,      ///< the match was refused
    unsure,         ///< the match needs a person's look
    found,          ///< the match may be used; dark
    following,      ///< light is asked for: on the patient, or dark until the pose is good
    verifying,      ///< one landmark alone is lit, for a person to look at
    checking_skin,  ///< a short scan while following
    offered,        ///< as ready, and there is a match of an earlier session to go on with
    looking_again,  ///< a short scan: are markers, rig and skin as that match has them?
};
inline constexpr std::array kSessionStates{
    SessionState::opening,      SessionState::ready,     SessionState::scanning,      SessionState::scanned,
    SessionState::matching,     SessionState::not_found, SessionState::unsure,        SessionState::found,
    SessionState::following,    SessionState::verifying, SessionState::checking_skin, SessionState::offered,
    SessionState::looking_again};

/// What becomes of what was begun.
enum class SessionHappening {
    room_made,
    scan_done,
    match_found,
    match_unsure,
    match_refused,
    landmarks_seen,  ///< all of them: the plan is lit again
    skin_checked,
    match_offered,
    match_resumed,
    failed,  ///< refused, ended by DARK, or the gate has stopped the light
};

/// What a state looks like, and which presses it takes. A button that is not enabled says why.
struct SessionView {
    const char* name;       ///< for the table of the guide: "Ready"
    StatusKind kind;        ///< where nothing else is to be said
    const char* headline;   ///< the same
    const char* what_next;  ///< one sentence; never of a button that is not enabled
    /// Why each button is not enabled; null: it is.
    const char *no_scan, *no_register, *no_track, *no_stop;
    OperatorAction next;  ///< the press that leads on
    bool confirm;         ///< a person is asked whether it is right; in light states only while the gate asks
    bool check_skin;
    int step;              ///< in the list of the session's steps
    StepState step_state;  ///< of that one
    bool has_scan, has_match;
    bool lights;  ///< light may come out of the projector
};
const SessionView& view_of(SessionState state);

/// Where a press leads; empty: it does nothing here, and `why_not` says why. DARK and Stop lead somewhere from
/// everywhere. `scan_there`: false where a match of an earlier session is gone on with, and nothing was scanned in this
/// one: then Register waits for a scan.
std::optional<SessionState> after_press(SessionState state, OperatorAction press, bool scan_there = true);
/// One sentence for a press that does nothing.
std::string why_not(SessionState state, OperatorAction press, bool scan_there = true);

/// Where that leads; a state in which it means nothing stays.
SessionState after(SessionState state, SessionHappening happening);

/// Puts a state into the model: words, buttons, steps; what is not true in it is taken out (scan, match, figures,
/// light), as it is in `blank`, the model of the case alone.
void enter(SessionState state, const OperatorModel& blank, OperatorModel& model, bool scan_there = true);

/// Nothing is left of what was lit: no figure of it, and no yes to it.
void show_no_light(OperatorModel& model);

/// What is said after DARK in that state; where its scan was given up, to scan.
Status dark_status(SessionState state, bool scan_there = true);

/// It was put out, and the cameras still see it (`Session::light_stays`).
Status light_stays_status();

}  // namespace planlight
