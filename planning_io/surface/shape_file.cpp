#include "planning_io/surface/shape_file.h"

#include <algorithm>
#include <cctype>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/header_statements.h"
#include "planning_io/surface/ply.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

Shape parse_ply_shape(const std::string& content, const fs::path& file) {
    const Ply ply = parse_ply(content, file);
    Shape shape;
    std::string comments;
    for (const auto& comment : ply.comments) comments += comment + '\n';
    shape.space = space_of_mesh(comments, file);
    const auto *x = ply.column("x"), *y = ply.column("y"), *z = ply.column("z");
    if (!x || !y || !z) throw DamagedFileError(file, "has no columns x, y, z", "Write or copy the PLY file again.");
    if (const auto* flags = ply.column("flags"))
        for (const double flag : *flags)
            shape.flags.push_back(flag >= 0 && flag <= 255 ? static_cast<std::uint8_t>(flag) : std::uint8_t{0});
    for (std::size_t i = 0; i < ply.vertices; ++i) shape.points.emplace_back((*x)[i], (*y)[i], (*z)[i]);
    for (const auto& face : ply.faces)
        for (std::size_t c = 2; c < face.size(); ++c)
            shape.triangles.push_back({static_cast<std::int32_t>(face[0]), static_cast<std::int32_t>(face[c - 1]),
                                       static_cast<std::int32_t>(face[c])});
    if (ply.faces.empty())  // beside faces, edges are the faces' own
        for (const auto& [from, to] : ply.edges)
            shape.lines.push_back(
                {{static_cast<std::int32_t>(from), static_cast<std::int32_t>(to)}, {}, {}, {}, {}, {}});
    return shape;
}

void check(const Shape& shape, const fs::path& file) {
    for (const auto& p : shape.points)
        if (!p.allFinite())
            throw InputError(file, "has a coordinate that is not a finite number", "Repair it and export it again.");
    const auto count = static_cast<std::int32_t>(shape.points.size());
    const auto exists = [&](std::int32_t i) { return i >= 0 && i < count; };
    bool good = true;
    for (const auto& line : shape.lines) good = good && std::all_of(line.points.begin(), line.points.end(), exists);
    for (const auto& t : shape.triangles) good = good && std::all_of(t.begin(), t.end(), exists);
    if (!good) throw DamagedFileError(file, "names a point that does not exist", "Export or copy the file again.");
}

}  // namespace

SpaceSaid space_of_mesh(const std::string& words, const fs::path& file) {
    if (unit_said(words, file, "write units=mm into its header or a comment").value_or(1) != 1)
        throw InputError(file, "says that its unit is um", "Export it again in mm.");
    return space_said(words, file);
}

Shape read_shape(const fs::path& file) {
    std::string ending = file.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const std::string content = read_whole(file);
    Shape shape;
    if (ending == ".stl")
        shape = parse_stl(content, file);
    else if (ending == ".obj")
        shape = parse_obj(content, file);
    else if (ending == ".ply")
        shape = parse_ply_shape(content, file);
    else if (ending == ".vtk" || ending == ".vtp")
        shape = parse_vtk_in_child(file, ending == ".vtp");
    else
        throw InputError(file, "is of no kind that meshes and lines are read from", "Give STL, PLY, OBJ, VTP or VTK.");
    check(shape, file);
    return shape;
}

WeldedShape welded(const Shape& shape) {
    WeldedShape result;
    result.shape.space = shape.space;
    std::vector<std::int32_t> order(shape.points.size()), now(shape.points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int32_t>(i);
    const auto point = [&](std::int32_t i) -> const Vector3d& { return shape.points[static_cast<std::size_t>(i)]; };
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        return std::lexicographical_compare(point(a).begin(), point(a).end(), point(b).begin(), point(b).end());
    });
    std::vector<std::int32_t> first(order.size());  // of every place, the first point of the file there
    for (std::size_t i = 0; i < order.size(); ++i)
        first[static_cast<std::size_t>(order[i])] =
            i > 0 && point(order[i]) == point(order[i - 1]) ? first[static_cast<std::size_t>(order[i - 1])] : order[i];
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (first[i] == static_cast<std::int32_t>(i)) {
            now[i] = static_cast<std::int32_t>(result.shape.points.size());
            result.shape.points.push_back(shape.points[i]);
            if (!shape.flags.empty()) result.shape.flags.push_back(shape.flags[i]);
        }
    }
    const auto moved = [&](std::int32_t i) {
        return now[static_cast<std::size_t>(first[static_cast<std::size_t>(i)])];
    };
    for (auto line : shape.lines) {
        for (auto& p : line.points) p = moved(p);
        result.shape.lines.push_back(std::move(line));
    }
    for (const auto& t : shape.triangles) {
        const std::array<std::int32_t, 3> corners{moved(t[0]), moved(t[1]), moved(t[2])};
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            ++result.degenerate;
        else
            result.shape.triangles.push_back(corners);
    }
    return result;
}

}  // namespace planlight
