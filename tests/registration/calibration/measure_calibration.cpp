// Calibrations of simulated rooms against their truth.
// measure_calibration PRESET FIRST_SEED ROOMS [POSES] [BOARD] [BEND_MM]
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "registration/calibration/calibrate_rig.h"
#include "tests/registration/calibration/board_scene.h"
#include "tests/registration/calibration/epipolar_error.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

struct Room {
    bool refused = false;
    std::array<double, 3> held_out_px{};
    double length_mm = 0, scale_mm = 0;
    double point_rms_mm = 0, point_p95_mm = 0, predicted_rms_mm = 0, light_p95_mm = 0, predicted_light_rms_mm = 0,
           light_rms_mm = 0;
    double epipolar_px = 0;  ///< rms over the working volume
};

RigEstimate devices_of(const RigCalibration& rig) {
    RigEstimate estimate;
    estimate.devices = {rig.left_camera, rig.right_camera, rig.projector};
    return estimate;
}

/// Scans the points of the working volume without any noise: their true pixels, the calibrated rig. What is left after
/// a common turn and shift is the calibration's error.
void compare(const Calibration& calibration, const RigCalibration& truth, Room& room) {
    const VolumeError& volume = *calibration.volume;
    const RigEstimate true_rig = devices_of(truth);
    const RigidTransform true_from_found =
        truth.left_camera.device_from_rig.inverse();  // the found rig frame is the left camera's
    std::vector<Vector3d> found, wanted;
    double predicted = 0, light_predicted = 0;
    std::vector<double> light, epipolar;
    for (std::size_t i = 0; i < volume.points.size(); ++i) {
        if (!volume.seen[i]) continue;
        const Vector3d p = true_from_found * volume.points[i];
        const auto epipolar_px =
            test::epipolar_error_px(truth.left_camera, truth.right_camera, *calibration.device(DeviceName::left_camera),
                                    *calibration.device(DeviceName::right_camera), p);
        if (epipolar_px) epipolar.push_back(*epipolar_px);
        PixelsOfPoint pixels;
        for (std::size_t d = 0; d < 3; ++d) {
            const auto pixel = project(*true_rig.devices[d], p);
            if (pixel && in_picture(*true_rig.devices[d], *pixel)) pixels[d] = *pixel;
        }
        const auto scanned = triangulate_pixels(calibration.bundle.rig, pixels, kScanSigma_px, volume.points[i]);
        if (!scanned) continue;
        found.push_back(*scanned);
        wanted.push_back(p);
        predicted += volume.sigma_mm[i] * volume.sigma_mm[i];
        if (!pixels[0] || !pixels[1] || !pixels[2] || std::isnan(volume.light_sigma_mm[i])) continue;
        const auto by_cameras = triangulate_pixels(calibration.bundle.rig, {pixels[0], pixels[1], std::nullopt},
                                                   kScanSigma_px, volume.points[i]);
        if (!by_cameras) continue;
        const double mm_per_px = (truth.projector.device_from_rig * p).z() / truth.projector.focal_x;
        light.push_back(mm_per_px *
                        (*project(*calibration.device(DeviceName::projector), *by_cameras) - *pixels[2]).norm());
        light_predicted += volume.light_sigma_mm[i] * volume.light_sigma_mm[i];
    }
    Eigen::Matrix3Xd a(3, found.size()), b(3, found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        a.col(static_cast<Eigen::Index>(i)) = found[i];
        b.col(static_cast<Eigen::Index>(i)) = wanted[i];
    }
    const RigidTransform b_from_a = fit_rigid_transform(a, b);
    std::vector<double> errors;
    double square = 0, light_square = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        errors.push_back((b_from_a * found[i] - wanted[i]).norm());
        square += errors.back() * errors.back();
    }
    for (const double e : light) light_square += e * e;
    for (const double e : epipolar) room.epipolar_px += e * e / static_cast<double>(epipolar.size());
    room.epipolar_px = std::sqrt(room.epipolar_px);
    std::sort(errors.begin(), errors.end());
    std::sort(light.begin(), light.end());
    const auto n = static_cast<double>(errors.size()), m = static_cast<double>(std::max<std::size_t>(1, light.size()));
    room.point_rms_mm = std::sqrt(square / n);
    room.point_p95_mm = errors[errors.size() * 95 / 100];
    room.predicted_rms_mm = std::sqrt(predicted / n);
    room.light_p95_mm = light.empty() ? 0 : light[light.size() * 95 / 100];
    room.light_rms_mm = std::sqrt(light_square / m);
    room.predicted_light_rms_mm = std::sqrt(light_predicted / m);
}

void print_distribution(const std::string& name, std::vector<double> values) {
    if (values.empty()) return;
    std::sort(values.begin(), values.end());
    fmt::print("{:<44} median {:.3f}   95 % {:.3f}   worst {:.3f}\n", name, values[values.size() / 2],
               values[values.size() * 95 / 100], values.back());
}

}  // namespace
}  // namespace planlight

int main(int argc, char** argv) {
    using namespace planlight;
    if (argc < 4) {
        fmt::print("measure_calibration paper|modern FIRST_SEED ROOMS [POSES] [BOARD] [BEND_MM]\n");
        return 2;
    }
    const BoardSpec board = parse_board(argc > 5 ? argv[5] : "charuco 10x7 25 mm");
    std::vector<Room> rooms;
    for (int k = 0; k < std::stoi(argv[3]); ++k) {
        simulation::BoardRoomSettings settings;
        settings.preset = std::string(argv[1]) == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
        settings.seed = static_cast<unsigned>(std::stoi(argv[2]) + k);
        settings.poses = argc > 4 ? std::stoi(argv[4]) : 12;
        settings.whole = board.kind == BoardSpec::Kind::chessboard;
        auto sheet = test::printed(board);
        sheet.sag_mm = argc > 6 ? std::stod(argv[6]) : 0;
        sheet.bend_direction = 0.3 * settings.seed;
        simulation::SimulatedBoardRoom simulated(sheet, settings);
        const auto poses = test::observe_room(simulated, board);
        const Calibration calibration =
            calibrate_rig(poses, board, simulated.projector().width(), simulated.projector().height());
        Room room;
        if (calibration.refusal) {
            room.refused = true;
            fmt::print("seed {}: refused: {}\n", settings.seed, calibration.refusal->reason);
        } else {
            room.held_out_px = calibration.held_out.rms_px;
            room.length_mm = calibration.held_out.length_rms_mm;
            room.scale_mm = calibration.held_out.length_mean_mm;
            compare(calibration, simulated.true_rig(), room);
            fmt::print(
                "seed {}: held out {:.3f} {:.3f} {:.3f} px; length {:.3f} mm a 200; points off {:.4f} mm rms, said "
                "{:.4f}; "
                "light off {:.4f}, said {:.4f}; epipolar {:.3f} px; bend {:.3f} {:.3f} {:.3f}; left out {} {} {}; "
                "factor {:.2f}\n",
                settings.seed, room.held_out_px[0], room.held_out_px[1], room.held_out_px[2], room.length_mm,
                room.point_rms_mm, room.predicted_rms_mm, room.light_rms_mm, room.predicted_light_rms_mm,
                room.epipolar_px, calibration.bundle.rig.bend_mm.x(), calibration.bundle.rig.bend_mm.y(),
                calibration.bundle.rig.bend_mm.z(), calibration.bundle.left_out[0], calibration.bundle.left_out[1],
                calibration.bundle.left_out[2], calibration.bundle.uncertainty_factor);
        }
        std::fflush(stdout);
        rooms.push_back(room);
    }
    const auto values = [&](auto member) {
        std::vector<double> v;
        for (const Room& room : rooms)
            if (!room.refused) v.push_back(member(room));
        return v;
    };
    fmt::print("{} rooms, {} refused\n", rooms.size(),
               std::count_if(rooms.begin(), rooms.end(), [](const Room& r) { return r.refused; }));
    const char* names[] = {"left camera, held-out poses, px", "right camera, held-out poses, px",
                           "projector, held-out poses, px"};
    for (std::size_t d = 0; d < 3; ++d)
        print_distribution(names[d], values([&](const Room& r) { return r.held_out_px[d]; }));
    print_distribution("length error, mm a 200 mm, rms of a room", values([](const Room& r) { return r.length_mm; }));
    print_distribution("points of the working volume, mm, 95 %", values([](const Room& r) { return r.point_p95_mm; }));
    print_distribution("light sent to a point, mm, 95 %", values([](const Room& r) { return r.light_p95_mm; }));
    print_distribution("off the true epipolar lines, px, rms of a room",
                       values([](const Room& r) { return r.epipolar_px; }));
    print_distribution("points: true rms by stated sigma",
                       values([](const Room& r) { return r.point_rms_mm / r.predicted_rms_mm; }));
    print_distribution("light: true rms by stated sigma",
                       values([](const Room& r) { return r.light_rms_mm / r.predicted_light_rms_mm; }));
    return 0;
}
