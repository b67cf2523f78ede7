// What a live session does when a button is pressed: scan, find the patient, confirm, check the skin.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/case_model.h"
#include "app/live/clickable_scan.h"
#include "app/live/live_session.h"
#include "app/live/scene_of_session.h"
#include "app/report/registration_certificate.h"
#include "app/verify_landmarks.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr int kLandmarksToVerify = 2;

}  // namespace

void LiveSession::scan(Session& session) {
    {
        const std::lock_guard lock(mutex_);
        landmarks_.clear();  // they were clicked on the last scan
    }
    said();
    const ScanResult& scan = session.scan([&](int done, int of) {
        if (!light_permitted()) throw CheckFailedError("The scan was ended by DARK", "Press Scan to begin again.");
        set_progress(fmt::format("Scanning: keep the patient still. Picture {} of {}.", done, of),
                     static_cast<double>(done) / std::max(1, of));
    });
    const auto clickable = clickable_scan(scan.clean.kept, &session.rig().left_camera);
    happened(SessionHappening::scan_done, [&](OperatorModel& m) {
        if (clickable) m.landmarks = LandmarkViews{&drawing_.skin, clickable};
        m.status.headline = fmt::format("{} points of skin are scanned.", scan.clean.kept.size());
    });
}

/// Of what is being done, while it is not overtaken by DARK.
void LiveSession::set_progress(const std::string& headline, double share) {
    change_model([&](OperatorModel& m) {
        if (permitted_ != darks_ || !view_of(state_).lights) return;
        m.status.headline = headline;
        m.status.share = share;
    });
}

std::vector<PointPair> LiveSession::newest_landmarks() const {
    const std::lock_guard lock(mutex_);
    return landmarks_;
}

void LiveSession::find_patient(Session& session, const std::vector<PointPair>& landmarks) {
    following_ = projecting_ = false;
    session.go_dark();
    said();
    session.light_item(std::nullopt);  // of the former match
    const RegistrationResult& found = session.find_patient(landmarks);
    gate_.new_match();
    landmark_ = -1;
    OperatorModel shown = blank_;
    show_match(case_, found, std::make_shared<PointCloud>(session.scanned()->clean.kept), shown);
    if (found.verdict != Verdict::no) {
        shown.scene.markers = markers_in_ct(session.tracker(), shown.scene.ct_from_rig, drawing_.skin);
        shown.scene.plan = std::make_shared<PlanDrawing>(session.drawing());
        name_rows(session.drawing(), shown.rows);  // the match decides which labels have room
        for (const DrawnItem& item : session.drawing().items)
            shown.evidence.insert(shown.evidence.end(), item.warnings.begin(), item.warnings.end());
        const auto unlit = evidence_of_labels(session.drawing());  // first: nothing on the skin says so
        shown.evidence.insert(shown.evidence.begin(), unlit.begin(), unlit.end());
    }
    shown.evidence.push_back(keep(found, session.scanned()->clean.kept, landmarks));
    shown.evidence.insert(shown.evidence.end(), blank_.evidence.begin(), blank_.evidence.end());
    const auto happening = found.verdict == Verdict::yes   ? SessionHappening::match_found
                           : found.verdict == Verdict::ask ? SessionHappening::match_unsure
                                                           : SessionHappening::match_refused;
    happened(happening, [&](OperatorModel& m) {
        m.scene = shown.scene;
        m.rows = shown.rows;
        m.fit = shown.fit;
        m.evidence = shown.evidence;
        m.item_of_moment = std::nullopt;
        m.projector_view = projector_view(session.rig(), shown.scene.ct_from_rig);
        if (found.verdict == Verdict::no) show_refused_scan(session, m);
        if (state_ != SessionState::found)
            m.status.details.insert(m.status.details.end(), found.reasons.begin(), found.reasons.end());
    });
}

/// Keeps the match and its scan; what became of it, in a sentence. A full disk does not end a session.
std::string LiveSession::keep(const RegistrationResult& found, const PointCloud& cloud,
                              const std::vector<PointPair>& landmarks) {
    std::string kept = "This match is not kept.";
    NotKept not_kept;
    try {
        if (!keep_matches_in_.empty())
            kept = "Kept in " + keep_match(found, &cloud, landmarks, keep_matches_in_).string() + ".";
    } catch (const std::exception& fault) {
        kept = std::string("This match could not be kept: ") + fault.what() + ".";
        not_kept = {short_words_of_not_kept(fault), kept};
    }
    const std::lock_guard lock(mutex_);
    not_kept_ = not_kept;
    return kept;
}

void LiveSession::confirm(Session& session) {
    if (following_) {
        confirm_light(session);
        return;
    }
    if (session.registration() == nullptr || session.registration()->verdict != Verdict::ask) return;
    session.confirm();
    change_model([&](OperatorModel& m) {
        enter(state_, blank_, m, scan_there_);
        m.evidence.insert(m.evidence.begin(), "Confirmed by the operator, who looked at the fit.");
        m.status = {StatusKind::ready,
                    "The match is used on your word.",
                    {"Press Track, and look at the light on two landmarks before you use it."}};
    });
    said();
}

/// One press lights the first landmark, each further one says that the light on it is right; after the last the plan is
/// lit again, and verified.
void LiveSession::confirm_light(Session& session) {
    std::optional<LookAt> look_at;
    landmarks_to_look_at_ = static_cast<int>(session.landmarks().size());
    landmark_lit_from_.reset();
    cannot_verify_.clear();
    if (landmarks_to_look_at_ < kLandmarksToVerify) {
        cannot_verify_ =
            std::string(landmarks_to_look_at_ == 0 ? "None" : "Only one") +
            " of the two places to look at can be lit and seen by both cameras, so the light cannot be verified. "
            "Uncover more of the head or turn it, and scan again.";
        happened(SessionHappening::landmarks_seen);
    } else if (++landmark_ < landmarks_to_look_at_) {
        session.light_landmark(static_cast<std::size_t>(landmark_));
        gate_.other_light(seen_at_);
        const Eigen::Vector3d& place = session.landmarks()[static_cast<std::size_t>(landmark_)];
        landmark_place_ = words_of_place(drawing_.skin, place);
        look_at = LookAt{place, free_view_of(drawing_.skin, place)};
    } else {
        end_verification(session);
        gate_.verify(seen_at_);
        gate_.other_light(seen_at_);
        happened(SessionHappening::landmarks_seen);
    }
    change_model([&](OperatorModel& m) {
        if (permitted_ != darks_) return;  // DARK was pressed meanwhile, and stands there already
        m.confirm = false;                 // until the light of this is there to be looked at
        m.scene.plan = std::make_shared<PlanDrawing>(session.lit_drawing());
        if (landmark_ >= 0) {
            m.look_at = look_at;
            m.scene.bright_item = landmark_;
        }
    });
}

void LiveSession::end_verification(Session& session) {
    landmark_ = -1;
    cannot_verify_.clear();
    session.light_landmark(std::nullopt);
    change_model([&](OperatorModel& m) {
        show_lit_items(session, m);
        m.look_at = std::nullopt;
    });
}

/// Which items are bright, and which are hidden. What is lit for a person to look at goes on; the plan behind it
/// changes, and its light is not trusted before it is measured.
void LiveSession::light_items(const Press& press, Session& session) {
    if (press.action == OperatorAction::light_item) session.light_item(press.item);
    if (press.action == OperatorAction::show_item) session.show_item(press.item);
    if (press.action == OperatorAction::hide_item && press.item) session.hide_item(*press.item);
    if (following_) gate_.other_light(seen_at_);
    change_model([&](OperatorModel& m) { show_lit_items(session, m); });
}

/// In the table and in the 3-D view, where that does not show a landmark.
void LiveSession::show_lit_items(const Session& session, OperatorModel& m) const {
    m.item_of_moment = session.item_of_moment();
    for (std::size_t i = 0; i < m.rows.size(); ++i) m.rows[i].hidden = session.hidden_items().contains(i);
    if (landmark_ >= 0) return;
    m.scene.plan = std::make_shared<PlanDrawing>(session.lit_drawing());
    m.scene.bright_item = m.item_of_moment ? static_cast<int>(*m.item_of_moment) : -1;
}

/// A match on a scan from before the markers moved on the patient would lie as far off as the one there is, and be new.
void LiveSession::give_up_scan() {
    change_model([&](OperatorModel& m) {
        scan_there_ = false;
        m.do_register = {false, "scan first"};
    });
}

/// The short scan, and what it means for the light.
void LiveSession::check_skin(Session& session, AskedBy by) {
    landmark_lit_from_.reset();  // stripes take its place
    checks_.began(seen_at_);
    SkinCheck check;
    try {
        check = session.check_skin([&](int done, int of) {
            if (!light_permitted()) throw CheckFailedError("The check was ended by DARK", "Press Track to go on.");
            set_progress(view_of(SessionState::checking_skin).headline, static_cast<double>(done) / std::max(1, of));
        });
    } catch (const CheckFailedError& none) {
        if (by == AskedBy::person || !light_permitted()) throw;
        check.why_not = none.what();  // the light goes on: nobody has asked
    }
    gate_.other_light(seen_at_);  // the plan's is lit anew
    std::string words = "The skin was not checked: " + check.why_not + "; check it again.";
    if (check.elsewhere) {
        gate_.skin_checked(std::numeric_limits<double>::infinity());
        words = "Skin checked: it does not lie where the markers put it.";
    } else if (check.known) {
        gate_.skin_checked(check.off_mm);
        words = fmt::format("Skin checked: the plan's points lie within {:.1f} mm of where the markers put them.",
                            check.off_mm);
    }
    if (check.elsewhere || (check.known && check.off_mm > LightGateSettings{}.warn_mm)) give_up_scan();
    happened(SessionHappening::skin_checked);
    change_model([&](OperatorModel& m) { say_of_skin(words, m); });
}

/// First of the evidence, in place of what the check before left there.
void LiveSession::say_of_skin(const std::string& words, OperatorModel& m) {
    if (!m.evidence.empty() && m.evidence.front() == skin_words_) m.evidence.erase(m.evidence.begin());
    m.evidence.insert(m.evidence.begin(), words);
    skin_words_ = words;
}

}  // namespace planlight
