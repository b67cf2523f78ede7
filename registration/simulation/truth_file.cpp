#include "registration/simulation/truth_file.h"

#include <nlohmann/json.hpp>

namespace planlight::simulation {

using nlohmann::json;

namespace {

json vector_json(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

/// Four rows of four.
json matrix_json(const RigidTransform& t) {
    json rows = json::array();
    for (int r = 0; r < 4; ++r)
        rows.push_back({t.matrix()(r, 0), t.matrix()(r, 1), t.matrix()(r, 2), t.matrix()(r, 3)});
    return rows;
}

json device_json(const CameraModel& d) {
    return {{"width", d.width},
            {"height", d.height},
            {"focal_x", d.focal_x},
            {"focal_y", d.focal_y},
            {"centre_x", d.centre_x},
            {"centre_y", d.centre_y},
            {"k1", d.k1},
            {"k2", d.k2},
            {"p1", d.p1},
            {"p2", d.p2},
            {"k3", d.k3},
            {"device_from_rig", matrix_json(d.device_from_rig)}};
}

json rig_json(const RigCalibration& rig) {
    return {{"left_camera", device_json(rig.left_camera)},
            {"right_camera", device_json(rig.right_camera)},
            {"projector", device_json(rig.projector)},
            {"reprojection_rms_px", rig.reprojection_rms_px}};
}

json things_json(const ThingsSettings& s) {
    json names = json::array();
    if (s.drape_behind) names.push_back("drape-behind");
    if (s.drape_hole) names.push_back("drape-hole");
    if (s.hair) names.push_back("hair");
    if (s.hand) names.push_back("hand");
    if (s.tube) names.push_back("tube");
    if (s.retractor) names.push_back("retractor");
    return names;
}

}  // namespace

std::string rig_as_json(const RigCalibration& rig) {
    return rig_json(rig).dump();
}

std::string as_json(const TruthNumbers& truth) {
    json markers = json::array();
    for (std::size_t i = 0; i < truth.markers_in_ct.size(); ++i)
        markers.push_back({{"centre_in_ct", vector_json(truth.markers_in_ct[i])},
                           {"normal_in_ct", vector_json(truth.marker_normals_in_ct[i])},
                           {"covered", static_cast<bool>(truth.markers_covered[i])}});
    const RoomSettings& s = truth.settings;
    const json text = {{"format", "planlight-truth"},
                       {"version", 1},
                       {"preset", s.preset == Preset::paper ? "paper" : "modern"},
                       {"seed", s.seed},
                       {"skin_threshold_hu", s.skin_threshold_hu},
                       {"ambient", s.ambient},
                       {"noise", s.noise},
                       {"things", things_json(s.things)},
                       {"wet", s.wet},
                       {"calibration_error", s.calibration_error},
                       {"projector_delay_s", seconds(s.projector_delay)},
                       {"speed_mm_s", s.motion.speed_mm_s},
                       {"at_s", seconds(truth.at)},
                       {"rig_from_ct", matrix_json(truth.rig_from_ct)},
                       {"markers", markers},
                       {"marker_disc_diameter_mm", 8},
                       {"true_rig", rig_json(truth.true_rig)},
                       {"calibration", rig_json(truth.calibration)},
                       {"camera_blur_px", {truth.left_blur_px, truth.right_blur_px}},
                       {"gain", truth.gain}};
    return text.dump(2);
}

}  // namespace planlight::simulation
