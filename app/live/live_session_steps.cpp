// What a live session does when a button is pressed: scan, find the patient, confirm, follow.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

#include "app/case_model.h"
#include "app/live/clickable_scan.h"
#include "app/live/following_status.h"
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

/// What is said while a landmark is lit, where nothing worse is to be said.
void LiveSession::show_verification(const Session::Update& update, LightGate::Ruling& ruling) {
    if (!update.overlay.lit) landmark_lit_from_.reset();
    if (landmark_ < 0 && !cannot_verify_.empty() && update.overlay.lit && !ruling.stop)
        ruling.details.insert(ruling.details.begin(), cannot_verify_);
    if (landmark_ < 0 || !update.overlay.lit || ruling.stop) return;
    if (!landmark_lit_from_) landmark_lit_from_ = update.overlay.lit_from;
    std::erase_if(ruling.details, [](const std::string& detail) {  // that has been done
        return detail.find("\"Show landmarks\"") != std::string::npos;
    });
    const std::string question =
        fmt::format("LOOK: is the ring of light on landmark {} of {}?", landmark_ + 1, landmarks_to_look_at_);
    if (ruling.found_wrong)
        ruling.details.insert(ruling.details.begin(), question);
    else
        ruling.headline = question;
    ruling.details.insert(
        ruling.details.begin() + (ruling.found_wrong ? 1 : 0),
        (landmark_place_.empty() ? "The picture of the head shows where it belongs."
                                 : "It belongs there: " + landmark_place_ + " (see the picture of the head).") +
            " If it lies elsewhere on the patient, press Stop, and scan again.");
}

/// A match on a scan from before the markers moved on the patient would lie as far off as the one there is, and be new.
void LiveSession::give_up_scan() {
    change_model([&](OperatorModel& m) {
        scan_there_ = false;
        m.do_register = {false, "scan first"};
    });
}

/// The short scan, and what it means for the light.
void LiveSession::check_skin(Session& session) {
    landmark_lit_from_.reset();  // stripes take its place
    checks_.began(seen_at_);
    const bool was_due = std::exchange(check_was_due_, false);
    SkinCheck check;
    try {
        check = session.check_skin([&](int done, int of) {
            if (!light_permitted()) throw CheckFailedError("The check was ended by DARK", "Press Track to go on.");
            set_progress(view_of(SessionState::checking_skin).headline, static_cast<double>(done) / std::max(1, of));
        });
    } catch (const CheckFailedError& none) {
        if (!was_due || !light_permitted()) throw;
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

/// Where it was wished for: announced, which is returned, and then as if it had been pressed.
std::string LiveSession::check_skin_when_due(const Session& session, Room& room, const Session::Update& update) {
    std::vector<Eigen::Vector3d> markers;
    if (update.pose.rig_from_patient)
        for (const auto& marker : session.tracker().markers())
            markers.push_back(*update.pose.rig_from_patient * marker.centre_in_patient);
    const bool lit = update.overlay.lit && gate_.verified() && landmark_ < 0;
    const SkinCheckSchedule::Turn turn = checks_.step(seen_at_, gate_.skin_known_at().value_or(seen_at_), lit, markers);
    room.let_patient_move(turn.notice.empty());  // asked to lie still
    if (turn.check) check_was_due_ = post(OperatorAction::check_skin, AskedBy::program, {}, permitted_).empty();
    return turn.notice;
}

void LiveSession::follow(Session& session, Room& room) {
    if (const auto forbidden = gate_.forbids(seen_at_)) {  // a check of the skin, or the match itself, says no
        stop_light(session, *forbidden);
        return;
    }
    const auto update = session.update();
    if (!light_permitted()) return;  // DARK was pressed meanwhile; its own turn comes next
    seen_at_ = update.frame.at;
    say_whether_light_stays(update.light_stays);
    LightGate::Ruling ruling =
        gate_.step(seen_at_, update.overlay.lit, update.light, update.causes, update.pose.external_reliability_mm);
    if (ruling.stop) {
        stop_light(session, ruling);
        return;
    }
    show_verification(update, ruling);
    const std::string notice = check_skin_when_due(session, room, update);
    play_fault(ruling, room);
    projecting_ = update.overlay.lit;
    show_update(session, room, update, ruling, notice);
}

void LiveSession::play_fault(const LightGate::Ruling& ruling, Room& room) {
    constexpr int kGoodBefore = 20;
    if (ruling.trust == LightTrust::aligned && ++good_updates_ == kGoodBefore) room.begin_fault();
}

void LiveSession::stop_light(Session& session, const LightGate::Ruling& ruling) {
    following_ = projecting_ = false;
    session.go_dark();
    if (landmark_ >= 0) end_verification(session);
    happened(SessionHappening::failed, [&](OperatorModel& m) {  // what was seen then stays to be looked at
        OperatorModel seen;
        view_.put_into(seen);
        m.left.refused = seen.left.live;
        m.right.refused = seen.right.live;
        m.steps[4] = StepState::attention;
        m.next = OperatorAction::scan;  // as is said; Track is there for who knows better
        m.status = {StatusKind::refused, ruling.headline, ruling.details};
    });
}

/// How many pictures reached the skin in the last two seconds of the room, a second; empty while there were too few to
/// say.
std::optional<double> LiveSession::lit_per_s(const Session::Update& update) {
    constexpr Instant kOver = std::chrono::seconds(2);
    if (!update.overlay.lit) {
        lit_at_.clear();
        return std::nullopt;
    }
    lit_at_.push_back(update.overlay.lit_from);
    while (lit_at_.back() - lit_at_.front() > kOver) lit_at_.pop_front();
    if (lit_at_.size() < 5) return std::nullopt;
    return static_cast<double>(lit_at_.size() - 1) / seconds(lit_at_.back() - lit_at_.front());
}

/// Under the lock of the model: every update is counted, and said now and then as the last of the evidence.
void LiveSession::note_latency(const Session::Update& update, OperatorModel& m) {
    constexpr std::size_t kEvery = 25;
    const std::string before = latency_words_;
    latency_.add(update);
    if (latency_.updates % kEvery != 0) return;
    latency_words_ = latency_.sentence();
    if (latency_words_.empty()) return;
    if (!before.empty() && !m.evidence.empty() && m.evidence.back() == before)
        m.evidence.back() = latency_words_;
    else
        m.evidence.push_back(latency_words_);
}

/// A landmark that has only just been lit cannot have been looked at: a press that bounces says nothing.
bool LiveSession::looked_at(Instant now) const {
    constexpr Instant kLeast = std::chrono::milliseconds(500);
    return landmark_ < 0 || (landmark_lit_from_ && now - *landmark_lit_from_ >= kLeast);
}

/// Beside each item how far its light was seen off; nothing while the plan is not lit.
void LiveSession::show_measured(const Session::Update& update, OperatorModel& m) const {
    const bool plan_lit = update.overlay.lit && landmark_ < 0;
    for (std::size_t i = 0; i < m.rows.size(); ++i) {
        if (!plan_lit) m.rows[i].light_off_mm.reset();
        if (!plan_lit || !update.light || i >= update.light->items.size()) continue;
        m.rows[i].light_off_mm = item_off_mm(*update.light, i);
    }
}

void LiveSession::show_update(const Session& session, const Room& room, const Session::Update& update,
                              const LightGate::Ruling& ruling, const std::string& notice) {
    const auto light = room.true_light(session.lit_drawing(), update.overlay);
    Figures figures;
    figures.updates_per_s = lit_per_s(update);
    figures.delay_to_light_ms = 1000 * seconds(update.overlay.lit_from + session.found_delay() - update.pose.at);
    if (update.pose.rig_from_patient) {
        const Eigen::Vector3d middle = session.tracker().markers().front().centre_in_patient;
        figures.head_moved_mm = (*update.pose.rig_from_patient * middle - middle).norm();
        figures.head_turned_deg =
            angle_between(*update.pose.rig_from_patient, RigidTransform::Identity()) * 180 / std::numbers::pi;
    }
    if (!update.overlay.lit) figures.delay_to_light_ms.reset();
    // Not that of a landmark, nor beside the figure of something else.
    if (landmark_ < 0 && !ruling.of_other) figures.overlay_error_mm = ruling.off_mm;
    view_.found(update.frame.at, found_markers(session.tracker().seen_left()),
                found_markers(session.tracker().seen_right()));
    Status status = status_of(session, update, ruling, !drawing_.settings.card.empty() && landmark_ < 0);
    if (!notice.empty()) status.details.insert(status.details.begin(), notice);
    bool told = false;
    change_model([&](OperatorModel& m) {
        note_latency(update, m);
        // DARK or something else was pressed meanwhile, and stands there already.
        if (permitted_ != darks_ || (state_ != SessionState::following && state_ != SessionState::verifying)) return;
        told = true;
        m.status = status;
        m.steps[4] = gate_.verified() ? StepState::done : StepState::attention;
        m.steps[5] = gate_.verified() ? StepState::active : StepState::waiting;
        // A yes that waits for its turn is not asked for twice: the second would be of what has not been lit yet.
        const bool said_yes = std::any_of(presses_.begin(), presses_.end(),
                                          [](const Press& press) { return press.action == OperatorAction::confirm; });
        m.confirm = update.overlay.lit && ruling.ask_to_verify && !said_yes && looked_at(update.frame.at);
        m.next = m.confirm ? OperatorAction::confirm : OperatorAction::none;
        m.confirm_words = landmark_ >= 0 ? fmt::format("Light {} is right", landmark_ + 1) : "Show landmarks";
        show_measured(update, m);
        m.figures = figures;
        m.scene.light = light;
        if (update.overlay.lit) m.projector_view = projector_view(session.rig(), update.overlay.rig_from_ct.inverse());
    });
    if (told) said();
}

}  // namespace planlight
