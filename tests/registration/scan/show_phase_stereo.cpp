// Real pictures of others: a rectified stereo pair under phase-shifted fringes of two frequencies (two times eight
// pictures a camera). show_phase_stereo FOLDER OUT: decodes the fringes, matches along the rows, triangulates, writes
// cloud.ply and cloud.png to OUT. FOLDER: frames0_0.png (white), frames0_1.png (black), frames0_2 to 9 (first
// frequency) and secondary_cam1/frames0_10 to 17 (second one) of the left camera; frames1_* and secondary_cam2/ of the
// right. The calibration is not published: focal length, axes and distance of the cameras are CHOSEN below, so that the
// shape is right up to a stretch along the line of sight, and no length is known.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "planning_io/files/image_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "registration/scan/clean/remove_outliers.h"
#include "registration/scan/triangulate/triangulate_cameras.h"
#include "tests/registration/scan/draw_scan.h"

using namespace planlight;
using namespace planlight::scan_rooms;
namespace fs = std::filesystem;

namespace {

constexpr int kSteps = 8;
constexpr double kPeriod_px = 16;  // projector pixels we count a period of the first frequency as
constexpr double kChosenFocal_px = 2200, kChosenBaseline_mm = 200;

struct Pictures {
    GrayImage white, black;
    std::array<GrayImage, kSteps> first, second;
};

Pictures read_pictures(const fs::path& folder, int camera) {
    Pictures p;
    const auto read = [&](const fs::path& in, int k) {
        return read_gray(in / fmt::format("frames{}_{}.png", camera, k));
    };
    p.white = read(folder, 0);
    p.black = read(folder, 1);
    for (int k = 0; k < kSteps; ++k) {
        p.first[static_cast<std::size_t>(k)] = read(folder, 2 + k);
        p.second[static_cast<std::size_t>(k)] = read(folder / fmt::format("secondary_cam{}", camera + 1), 10 + k);
    }
    return p;
}

struct Fringe {
    double turns, amplitude;
};

/// Phase as turns in [0, 1).
Fringe fringe_at(const std::array<GrayImage, kSteps>& frames, std::size_t i) {
    double s = 0, c = 0;
    for (std::size_t k = 0; k < kSteps; ++k) {
        const double shift = 2 * std::numbers::pi * static_cast<double>(k) / kSteps;
        s += frames[k].pixels[i] * std::sin(shift);
        c += frames[k].pixels[i] * std::cos(shift);
    }
    const double turns = std::atan2(s, c) / (2 * std::numbers::pi);
    return {turns - std::floor(turns), 2 * std::hypot(s, c) / kSteps};
}

constexpr double kLeastAmplitude_grey = 4;

/// How many periods of the first frequency fit into one of the beat of both: what makes beat and phase agree best.
/// Negative when the phase runs against the beat. The second value is the rms disagreement in periods.
std::pair<int, double> periods_of(const Pictures& p) {
    std::pair<int, double> best{0, 1};
    for (int n = -120; n <= 120; ++n) {
        if (std::abs(n) < 5) continue;
        double squares = 0;
        int count = 0;
        for (std::size_t i = 0; i < p.white.pixels.size(); i += 37) {
            const Fringe a = fringe_at(p.first, i), b = fringe_at(p.second, i);
            if (a.amplitude < 12 || b.amplitude < 12) continue;
            const double beat = b.turns - a.turns - std::floor(b.turns - a.turns), off = n * beat - a.turns;
            squares += std::pow(off - std::round(off), 2);
            ++count;
        }
        const double rms = std::sqrt(squares / std::max(1, count));
        if (count > 100 && rms < best.second) best = {n, rms};
    }
    return best;
}

DecodedView decode(const Pictures& p, int periods) {
    DecodedView view;
    view.width = p.white.width;
    view.height = p.white.height;
    const std::size_t count = p.white.pixels.size();
    view.column.assign(count, NAN);
    view.sigma_px.assign(count, NAN);
    constexpr double kNoise_grey = 1, kSureOfOrder = 0.25;  // periods between beat and phase
    for (std::size_t i = 0; i < count; ++i) {
        const Fringe a = fringe_at(p.first, i), b = fringe_at(p.second, i);
        if (p.white.pixels[i] >= 254)
            ++view.saturated;
        else if (a.amplitude < kLeastAmplitude_grey || b.amplitude < kLeastAmplitude_grey)
            ++view.dark;
        else {
            const double beat = b.turns - a.turns - std::floor(b.turns - a.turns), wanted = periods * beat - a.turns;
            const double order = std::round(wanted);
            if (std::abs(wanted - order) > kSureOfOrder) {
                ++view.uncertain;
                continue;
            }
            const double column = kPeriod_px * (order + a.turns);
            view.column[i] = static_cast<float>(periods > 0 ? column : kPeriod_px * std::abs(periods) + column);
            view.sigma_px[i] = static_cast<float>(kPeriod_px / (2 * std::numbers::pi) * std::sqrt(2.0 / kSteps) *
                                                  kNoise_grey / a.amplitude);
            ++view.decoded;
        }
    }
    return view;
}

RigCalibration chosen_rig(int width, int height) {
    RigCalibration rig;
    rig.left_camera.width = width;
    rig.left_camera.height = height;
    rig.left_camera.focal_x = rig.left_camera.focal_y = kChosenFocal_px;
    rig.left_camera.centre_x = (width - 1) / 2.0;
    rig.left_camera.centre_y = (height - 1) / 2.0;
    rig.right_camera = rig.left_camera;
    rig.right_camera.device_from_rig.translation().x() = -kChosenBaseline_mm;
    return rig;
}

/// rms distance of points from the plane through their neighbours in the picture (about 3 mm), by the median of its
/// size.
double roughness_mm(const PointCloud& cloud) {
    std::vector<double> sizes;
    const std::size_t n = cloud.size();
    for (std::size_t i = 0; i < n; i += 1 + n / 2000) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
        int near = 0;
        for (const auto& q : cloud.points_in_rig) {
            const Eigen::Vector3d d = q - cloud.points_in_rig[i];
            if (d.squaredNorm() > 9 || d.squaredNorm() == 0) continue;
            sum += d;
            squares += d * d.transpose();
            ++near;
        }
        if (near < 8) continue;
        const Eigen::Vector3d mean = sum / near;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / near - mean * mean.transpose());
        sizes.push_back(std::abs(solver.eigenvectors().col(0).dot(mean)));
    }
    if (sizes.empty()) return 0;
    return 1.4826 * median(sizes);
}

RgbImage picture_of(const PointCloud& cloud) {
    std::vector<double> depth;
    for (const auto& p : cloud.points_in_rig) depth.push_back(p.z());
    std::vector<double> sorted = depth;
    std::sort(sorted.begin(), sorted.end());
    const double low = sorted[sorted.size() / 50], high = sorted[sorted.size() - 1 - sorted.size() / 50];
    std::vector<Rgb> colours;
    for (const double z : depth) colours.push_back(sequential_colour((high - z) / (high - low)));
    std::vector<RgbImage> views;
    for (const double turned : {-0.6, 0.0, 0.6})
        views.push_back(draw_cloud(
            cloud, colours, Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitY()).toRotationMatrix(), 1.2, 205, 262, 1));
    return with_legend(side_by_side(views, 3), "far to near; the scale is chosen, not known", 0, 1, sequential_colour);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: show_phase_stereo FOLDER OUT\n");
        return static_cast<int>(ExitCode::usage);
    }
    try {
        const Pictures left = read_pictures(argv[1], 0), right = read_pictures(argv[1], 1);
        const auto [periods, disagree] = periods_of(left);
        const auto [periods_right, disagree_right] = periods_of(right);
        fmt::print("periods in one beat: {} (rms {:.3f} of a period) left, {} ({:.3f}) right\n", periods, disagree,
                   periods_right, disagree_right);
        const DecodedView left_view = decode(left, periods), right_view = decode(right, periods);
        for (const auto& [name, v] : {std::pair{"left", &left_view}, std::pair{"right", &right_view}})
            fmt::print("{}: decoded {}, dark {}, saturated {}, uncertain {}\n", name, v->decoded, v->dark, v->saturated,
                       v->uncertain);
        RigCalibration rig = chosen_rig(left_view.width, left_view.height);
        const int width = static_cast<int>(kPeriod_px) * std::abs(periods);
        const Triangulation raw = triangulate_cameras(left_view, right_view, rig, width, left_view.height);
        rig.projector = rig.left_camera;
        const OutlierReport clean = remove_outliers(raw, rig);
        fmt::print(
            "points {} (no partner {}, ragged {}, outside {}); kept {} (jump {}, grazing {}, small pieces {}, lonely "
            "{}, "
            "thinned {})\n",
            raw.cloud.size(), raw.no_partner, raw.ragged, raw.outside_volume, clean.kept.size(), clean.jump,
            clean.grazing, clean.small_piece, clean.lonely, clean.thinned);
        Eigen::AlignedBox3d box;
        for (const auto& p : clean.kept.points_in_rig) box.extend(p);
        fmt::print(
            "chosen: focal length {} px, cameras {} mm apart; then {:.0f} x {:.0f} x {:.0f} mm, roughness {:.3f} mm\n",
            kChosenFocal_px, kChosenBaseline_mm, box.sizes().x(), box.sizes().y(), box.sizes().z(),
            roughness_mm(clean.kept));
        fs::create_directories(argv[2]);
        write_cloud(clean.kept, fs::path(argv[2]) / "cloud.ply");
        write_png(picture_of(clean.kept), fs::path(argv[2]) / "cloud.png");
        return 0;
    } catch (const Error& error) {
        fmt::print(stderr, "{} {}\n", error.what(), error.remedy);
        return static_cast<int>(error.exit_code);
    }
}
