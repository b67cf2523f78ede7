// What is wrong on purpose, and how often it is noticed: rooms of the paper's size, eight poses, seen without pictures.
// measure_refusals [SEEDS]
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "registration/calibration/calibrate_rig.h"
#include "tests/registration/calibration/ideal_board.h"

namespace planlight {
namespace {

using Poses = std::vector<PoseObservation>;

/// In the last `poses_after` poses a device stands turned.
Poses knocked_before(const test::IdealRoom& room, unsigned seed, CameraModel RigCalibration::*device, double degrees,
                     std::size_t poses_after) {
    test::IdealRoom after = room;
    const double way = seed;
    const Eigen::Vector3d axis(std::cos(way), std::sin(way), 0);
    (after.rig.*device).device_from_rig =
        Eigen::AngleAxisd(degrees * M_PI / 180, axis) * (room.rig.*device).device_from_rig;
    Poses poses = room.observe(seed);
    const Poses later = after.observe(seed);
    for (std::size_t i = poses.size() - poses_after; i < poses.size(); ++i) poses[i] = later[i];
    return poses;
}

Poses for_each_view(Poses poses, const std::function<void(PoseObservation&)>& change) {
    for (PoseObservation& pose : poses) change(pose);
    return poses;
}

}  // namespace
}  // namespace planlight

int main(int argc, char** argv) {
    using namespace planlight;
    const unsigned seeds = argc > 1 ? static_cast<unsigned>(std::stoi(argv[1])) : 10;
    const test::IdealRoom room = test::ideal_room();
    const auto knocked = [&](CameraModel RigCalibration::*device, double degrees, std::size_t poses_after = 4) {
        return [=, &room](unsigned seed) { return knocked_before(room, seed, device, degrees, poses_after); };
    };
    const std::vector<std::pair<std::string, std::function<Poses(unsigned)>>> kinds{
        {"nothing wrong", [&](unsigned seed) { return room.observe(seed); }},
        {"right camera turned by 0.01 degrees half way", knocked(&RigCalibration::right_camera, 0.01)},
        {"right camera turned by 0.02 degrees half way", knocked(&RigCalibration::right_camera, 0.02)},
        {"right camera turned by 0.1 degrees half way", knocked(&RigCalibration::right_camera, 0.1)},
        {"projector turned by 0.005 degrees half way", knocked(&RigCalibration::projector, 0.005)},
        {"projector turned by 0.01 degrees half way", knocked(&RigCalibration::projector, 0.01)},
        {"projector turned by 0.1 degrees half way", knocked(&RigCalibration::projector, 0.1)},
        {"right camera turned by 0.02 degrees before the last", knocked(&RigCalibration::right_camera, 0.02, 1)},
        {"right camera turned by 0.1 degrees before the last", knocked(&RigCalibration::right_camera, 0.1, 1)},
        {"right camera turned by 1 degree before the last", knocked(&RigCalibration::right_camera, 1, 1)},
        {"projector turned by 0.01 degrees before the last", knocked(&RigCalibration::projector, 0.01, 1)},
        {"projector turned by 0.02 degrees before the last", knocked(&RigCalibration::projector, 0.02, 1)},
        {"projector turned by 0.1 degrees before the last", knocked(&RigCalibration::projector, 0.1, 1)},
        {"projector turned by 1 degree before the last", knocked(&RigCalibration::projector, 1, 1)},
        {"left and right swapped",
         [&](unsigned seed) {
             return for_each_view(room.observe(seed), [](PoseObservation& p) { std::swap(p.left, p.right); });
         }},
        {"projector mirrored",
         [&](unsigned seed) {
             return for_each_view(room.observe(seed), [&](PoseObservation& p) {
                 for (auto* seen : {&p.left, &p.right})
                     for (LightSample& sample : seen->light)
                         sample.pixel_in_projector.x() = room.rig.projector.width - 1 - sample.pixel_in_projector.x();
             });
         }},
        {"right pictures of the next pose",
         [&](unsigned seed) {
             Poses poses = room.observe(seed);
             for (std::size_t i = 0; i + 1 < poses.size(); ++i) std::swap(poses[i].right, poses[i + 1].right);
             return poses;
         }},
    };
    for (const auto& [name, make] : kinds) {
        unsigned refused = 0;
        std::string example;
        for (unsigned seed = 1; seed <= seeds; ++seed) {
            const Calibration calibration =
                calibrate_rig(make(seed), room.board, room.rig.projector.width, room.rig.projector.height);
            if (!calibration.refusal) continue;
            ++refused;
            example = calibration.refusal->reason;
        }
        fmt::print("{:<54} refused {} of {}{}\n", name, refused, seeds, example.empty() ? "" : ": " + example);
        std::fflush(stdout);
    }
    return 0;
}
