#include "app/report/preparation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/report/slice_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"

namespace planlight {

using Eigen::Vector3d;

namespace {

Vector3d mean_of(const std::vector<Vector3d>& points) {
    Vector3d sum = Vector3d::Zero();
    for (const auto& p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

std::string place_of(SliceKind kind, const Vector3d& p) {
    if (kind == SliceKind::axial) return fmt::format("{} {:.1f} mm", p.z() < 0 ? "I" : "S", std::abs(p.z()));
    if (kind == SliceKind::coronal) return fmt::format("{} {:.1f} mm", p.y() < 0 ? "A" : "P", std::abs(p.y()));
    return fmt::format("{} {:.1f} mm", p.x() < 0 ? "R" : "L", std::abs(p.x()));
}

nlohmann::json items_json(const PlanDrawing& drawing) {
    nlohmann::json items = nlohmann::json::array();
    for (const auto& item : drawing.items)
        items.push_back({{"name", item.name},
                         {"label", item.label},
                         {"distance_to_skin_mm", item.distance_to_skin_mm},
                         {"warnings", item.warnings}});
    return items;
}

std::string figures_table(const Preparation& done) {
    const Case& c = done.prepared;
    const auto row = [](const std::string& name, const std::string& value) {
        return fmt::format("<tr><td>{}</td><td>{}</td></tr>", name, html_escaped(value));
    };
    std::string skin;
    if (done.on_given_surface) {
        skin = row("Surface", "as given, not segmented here");
    } else {
        skin = row("Skin threshold", fmt::format("{:.0f}", done.threshold)) +
               row("Body", fmt::format("{:.0f} ml", done.body_ml)) +
               row("Taken away (table, head holder, wires)",
                   fmt::format("{} piece{}, {:.0f} ml", done.pieces_removed, done.pieces_removed == 1 ? "" : "s",
                               done.removed_ml));
        if (done.brightness_ratio > 1)
            skin += row("Brightness across the head, evened out", fmt::format("{:.1f} : 1", done.brightness_ratio));
        if (c.skin_edge_sigma_mm > 0)
            skin += row("Skin's edge moved by noise", fmt::format("{:.2f} mm (1 sigma)", c.skin_edge_sigma_mm));
    }
    return "<h2>Figures</h2><table>" + row("Case", c.code) + row("Made", c.created) + skin +
           row(done.on_given_surface ? "Mesh" : "Skin mesh",
               fmt::format("{} triangles, {} vertices", c.skin.triangles.size(), c.skin.vertices_in_ct.size())) +
           row("LUT", fmt::format("{} x {} x {} voxels of {:.2f} mm, {} skin voxels", c.lut.size[0], c.lut.size[1],
                                  c.lut.size[2], c.lut.voxel_mm, c.lut.skin.size())) +
           row("Time", done.on_given_surface ? fmt::format("LUT {:.2f} s", done.lut_s)
                                             : fmt::format("skin {:.2f} s, surface {:.2f} s, LUT {:.2f} s",
                                                           done.segment_s, done.triangulate_s, done.lut_s)) +
           "</table>";
}

std::string plan_table(const PlanDrawing& drawing) {
    if (drawing.items.empty()) return "<h2>Plan</h2><p>No items.</p>";
    std::string html = "<h2>Plan</h2><table><tr><th>Name</th><th>Drawn as</th><th>Farthest point from skin</th></tr>";
    for (const auto& item : drawing.items)
        html += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"{}\">{:.1f} mm</td></tr>", html_escaped(item.name),
                            html_escaped(item.label), item.warnings.empty() ? "" : "no", item.distance_to_skin_mm);
    return html + "</table>";
}

std::string warnings_section(const std::vector<std::string>& warnings) {
    if (warnings.empty())
        return "<div class=\"verdict yes\">&#10003; Prepared without a warning. Look at the pictures before you use "
               "it.</div>";
    std::string html = fmt::format("<div class=\"verdict no\">&#9888; Prepared with {} warning{}.</div>",
                                   warnings.size(), warnings.size() == 1 ? "" : "s");
    for (const auto& warning : warnings) html += fmt::format("<p class=\"no\">{}</p>", html_escaped(warning));
    return html;
}

}  // namespace

Vector3d point_of_interest(const Case& the_case) {
    if (!the_case.plan.trajectories.empty() && the_case.plan.trajectories.front().target_in_ct.allFinite())
        return the_case.plan.trajectories.front().target_in_ct;
    const auto points = points_of(the_case.plan);
    if (!points.empty() && mean_of(points).allFinite()) return mean_of(points);
    return the_case.skin.vertices_in_ct.empty() ? Vector3d::Zero() : mean_of(the_case.skin.vertices_in_ct);
}

std::vector<ReportPicture> preparation_pictures(const Volume& volume, const Case& the_case, const PlanDrawing& drawing,
                                                std::string& warning) {
    std::vector<ReportPicture> pictures;
    const Vector3d at = point_of_interest(the_case);
    const auto add_slice = [&](const std::string& name, SliceKind kind, const std::string& seen) {
        pictures.push_back({name, fmt::format("At {}, seen {}.", place_of(kind, at), seen),
                            slice_picture(volume, the_case.skin, the_case.plan, kind, at)});
    };
    add_slice("Axial", SliceKind::axial, "from the feet");
    add_slice("Coronal", SliceKind::coronal, "from the front");
    add_slice("Sagittal", SliceKind::sagittal, "from the left");
    SceneModel scene;
    scene.skin = std::make_shared<TriangleMesh>(the_case.skin);
    scene.plan = std::make_shared<PlanDrawing>(drawing);
    constexpr double kQuarter = std::numbers::pi / 2;
    try {
        for (const auto& [name, azimuth] : {std::pair{"From the front", 0.0},
                                            {"From the right", kQuarter},
                                            {"From behind", 2 * kQuarter},
                                            {"From the left", 3 * kQuarter}}) {
            SceneView view;
            view.azimuth = azimuth;
            view.elevation = 0.15;
            pictures.push_back({name, "", render_scene(scene, view, 560, 460)});
        }
    } catch (const DeviceError& error) {
        warning = fmt::format("the report has no views of the head: {}", error.what());
    }
    return pictures;
}

std::string preparation_json(const Preparation& done, const PlanDrawing& drawing) {
    const Case& c = done.prepared;
    nlohmann::json result = {
        {"case", c.code},
        {"created", c.created},
        {"surface_given", done.on_given_surface},
        {"skin", {{"vertices", c.skin.vertices_in_ct.size()}, {"triangles", c.skin.triangles.size()}}},
        {"lut", {{"size", c.lut.size}, {"voxel_mm", c.lut.voxel_mm}, {"skin_voxels", c.lut.skin.size()}}},
        {"plan_items", c.plan.size()},
        {"items", items_json(drawing)},
        {"seconds", {{"skin", done.segment_s}, {"surface", done.triangulate_s}, {"lut", done.lut_s}}},
        {"warnings", c.warnings}};
    if (!done.on_given_surface)
        result.update({{"threshold", done.threshold},
                       {"body_ml", done.body_ml},
                       {"removed_pieces", done.pieces_removed},
                       {"removed_ml", done.removed_ml},
                       {"brightness_ratio", done.brightness_ratio},
                       {"edge_sigma_mm", c.skin_edge_sigma_mm}});
    return result.dump(2) + "\n";
}

void write_preparation_report(const std::filesystem::path& folder, const Preparation& done, const PlanDrawing& drawing,
                              const std::vector<ReportPicture>& pictures) {
    const auto file = folder / "report.html";
    const auto middle = pictures.begin() + std::min<std::ptrdiff_t>(3, static_cast<std::ptrdiff_t>(pictures.size()));
    const std::vector<ReportPicture> slices(pictures.begin(), middle), heads(middle, pictures.end());
    const std::string body =
        fmt::format("<p class=\"muted\">Case {}. For research; not a medical device.</p>",
                    html_escaped(done.prepared.code)) +
        warnings_section(done.prepared.warnings) + html_figures(slices, file, 3) +
        "<p class=\"muted\">Green: skin. Amber: lids over openings. Grey: ends of the scan. Pink: plan within 3 mm "
        "of the slice.</p>" +
        (heads.empty() ? "" : html_figures(heads, file, 4)) + plan_table(drawing) + figures_table(done);
    write_safely(file, html_page("Preparation", body));
    write_safely(folder / "report.json", preparation_json(done, drawing));
}

}  // namespace planlight
