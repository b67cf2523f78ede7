#include "app/live/live_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/live/case_model.h"
#include "app/live/clickable_scan.h"
#include "app/live/scene_of_session.h"
#include "app/report/registration_certificate.h"
#include "planning_io/plan_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

std::string landmark_evidence(const std::vector<PointPair>& landmarks, const RegistrationResult& found) {
    const std::vector<double> errors = landmark_errors_mm(landmarks, found.patient_from_ct);
    return fmt::format("{} landmarks were clicked; the farthest lies {:.1f} mm from where the match puts it.", landmarks.size(),
                       *std::max_element(errors.begin(), errors.end()));
}

}  // namespace

/// Passes everything to the simulated projector and keeps the newest picture for the projector window.
class LiveSession::LightTap final : public Projector {
public:
    LightTap(Projector& simulated, LiveSession& session) : simulated_(simulated), session_(session) {}
    int width() const override { return simulated_.width(); }
    int height() const override { return simulated_.height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        if (session_.dark_wanted_) {
            go_dark();
            return simulated_.show(RgbImage(width(), height()), valid_until);
        }
        const Instant lit_from = simulated_.show(picture, valid_until);
        keep(std::make_shared<RgbImage>(picture));
        return lit_from;
    }
    void go_dark() noexcept override {
        simulated_.go_dark();
        keep(nullptr);
    }

private:
    void keep(std::shared_ptr<const RgbImage> picture) noexcept {
        const std::lock_guard lock(session_.mutex_);
        session_.light_.picture = std::move(picture);
        ++session_.light_.number;
    }
    Projector& simulated_;
    LiveSession& session_;
};

LiveSession::LiveSession(const Volume& volume, const Case& the_case, const CaseDrawing& drawing, const LiveSettings& settings)
    : case_(the_case), drawing_(drawing), settings_(settings), model_(model_of_case(the_case, drawing)) {
    set_status(StatusKind::ready, "The simulated room is being made.");
    thread_ = std::thread([this, &volume] {
        try {
            run(volume, settings_);
        } catch (const std::exception& fault) {
            const std::lock_guard lock(mutex_);
            fault_ = fault.what();
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
            actions_.clear();
            dark_wanted_ = true;
            light_ = {nullptr, light_.number + 1};
        }
        actions_.push_back(action);
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
    return model_;
}

LiveSession::Light LiveSession::light() const {
    const std::lock_guard lock(mutex_);
    return light_;
}

bool LiveSession::projecting() const { return projecting_; }

std::string LiveSession::fault() const {
    const std::lock_guard lock(mutex_);
    return fault_;
}

template <class Change>
void LiveSession::change_model(Change change) {
    const std::lock_guard lock(mutex_);
    change(model_);
}

void LiveSession::set_status(StatusKind kind, const std::string& headline, std::vector<std::string> details) {
    change_model([&](OperatorModel& m) { m.status = {kind, headline, std::move(details)}; });
}

/// Steps before the active one are done, later ones wait.
void LiveSession::set_steps(int active, StepState state) {
    change_model([&](OperatorModel& m) {
        for (int i = 0; i < static_cast<int>(m.steps.size()); ++i)
            m.steps[static_cast<std::size_t>(i)] = i < active ? StepState::done : i == active ? state : StepState::waiting;
    });
}

OperatorAction LiveSession::next_action(bool wait) {
    std::unique_lock lock(mutex_);
    if (wait) wake_.wait(lock, [&] { return ending_ || !actions_.empty(); });
    if (ending_) return OperatorAction::quit;
    if (actions_.empty()) return OperatorAction::none;
    const OperatorAction action = actions_.front();
    actions_.pop_front();
    return action;
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
        const OperatorAction action = next_action(!following_);
        if (action == OperatorAction::quit) return;
        try {
            act(action, session, rig);
        } catch (const Error& refusal) {
            following_ = projecting_ = false;
            session.go_dark();
            set_status(StatusKind::refused, std::string(refusal.what()) + ".", {refusal.remedy});
        }
    }
}

void LiveSession::act(OperatorAction action, Session& session, simulation::SimulatedRig& rig) {
    switch (action) {
        case OperatorAction::scan:
            following_ = projecting_ = dark_wanted_ = false;
            if (moving_) rig.set_motion({0, rig.clock().now()});
            moving_ = false;
            scan(session);
            return;
        case OperatorAction::do_register:
        case OperatorAction::use_landmarks: find_patient(session, newest_landmarks()); return;
        case OperatorAction::track:
            dark_wanted_ = false;
            following_ = true;
            if (!moving_) rig.set_motion({settings_.speed_mm_s, rig.clock().now()});
            moving_ = true;
            set_steps(5);
            break;
        case OperatorAction::confirm: confirm(session); return;
        case OperatorAction::dark:
        case OperatorAction::stop:
            following_ = projecting_ = false;
            session.go_dark();
            set_status(StatusKind::dark, "Dark: no light on the patient.", {"Press Track to show the plan again."});
            change_model([](OperatorModel& m) {
                m.scene.light = nullptr;
                m.stop = {false, "nothing runs"};
            });
            return;
        case OperatorAction::none:
        case OperatorAction::quit: break;
    }
    if (following_) follow(session, rig);
}

void LiveSession::scan(Session& session) {
    set_steps(2);
    set_status(StatusKind::scanning, "Scanning: keep the patient still.");
    change_model([](OperatorModel& m) {
        m.scene.cloud = nullptr;
        m.scene.light = nullptr;
        m.scene.markers = nullptr;
        m.fit = std::nullopt;
        m.landmarks = std::nullopt;
        m.confirm = false;
        m.track = {false, "register first"};
    });
    const ScanResult& scan = session.scan([&](int done, int of) {
        set_status(StatusKind::scanning, fmt::format("Scanning: picture {} of {}.", done, of), {"Keep the patient still."});
    });
    const ScanCapture& capture = *session.capture();
    const auto clickable = clickable_scan(scan.clean.kept, &session.rig().left_camera);
    change_model([&](OperatorModel& m) {
        m.left.picture = std::make_shared<GrayImage>(capture.left.front());
        m.right.picture = std::make_shared<GrayImage>(capture.right.front());
        m.left.found = found_markers(session.tracker().seen_left());
        m.right.found = found_markers(session.tracker().seen_right());
        m.do_register = {true, {}};
        if (clickable) m.landmarks = LandmarkViews{&drawing_.skin, clickable};
    });
    set_steps(3);
    set_status(StatusKind::ready, fmt::format("{} points of skin scanned.", scan.clean.kept.size()), {"Register next."});
}

std::vector<PointPair> LiveSession::newest_landmarks() const {
    const std::lock_guard lock(mutex_);
    return landmarks_;
}

void LiveSession::find_patient(Session& session, const std::vector<PointPair>& landmarks) {
    following_ = projecting_ = false;
    session.go_dark();
    set_status(StatusKind::matching, landmarks.empty() ? "Finding the patient."
                                                       : fmt::format("Finding the patient, with {} landmarks.", landmarks.size()));
    const RegistrationResult& found = session.find_patient(landmarks);
    OperatorModel shown = model();
    show_match(case_, found, std::make_shared<PointCloud>(session.scanned()->clean.kept), shown);
    shown.confirm = found.verdict == Verdict::ask;
    shown.scene.light = nullptr;
    shown.stop = {false, "nothing runs"};
    shown.track = {false, "register first"};
    if (found.verdict != Verdict::no) {
        shown.scene.markers = markers_in_ct(session.tracker(), shown.scene.ct_from_rig);
        shown.scene.plan = std::make_shared<PlanDrawing>(session.drawing());
        if (!landmarks.empty()) shown.evidence.insert(shown.evidence.begin(), landmark_evidence(landmarks, found));
        shown.track = {found.verdict == Verdict::yes, found.verdict == Verdict::yes ? "" : "look at the fit first"};
    }
    shown.evidence.push_back(keep(found, session.scanned()->clean.kept, landmarks));
    change_model([&](OperatorModel& m) { m = std::move(shown); });
    set_steps(3, found.verdict == Verdict::yes ? StepState::done : StepState::attention);
    if (found.verdict == Verdict::yes) {
        set_steps(4);
        set_status(StatusKind::ready, "The patient is found.", {"Look at the scan on the skin, then press Track."});
    } else {
        set_status(found.verdict == Verdict::ask ? StatusKind::check : StatusKind::refused,
                   found.verdict == Verdict::ask ? "Not sure: look whether the scan fits the skin, or scan again."
                                                 : "The patient was not found: scan again, or click landmarks.",
                   found.reasons);
    }
}

/// Keeps the match and its scan; what became of it, in a sentence. A full disk does not end a session.
std::string LiveSession::keep(const RegistrationResult& found, const PointCloud& cloud,
                              const std::vector<PointPair>& landmarks) const {
    if (settings_.keep_matches_in.empty()) return "This match is not kept.";
    try {
        return "Kept in " + keep_match(found, &cloud, landmarks, settings_.keep_matches_in).string() + ".";
    } catch (const std::exception& fault) {
        return std::string("This match could not be kept: ") + fault.what() + ".";
    }
}

void LiveSession::confirm(Session& session) {
    if (session.registration() == nullptr || session.registration()->verdict != Verdict::ask) return;
    session.confirm();
    change_model([](OperatorModel& m) {
        m.confirm = false;
        m.track = {true, {}};
        m.evidence.insert(m.evidence.begin(), "Confirmed by the operator, who looked at the fit.");
    });
    set_steps(4);
    set_status(StatusKind::ready, "The match is used on your word.",
               {"Press Track, and look at the light on two landmarks before you use it."});
}

void LiveSession::follow(Session& session, simulation::SimulatedRig& rig) {
    const auto update = session.update();
    if (dark_wanted_) return;
    projecting_ = update.overlay.lit;
    show_update(session, rig, update);
}

void LiveSession::show_update(const Session& session, const simulation::SimulatedRig& rig, const Session::Update& update) {
    const auto light = true_light_lines(session.drawing(), rig.calibration(), update.overlay, rig);
    Figures figures;
    figures.updates_per_s = 1 / std::max(update.times.total_s(), 1e-6);
    figures.delay_to_light_ms = 1000 * seconds(update.overlay.lit_from - update.pose.at);
    if (update.pose.rig_from_patient) {
        const Eigen::Vector3d middle = session.tracker().markers().front().centre_in_patient;
        figures.head_moved_mm = (*update.pose.rig_from_patient * middle - middle).norm();
        figures.head_turned_deg =
            angle_between(*update.pose.rig_from_patient, RigidTransform::Identity()) * 180 / std::numbers::pi;
    }
    if (!update.overlay.lit) figures.delay_to_light_ms.reset();
    change_model([&](OperatorModel& m) {
        m.figures = figures;
        m.scene.light = light;
        m.left.picture = std::make_shared<GrayImage>(brightened(update.frame.left));
        m.right.picture = std::make_shared<GrayImage>(brightened(update.frame.right));
        m.left.found = found_markers(session.tracker().seen_left());
        m.right.found = found_markers(session.tracker().seen_right());
        m.stop = {true, {}};
    });
    if (update.overlay.lit)
        set_status(StatusKind::aligned, "The plan is on the skin.",
                   {fmt::format("Followed by {} markers, residual {:.2f} px.",
                                std::max(update.pose.markers_left, update.pose.markers_right), update.pose.residual_px),
                    "The light itself is not measured yet: look at it on landmarks before you use it."});
    else
        set_status(StatusKind::dark, "Dark: " + update.overlay.reason + ".",
                   {"The light comes back by itself when the pose is good."});
}

}  // namespace planlight
