#include "tests/registration/matching/trial_heads.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>

#include "planning_io/volume/read_volume.h"
#include "segmentation/build_skin_lut.h"
#include "segmentation/segment_skin.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

double blended_distance(const std::vector<Ellipsoid>& parts, double blend_mm, const Vector3d& p) {
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> all;
    for (const Ellipsoid& part : parts) {
        const Vector3d q = (p - part.centre).cwiseQuotient(part.half_axes);
        const double k0 = q.norm(), k1 = q.cwiseQuotient(part.half_axes).norm();
        all.push_back(k1 < 1e-9 ? -part.half_axes.minCoeff() : k0 * (k0 - 1) / k1);
        least = std::min(least, all.back());
    }
    double sum = 0;
    for (const double d : all) sum += std::exp(-(d - least) / blend_mm);
    return least - blend_mm * std::log(sum);
}

/// A CT whose -300 HU is the surface: the values fall linearly with the distance there. It begins at `lowest_z_mm`.
Volume volume_of(const std::vector<Ellipsoid>& parts, double blend_mm, double voxel_mm, double lowest_z_mm) {
    const Vector3d low(-115, -150, lowest_z_mm), high(115, 140, 150);
    Volume volume;
    for (int axis = 0; axis < 3; ++axis)
        volume.size[static_cast<std::size_t>(axis)] = static_cast<int>((high[axis] - low[axis]) / voxel_mm) + 1;
    volume.ct_from_voxel = Eigen::Translation3d(low) * Eigen::Scaling(voxel_mm);
    volume.is_hu = true;
    volume.modality = "CT";
    volume.source = "blended ellipsoids";
    volume.values.reserve(volume.index(0, 0, volume.size[2]));
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const Vector3d p = volume.ct_from_voxel * Vector3d(i, j, k);
                const double hu = -300 - 150 * blended_distance(parts, blend_mm, p);
                volume.values.push_back(static_cast<float>(std::clamp(hu, -1000.0, 60.0)));
            }
    return volume;
}

/// Table and truth from the same volume: the truth keeps every triangle, the table is made as the product makes it.
TrialHead head_of_volume(const std::string& name, const Volume& volume) {
    SkinSettings settings;
    const SkinMask mask = segment_skin(volume, settings);
    SkinLut lut = build_skin_lut(triangulate_skin(volume, mask, settings));
    settings.max_decimation_error_mm = 0.005;
    return {name, std::move(lut), TrialSurface(triangulate_skin(volume, mask, settings))};
}

/// The truth is the blended surface itself; only the table goes through voxels.
TrialHead synthetic_head(const std::string& name, const std::vector<Ellipsoid>& parts, double blend_mm,
                         double lowest_z_mm) {
    const Volume volume = volume_of(parts, blend_mm, 1.4, lowest_z_mm);
    SkinSettings settings;
    settings.threshold = -300;
    SkinLut lut = build_skin_lut(triangulate_skin(volume, segment_skin(volume, settings), settings));
    return {name, std::move(lut), TrialSurface(blended_mesh(parts, blend_mm, 1.8))};
}

// x: left, y: posterior, z: superior.
const std::vector<Ellipsoid> kLongHead{
    {{0, 5, 30}, {68, 102, 80}},     {{3, -50, -40}, {44, 46, 66}}, {{4, -104, -32}, {10, 20, 26}},
    {{-3, -88, -96}, {19, 16, 15}},  {{72, 20, -20}, {7, 16, 31}},  {{-70, 14, -14}, {9, 19, 33}},
    {{28, -84, 4}, {20, 11, 8}},     {{-25, -86, 2}, {22, 10, 9}},  {{46, -55, -36}, {16, 18, 14}},
    {{-41, -58, -34}, {15, 20, 13}}, {{20, 30, -80}, {46, 50, 70}}, {{-30, -70, 48}, {14, 10, 12}},
};
const std::vector<Ellipsoid> kRoundHead{
    {{0, 0, 20}, {80, 88, 82}},     {{-2, -34, -38}, {60, 50, 52}},  {{-3, -84, -22}, {15, 14, 15}},
    {{5, -70, -76}, {26, 18, 14}},  {{84, 8, -10}, {12, 14, 22}},    {{-83, 6, -16}, {11, 15, 21}},
    {{40, -60, -44}, {24, 20, 20}}, {{-44, -56, -40}, {22, 24, 22}}, {{5, 28, -70}, {58, 52, 60}},
    {{35, -72, 30}, {24, 10, 14}},
};

/// Ends of open edges, by where they begin: every border is a ring.
std::vector<std::vector<std::int32_t>> borders_of(const TriangleMesh& mesh) {
    std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
    for (const auto& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
    std::map<std::int32_t, std::int32_t> next;
    for (const auto& [edge, count] : edges)
        if (!edges.contains({edge.second, edge.first})) next[edge.first] = edge.second;
    std::vector<std::vector<std::int32_t>> rings;
    while (!next.empty()) {
        std::vector<std::int32_t> ring;
        for (auto at = next.begin(); at != next.end(); at = next.find(at == next.end() ? -1 : ring.back())) {
            ring.push_back(at->second);
            next.erase(at);
        }
        rings.push_back(ring);
    }
    return rings;
}

/// A mesh with its holes closed by fans: the longest border is the cut of the neck, the others are lids.
TriangleMesh closed(TriangleMesh mesh) {
    mesh.flags.assign(mesh.vertices_in_ct.size(), kSkin);
    const auto rings = borders_of(mesh);
    std::size_t longest = 0;
    for (const auto& ring : rings) longest = std::max(longest, ring.size());
    for (const auto& ring : rings) {
        const std::uint8_t flag = ring.size() == longest ? kCutPlane : kSeal;
        Vector3d middle = Vector3d::Zero();
        for (const auto v : ring)
            middle += mesh.vertices_in_ct[static_cast<std::size_t>(v)] / static_cast<double>(ring.size());
        const auto hub = static_cast<std::int32_t>(mesh.vertices_in_ct.size());
        mesh.vertices_in_ct.push_back(middle);
        mesh.flags.push_back(flag);
        for (std::size_t i = 0; i < ring.size(); ++i) {
            mesh.flags[static_cast<std::size_t>(ring[i])] = flag;
            mesh.triangles.push_back({ring[(i + 1) % ring.size()], ring[i], hub});
        }
    }
    return mesh;
}

/// ASCII PLY of points and triangles; its axes (left, up, front) become ct's.
TriangleMesh read_mannequin(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::size_t points = 0, faces = 0;
    for (std::string line; std::getline(in, line) && line != "end_header";) {
        if (line.starts_with("element vertex ")) points = std::stoul(line.substr(15));
        if (line.starts_with("element face ")) faces = std::stoul(line.substr(13));
    }
    TriangleMesh mesh;
    for (std::size_t i = 0; i < points; ++i) {
        double left, up, front;
        in >> left >> up >> front;
        mesh.vertices_in_ct.emplace_back(left, -front, up);
    }
    for (std::size_t i = 0; i < faces; ++i) {
        int corners;
        std::array<std::int32_t, 3> t;
        in >> corners >> t[0] >> t[1] >> t[2];
        mesh.triangles.push_back(t);
    }
    if (!in || points == 0) throw std::runtime_error("cannot read the mannequin " + file.string());
    return closed(mesh);
}

}  // namespace

TriangleMesh blended_mesh(const std::vector<Ellipsoid>& parts, double blend_mm, double edge_mm) {
    Volume volume = volume_of(parts, blend_mm, edge_mm, -185);
    SkinSettings settings;
    settings.threshold = -300;
    settings.max_decimation_error_mm = 0.005;
    TriangleMesh mesh = triangulate_skin(volume, segment_skin(volume, settings), settings);
    for (Vector3d& p : mesh.vertices_in_ct)
        for (int i = 0; i < 3; ++i) {
            constexpr double kStep_mm = 1e-3;
            const double d = blended_distance(parts, blend_mm, p);
            Vector3d gradient;
            for (int axis = 0; axis < 3; ++axis)
                gradient[axis] =
                    (blended_distance(parts, blend_mm, p + kStep_mm * Vector3d::Unit(axis)) - d) / kStep_mm;
            p -= std::clamp(d, -1.0, 1.0) / std::max(gradient.squaredNorm(), 0.04) * gradient;
        }
    mesh.flags.clear();
    return mesh;
}

std::vector<TrialHead> trial_heads(const TrialHeadFiles& files) {
    std::vector<TrialHead> heads;
    const auto there = [](const std::filesystem::path& file) { return !file.empty() && std::filesystem::exists(file); };
    if (const auto file = example_patient())
        heads.push_back(head_of_volume("example patient (CT)", read_volume(*file)));
    if (there(files.ch2)) heads.push_back(head_of_volume("ch2 (MR)", read_volume(files.ch2)));
    if (there(files.ct_head)) heads.push_back(head_of_volume("Slicer's CT head, 3.2 mm", read_volume(files.ct_head)));
    if (there(files.mannequin)) {
        const TriangleMesh mesh = read_mannequin(files.mannequin);
        heads.push_back({"mannequin", build_skin_lut(mesh), TrialSurface(mesh)});
    }
    for (const auto& file : files.volumes)
        if (there(file)) heads.push_back(head_of_volume(file.filename().string(), read_volume(file)));
    heads.push_back({"analytic head", build_skin_lut(analytic_head_mesh(2)), TrialSurface(analytic_head_mesh(1.5))});
    heads.push_back(synthetic_head("long head", kLongHead, 6, -185));
    heads.push_back(synthetic_head("round head", kRoundHead, 9, -185));
    heads.push_back(synthetic_head("long head, CT ends above the mouth", kLongHead, 6, -55));
    return heads;
}

}  // namespace planlight::test
