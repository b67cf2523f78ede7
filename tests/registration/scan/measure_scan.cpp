// Measures a scan of a sphere (radius 80 mm) in the room of the tests, in the paper's set-up and in a modern one.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "tests/registration/scan/stripe_room.h"

using namespace planlight;
using namespace planlight::stripe_room;

namespace {

void measure(const char* name, const Room& room, const Eigen::Vector3d& centre, double radius) {
    const ScanCapture shot = capture(room, stripes_of(room));
    const RigCalibration rig = rig_of(room);
    ScanResult best = scan_from_capture(shot, rig);
    for (int k = 0; k < 4; ++k) {
        const ScanResult again = scan_from_capture(shot, rig);
        best.sequence_s = std::min(best.sequence_s, again.sequence_s);
        best.decode_s = std::min(best.decode_s, again.decode_s);
        best.triangulate_s = std::min(best.triangulate_s, again.triangulate_s);
        best.outliers_s = std::min(best.outliers_s, again.outliers_s);
    }
    const Truth truth = truth_of(room, room.left);
    std::vector<double> errors;
    double bias = 0;
    std::size_t wrong = 0, lit = 0;
    for (std::size_t i = 0; i < truth.code.size(); ++i) {
        if (!std::isnan(truth.code[i].x())) ++lit;
        if (std::isnan(best.left.column[i])) continue;
        const double e = best.left.column[i] - truth.code[i].x();
        if (!(std::abs(e) < 2)) {
            ++wrong;
            continue;
        }
        bias += e;
        errors.push_back(std::abs(e));
    }
    bias /= static_cast<double>(errors.size());
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    double sum = 0, squares = 0;
    for (const auto& p : best.raw.cloud.points_in_rig) {
        const double e = (p - centre).norm() - radius;
        sum += e;
        squares += e * e;
    }
    const auto n = static_cast<double>(best.raw.cloud.size());
    fmt::print("{}: left decoded {} of {} lit, dark {}, saturated {}, uncertain {}, noise {:.2f} grey\n", name,
               best.left.decoded, lit, best.left.dark, best.left.saturated, best.left.uncertain, best.left.noise_grey);
    fmt::print("  code: median error {:.4f} px, bias {:+.5f} px, wrong or unlit {}\n", errors[errors.size() / 2], bias,
               wrong);
    fmt::print(
        "  points {} (three views {}, two {}), stride {} x {}, no partner {}, ragged {}, disagree {}, outside {}\n",
        best.raw.cloud.size(), best.raw.three_view, best.raw.two_view, best.raw.stride.x, best.raw.stride.y,
        best.raw.no_partner, best.raw.ragged, best.raw.disagree, best.raw.outside_volume);
    fmt::print("  sphere: mean {:+.4f} mm, rms {:.4f} mm; projector off {:.3f} {:.3f} px, epipolar {:.3f} px\n",
               sum / n, std::sqrt(squares / n), best.raw.projector_offset_px.x(), best.raw.projector_offset_px.y(),
               best.raw.epipolar_rms_px);
    fmt::print("  kept {}, jump {}, grazing {}, small {}, lonely {}, thinned {}\n", best.clean.kept.size(),
               best.clean.jump, best.clean.grazing, best.clean.small_piece, best.clean.lonely, best.clean.thinned);
    fmt::print("  best of 5: sequence {:.1f} ms, decode {:.1f} ms, triangulate {:.1f} ms, outliers {:.1f} ms\n",
               1e3 * best.sequence_s, 1e3 * best.decode_s, 1e3 * best.triangulate_s, 1e3 * best.outliers_s);
}

}  // namespace

int main(int argc, char**) {
    const Eigen::Vector3d centre(120, -40, 360);
    measure("paper", paper_room(sphere(centre, 80)), centre, 80);
    if (argc < 2) measure("modern", modern_room(sphere(centre, 80)), centre, 80);
}
