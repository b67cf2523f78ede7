#include "registration/calibration/calibrate_rig.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "registration/calibration/initial_calibration.h"
#include "registration/calibration/judge_calibration.h"
#include "registration/calibration/judge_pictures.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A place on the board, and where the rig finds it.
struct Placed {
    Vector3d in_board, in_rig;
};

/// Corners that both cameras see; with one camera and a projector the lit pixels.
std::vector<Placed> placed_on_board(const PoseObservation& pose, const RigEstimate& rig,
                                    const RigidTransform& rig_from_board, const BoardSpec& board) {
    std::vector<Placed> placed;
    const auto add = [&](const PixelsOfPoint& pixels, const Vector3d& in_board) {
        if (const auto p = triangulate_pixels(rig, pixels, kScanSigma_px, rig_from_board * in_board))
            placed.push_back({in_board, *p});
    };
    if (rig.device(DeviceName::right_camera)) {
        for (std::size_t i = 0; i < pose.left.corners.size(); ++i) {
            const int id = pose.left.corners.ids[i];
            const auto& ids = pose.right.corners.ids;
            const auto other = std::lower_bound(ids.begin(), ids.end(), id);
            if (other == ids.end() || *other != id) continue;
            add({pose.left.corners.pixels[i], pose.right.corners.pixels[static_cast<std::size_t>(other - ids.begin())],
                 std::nullopt},
                board.corner_in_board(id));
        }
    } else if (rig.device(DeviceName::projector)) {
        for (std::size_t i = 0; i < pose.left.light.size(); i += 4) {
            const LightSample& sample = pose.left.light[i];
            if (const auto p = board_point(*rig.device(DeviceName::left_camera), sample.pixel_in_camera, rig_from_board,
                                           rig.bend_mm, board))
                add({sample.pixel_in_camera, std::nullopt, sample.pixel_in_projector}, *p);
        }
    }
    return placed;
}

struct LengthSum {
    std::size_t count = 0;
    double sum = 0, square = 0;
};

/// Distances of 150 to 250 mm on the board (or 60 to 100 % of a small board's width), their errors taken to 200 mm.
/// What is off by more than 2 % is a wrong corner, not a length.
void add_lengths(const std::vector<Placed>& placed, const BoardSpec& board, LengthSum& lengths) {
    const double high = std::min(250.0, board.width_mm()), low = 0.6 * high;
    for (std::size_t i = 0; i < placed.size(); ++i)
        for (std::size_t k = i + 1; k < placed.size(); ++k) {
            const double true_mm = (placed[i].in_board - placed[k].in_board).norm();
            if (true_mm < low || true_mm > high) continue;
            const double error = ((placed[i].in_rig - placed[k].in_rig).norm() - true_mm) * 200 / true_mm;
            if (std::abs(error) > 4) continue;
            ++lengths.count;
            lengths.sum += error;
            lengths.square += error * error;
        }
}

HeldOut hold_out(const std::vector<PoseObservation>& poses, const BoardSpec& board, const BundleResult& full,
                 const CalibrationSettings& settings) {
    HeldOut out;
    LengthSum lengths;
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < poses.size(); ++i)
        if (full.rig.rig_from_board[i]) seen.push_back(i);
    const std::size_t folds = std::min<std::size_t>(static_cast<std::size_t>(settings.folds), seen.size());
    std::array<double, 3> square{};
    for (std::size_t fold = 0; fold < folds; ++fold) {
        RigEstimate training = full.rig, test = full.rig;
        for (std::size_t k = 0; k < seen.size(); ++k)
            (k % folds == fold ? training : test).rig_from_board[seen[k]].reset();
        const BundleResult learnt = adjust_bundle(poses, board, training, settings.bundle);
        test.devices = learnt.rig.devices;
        test.bend_mm = learnt.rig.bend_mm;
        BundleSettings fixed = settings.bundle;
        fixed.rig_fixed = true;
        const BundleResult judged = adjust_bundle(poses, board, test, fixed);
        for (std::size_t d = 0; d < 3; ++d) {
            square[d] += judged.rms_px[d] * judged.rms_px[d] * static_cast<double>(judged.used[d]);
            out.used[d] += judged.used[d];
            out.left_out[d] += judged.left_out[d];
        }
        for (std::size_t i = 0; i < poses.size(); ++i)
            if (judged.rig.rig_from_board[i])
                add_lengths(placed_on_board(poses[i], judged.rig, *judged.rig.rig_from_board[i], board), board,
                            lengths);
    }
    for (std::size_t d = 0; d < 3; ++d)
        out.rms_px[d] = out.used[d] ? std::sqrt(square[d] / static_cast<double>(out.used[d])) : 0;
    out.lengths = lengths.count;
    if (lengths.count > 0) {
        out.length_rms_mm = std::sqrt(lengths.square / static_cast<double>(lengths.count));
        out.length_mean_mm = lengths.sum / static_cast<double>(lengths.count);
    }
    return out;
}

}  // namespace

Calibration calibrate_rig(const std::vector<PoseObservation>& observed, const BoardSpec& board, int projector_width,
                          int projector_height, const CalibrationSettings& settings) {
    Calibration calibration;
    const auto refused = [&](std::optional<Refusal> refusal) {
        calibration.refusal = std::move(refusal);
        return calibration.refusal.has_value();
    };
    if (refused(judge_pictures(observed, board, settings))) return calibration;
    const std::vector<PoseObservation> poses = named_as_left(observed, board);
    InitialCalibration start = calibrate_cameras_initially(poses, board);
    if (!start.failure.empty()) {
        refused(Refusal{start.failure, "Capture more poses of the board, tilted 15 to 40 degrees every way."});
        return calibration;
    }
    if (refused(judge_poses(start.rig, board, settings))) return calibration;
    BundleSettings corners_only = settings.bundle;
    corners_only.light = false;
    calibration.bundle = adjust_bundle(poses, board, start.rig, corners_only);
    if (refused(judge_cameras(poses, board, calibration.bundle, settings))) return calibration;
    if (projector_width > 0) {
        start.rig = calibration.bundle.rig;
        add_initial_projector(poses, board, projector_width, projector_height, start);
        if (start.projector_mirrored &&
            refused(Refusal{"the projector's picture is mirrored",
                            "Switch the projector from rear to front projection, then capture again."}))
            return calibration;
        if (!start.failure.empty() &&
            refused(Refusal{start.failure, "Let the projector light most of the board in every pose."}))
            return calibration;
        calibration.bundle = adjust_bundle(poses, board, start.rig, settings.bundle);
    }
    calibration.volume = predict_volume_error(calibration.bundle, board);
    if (refused(judge_rig(poses, board, calibration, settings))) return calibration;
    calibration.held_out = hold_out(poses, board, calibration.bundle, settings);
    calibration.warnings = warnings_about(poses, calibration);
    return calibration;
}

RigCalibration rig_calibration_of(const Calibration& calibration, const std::string& made_on) {
    if (!calibration.makes_a_rig() || calibration.refusal)
        throw std::invalid_argument("rig_calibration_of: not the calibration of a rig");
    RigCalibration rig;
    rig.left_camera = *calibration.device(DeviceName::left_camera);
    rig.right_camera = calibration.device(DeviceName::right_camera).value_or(CameraModel{});
    rig.projector = calibration.device(DeviceName::projector).value_or(CameraModel{});
    rig.made_on = made_on;
    double square = 0;
    std::size_t count = 0;
    for (std::size_t d = 0; d < 3; ++d) {
        square += calibration.bundle.rms_px[d] * calibration.bundle.rms_px[d] *
                  static_cast<double>(calibration.bundle.used[d]);
        count += calibration.bundle.used[d];
    }
    rig.reprojection_rms_px = count ? std::sqrt(square / static_cast<double>(count)) : 0;
    return rig;
}

}  // namespace planlight
