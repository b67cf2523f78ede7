// Our calibration of other people's captures beside the one they published. measure_real
#include <fmt/format.h>

#include <cmath>

#include "registration/calibration/calibrate_rig.h"
#include "registration/calibration/initial_calibration.h"
#include "tests/registration/calibration/real_captures.h"

namespace planlight {
namespace {

void print_device(const char* whose, const CameraModel& d, const BundleResult* bundle, Eigen::Index at) {
    const auto sigma = [&](Eigen::Index i) {
        return bundle ? fmt::format(" +-{:<7.2f}", std::sqrt(bundle->covariance(at + i, at + i)))
                      : std::string("          ");
    };
    fmt::print("  {:<10} f {:8.2f}{} {:8.2f}{} axis {:7.2f}{} {:7.2f}{} k {:+.4f} {:+.4f} {:+.5f} {:+.5f} {:+.4f}\n",
               whose, d.focal_x, sigma(0), d.focal_y, sigma(1), d.centre_x, sigma(2), d.centre_y, sigma(3), d.k1, d.k2,
               d.p1, d.p2, d.k3);
}

/// Devices judged by the same measure, whoever found them: the board's poses from the left camera's corners alone,
/// flat; root mean square length of what is left of its corners, and of the light, nothing left out.
struct Judged {
    double corners_px = 0, light_px = 0;
};
Judged judge(const test::RealCaptures& captures, const RigEstimate& rig) {
    const CameraModel& camera = *rig.device(DeviceName::left_camera);
    Judged judged;
    double corners = 0, lit = 0;
    for (const PoseObservation& pose : captures.poses) {
        const auto rig_from_board = board_pose(camera, pose.left.corners, captures.board);
        if (!rig_from_board) continue;
        for (std::size_t i = 0; i < pose.left.corners.size(); ++i, ++corners)
            judged.corners_px +=
                (*project(camera, *rig_from_board * captures.board.corner_in_board(pose.left.corners.ids[i])) -
                 pose.left.corners.pixels[i])
                    .squaredNorm();
        for (const LightSample& sample : pose.left.light)
            if (const auto p = board_point(camera, sample.pixel_in_camera, *rig_from_board, Eigen::Vector3d::Zero(),
                                           captures.board)) {
                judged.light_px +=
                    (*project(*rig.device(DeviceName::projector), *rig_from_board * *p) - sample.pixel_in_projector)
                        .squaredNorm();
                ++lit;
            }
    }
    judged.corners_px = std::sqrt(judged.corners_px / corners);
    judged.light_px = lit > 0 ? std::sqrt(judged.light_px / lit) : 0;
    return judged;
}

/// As others model it: a flat board, k3 free.
Calibration with_their_model(const test::RealCaptures& captures) {
    CalibrationSettings settings = test::settings_for_real_captures();
    settings.bundle.bend = false;
    settings.bundle.sixth_order = true;
    return calibrate_rig(captures.poses, captures.board, captures.projector_width, captures.projector_height, settings);
}

void table(const char* name, const test::RealCaptures& captures) {
    fmt::print("{}\n", name);
    const Calibration ours = calibrate_rig(captures.poses, captures.board, captures.projector_width,
                                           captures.projector_height, test::settings_for_real_captures());
    if (ours.refusal) {
        fmt::print("  refused: {} {}\n", ours.refusal->reason, ours.refusal->remedy);
        return;
    }
    const Calibration theirs = with_their_model(captures);
    Eigen::Index at = 0;
    for (const DeviceName device : kDevices) {
        if (!ours.device(device)) continue;
        const auto d = static_cast<std::size_t>(device);
        fmt::print(" {}: ours {:.3f} px ({:.3f} on held-out poses, {} used, {} left out)", text_of(device),
                   ours.bundle.rms_px[d], ours.held_out.rms_px[d], ours.bundle.used[d], ours.bundle.left_out[d]);
        fmt::print("\n");
        print_device("ours", *ours.device(device), &ours.bundle, at);
        if (!theirs.refusal) {
            fmt::print("  (flat board, k3 free: {:.3f} px, {:.3f} on held-out poses)\n", theirs.bundle.rms_px[d],
                       theirs.held_out.rms_px[d]);
            print_device("flat, k3", *theirs.device(device), &theirs.bundle, at);
        }
        if (captures.published.device(device))
            print_device("published", *captures.published.device(device), nullptr, 0);
        at += device == DeviceName::left_camera ? 9 : 15;
    }
    const auto line = [&](const char* whose, const RigEstimate& rig) {
        const Judged judged = judge(captures, rig);
        fmt::print(" board placed by the left camera alone, {:<9}: corners {:.3f} px", whose, judged.corners_px);
        if (judged.light_px > 0) fmt::print(", light {:.3f} px", judged.light_px);
        fmt::print("\n");
    };
    line("ours", ours.bundle.rig);
    if (!theirs.refusal) line("flat, k3", theirs.bundle.rig);
    line("published", captures.published);
    fmt::print(" lengths {:.3f} of 200 rms over {}, mean {:+.3f}; bend {:.3f} {:.3f} {:.3f}",
               ours.held_out.length_rms_mm, ours.held_out.lengths, ours.held_out.length_mean_mm,
               ours.bundle.rig.bend_mm.x(), ours.bundle.rig.bend_mm.y(), ours.bundle.rig.bend_mm.z());
    if (ours.volume) fmt::print("; predicted {:.3f} (95 %)", ours.volume->p95_mm);
    fmt::print("; uncertainty factor {:.2f}", ours.bundle.uncertainty_factor);
    fmt::print("\n");
    for (const std::string& warning : ours.warnings) fmt::print(" warning: {}\n", warning);
}

}  // namespace
}  // namespace planlight

int main() {
    using namespace planlight;
    const auto stereo = test::stereo_pairs();
    if (stereo) table("OpenCV's stereo pairs, left and right", *stereo);
    if (stereo) {
        test::RealCaptures left = *stereo;
        for (auto& pose : left.poses) pose.right = {};
        table("OpenCV's stereo pairs, left camera alone", left);
    }
    if (const auto captures = test::camera_and_projector())
        table("procam-calibration, a camera and a projector", *captures);
    else
        fmt::print("The captures are not on this machine.\n");
    return 0;
}
