// How well CHECK measures the light: the example patient at rest in simulated rooms, the plan drawn beside its place by
// a known shift, and what `check_light` makes of one frame of both cameras, against where the light truly fell.
// measure_light_check paper|modern FIRST COUNT
// measure_light_check paper|modern FIRST COUNT session: whole sessions instead (scan, match, tracking), at rest and
// with the head moving at up to 20 and 50 mm/s: what CHECK measured in each frame against where the light of the
// picture that was lit in it truly fell at that moment, as 95 % of the light; and what an update's CHECK costs, with
// the projector covered as well, where it seeks the light farther aside.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>

#include "app/evaluation/distribution.h"
#include "app/evaluation/measure_overlay.h"
#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/statistics.h"
#include "planning_io/volume/read_volume.h"
#include "projection/check_light.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using Eigen::Vector3d;

constexpr double kShifts_mm[] = {0, 0.5, 1, 2};

struct Row {
    std::vector<double> error_mm, shift_error_mm, seen_share, cost_ms;
};

/// A direction along the skin at the plan's first point, square to the projector's sight.
Vector3d sideways(const Vector3d& to_projector_in_ct, std::mt19937& random) {
    std::normal_distribution<double> normal;
    const Vector3d any(normal(random), normal(random), normal(random));
    return (any - any.dot(to_projector_in_ct) * to_projector_in_ct).normalized();
}

void measure(const simulation::SimulatedRig& truth, simulation::SimulatedRig& rig, const Case& the_case,
             const CaseDrawing& drawing, double shift_mm, std::mt19937& random, Row& row) {
    const DrawingRenderer renderer(drawing.skin, rig.calibration().projector);
    const Instant now = rig.clock().now();
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(now);
    const Vector3d towards =
        rig_from_ct.linear().transpose() * (rig.calibration().projector.centre_in_rig() -
                                            rig_from_ct * the_case.plan.osteotomy_lines.front().points_in_ct.front())
                                               .normalized();
    const Vector3d shift_in_ct = shift_mm * sideways(towards, random);
    const RigidTransform drawn = rig_from_ct * Eigen::Translation3d(shift_in_ct);
    const Instant lit = rig.projector().show(renderer.render(drawing.drawing, drawn), now + std::chrono::seconds(10));
    const StereoFrame frame = rig.cameras().grab(lit, std::chrono::seconds(1));
    const auto start = std::chrono::steady_clock::now();
    const LightCheck check = check_light(drawing.drawing, drawing.skin, rig.calibration(), rig_from_ct, frame);
    row.cost_ms.push_back(1000 * seconds(std::chrono::steady_clock::now() - start));
    const OverlayErrors true_errors = measure_overlay(truth, the_case.plan, drawing.drawing, renderer, {},
                                                      {drawn, RigidTransform::Identity(), frame.at}, false);
    row.error_mm.push_back(check.off_mm - quantile(true_errors.position_mm, 0.95));
    for (const ItemLight& item : check.items) {
        if (!item.known()) continue;
        // What the item's strokes can tell of the shift: its part along the skin there.
        const Vector3d direction = item.off_mm > 1e-6 ? Vector3d(item.shift_in_ct / item.off_mm) : towards;
        row.shift_error_mm.push_back(item.off_mm - std::abs(shift_in_ct.dot(direction)));
    }
    row.seen_share.push_back(check.seen_share());
}

struct Frames {
    std::vector<double> measured_mm, true_mm, difference_mm, cost_ms, seen_share;
    std::vector<double> track_ms, draw_ms, check_ms;  // of each update, by the wall
};

double processor_ms() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::string text_of(const std::vector<double>& values) {
    const Distribution d = distribution_of(values);
    return fmt::format("{:.2f} / {:.2f} / {:.2f}", d.median, d.p95, d.worst);
}

/// Updates of one session at one speed. The frame shows the newest picture that was lit by its mid-exposure.
void follow(Session& session, const SkinSurface& skin, simulation::SimulatedRig& rig, const Plan& plan, int updates,
            Frames& frames) {
    std::vector<ShownPicture> shown;
    LightChecker timed(session.drawing(), skin, session.rig());
    for (int i = 0; i < updates; ++i) {
        const Session::Update update = session.update();
        frames.track_ms.push_back(1e3 * update.times.track_s);
        frames.draw_ms.push_back(1e3 * update.times.draw_s);
        if (update.light) frames.check_ms.push_back(1e3 * update.times.check_s);
        const ShownPicture* lit = nullptr;
        for (const ShownPicture& picture : shown)
            if (picture.lit_from <= update.frame.at) lit = &picture;
        if (update.light && lit && update.light->seen > 0) {
            const double before_ms = processor_ms();
            timed.look(*update.pose.rig_from_patient * session.registration()->patient_from_ct, update.frame);
            frames.cost_ms.push_back(processor_ms() - before_ms);
            frames.seen_share.push_back(update.light->seen_share());
            const OverlayErrors truth =
                measure_overlay(rig, plan, session.drawing(), session.renderer(), session.render_settings(),
                                {lit->rig_from_ct, RigidTransform::Identity(), update.frame.at}, false);
            frames.measured_mm.push_back(update.light->off_mm);
            frames.true_mm.push_back(quantile(truth.position_mm, 0.95));
            frames.difference_mm.push_back(std::abs(frames.measured_mm.back() - frames.true_mm.back()));
        }
        if (update.overlay.lit) shown.push_back({update.overlay.lit_from, update.overlay.rig_from_ct});
    }
}

int measure_sessions(const Volume& volume, const Case& the_case, const CaseDrawing& drawing, simulation::Preset preset,
                     int first, int count) {
    constexpr double kSpeeds_mm_s[] = {0, 20, 50};
    std::vector<Frames> all(std::size(kSpeeds_mm_s));
    Frames covered;
    int refused = 0;
    for (int seed = first; seed < first + count; ++seed) {
        simulation::RoomSettings room;
        room.preset = preset;
        room.seed = static_cast<unsigned>(seed);
        simulation::SimulatedRig rig(volume, points_of(the_case.plan), room);
        SessionSettings settings;
        settings.check_light_every = 3;
        settings.while_computing = [&rig] { rig.wait(std::chrono::milliseconds(10)); };
        Session session(the_case, drawing, rig.calibration(), rig.projector(), rig.cameras(), rig.clock(), settings);
        session.scan();
        if (session.find_patient().verdict == Verdict::no) {
            ++refused;
            continue;
        }
        session.confirm();
        for (std::size_t k = 0; k < all.size(); ++k) {
            if (k > 0) rig.set_motion({kSpeeds_mm_s[k], rig.clock().now()});
            follow(session, drawing.skin, rig, the_case.plan, k == 0 ? 16 : 40, all[k]);
        }
        rig.set_motion({0, rig.clock().now()});
        rig.cover_projector(true);
        follow(session, drawing.skin, rig, the_case.plan, 40, covered);
        fmt::print(stderr, "room {}\n", seed);
    }
    fmt::print("rooms {} to {}, {} refused; 95 % of the light in a frame, mm: median / 95 % / worst\n", first,
               first + count - 1, refused);
    fmt::print(
        "head, mm/s | frames | measured | true | measured and true apart | seen | CHECK, ms of processor (median / 95 "
        "%)\n");
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Frames& f = all[k];
        const Distribution cost = distribution_of(f.cost_ms);
        fmt::print("{:.0f} | {} | {} | {} | {} | {:.0f} % | {:.1f} / {:.1f}\n", kSpeeds_mm_s[k], f.true_mm.size(),
                   text_of(f.measured_mm), text_of(f.true_mm), text_of(f.difference_mm), 100 * median(f.seen_share),
                   cost.median, cost.p95);
    }
    fmt::print(
        "head, mm/s | updates | tracking, ms by the wall (median / 95 % / worst) | drawing | CHECK where it looks\n");
    for (std::size_t k = 0; k < all.size(); ++k)
        fmt::print("{:.0f} | {} | {} | {} | {}\n", kSpeeds_mm_s[k], all[k].track_ms.size(), text_of(all[k].track_ms),
                   text_of(all[k].draw_ms), text_of(all[k].check_ms));
    double covered_ms = 0;
    for (const double ms : covered.check_ms) covered_ms += ms;
    fmt::print("projector covered | {} | {} | {} | {}; {:.2f} ms an update, mean of all\n", covered.track_ms.size(),
               text_of(covered.track_ms), text_of(covered.draw_ms), text_of(covered.check_ms),
               covered_ms / static_cast<double>(std::max<std::size_t>(1, covered.track_ms.size())));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string preset = argc > 1 ? argv[1] : "paper";
    const int first = argc > 2 ? std::atoi(argv[2]) : 1, count = argc > 3 ? std::atoi(argv[3]) : 3;
    if (!test::example_patient()) return 77;
    const Volume volume = read_volume(*test::example_patient());
    const Preparation prepared = prepare_case(
        volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {}, "2001-10-14");
    const CaseDrawing drawing(prepared.prepared);
    if (argc > 4 && std::string(argv[4]) == "session")
        return measure_sessions(volume, prepared.prepared, drawing,
                                preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern, first,
                                count);
    std::vector<Row> rows(std::size(kShifts_mm));
    for (int seed = first; seed < first + count; ++seed) {
        std::mt19937 random(static_cast<unsigned>(seed));
        simulation::RoomSettings room;
        room.preset = preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
        room.seed = static_cast<unsigned>(seed);
        room.skin_threshold_hu = prepared.threshold;  // the skin that was prepared: what CHECK sees is the light alone
        simulation::SimulatedRig rig(volume, points_of(prepared.prepared.plan), room);
        for (std::size_t i = 0; i < rows.size(); ++i)
            measure(rig, rig, prepared.prepared, drawing, kShifts_mm[i], random, rows[i]);
        fmt::print(stderr, "room {}\n", seed);
    }
    fmt::print("{} room, seeds {} to {}\n", preset, first, first + count - 1);
    fmt::print(
        "drawn beside | measured - true, 95 % of the light (median / worst) | item's shift - true (median / 95 % / "
        "worst) | seen | ms\n");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        Row& row = rows[i];
        for (double& e : row.shift_error_mm) e = std::abs(e);
        for (double& e : row.error_mm) e = std::abs(e);
        const Distribution whole = distribution_of(row.error_mm), item = distribution_of(row.shift_error_mm);
        fmt::print("{:.1f} mm | {:.2f} / {:.2f} | {:.2f} / {:.2f} / {:.2f} | {:.0f} % | {:.1f}\n", kShifts_mm[i],
                   whole.median, whole.worst, item.median, item.p95, item.worst, 100 * median(row.seen_share),
                   median(row.cost_ms));
    }
    return 0;
}
