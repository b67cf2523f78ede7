#include "tests/registration/scan/random_rooms.h"

#include <algorithm>
#include <random>

namespace planlight::scan_rooms {

simulation::RoomSettings random_room(simulation::Preset preset, unsigned seed) {
    std::mt19937 random(seed * 7919 + 17);
    simulation::RoomSettings room;
    room.preset = preset;
    room.seed = seed;
    room.ambient = std::uniform_real_distribution<double>(0.05, 0.35)(random);
    return room;
}

Volume sphere_volume() {
    constexpr double kVoxel_mm = 1.5, kMargin_mm = 12;
    const int n = static_cast<int>(2 * (kSphereRadius_mm + kMargin_mm) / kVoxel_mm) + 1;
    Volume volume;
    volume.size = {n, n, n};
    const double low = -kVoxel_mm * (n - 1) / 2;
    volume.ct_from_voxel = Eigen::Translation3d(low, low, low) * Eigen::Scaling(kVoxel_mm);
    volume.is_hu = true;
    volume.modality = "CT";
    volume.source = "sphere";
    volume.values.resize(volume.index(0, 0, n));
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const double distance = (volume.ct_from_voxel * Eigen::Vector3d(i, j, k)).norm() - kSphereRadius_mm;
                volume.values[volume.index(i, j, k)] =
                    static_cast<float>(std::clamp(-300 - 150 * distance, -1000.0, 400.0));
            }
    return volume;
}

ScanCapture capture_of(simulation::SimulatedRig& room, const std::string& set) {
    StripeSettings stripes;
    stripes.width = room.projector().width();
    stripes.height = room.projector().height();
    if (set == "fast") stripes = fast_stripes(stripes.width, stripes.height);
    if (set.starts_with("multi"))
        stripes = multi_frequency_stripes(stripes.width, stripes.height, set == "multi-frequency");
    return capture_scan(room.projector(), room.cameras(), room.clock(), stripes);
}

std::string name_of(simulation::Preset preset) {
    return preset == simulation::Preset::paper ? "paper" : "modern";
}

}  // namespace planlight::scan_rooms
