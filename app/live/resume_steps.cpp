// What a live session does to go on with the match of an earlier one, or with its own after its projector was away.
#include <fmt/format.h>

#include <algorithm>

#include "app/case_model.h"
#include "app/console.h"
#include "app/live/live_session.h"
#include "app/live/scene_of_session.h"
#include "app/local_time.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// Of a match, as the clock on the wall had it; with its day where that is not today.
std::string time_of_day(const std::string& utc) {
    const std::string here = short_local_time(utc, today());
    return here.empty() ? "the session before" : here;
}

}  // namespace

void LiveSession::offer_to_resume() {
    if (!offer_) return;
    happened(SessionHappening::match_offered, [&](OperatorModel& m) {
        m.status.headline =
            fmt::format("Ready to scan, or to go on with the match of {}.", time_of_day(offer_->match.made_utc));
    });
    if (offer_->at_once) post(OperatorAction::confirm, AskedBy::program, {}, 0);
}

/// Light only when markers, rig and skin agree with the match; what does not is said by whoever catches it.
ResumeCheck LiveSession::look_whether_it_holds(Session& session, const KeptMatch& match) {
    return session.resume(match, [&](int done, int of) {
        if (!light_permitted()) throw CheckFailedError("The short scan was ended by DARK", "Press the button again.");
        set_progress(view_of(SessionState::looking_again).headline, static_cast<double>(done) / std::max(1, of));
    });
}

void LiveSession::resume(Session& session) {
    KeptMatch match = offer_->match;
    match.lit = {};  // what was hidden and looked at then is not known to whoever stands here now
    following_ = projecting_ = false;
    said();
    const ResumeCheck check = look_whether_it_holds(session, match);
    gate_.new_match();
    landmark_ = -1;
    const RegistrationResult& found = *session.registration();
    OperatorModel shown = blank_;
    show_match(case_, found, nullptr, shown);
    shown.scene.markers = markers_in_ct(session.tracker(), found.patient_from_ct.inverse(), drawing_.skin);
    shown.scene.plan = std::make_shared<PlanDrawing>(session.drawing());
    name_rows(session.drawing(), shown.rows);
    shown.evidence.insert(
        shown.evidence.begin(),
        fmt::format("The match of {} is used again: {} markers within {:.2f} mm, the plan's skin within {:.1f} mm of "
                    "where they put it.",
                    time_of_day(match.made_utc), check.markers, check.marker_off_mm, check.skin_off_mm));
    const auto unlit = evidence_of_labels(session.drawing());
    shown.evidence.insert(shown.evidence.begin(), unlit.begin(), unlit.end());
    shown.evidence.insert(shown.evidence.end(), blank_.evidence.begin(), blank_.evidence.end());
    const bool taken = happened(SessionHappening::match_resumed, [&](OperatorModel& m) {
        m.scene = shown.scene;
        m.rows = shown.rows;
        m.fit = shown.fit;
        m.evidence = shown.evidence;
        m.item_of_moment = std::nullopt;
        m.projector_view = projector_view(session.rig(), found.patient_from_ct.inverse());
        m.status = {StatusKind::ready,
                    "Markers, rig and skin agree with the match.",
                    {"Press Track, and look at the light on two landmarks before you use it."},
                    {}};
    });
    if (taken) offer_.reset();  // else it stands as it stood: DARK was pressed while it was looked at
}

void LiveSession::look_before_light() {
    ++looks_asked_;
}

/// After the projector was away: it, or the patient, may have been moved meanwhile. What was not found so stays to be
/// looked at by the next press of Track.
void LiveSession::look_again(Session& session) {
    const unsigned asked = looks_asked_;  // one that is asked for meanwhile is another
    if (looked_ == asked) return;
    if (auto match = session.kept_match()) {
        match->made_utc = today();
        away_ = kept_match_of(text_of(*match), {});  // as its recording has it, so that a replay goes on with the same
    }
    if (!away_) return;
    away_->lit = session.lit_part();      // also of presses after a look that was refused
    change_model([&](OperatorModel& m) {  // the session gives up the scan
        scan_there_ = false;
        enter(state_, blank_, m, scan_there_);
    });
    look_whether_it_holds(session, *away_);
    gate_.new_match();  // a person looked at the light of the projector as it was then
    change_model([&](OperatorModel& m) { show_lit_items(session, m); });
    looked_ = asked;
    away_.reset();
}

}  // namespace planlight
