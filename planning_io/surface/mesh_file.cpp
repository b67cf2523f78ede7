#include "planning_io/surface/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <tuple>

#include "planning_io/files/content_hash.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/surface/ply.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void damaged(const fs::path& file, const std::string& problem) {
    throw DamagedFileError(file, problem, "Write or copy the PLY file again.");
}

/// Appends values as they lie in memory (little endian).
class Rows {
public:
    template <class T>
    void add(T value) {
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        content_.append(bytes, sizeof(T));
    }
    void add(const Eigen::Vector3d& v) {
        for (int axis = 0; axis < 3; ++axis) add(v[axis]);
    }
    void add(const std::vector<std::array<std::int32_t, 3>>& triangles) {
        for (const auto& triangle : triangles) {
            add(std::uint8_t{3});
            for (const std::int32_t corner : triangle) add(corner);
        }
    }
    void write(const std::string& header, const fs::path& file) const {
        write_safely(file, [&](std::ostream& out) { out << header << content_; });
    }

private:
    std::string content_;
};

std::string columns_of(const char* type, std::initializer_list<const char*> names) {
    std::string lines;
    for (const char* name : names) lines += std::string("property ") + type + " " + name + "\n";
    return lines;
}

std::string lines_of(const std::vector<std::string>& comments) {
    std::string lines;
    for (const std::string& comment : comments) lines += "comment " + comment + "\n";
    return lines;
}

std::string faces_in_header(std::size_t count) {
    return "element face " + std::to_string(count) + "\nproperty list uchar int vertex_indices\n";
}

template <class Column>
void check_length(const Column& column, std::size_t count, const fs::path& file, const char* name) {
    if (!column.empty() && column.size() != count)
        throw InputError(file, std::string("the column of ") + name + " is not as long as the points",
                         "Give one value for each point, or none.");
}

const std::vector<double>& any_column(const Ply& ply, const char* name, const fs::path& file) {
    const auto* values = ply.column(name);
    if (!values) damaged(file, std::string("has no column \"") + name + "\"");
    return *values;
}

/// The column, which must be there and finite.
const std::vector<double>& column(const Ply& ply, const char* name, const fs::path& file) {
    const auto* values = &any_column(ply, name, file);
    for (const double value : *values)
        if (!std::isfinite(value))
            throw InputError(file, std::string("has a value in \"") + name + "\" that is not a finite number",
                             "Repair the mesh or the scan and export it again.");
    return *values;
}

std::vector<Eigen::Vector3d> vectors(const Ply& ply, std::array<const char*, 3> names, double sign_xy,
                                     const fs::path& file) {
    const auto &x = column(ply, names[0], file), &y = column(ply, names[1], file), &z = column(ply, names[2], file);
    std::vector<Eigen::Vector3d> result(ply.vertices);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = {sign_xy * x[i], sign_xy * y[i], z[i]};
    return result;
}

/// Of unit length; zero where there is none.
std::vector<Eigen::Vector3d> normals_of(const Ply& ply, const fs::path& file) {
    constexpr double kUnit = 1e-4;  // off it by less: as it was written, to the last digit
    const auto &x = any_column(ply, "nx", file), &y = any_column(ply, "ny", file), &z = any_column(ply, "nz", file);
    std::vector<Eigen::Vector3d> normals(ply.vertices, Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Eigen::Vector3d n(x[i], y[i], z[i]);
        const double length = n.stableNorm();
        if (std::isfinite(length) && length > 0)
            normals[i] = std::abs(length - 1) < kUnit ? n : Eigen::Vector3d(n / length);
    }
    return normals;
}

/// Keeps the values of the points that are kept, in their order.
template <class Column>
void keep(const std::vector<char>& kept, Column& values) {
    if (values.size() != kept.size()) return;
    std::size_t to = 0;
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (kept[i]) values[to++] = values[i];
    values.resize(to);
}

void keep(const std::vector<char>& kept, PointCloud& cloud) {
    keep(kept, cloud.sigma_mm);
    keep(kept, cloud.pixels_in_projector);
    keep(kept, cloud.normals_in_rig);
    keep(kept, cloud.points_in_rig);
}

void leave_out_at_origin_and_repeated(PointCloud& cloud, PointsLeftOut& left_out) {
    const auto& points = cloud.points_in_rig;
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const auto &p = points[a], &q = points[b];
        return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
    });
    std::vector<char> kept(points.size(), 1);
    for (std::size_t k = 0; k < order.size(); ++k) {
        const std::size_t i = order[k];
        const bool at_origin = points[i].isZero(0), repeated = k > 0 && points[i] == points[order[k - 1]];
        kept[i] = !at_origin && !repeated;
        if (!kept[i]) ++(at_origin ? left_out.at_origin : left_out.repeated);
    }
    keep(kept, cloud);
}

/// A column of normals that most points lack is none.
void leave_out_without_normal(PointCloud& cloud, PointsLeftOut& left_out) {
    std::vector<char> kept;
    for (const auto& n : cloud.normals_in_rig) kept.push_back(!n.isZero(0));
    const auto without = static_cast<std::size_t>(std::count(kept.begin(), kept.end(), 0));
    if (2 * without > kept.size()) return cloud.normals_in_rig.clear();
    left_out.without_normal = without;
    if (without > 0) keep(kept, cloud);
}

}  // namespace

void write_mesh(const TriangleMesh& mesh, const fs::path& file) {
    const std::size_t count = mesh.vertices_in_ct.size();
    check_length(mesh.normals_in_ct, count, file, "normals");
    check_length(mesh.flags, count, file, "flags");
    check_length(mesh.thickness_mm, count, file, "thickness");
    std::string header =
        "ply\nformat binary_little_endian 1.0\ncomment Planlight skin mesh, mm. SPACE=LPS\nelement vertex " +
        std::to_string(count) + "\n" + columns_of("double", {"x", "y", "z"});
    if (!mesh.normals_in_ct.empty()) header += columns_of("double", {"nx", "ny", "nz"});
    if (!mesh.flags.empty()) header += columns_of("uchar", {"flags"});
    if (!mesh.thickness_mm.empty()) header += columns_of("float", {"thickness"});
    header += faces_in_header(mesh.triangles.size()) + "end_header\n";
    Rows rows;
    for (std::size_t i = 0; i < count; ++i) {
        rows.add(mesh.vertices_in_ct[i]);
        if (!mesh.normals_in_ct.empty()) rows.add(mesh.normals_in_ct[i]);
        if (!mesh.flags.empty()) rows.add(mesh.flags[i]);
        if (!mesh.thickness_mm.empty()) rows.add(mesh.thickness_mm[i]);
    }
    rows.add(mesh.triangles);
    rows.write(header, file);
}

TriangleMesh read_mesh(const fs::path& file) {
    const Ply ply = parse_ply(read_whole(file), file);
    const bool lps = ply.says("SPACE=LPS"), ras = ply.says("SPACE=RAS");
    if (lps == ras)
        throw InputError(file, lps ? "says both SPACE=LPS and SPACE=RAS" : "does not say its coordinate system",
                         "Export the mesh with its space (3D Slicer does), or add the line \"comment SPACE=LPS\" to "
                         "its header if that is what it is.");
    const double sign_xy = ras ? -1 : 1;
    TriangleMesh mesh;
    mesh.vertices_in_ct = vectors(ply, {"x", "y", "z"}, sign_xy, file);
    if (ply.column("nx")) mesh.normals_in_ct = vectors(ply, {"nx", "ny", "nz"}, sign_xy, file);
    if (const auto* flags = ply.column("flags"))
        for (const double flag : *flags) {
            if (!(flag >= 0 && flag <= 255)) damaged(file, "has flags that are not bytes");
            mesh.flags.push_back(static_cast<std::uint8_t>(flag));
        }
    if (const auto* thickness = ply.column("thickness"))
        for (const double mm : *thickness) {
            if (mm < 0 || std::isinf(mm)) damaged(file, "has a thickness below zero or without end");
            mesh.thickness_mm.push_back(static_cast<float>(mm));  // not a number where unknown
        }
    for (const auto& face : ply.faces)
        for (std::size_t c = 2; c < face.size(); ++c)  // a polygon becomes a fan
            mesh.triangles.push_back({static_cast<std::int32_t>(face[0]), static_cast<std::int32_t>(face[c - 1]),
                                      static_cast<std::int32_t>(face[c])});
    return mesh;
}

void write_cloud(const PointCloud& cloud, const fs::path& file,
                 const std::vector<std::array<std::int32_t, 3>>& triangles, const std::vector<std::string>& comments) {
    const std::size_t count = cloud.size();
    check_length(cloud.normals_in_rig, count, file, "normals");
    check_length(cloud.sigma_mm, count, file, "sigma");
    check_length(cloud.pixels_in_projector, count, file, "projector pixels");
    std::string header = "ply\nformat binary_little_endian 1.0\ncomment Planlight scan, mm. FRAME=rig\n" +
                         lines_of(comments) + "element vertex " + std::to_string(count) + "\n" +
                         columns_of("double", {"x", "y", "z"});
    if (!cloud.normals_in_rig.empty()) header += columns_of("double", {"nx", "ny", "nz"});
    if (!cloud.sigma_mm.empty()) header += columns_of("float", {"sigma"});
    if (!cloud.pixels_in_projector.empty()) header += columns_of("double", {"projector_x", "projector_y"});
    Rows rows;
    for (std::size_t i = 0; i < count; ++i) {
        rows.add(cloud.points_in_rig[i]);
        if (!cloud.normals_in_rig.empty()) rows.add(cloud.normals_in_rig[i]);
        if (!cloud.sigma_mm.empty()) rows.add(cloud.sigma_mm[i]);
        if (!cloud.pixels_in_projector.empty())
            rows.add(cloud.pixels_in_projector[i].x()), rows.add(cloud.pixels_in_projector[i].y());
    }
    if (!triangles.empty()) header += faces_in_header(triangles.size());
    rows.add(triangles);
    rows.write(header + "end_header\n", file);
}

PointCloud read_cloud(const fs::path& file, const CloudOrigin& origin, std::vector<std::string>* comments,
                      PointsLeftOut* left_out) {
    const Ply ply = parse_ply(read_whole(file), file);
    if (comments) *comments = ply.comments;
    if (!origin.in_rig && !ply.says("FRAME=rig"))
        throw InputError(file, "does not say that its points are in the rig's frame",
                         "Add the line \"comment FRAME=rig\" to its header, or say --in-rig, if they are.");
    PointCloud cloud;
    cloud.points_in_rig = vectors(ply, {"x", "y", "z"}, 1, file);
    for (auto& p : cloud.points_in_rig) p *= origin.unit_mm;
    if (ply.column("nx")) cloud.normals_in_rig = normals_of(ply, file);
    if (ply.column("sigma"))
        for (const double sigma : column(ply, "sigma", file)) cloud.sigma_mm.push_back(static_cast<float>(sigma));
    if (ply.column("projector_x")) {
        const auto &x = column(ply, "projector_x", file), &y = column(ply, "projector_y", file);
        for (std::size_t i = 0; i < x.size(); ++i) cloud.pixels_in_projector.emplace_back(x[i], y[i]);
    }
    PointsLeftOut none;
    PointsLeftOut& counts = left_out ? *left_out : none;
    leave_out_at_origin_and_repeated(cloud, counts);
    leave_out_without_normal(cloud, counts);
    return cloud;
}

std::string hash_of(const TriangleMesh& mesh) {
    ContentHash hash;
    hash.add("planlight mesh 1");
    for (const auto& vertex : mesh.vertices_in_ct) hash.add_values(vertex.data(), 3);
    hash.add("triangles");
    for (const auto& triangle : mesh.triangles) hash.add_values(triangle.data(), 3);
    return hash.hex();
}

}  // namespace planlight
