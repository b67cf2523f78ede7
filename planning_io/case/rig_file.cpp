#include "planning_io/case/rig_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "planning_io/case/rig_json.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "planlight rig";
constexpr int kVersion = 1;
constexpr const char* kCalibrate = "Calibrate the rig again.";

void check_device(const CameraModel& d, const std::string& name, const fs::path& file) {
    const auto refuse = [&](const std::string& problem) { throw InputError(file, name + " " + problem, kCalibrate); };
    if (d.width < 1 || d.height < 1) refuse("has no pixels");
    const double diagonal = std::hypot(d.width, d.height);
    for (const double focal : {d.focal_x, d.focal_y})
        if (!(focal > 0.05 * diagonal) || !(focal < 500 * diagonal))
            refuse("has a focal length of " + Json(focal).dump() + " pixels, which cannot be");
    if (!(std::max(d.focal_x, d.focal_y) < 2 * std::min(d.focal_x, d.focal_y)))
        refuse("has pixels twice as wide as high, or the other way round");
    for (const double c : {d.centre_x, d.centre_y, d.k1, d.k2, d.p1, d.p2, d.k3})
        if (!std::isfinite(c)) refuse("has a number that is not finite");
    if (!is_rigid(d.device_from_rig.matrix())) refuse("has a device_from_rig that is not a rotation and a translation");
    if (d.device_from_rig.translation().norm() > 1e5) refuse("stands more than 100 m from the rig's origin");
    if (!undistort(d, {(d.width - 1) / 2.0, (d.height - 1) / 2.0}))
        refuse("has a lens distortion that folds the middle of its picture");
}

void check_pair(const CameraModel& a, const CameraModel& b, const std::string& names, const fs::path& file) {
    const double apart_mm = (a.centre_in_rig() - b.centre_in_rig()).norm();
    if (!(apart_mm > 5))
        throw InputError(file, fmt::format("{} stand {:.2g} mm apart, at one place", names, apart_mm),
                         "Give positions in mm, or calibrate the rig again.");
    const Eigen::Vector3d view_a = a.device_from_rig.linear().row(2), view_b = b.device_from_rig.linear().row(2);
    if (!(view_a.dot(view_b) > 0)) throw InputError(file, names + " look away from each other", kCalibrate);
}

void check_rig(const RigCalibration& rig, const fs::path& file) {
    check_device(rig.left_camera, "left_camera", file);
    const bool right = present(rig.right_camera), light = present(rig.projector);
    if (!right && !light)
        throw InputError(file, "has a camera and nothing else",
                         "A rig needs a second camera or a projector: calibrate with it.");
    if (right) {
        check_device(rig.right_camera, "right_camera", file);
        check_pair(rig.left_camera, rig.right_camera, "left_camera and right_camera", file);
    }
    if (light) {
        check_device(rig.projector, "projector", file);
        check_pair(rig.left_camera, rig.projector, "left_camera and projector", file);
    }
    if (right && light) check_pair(rig.right_camera, rig.projector, "right_camera and projector", file);
    if (!std::isfinite(rig.reprojection_rms_px) || rig.reprojection_rms_px < 0)
        throw InputError(file, "has a senseless reprojection_rms_px", kCalibrate);
}

}  // namespace

std::string text_of(const RigCalibration& rig, const fs::path& file) {
    check_rig(rig, file);
    Json json{{"format", kFormat},
              {"version", kVersion},
              {"made_on", rig.made_on},
              {"reprojection_rms_px", rig.reprojection_rms_px},
              {"left_camera", json_of(rig.left_camera, rig.serials.left_camera)}};
    if (present(rig.right_camera)) json["right_camera"] = json_of(rig.right_camera, rig.serials.right_camera);
    if (present(rig.projector)) json["projector"] = json_of(rig.projector, rig.serials.projector);
    return dump(json);
}

void write_rig(const RigCalibration& rig, const fs::path& file) {
    write_safely(file, text_of(rig, file));
}

RigCalibration read_rig(const fs::path& file) {
    const RigCalibration rig = read_partial_rig(file);
    if (!rig.whole())
        throw InputError(file,
                         fmt::format("has no {}; this needs both cameras and the projector",
                                     present(rig.projector) ? "right_camera" : "projector"),
                         "Calibrate the whole rig; a rig of two devices is for `scan`.");
    return rig;
}

RigCalibration read_partial_rig(const fs::path& file) {
    return rig_of_text(read_whole(file), file);
}

RigCalibration rig_of_text(const std::string& text, const fs::path& file) {
    const Json json = parse_json(text, file);
    const JsonValue root(json, file);
    check_format(root, kFormat, kVersion, file);
    root.has_only({"format", "version", "made_on", "reprojection_rms_px", "left_camera", "right_camera", "projector"});
    RigCalibration rig;
    rig.left_camera = camera_model_of(root.at("left_camera"));
    rig.serials.left_camera = serial_of(root.at("left_camera"));
    if (const auto right = root.find("right_camera")) {
        rig.right_camera = camera_model_of(*right);
        rig.serials.right_camera = serial_of(*right);
    }
    if (const auto light = root.find("projector")) {
        rig.projector = camera_model_of(*light);
        rig.serials.projector = serial_of(*light);
    }
    rig.made_on = root.at("made_on").text();
    rig.reprojection_rms_px = root.at("reprojection_rms_px").number();
    check_rig(rig, file);
    return rig;
}

std::string hash_of(const RigCalibration& rig) {
    ContentHash hash;
    hash.add("planlight rig 1");
    for (const CameraModel* d : {&rig.left_camera, &rig.right_camera, &rig.projector}) {
        const std::array<double, 11> numbers{static_cast<double>(d->width),
                                             static_cast<double>(d->height),
                                             d->focal_x,
                                             d->focal_y,
                                             d->centre_x,
                                             d->centre_y,
                                             d->k1,
                                             d->k2,
                                             d->p1,
                                             d->p2,
                                             d->k3};
        hash.add_values(numbers.data(), numbers.size());
        hash.add_values(d->device_from_rig.matrix().data(), 16);
    }
    return hash.hex();
}

RigName name_of(const RigCalibration& rig) {
    return {hash_of(rig), rig.made_on, rig.serials};
}

std::string as_json(const CameraModel& device) {
    return json_of(device).dump();
}

}  // namespace planlight
