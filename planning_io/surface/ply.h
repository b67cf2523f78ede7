#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace planlight {

/// One column of a PLY element, widened to double (exact for every PLY type).
struct PlyColumn {
    std::string name;
    std::vector<double> values;
};

/// The vertices, faces and edges of a PLY file (ascii, or binary of either endianness); other elements are skipped.
struct Ply {
    std::vector<std::string> comments;
    std::size_t vertices = 0;
    std::vector<PlyColumn> columns;
    std::vector<std::vector<std::int64_t>> faces;
    std::vector<std::array<std::int64_t, 2>> edges;  ///< `vertex1` and `vertex2` of each element `edge`

    const std::vector<double>* column(std::string_view name) const;
    bool says(std::string_view words) const;  ///< in one of its comments
};

/// Throws InputError for what is not PLY, DamagedFileError for a cut or damaged one.
Ply parse_ply(std::string_view content, const std::filesystem::path& file);

}  // namespace planlight
