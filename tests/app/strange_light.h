#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/volume/read_volume.h"
#include "projection/check_light.h"
#include "projection/light_gate.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/support/test_data.h"

namespace planlight::test {

/// The light of a plan in a simulated room, as a gate judges it that a person has verified.
class StrangeLight : public testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!example_patient()) return;
        volume_ = read_volume(*example_patient());
        const auto prepared =
            prepare_case(*volume_, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {},
                         {}, "2001-10-14");
        case_ = prepared.prepared;
        threshold_ = prepared.threshold;
    }
    void SetUp() override {
        if (!volume_) GTEST_SKIP() << "the package invesalius-examples is not installed";
        room_.preset = simulation::Preset::paper;
        room_.seed = 11;
        room_.skin_threshold_hu = threshold_;
    }

    struct Seen {
        LightCheck check;
        LightGate::Ruling ruling;
    };
    /// The plan drawn `aside_mm` along the skin, seen in some frames by a gate whose light a person has verified.
    static Seen seen(simulation::SimulatedRig& rig, const Plan& plan, double aside_mm) {
        Case the_case = *case_;
        the_case.plan = plan;
        const CaseDrawing drawing(the_case);
        const RigidTransform rig_from_ct = rig.true_rig_from_ct(rig.clock().now());
        const Eigen::Vector3d p = points_of(plan).front();
        const Eigen::Vector3d normal = drawing.skin.nearest(p).normal_in_ct;
        // Neither along the line of the one-line plan nor across it.
        const Eigen::Vector3d aside = aside_mm * (normal.cross(Eigen::Vector3d(0.2, 0.1, 1))).normalized();
        const DrawingRenderer renderer(drawing.skin, rig.calibration().projector);
        const Instant lit =
            rig.projector().show(renderer.render(drawing.drawing, rig_from_ct * Eigen::Translation3d(aside)),
                                 rig.clock().now() + std::chrono::seconds(10));
        LightChecker checker(drawing.drawing, drawing.skin, rig.calibration());
        LightGate gate;
        gate.verify(rig.clock().now());
        Seen seen;
        for (int i = 0; i < 6; ++i) {
            const StereoFrame frame = rig.cameras().grab(lit, std::chrono::seconds(1));
            seen.check = checker.look(rig_from_ct, frame);
            seen.ruling = gate.step(frame.at, true, seen.check);
            if (seen.ruling.stop) break;
        }
        return seen;
    }

    void expect_honest(const std::string& name, const Plan& plan) {
        simulation::SimulatedRig rig(*volume_, points_of(plan), room_);
        const Seen good = seen(rig, plan, 0), off = seen(rig, plan, 2.5);
        for (const auto& [what, s] : {std::pair("good", &good), {"2.5 mm aside", &off}})
            fmt::print("{:<22} {:<13} seen {:>3} of {:>3}, 95 % {:.2f} mm: {} {}\n", name, what, s->check.seen,
                       s->check.expected, s->check.off_mm,
                       s->ruling.stop                           ? "DARK"
                       : s->ruling.trust == LightTrust::aligned ? "ALIGNED"
                                                                : "CHECK",
                       s->ruling.headline);
        EXPECT_FALSE(good.ruling.stop) << name << ": " << good.ruling.headline;
        EXPECT_NE(off.ruling.trust, LightTrust::aligned) << name << ": " << off.ruling.headline;
        green_ = good.ruling.trust == LightTrust::aligned;
    }
    const Plan& example() const { return case_->plan; }
    /// Near the middle of the example's plan, on the skin.
    static Eigen::Vector3d middle() { return case_->plan.boreholes.front().position_in_ct; }

    static Plan one_hole_of_2_mm() {
        Plan plan;
        plan.boreholes = {case_->plan.boreholes.front()};
        plan.boreholes.front().diameter_mm = 2;
        return plan;
    }
    static Plan biopsy_straight_in() {
        Plan plan;
        Trajectory way;
        way.name = "Biopsy";
        way.entry_in_ct = middle();
        way.target_in_ct = middle() - 60 * CaseDrawing(*case_).skin.nearest(middle()).normal_in_ct;
        plan.trajectories = {way};
        return plan;
    }
    /// Six holes of 2.4 mm in two rows, 7 mm apart, with short names.
    static Plan screws_of_a_plate() {
        const CaseDrawing drawing(*case_);
        const auto at = drawing.skin.nearest(middle());
        const Eigen::Vector3d u = at.normal_in_ct.cross(Eigen::Vector3d(0.2, 0.1, 1)).normalized(),
                              v = at.normal_in_ct.cross(u);
        Plan plan;
        for (int i = 0; i < 6; ++i) {
            Borehole hole;
            hole.name = fmt::format("S{}", i + 1);
            hole.position_in_ct = drawing.skin.nearest(at.p_in_ct + 7.0 * (i % 3) * u + 7.0 * (i / 3) * v).p_in_ct;
            hole.diameter_mm = 2.4;
            plan.boreholes.push_back(hole);
        }
        return plan;
    }

    simulation::RoomSettings room_;
    bool green_ = false;
    inline static std::optional<Volume> volume_;
    inline static std::optional<Case> case_;
    inline static double threshold_ = 0;
};
}  // namespace planlight::test
