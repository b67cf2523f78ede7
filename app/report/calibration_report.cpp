#include "app/report/calibration_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/json_text.h"
#include "planning_io/case/rig_file.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr const char* kKeys[] = {"left_camera", "right_camera", "projector"};

/// One standard deviation of a device's lens numbers, in the order of `numbers_of`.
std::vector<double> lens_sigmas(const BundleResult& bundle, DeviceName wanted) {
    Eigen::Index at = 0;
    for (const DeviceName name : kDevices) {
        if (!bundle.rig.device(name)) continue;
        if (name == wanted) {
            std::vector<double> sigmas;
            for (Eigen::Index i = 0; i < 9; ++i)
                sigmas.push_back(std::sqrt(std::max(0.0, bundle.covariance(at + i, at + i))));
            return sigmas;
        }
        at += name == DeviceName::left_camera ? 9 : 15;
    }
    return {};
}

/// Dark blue, green, red.
Rgb heat(double share) {
    const double s = std::clamp(share, 0.0, 1.0);
    const auto mix = [](double a, double b, double t) {
        return static_cast<std::uint8_t>(std::lround(a + (b - a) * t));
    };
    if (s < 0.5) return {mix(20, 54, 2 * s), mix(60, 214, 2 * s), mix(160, 138, 2 * s)};
    return {mix(54, 255, 2 * s - 1), mix(214, 80, 2 * s - 1), mix(138, 70, 2 * s - 1)};
}

Rgb colour_of_pose(std::size_t pose, std::size_t poses) {
    return heat(static_cast<double>(pose) / static_cast<double>(poses));
}

/// Where the board's corners, or the light on it, lay in a device's picture.
RgbImage coverage(const CalibrationReport& report, DeviceName name) {
    const CameraModel& d = *report.calibration.device(name);
    const double shrink = 640.0 / d.width;
    RgbImage picture(640, std::max(1, static_cast<int>(d.height * shrink)), {255, 255, 255});
    const auto dot = [&](const Eigen::Vector2d& p, Rgb colour) {
        const int x = static_cast<int>(p.x() * shrink), y = static_cast<int>(p.y() * shrink);
        const int r = name == DeviceName::projector ? 1 : 2;
        for (int j = -r; j <= r; ++j)
            for (int i = -r; i <= r; ++i)
                if (x + i >= 0 && y + j >= 0 && x + i < picture.width && y + j < picture.height)
                    picture.at(x + i, y + j) = colour;
    };
    for (std::size_t k = 0; k < report.poses.size(); ++k) {
        const Rgb colour = colour_of_pose(k, report.poses.size());
        if (name == DeviceName::projector) {
            for (const LightSample& sample : report.poses[k].left.light) dot(sample.pixel_in_projector, colour);
            for (const LightSample& sample : report.poses[k].right.light) dot(sample.pixel_in_projector, colour);
        } else {
            for (const auto& p : view_of(report.poses[k], name).corners.pixels) dot(p, colour);
        }
    }
    return picture;
}

const std::string& serial_of(const DeviceSerials& serials, DeviceName name) {
    if (name == DeviceName::projector) return serials.projector;
    return name == DeviceName::left_camera ? serials.left_camera : serials.right_camera;
}

DocumentTable devices_of(const CalibrationReport& report) {
    const Calibration& c = report.calibration;
    using Kind = DocumentTable::Kind;
    DocumentTable table{{{"Device", Kind::figure},
                         {"Serial"},
                         {"Picture", Kind::figure},
                         {"Held-out poses", Kind::figure},
                         {"All poses", Kind::figure},
                         {"Left out", Kind::figure},
                         {"Focal length", Kind::figure},
                         {"Optical axis", Kind::figure}},
                        {}};
    for (const DeviceName name : kDevices) {
        const auto& d = c.device(name);
        if (!d) continue;
        const auto i = static_cast<std::size_t>(name);
        const std::string& serial = serial_of(report.serials, name);
        const auto sigma = lens_sigmas(c.bundle, name);
        const double all = static_cast<double>(c.bundle.used[i] + c.bundle.left_out[i]);
        table.rows.push_back(
            {{text_of(name)},
             {serial.empty() ? "not given" : serial},
             {fmt::format("{} x {}", d->width, d->height)},
             {fmt::format("{:.3f} px", c.held_out.rms_px[i])},
             {fmt::format("{:.3f} px", c.bundle.rms_px[i])},
             {fmt::format("{:.1f} %", all > 0 ? 100 * static_cast<double>(c.bundle.left_out[i]) / all : 0)},
             {fmt::format("{:.2f} ± {:.2f} px", d->focal_x, sigma[0])},
             {fmt::format("{:.2f}, {:.2f} ± {:.2f} px", d->centre_x, d->centre_y, sigma[2])}});
    }
    return table;
}

/// How far a layer of the volume's grid is from the projector (or the left camera).
double depth_mm(const Calibration& c, int layer) {
    const auto& from =
        c.device(DeviceName::projector) ? *c.device(DeviceName::projector) : *c.device(DeviceName::left_camera);
    return (from.device_from_rig *
            c.volume->points[static_cast<std::size_t>(layer * c.volume->grid[0] * c.volume->grid[1])])
        .z();
}

PageVerdict verdict_of(const Calibration& c) {
    if (c.warnings.empty()) return {PageVerdict::Kind::good, "Calibrated without a warning.", {}};
    return {PageVerdict::Kind::look,
            fmt::format("Calibrated with {} warning{}.", c.warnings.size(), c.warnings.size() == 1 ? "" : "s"),
            c.warnings};
}

/// The colours of `heat` with 0, half and all of what they stand for.
DocumentScale scale_of(double full_mm) {
    return {
        {heat(0), heat(0.5), heat(1)},
        {{0, "0 mm"}, {0.5, fmt::format("{:.3f} mm", 0.5 * full_mm)}, {1, fmt::format("{:.3f} mm and more", full_mm)}}};
}

/// Which colour in the pictures is which pose.
DocumentKey key_of_poses(const CalibrationReport& report) {
    DocumentKey key;
    for (std::size_t k = 0; k < report.poses.size(); ++k)
        key.colours.emplace_back(colour_of_pose(k, report.poses.size()), report.poses[k].name);
    return key;
}

}  // namespace

std::vector<RgbImage> volume_pictures(const VolumeError& volume, double full_scale_mm) {
    constexpr int kCell = 40;
    const auto& [across, down, deep] = volume.grid;
    std::vector<RgbImage> pictures;
    for (int z = 0; z < deep; ++z) {
        RgbImage picture(across * kCell, down * kCell, {225, 228, 232});
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) {
                const auto i = static_cast<std::size_t>((z * down + y / kCell) * across + x / kCell);
                if (volume.seen[i]) picture.at(x, y) = heat(volume.sigma_mm[i] / full_scale_mm);
            }
        pictures.push_back(std::move(picture));
    }
    return pictures;
}

std::vector<std::string> changes_since(const RigCalibration& before, const RigCalibration& now) {
    const auto baseline = [](const RigCalibration& rig) {
        return (rig.left_camera.centre_in_rig() - rig.right_camera.centre_in_rig()).norm();
    };
    const auto projector_from_left = [](const RigCalibration& rig) {
        return rig.projector.device_from_rig * rig.left_camera.device_from_rig.inverse();
    };
    const RigidTransform moved = projector_from_left(now) * projector_from_left(before).inverse();
    std::vector<std::string> changes{
        fmt::format("Cameras {:.2f} mm apart; {:+.2f} mm since {}.", baseline(now), baseline(now) - baseline(before),
                    before.made_on),
        fmt::format("Projector moved by {:.2f} mm and turned by {:.3f} degrees against the left camera since then.",
                    moved.translation().norm(),
                    std::acos(std::clamp((moved.linear().trace() - 1) / 2, -1.0, 1.0)) * 180 / std::numbers::pi)};
    const auto exchanged = [&](const char* name, const std::string& was, const std::string& is) {
        if (!was.empty() && !is.empty() && was != is)
            changes.push_back(fmt::format("The {} is another one: {}, was {}.", name, is, was));
    };
    exchanged("left camera", before.serials.left_camera, now.serials.left_camera);
    exchanged("right camera", before.serials.right_camera, now.serials.right_camera);
    exchanged("projector", before.serials.projector, now.serials.projector);
    return changes;
}

std::string calibration_summary(const CalibrationReport& report) {
    const Calibration& c = report.calibration;
    std::string text = fmt::format("{} of {} poses.\n", c.bundle.rig.poses(), report.poses.size());
    for (const DeviceName name : kDevices)
        if (c.device(name))
            text += fmt::format("  {:<12} {:.3f} px on held-out poses\n", text_of(name),
                                c.held_out.rms_px[static_cast<std::size_t>(name)]);
    if (c.held_out.lengths > 0)
        text += fmt::format(
            "  lengths      {:.3f} mm a 200 mm, {:+.3f} common to all, if the square is {:g} mm: nothing else can "
            "tell\n",
            c.held_out.length_rms_mm, c.held_out.length_mean_mm, report.board.square_mm);
    if (c.volume)
        text += fmt::format("  points       {:.3f} mm (95 % of the working volume, one sigma, from the rig alone)\n",
                            c.volume->p95_mm);
    for (const std::string& change : report.changes) text += "  " + change + "\n";
    return text +
           (report.rig_file.empty()
                ? std::string(
                      "No rig file: that needs a second camera or a projector. The camera found is in the report: ")
                : report.rig_file.string() + "; the report: ");
}

namespace {

/// Of nothing there is no figure: null, not a perfect 0.
Json if_any(std::size_t count, double value) {
    return count > 0 ? Json(value) : Json();
}

}  // namespace

std::string calibration_json(const CalibrationReport& report) {
    const Calibration& c = report.calibration;
    Json json = {{"format", "planlight calibration"},   {"version", 1},
                 {"made_on", report.made_on},           {"board", text_of(report.board)},
                 {"poses", c.bundle.rig.poses()},       {"poses_given", report.poses.size()},
                 {"rig_file", report.rig_file.string()}};
    for (const DeviceName name : kDevices) {
        const auto& d = c.device(name);
        if (!d) continue;
        const auto i = static_cast<std::size_t>(name);
        Json device = Json::parse(as_json(*d));
        if (const std::string& serial = serial_of(report.serials, name); !serial.empty()) device["serial"] = serial;
        device["lens_sigmas"] = lens_sigmas(c.bundle, name);
        device["held_out_rms_px"] = if_any(c.held_out.used[i], c.held_out.rms_px[i]);
        device["rms_px"] = if_any(c.bundle.used[i], c.bundle.rms_px[i]);
        device["used"] = c.bundle.used[i];
        device["left_out"] = c.bundle.left_out[i];
        json["devices"][kKeys[i]] = device;
    }
    json["board_bend_mm"] = {c.bundle.rig.bend_mm.x(), c.bundle.rig.bend_mm.y(), c.bundle.rig.bend_mm.z()};
    json["lengths"] = {{"count", c.held_out.lengths},
                       {"rms_mm_at_200", if_any(c.held_out.lengths, c.held_out.length_rms_mm)},
                       {"mean_mm_at_200", if_any(c.held_out.lengths, c.held_out.length_mean_mm)}};
    json["predicted_error"] = nullptr;
    if (c.volume)
        json["predicted_error"] = {
            {"median_mm", c.volume->median_mm},
            {"p95_mm", c.volume->p95_mm},
            {"worst_mm", c.volume->worst_mm},
            {"light_p95_mm", c.volume->light_p95_mm > 0 ? Json(c.volume->light_p95_mm) : Json()}};
    json["residuals"] = Json::array();
    for (const PoseResidual& r : c.bundle.residuals)
        json["residuals"].push_back({{"pose", report.poses[r.pose].name},
                                     {"device", kKeys[static_cast<std::size_t>(r.device)]},
                                     {"rms_px", if_any(r.used, r.rms_px)},
                                     {"used", r.used},
                                     {"left_out", r.left_out}});
    json["warnings"] = c.warnings;
    json["changes"] = report.changes;
    return json_text(json) + "\n";
}

namespace {

void add_devices(const CalibrationReport& report, std::vector<DocumentBlock>& blocks) {
    const HeldOut& held_out = report.calibration.held_out;
    blocks.push_back(DocumentHeading{"Devices"});
    blocks.push_back(devices_of(report));
    blocks.push_back(DocumentText{
        "Difference between where a corner (for the projector: the light on the board) is and where the rig "
        "says, root mean square, on poses that the calibration had not seen. Behind ±: one standard "
        "deviation.",
        Tone::quiet});
    if (held_out.lengths > 0)
        blocks.push_back(DocumentText{fmt::format(
            "{} lengths on held-out boards: {:.3f} mm a 200 mm root mean square, {:+.3f} mm of it common to all. All "
            "lengths are by the board's square of {:g} mm, as it was said: were it another, every scan would be too "
            "large or too small by as much, and nothing here would show it. Measure ten squares with a calliper.",
            held_out.lengths, held_out.length_rms_mm, held_out.length_mean_mm, report.board.square_mm)});
    for (const std::string& change : report.changes) blocks.push_back(DocumentText{change});
}

void add_volume(const Calibration& c, std::vector<DocumentBlock>& blocks) {
    const double full = std::max(0.02, std::ceil(c.volume->worst_mm * 50) / 50);
    std::vector<ReportPicture> pictures;
    int depth = 0;
    for (RgbImage& picture : volume_pictures(*c.volume, full))
        pictures.push_back({fmt::format("{:.0f} mm away", depth_mm(c, depth++)), "", std::move(picture)});
    blocks.push_back(DocumentHeading{"Predicted error over the working volume"});
    blocks.push_back(DocumentText{fmt::format(
        "What the rig's own uncertainty does to a scanned point, one standard deviation: median {:.3f}, 95 % {:.3f}, "
        "worst {:.3f} mm. Where light lands that is sent to a point: 95 % {:.3f} mm. Seen from the projector, nearest "
        "first; grey: not seen.",
        c.volume->median_mm, c.volume->p95_mm, c.volume->worst_mm, c.volume->light_p95_mm)});
    blocks.push_back(scale_of(full));
    blocks.push_back(figures_of(pictures, 5));
}

ReportFacts facts_of(const CalibrationReport& report) {
    ReportFacts facts{{"Rig", report.rig_file.empty() ? "no rig file" : report.rig_file.filename().string()},
                      {"Calibrated", report.made_on},
                      {"Board", text_of(report.board)},
                      {"Poses", fmt::format("{} of {}", report.calibration.bundle.rig.poses(), report.poses.size())}};
    for (const DeviceName name : kDevices)
        if (const std::string& serial = serial_of(report.serials, name); !serial.empty())
            facts.emplace_back(text_of(name), "serial " + serial);
    return facts;
}

}  // namespace

Document calibration_document(const CalibrationReport& report) {
    const Calibration& c = report.calibration;
    Document document{"Calibration"};
    document.verdict = verdict_of(c);
    document.facts = with_program(facts_of(report));
    add_devices(report, document.blocks);
    if (c.volume) add_volume(c, document.blocks);
    std::vector<ReportPicture> where;
    for (const DeviceName name : kDevices)
        if (c.device(name))
            where.push_back(
                {text_of(name), "A colour a pose. Where no board was, the lens is guessed.", coverage(report, name)});
    document.blocks.push_back(DocumentHeading{"Where the board was"});
    document.blocks.push_back(key_of_poses(report));
    document.blocks.push_back(figures_of(where, 3));
    document.signed_by = {"Read and accepted by"};
    document.foot = foot_of_program();
    return document;
}

}  // namespace planlight
