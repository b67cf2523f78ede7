#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/plan/plan_import.h"
#include "planning_io/surface/shape_file.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// What a surface's file does not say of itself.
struct SurfaceSettings {
    PlanImportSettings said;  ///< space of files that do not say theirs; frame of reference of the CT (for DICOM SEG)
    std::string segment;      ///< which of a SEG or RTSTRUCT, by its name; needed when it holds several
};

/// A surface to project on, and what it was judged by.
struct SurfaceFile {
    TriangleMesh mesh;  ///< welded, without triangles of no area, turned outwards; normals per vertex
    bool closed = true;
    std::size_t border_edges = 0;    ///< of one triangle only
    std::size_t odd_edges = 0;       ///< of three triangles or more
    std::size_t degenerate = 0;      ///< triangles left out
    std::size_t pieces = 1;          ///< connected
    std::vector<std::string> notes;  ///< in words, with the file's name
};

/// Reads STL, PLY, OBJ, VTP, VTK, a segment of a DICOM SEG or a solid of an RTSTRUCT as a surface in ct.
///
/// Refused (InputError, with numbers): no SPACE mark and no `said.space`; fewer than 100 triangles; smaller than 50 mm
/// or larger than 600 mm; more than 0.1 % of the edges with three triangles or more, or sides that cannot be turned
/// alike. A closed piece is turned so that its volume is positive, an open one so that it faces away from its middle.
SurfaceFile read_surface(const std::filesystem::path& file, const SurfaceSettings& settings = {});

/// A file's triangles as a surface in ct: `read_surface` without its bounds of size, of points that are welded already.
/// `degenerate`: triangles that were left out before.
SurfaceFile surface_of(const Shape& welded, Space space, std::size_t degenerate, const std::filesystem::path& file);

/// Looks at the edges of `surface.mesh`, turns it outwards and gives it normals. Throws InputError as `read_surface`.
void judge_surface(SurfaceFile& surface, const std::filesystem::path& file);

}  // namespace planlight
