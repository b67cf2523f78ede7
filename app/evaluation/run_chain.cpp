#include "app/evaluation/run_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using simulation::SimulatedRig;

/// The chain of one room: the product's session and the room's truth, side by side, with the figures they give.
class Chain {
public:
    Chain(const Volume& volume, const Case& the_case, const CaseDrawing& drawing, const ChainSettings& settings,
          const ChainWatcher& watcher)
        : case_(the_case),
          settings_(settings),
          watcher_(watcher),
          plan_points_in_ct_(points_of(the_case.plan)),
          rig_(volume, plan_points_in_ct_, room(settings)),
          session_(the_case, drawing, calibration(),
                   watcher.wrap_projector ? watcher.wrap_projector(rig_.projector()) : rig_.projector(), rig_.cameras(),
                   rig_.clock(), session_settings()),
          random_(settings.seed) {
        figures_.preset = name_of(settings.preset);
        figures_.seed = settings.seed;
    }

    ChainFigures run() {
        std::string stage = "scan";
        try {
            scan();
            stage = "register";
            find_patient();
            if (figures_.registration->verdict != Verdict::no) {
                stage = "project at rest";
                follow(settings_.rest_updates, 3, "at rest", figures_.at_rest, figures_.rest_dark);
                rig_.set_motion({settings_.speed_mm_s, rig_.clock().now()});
                stage = "project while moving";
                follow(settings_.moving_updates, settings_.measured_updates, "moving", figures_.moving,
                       figures_.moving_dark);
                stage = "lost markers";
                lose_markers();
            } else {
                figures_.refused = "register: " + fmt::format("{}", fmt::join(figures_.registration->reasons, "; "));
            }
        } catch (const Error& refusal) {
            figures_.refused = stage + ": " + refusal.what();
        }
        session_.go_dark();
        return std::move(figures_);
    }

private:
    static simulation::RoomSettings room(const ChainSettings& settings) {
        simulation::RoomSettings room;
        room.preset = settings.preset;
        room.seed = settings.seed;
        return room;
    }

    RigCalibration calibration() const {
        RigCalibration given = rig_.calibration();
        if (settings_.spoil_calibration) settings_.spoil_calibration(given);
        return given;
    }

    SessionSettings session_settings() {
        SessionSettings session;
        session.while_computing = [this] { rig_.wait(settings_.computing); };
        return session;
    }

    void report_progress(const std::string& stage, double share) const {
        if (watcher_.progress) watcher_.progress(stage, share);
    }

    void scan() {
        const ScanResult& scanned = session_.scan(
            [&](int done, int of) { report_progress("scan", static_cast<double>(done) / static_cast<double>(of)); });
        const ScanCapture& capture = *session_.capture();
        figures_.patterns = static_cast<int>(capture.left.size());
        figures_.scan_simulated_s = seconds(capture.ended - capture.began);
        figures_.decoded_left = scanned.left.decoded;
        figures_.decoded_right = scanned.right.decoded;
        const auto& raw = scanned.raw;
        const auto& clean = scanned.clean;
        figures_.removed = {{"no partner in the other camera", raw.no_partner},
                            {"views disagree", raw.disagree},
                            {"outside the working volume", raw.outside_volume},
                            {"jump", clean.jump},
                            {"grazing", clean.grazing},
                            {"small piece", clean.small_piece},
                            {"lonely", clean.lonely},
                            {"thinned", clean.thinned}};
        figures_.scan_points = clean.kept.size();
        auto errors = rig_.scan_errors_mm(clean.kept.points_in_rig, capture.began);
        if (!errors.empty()) {
            figures_.scan_bias_mm = median(errors);
        }
        for (double& e : errors) e = std::abs(e);
        figures_.scan_error_mm = std::move(errors);
        figures_.stage_s["decode"] = scanned.decode_s;
        figures_.stage_s["triangulate"] = scanned.triangulate_s;
        figures_.stage_s["outliers"] = scanned.outliers_s;
        if (watcher_.scanned) watcher_.scanned(session_, rig_);
    }

    void find_patient() {
        report_progress("register", 0);
        const RegistrationResult& found = session_.find_patient();
        figures_.registration = found;
        figures_.stage_s["initial match"] = found.initial_match_s;
        figures_.stage_s["fine match"] = found.refine_s;
        const RigidTransform truth = rig_.true_rig_from_ct(session_.capture()->began);
        for (const Vector3d& p : plan_points_in_ct_) {
            figures_.tre_mm.push_back((found.patient_from_ct * p - truth * p).norm());
            figures_.tre_of_bound.push_back(figures_.tre_mm.back() / predicted_error(found.covariance, p).bound_95_mm);
            figures_.initial_error_mm =
                std::max(figures_.initial_error_mm, (found.initial_patient_from_ct * p - truth * p).norm());
        }
        const double turned_deg = angle_between(found.initial_patient_from_ct, truth) * 180 / std::numbers::pi;
        figures_.initial_match_right =
            found.verdict != Verdict::no && figures_.initial_error_mm < 10 && turned_deg < 10;
        if (found.verdict == Verdict::ask) {
            // In the operating room a person looks at landmarks now. Here the truth looks: a wrong pose is not
            // confirmed.
            if (*std::max_element(figures_.tre_mm.begin(), figures_.tre_mm.end()) < 5) session_.confirm();
        }
        report_progress("register", 1);
        if (watcher_.registered) watcher_.registered(session_, rig_);
    }

    /// Tracked updates; `measured` of them, evenly spread, are followed to the true skin at a random moment of their
    /// light.
    void follow(int updates, int measured, const std::string& stage, OverlayErrors& errors, int& dark) {
        std::optional<DrawnPicture> waiting;
        for (int i = 0; i < updates; ++i) {
            const Session::Update update = session_.update();
            note(update, stage, dark);
            note_measured(update, stage == "at rest" ? figures_.measured_rest_mm : figures_.measured_moving_mm);
            report_progress(stage, static_cast<double>(i + 1) / updates);
            if (waiting) {
                const double share = std::uniform_real_distribution<double>(0, 1)(random_);
                const Instant until = update.overlay.lit ? update.overlay.lit_from : waiting->lit_at;
                waiting->lit_at += from_seconds(share * seconds(until - waiting->lit_at));
                errors.append(measure_overlay(rig_, case_.plan, session_.drawing(), session_.renderer(),
                                              session_.render_settings(), *waiting, stage == "at rest"));
                waiting.reset();
            }
            const bool wanted = (i + 1) * measured / updates != i * measured / updates;
            if (wanted && update.overlay.lit)
                waiting = DrawnPicture{update.overlay.rig_from_ct, RigidTransform::Identity(), update.overlay.lit_from};
            if (waiting && update.pose.rig_from_patient) waiting->rig_from_patient = *update.pose.rig_from_patient;
        }
    }

    static void note_measured(const Session::Update& update, std::vector<double>& measured_mm) {
        if (!update.light) return;
        for (const SeenSegment& segment : update.light->segments)
            if (segment.seen) measured_mm.push_back(std::abs(segment.off_mm));
    }

    void note(const Session::Update& update, const std::string& stage, int& dark) {
        if (!update.overlay.lit) {
            ++dark;
            ++figures_.dark_reasons[update.overlay.reason];
        }
        figures_.update_s.push_back(update.times.total_s());
        if (update.pose.rig_from_patient) {
            const RigidTransform rig_from_ct = *update.pose.rig_from_patient * figures_.registration->patient_from_ct;
            const RigidTransform truth = rig_.true_rig_from_ct(update.pose.at);
            for (const Vector3d& p : plan_points_in_ct_)
                figures_.tracking_error_mm.push_back((rig_from_ct * p - truth * p).norm());
        }
        if (watcher_.updated) watcher_.updated(session_, rig_, update, stage);
    }

    void lose_markers() {
        rig_.set_motion({0, rig_.clock().now()});
        const int all = static_cast<int>(rig_.true_markers_in_ct().size());
        const auto lit_after_covering = [&](int covered, int& updates, int& lit) {
            std::vector<int> which(static_cast<std::size_t>(std::max(covered, 0)));
            for (std::size_t i = 0; i < which.size(); ++i) which[i] = static_cast<int>(i);
            rig_.cover_markers(which);
            int unused_dark = 0;
            for (updates = 0; updates < 3; ++updates) {
                const auto update = session_.update();
                note(update, "markers covered", unused_dark);
                lit += update.overlay.lit;
            }
        };
        lit_after_covering(1, figures_.lost_marker_updates, figures_.lost_marker_lit);
        lit_after_covering(all - 2, figures_.too_few_updates, figures_.too_few_lit);
    }

    const Case& case_;
    const ChainSettings settings_;
    const ChainWatcher& watcher_;
    std::vector<Vector3d> plan_points_in_ct_;
    SimulatedRig rig_;
    Session session_;
    std::mt19937 random_;
    ChainFigures figures_;
};

}  // namespace

std::string name_of(simulation::Preset preset) {
    return preset == simulation::Preset::paper ? "paper" : "modern";
}

ChainFigures run_chain(const Volume& volume, const Case& the_case, const CaseDrawing& drawing,
                       const ChainSettings& settings, const ChainWatcher& watcher) {
    return Chain(volume, the_case, drawing, settings, watcher).run();
}

}  // namespace planlight
