// What is noticed of a patient who moves during the scan: measure_movement [SEED] [ROOMS] [paper|modern]. Each room is
// scanned five times, at rest and at four speeds. Printed: the true way of the skin near the markers against what is
// said.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "registration/tracking/markers_in_scan.h"
#include "tests/registration/scan/random_rooms.h"

using namespace planlight;
using namespace planlight::scan_rooms;
using simulation::SimulatedRig;

namespace {

/// The greatest way of a marker between two moments of the scan.
double true_way_mm(const SimulatedRig& room, const ScanCapture& capture) {
    constexpr int kMoments = 40;
    double moved = 0;
    std::vector<RigidTransform> poses;
    for (int k = 0; k <= kMoments; ++k)
        poses.push_back(room.true_rig_from_ct(capture.began + (capture.ended - capture.began) * k / kMoments));
    for (std::size_t i = 0; i < poses.size(); ++i)
        for (std::size_t j = i + 1; j < poses.size(); ++j)
            for (const auto& m : room.true_markers_in_ct())
                moved = std::max(moved, (poses[j] * m - poses[i] * m).norm());
    return moved;
}

struct Bin {
    double from, to;
    int scans = 0, markers = 0, noticed = 0, noticed_by_pictures = 0;
    double worst_off = 0, worst_off_pictures = 0, bias_pictures = 0, error_mm = 0;
};

}  // namespace

int main(int argc, char** argv) {
    try {
        const unsigned seed = argc > 1 ? static_cast<unsigned>(std::stoul(argv[1])) : 1;
        const unsigned rooms = argc > 2 ? static_cast<unsigned>(std::stoul(argv[2])) : 2;
        const auto preset =
            argc > 3 && std::string(argv[3]) == "modern" ? simulation::Preset::modern : simulation::Preset::paper;
        constexpr double kLimit_mm = 0.15;
        const Volume head = read_volume("/usr/share/doc/invesalius-examples/examples/Cranium.inv3");
        std::array<Bin, 7> bins{
            {{0, 1e-9}, {1e-9, 0.1}, {0.1, 0.15}, {0.15, 0.2}, {0.2, 0.35}, {0.35, 0.7}, {0.7, 1e9}}};
        for (unsigned k = 0; k < rooms; ++k)
            for (const double speed_mm_s : {0.0, 0.1, 0.2, 0.4, 1.2}) {
                SimulatedRig room(head, {}, random_room(preset, seed + k));
                if (speed_mm_s > 0) {
                    room.set_motion({speed_mm_s, room.clock().now()});
                    room.wait(std::chrono::seconds(1 + k % 5));
                }
                const ScanCapture capture = capture_of(room);
                const double truth = true_way_mm(room, capture);
                const ScanResult scan = scan_from_capture(capture, room.calibration());
                const ScanMovement markers = movement_of_markers(capture, room.calibration());
                const ScanMovement pictures =
                    movement_in_pictures(capture, mm_per_pixel(scan.clean.kept, room.calibration().left_camera),
                                         mm_per_pixel(scan.clean.kept, room.calibration().right_camera));
                auto errors = room.scan_errors_mm(scan.clean.kept.points_in_rig, capture.began);
                for (double& e : errors) e = std::abs(e);
                std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                                 errors.end());
                fmt::print(stderr,
                           "{} room {} {:.2f} mm/s: true {:.3f}, markers {:.3f} ({} of {} moments), pictures {:.3f}, "
                           "cloud {:.3f}\n",
                           name_of(preset), seed + k, speed_mm_s, truth, markers.moved_mm, markers.markers,
                           markers.moments, pictures.moved_mm, errors[errors.size() / 2]);
                Bin& bin = *std::find_if(bins.begin(), bins.end(),
                                         [&](const Bin& b) { return truth >= b.from && truth < b.to; });
                ++bin.scans;
                const bool by_markers = markers.by == ScanMovement::By::markers;
                bin.markers += by_markers;
                bin.noticed += by_markers && markers.moved_mm > kLimit_mm;
                bin.noticed_by_pictures += pictures.moved_mm > kLimit_mm;
                if (by_markers) bin.worst_off = std::max(bin.worst_off, std::abs(markers.moved_mm - truth));
                bin.worst_off_pictures = std::max(bin.worst_off_pictures, std::abs(pictures.moved_mm - truth));
                bin.error_mm += errors[errors.size() / 2];
            }
        fmt::print("{}: said to have moved more than {} mm\n{:>16}{:>7}{:>12}{:>11}{:>12}{:>14}{:>12}\n",
                   name_of(preset), kLimit_mm, "true way (mm)", "scans", "by markers", "worst off", "by pictures",
                   "worst off", "cloud off");
        for (const Bin& bin : bins)
            if (bin.scans > 0)
                fmt::print("{:>16}{:>7}{:>12}{:>11.3f}{:>12}{:>14.3f}{:>12.3f}\n",
                           bin.to < 1e-8
                               ? "at rest"
                               : fmt::format("{:g} to {:g}", bin.from < 1e-8 ? 0 : bin.from, std::min(bin.to, 9.0)),
                           bin.scans, fmt::format("{} of {}", bin.noticed, bin.markers), bin.worst_off,
                           bin.noticed_by_pictures, bin.worst_off_pictures, bin.error_mm / bin.scans);
        return 0;
    } catch (const Error& error) {
        fmt::print(stderr, "{} {}\n", error.what(), error.remedy);
        return static_cast<int>(error.exit_code);
    }
}
