#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/plan/coordinate_space.h"
#include "planning_io/types/plan.h"

namespace planlight {

/// A polyline (or a single point) of a mesh file, with what the file says of it.
struct ShapeLine {
    std::vector<std::int32_t> points;  ///< indices; the first again at the end when it is closed
    std::string kind;  ///< "trajectory", "borehole", "osteotomy_line", "cut_plane" in our own files; else empty
    std::string name, description;  ///< empty when the file has none
    std::optional<Eigen::Vector3d> axis;
    std::optional<Colour> colour;
};

/// What a mesh file holds, before it means anything: points as they stand in the file, lines and triangles over them.
struct Shape {
    std::vector<Eigen::Vector3d> points;
    std::vector<ShapeLine> lines;
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<std::uint8_t> flags;  ///< SkinFlag per point, of our own PLY files; else empty
    SpaceSaid space;                  ///< by "SPACE=LPS" or "SPACE=RAS", where 3D Slicer puts it, or in other words
};

/// Reads STL (binary, ascii), OBJ, PLY, legacy VTK and VTP; polygons and strips become triangles. VTK and VTP are
/// parsed in a child process. Coordinates are finite and corners exist; else, and where the file is cut or garbled,
/// DamagedFileError.
Shape read_shape(const std::filesystem::path& file);

/// One point for all corners at the same place (STL repeats each), without the triangles that have become lines or
/// points.
struct WeldedShape {
    Shape shape;
    std::size_t degenerate = 0;  ///< triangles left out
};

/// Points stand in the order in which they first come in the file.
WeldedShape welded(const Shape& shape);

/// What a header or comments say of the frame. Throws InputError where they say a unit that is not mm.
SpaceSaid space_of_mesh(const std::string& words, const std::filesystem::path& file);

// The readers of single formats, over the file's content (VTK's over the file).
Shape parse_stl(const std::string& content, const std::filesystem::path& file);
Shape parse_obj(const std::string& content, const std::filesystem::path& file);
Shape parse_vtk_in_child(const std::filesystem::path& file, bool xml);

}  // namespace planlight
