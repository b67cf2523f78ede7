#include "tests/registration/scan/scan_pictures.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "planning_io/files/image_file.h"
#include "registration/scan/triangulate/point_covariance.h"
#include "tests/registration/scan/draw_scan.h"

namespace planlight::scan_rooms {
namespace {

RgbImage no_wider_than(RgbImage picture, int width) {
    while (picture.width > width) picture = half_size(picture);
    return picture;
}

RgbImage patterns(const StripeSettings& stripes) {
    std::vector<RgbImage> pictures;
    const auto sequence = stripe_sequence(stripes);
    for (const char* name :
         {"white", "column-gray-2", "column-gray-4", "column-phase-0", "row-gray-3", "row-phase-2"}) {
        const auto found =
            std::find_if(sequence.begin(), sequence.end(), [&](const auto& p) { return p.name == name; });
        if (found == sequence.end()) continue;
        RgbImage picture = no_wider_than(draw_stripes(stripes, *found), 300);
        write_words(picture, name);
        pictures.push_back(std::move(picture));
    }
    return side_by_side(pictures, 3);
}

RgbImage camera_and_code(const ScanCapture& capture, const ScanResult& scan) {
    const auto sequence = stripe_sequence(capture.stripes);
    std::vector<RgbImage> pictures;
    for (const char* name : {"column-phase-0"}) {
        const auto found =
            std::find_if(sequence.begin(), sequence.end(), [&](const auto& p) { return p.name == name; });
        RgbImage picture =
            no_wider_than(coloured(capture.left.at(static_cast<std::size_t>(found - sequence.begin()))), 500);
        write_words(picture, fmt::format("left camera, {}", name));
        pictures.push_back(std::move(picture));
    }
    RgbImage columns = no_wider_than(draw_columns(scan.left, capture.stripes.width), 500);
    write_words(columns, "decoded column");
    pictures.push_back(std::move(columns));
    const RgbImage row = side_by_side(pictures, 2);
    return with_legend(row, "decoded column (projector pixels)", 0, capture.stripes.width - 1, sequential_colour);
}

RgbImage cloud_error(const simulation::SimulatedRig& room, const ScanCapture& capture, const ScanResult& scan) {
    constexpr double kRange_mm = 0.1;
    const PointCloud& cloud = scan.clean.kept;
    std::vector<Rgb> colours;
    for (const double e : room.scan_errors_mm(cloud.points_in_rig, capture.began))
        colours.push_back(signed_colour(0.5 + e / (2 * kRange_mm)));
    const Eigen::Matrix3d front = room.calibration().projector.device_from_rig.linear();
    std::vector<RgbImage> views;
    for (const double turned : {-0.7, 0.0, 0.7})
        views.push_back(draw_cloud(cloud, colours,
                                   Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitY()).toRotationMatrix() * front, 1.05,
                                   240, 240, 1));
    return with_legend(side_by_side(views, 3), "distance to the true skin (mm), red outside, blue inside", -kRange_mm,
                       kRange_mm, signed_colour);
}

/// One standard deviation along the worst direction, at three depths before the projector.
RgbImage volume_sigma(const RigCalibration& rig) {
    constexpr double kHalfWidth_mm = 200, kHalfHeight_mm = 130, kStep_mm = 1.25;
    const RigidTransform rig_from_projector = rig.projector.device_from_rig.inverse();
    const auto middle =
        ray_through(rig.projector, Eigen::Vector2d(rig.projector.width / 2.0, rig.projector.height / 2.0));
    const Eigen::Vector3d way = rig.projector.device_from_rig.linear() * middle->direction;
    std::vector<std::vector<double>> planes;
    double most = 0;
    const int w = static_cast<int>(2 * kHalfWidth_mm / kStep_mm), h = static_cast<int>(2 * kHalfHeight_mm / kStep_mm);
    const std::vector<double> depths{820, 900, 980};
    for (const double depth : depths) {
        auto& plane = planes.emplace_back();
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                const Eigen::Vector3d p =
                    rig_from_projector *
                    Eigen::Vector3d(depth * way.x() / way.z() + (x + 0.5) * kStep_mm - kHalfWidth_mm,
                                    depth * way.y() / way.z() + (y + 0.5) * kStep_mm - kHalfHeight_mm, depth);
                const auto seen = [&](const CameraModel& d) {
                    const auto pixel = project(d, p);
                    return pixel && in_picture(d, *pixel);
                };
                double sigma = -1;
                if (seen(rig.left_camera) && seen(rig.right_camera) && seen(rig.projector)) {
                    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(expected_covariance(p, rig));
                    sigma = std::sqrt(std::max(0.0, solver.eigenvalues()(2)));
                    most = std::max(most, sigma);
                }
                plane.push_back(sigma);
            }
    }
    const double top = std::ceil(100 * most) / 100;
    std::vector<RgbImage> pictures;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        RgbImage picture(w, h, {60, 60, 60});
        for (std::size_t i = 0; i < planes[k].size(); ++i)
            if (planes[k][i] >= 0) picture.pixels[i] = sequential_colour(planes[k][i] / top);
        write_words(picture, fmt::format("{:g} mm before the projector", depths[k]));
        pictures.push_back(std::move(picture));
    }
    return with_legend(
        side_by_side(pictures, 3),
        fmt::format(
            "one sigma in depth (mm), from the calibration alone; each {:g} x {:g} mm; grey: not all three see it",
            2 * kHalfWidth_mm, 2 * kHalfHeight_mm),
        0, top, sequential_colour);
}

}  // namespace

void write_scan_pictures(const simulation::SimulatedRig& room, const ScanCapture& capture, const ScanResult& scan,
                         const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    write_png(patterns(capture.stripes), folder / "patterns.png");
    write_png(camera_and_code(capture, scan), folder / "camera_and_code.png");
    write_png(cloud_error(room, capture, scan), folder / "cloud_error.png");
    write_png(volume_sigma(room.calibration()), folder / "volume_sigma.png");
}

}  // namespace planlight::scan_rooms
