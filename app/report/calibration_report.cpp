#include "app/report/calibration_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/json_text.h"
#include "app/report/html_page.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/safe_write.h"

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
        const Rgb colour = heat(static_cast<double>(k) / static_cast<double>(report.poses.size()));
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

std::string device_rows(const CalibrationReport& report) {
    const Calibration& c = report.calibration;
    std::string html =
        "<table><tr><th>Device</th><th>Serial</th><th>Picture</th><th>Held-out poses</th><th>All poses</th><th>Left "
        "out</th><th>Focal "
        "length</th>"
        "<th>Optical axis</th></tr>";
    for (const DeviceName name : kDevices) {
        const auto& d = c.device(name);
        if (!d) continue;
        const auto i = static_cast<std::size_t>(name);
        const std::string& serial = serial_of(report.serials, name);
        const auto sigma = lens_sigmas(c.bundle, name);
        const double all = static_cast<double>(c.bundle.used[i] + c.bundle.left_out[i]);
        html += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{} x {}</td><td>{:.3f} px</td><td>{:.3f} px</td><td>{:.1f} %</td><td>{:.2f} "
            "&plusmn; {:.2f} "
            "px</td>"
            "<td>{:.2f}, {:.2f} &plusmn; {:.2f} px</td></tr>",
            text_of(name), serial.empty() ? "not given" : xml_escaped(serial), d->width, d->height,
            c.held_out.rms_px[i], c.bundle.rms_px[i],
            all > 0 ? 100 * static_cast<double>(c.bundle.left_out[i]) / all : 0, d->focal_x, sigma[0], d->centre_x,
            d->centre_y, sigma[2]);
    }
    return html + "</table>";
}

/// How far a layer of the volume's grid is from the projector (or the left camera).
double depth_mm(const Calibration& c, int layer) {
    const auto& from =
        c.device(DeviceName::projector) ? *c.device(DeviceName::projector) : *c.device(DeviceName::left_camera);
    return (from.device_from_rig *
            c.volume->points[static_cast<std::size_t>(layer * c.volume->grid[0] * c.volume->grid[1])])
        .z();
}

std::string verdict(const Calibration& c) {
    if (c.warnings.empty()) return "<div class=\"verdict yes\">&#10003; Calibrated without a warning.</div>";
    std::string html = fmt::format("<div class=\"verdict no\">&#9888; Calibrated with {} warning{}.</div>",
                                   c.warnings.size(), c.warnings.size() == 1 ? "" : "s");
    for (const std::string& warning : c.warnings) html += fmt::format("<p class=\"no\">{}</p>", xml_escaped(warning));
    return html;
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

void write_calibration_html(const CalibrationReport& report, const std::filesystem::path& file) {
    const Calibration& c = report.calibration;
    std::string body =
        fmt::format("<p class=\"muted\">{}, {} of {} poses, board {}. For research; not a medical device.</p>",
                    xml_escaped(report.made_on), c.bundle.rig.poses(), report.poses.size(),
                    xml_escaped(text_of(report.board))) +
        verdict(c) + "<h2>Devices</h2>" + device_rows(report);
    body +=
        "<p class=\"muted\">Difference between where a corner (for the projector: the light on the board) is and where "
        "the rig "
        "says, root mean square, "
        "on poses that the calibration had not seen. Behind &plusmn;: one standard deviation.</p>";
    if (c.held_out.lengths > 0)
        body += fmt::format(
            "<p>{} lengths on held-out boards: {:.3f} mm a 200 mm root mean square, {:+.3f} mm of it common to all. "
            "All lengths "
            "are by the board's square of {:g} mm, as it was said: were it another, every scan would be too large or "
            "too small "
            "by as much, and nothing here would show it. Measure ten squares with a calliper.</p>",
            c.held_out.lengths, c.held_out.length_rms_mm, c.held_out.length_mean_mm, report.board.square_mm);
    for (const std::string& change : report.changes) body += fmt::format("<p>{}</p>", xml_escaped(change));
    if (c.volume) {
        const double full = std::max(0.02, std::ceil(c.volume->worst_mm * 50) / 50);
        std::vector<ReportPicture> pictures;
        int depth = 0;
        for (RgbImage& picture : volume_pictures(*c.volume, full))
            pictures.push_back({fmt::format("{:.0f} mm away", depth_mm(c, depth++)), "", std::move(picture)});
        body +=
            fmt::format(
                "<h2>Predicted error over the working volume</h2><p>What the rig's own uncertainty does to a scanned "
                "point, one standard deviation: median "
                "{:.3f}, 95 % {:.3f}, worst {:.3f} mm. Where light lands that is sent to a point: 95 % {:.3f} mm. "
                "Colours: "
                "dark blue 0, green {:.3f}, red {:.3f} mm; "
                "seen from the projector, nearest first.</p>",
                c.volume->median_mm, c.volume->p95_mm, c.volume->worst_mm, c.volume->light_p95_mm, full / 2, full) +
            html_figures(pictures, 5);
    }
    std::vector<ReportPicture> where;
    for (const DeviceName name : kDevices)
        if (c.device(name))
            where.push_back(
                {text_of(name), "A colour a pose. Where no board was, the lens is guessed.", coverage(report, name)});
    body += "<h2>Where the board was</h2>" + html_figures(where, 3);
    ReportFacts facts{{"Rig", report.rig_file.empty() ? "no rig file" : report.rig_file.filename().string()},
                      {"Calibrated", report.made_on}};
    for (const DeviceName name : kDevices)
        if (const std::string& serial = serial_of(report.serials, name); !serial.empty())
            facts.emplace_back(text_of(name), "serial " + serial);
    write_safely(file, html_page("Calibration", body, facts));
}

}  // namespace planlight
