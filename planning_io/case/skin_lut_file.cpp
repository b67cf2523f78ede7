#include "planning_io/case/skin_lut_file.h"

#include "planning_io/files/checked_chunks.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/types/processor_clones.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTableBytes = std::size_t{8} << 30;

[[noreturn]] void damaged(const fs::path& file, const std::string& problem) {
    throw DamagedFileError(file, problem, "Prepare the case again, or copy its folder again.");
}

std::size_t product(const std::array<int, 3>& size) {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
}

/// The skin points, one array for each thing they hold.
struct SkinColumns {
    std::vector<float> positions, normals, thickness;
    std::vector<std::uint16_t> voxels;
    std::vector<std::uint8_t> flags;

    void resize(std::size_t count) {
        positions.resize(3 * count);
        normals.resize(3 * count);
        thickness.resize(count);
        voxels.resize(3 * count);
        flags.resize(count);
    }
};

SkinColumns columns_of(const std::vector<SkinPoint>& skin) {
    SkinColumns columns;
    columns.resize(skin.size());
    for (std::size_t i = 0; i < skin.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            columns.positions[3 * i + axis] = skin[i].position_in_ct[static_cast<Eigen::Index>(axis)];
            columns.normals[3 * i + axis] = skin[i].normal_in_ct[static_cast<Eigen::Index>(axis)];
            columns.voxels[3 * i + axis] = skin[i].voxel[axis];
        }
        columns.thickness[i] = skin[i].thickness_mm;
        columns.flags[i] = skin[i].flags;
    }
    return columns;
}

std::vector<SkinPoint> points_of(const SkinColumns& columns) {
    std::vector<SkinPoint> skin(columns.flags.size());
    for (std::size_t i = 0; i < skin.size(); ++i) {
        skin[i].position_in_ct = Eigen::Map<const Eigen::Vector3f>(&columns.positions[3 * i]);
        skin[i].normal_in_ct = Eigen::Map<const Eigen::Vector3f>(&columns.normals[3 * i]);
        skin[i].voxel = {columns.voxels[3 * i], columns.voxels[3 * i + 1], columns.voxels[3 * i + 2]};
        skin[i].thickness_mm = columns.thickness[i];
        skin[i].flags = columns.flags[i];
    }
    return skin;
}

std::vector<ChunkedArray> arrays_of(SkinLut& lut, SkinColumns& columns) {
    return {array_of(lut.nearest),    array_of(columns.positions), array_of(columns.normals),
            array_of(columns.voxels), array_of(columns.thickness), array_of(columns.flags),
            array_of(lut.distance_mm)};
}

std::string fields_of(const SkinLut& lut) {
    FieldWriter out;
    for (const int n : lut.size) out.add(static_cast<std::uint32_t>(n));
    for (const int n : lut.distance_size) out.add(static_cast<std::uint32_t>(n));
    out.add(lut.voxel_mm);
    out.add(lut.distance_voxel_mm);
    for (int axis = 0; axis < 3; ++axis) out.add(lut.origin_in_ct[axis]);
    out.add(static_cast<std::uint64_t>(lut.skin.size()));
    out.add_text(lut.volume_hash);
    out.add_text(lut.mesh_hash);
    return out.bytes();
}

std::array<int, 3> read_size(FieldReader& in, const fs::path& file) {
    std::array<int, 3> size{};
    for (int& n : size) {
        const auto value = in.next<std::uint32_t>();
        if (value > 65536) damaged(file, "says a size that makes no sense");
        n = static_cast<int>(value);
    }
    if (product(size) > kMaxTableBytes / 4) damaged(file, "says a size that makes no sense");
    return size;
}

/// The header's fields; the arrays have their sizes, not yet their contents.
SkinLut lut_of(const std::string& fields, SkinColumns& columns, const fs::path& file) {
    FieldReader in(fields, file);
    SkinLut lut;
    lut.size = read_size(in, file);
    lut.distance_size = read_size(in, file);
    lut.voxel_mm = in.next<double>();
    lut.distance_voxel_mm = in.next<double>();
    for (int axis = 0; axis < 3; ++axis) lut.origin_in_ct[axis] = in.next<double>();
    const auto points = in.next<std::uint64_t>();
    lut.volume_hash = in.next_text();
    lut.mesh_hash = in.next_text();
    in.expect_end();
    if (points > kMaxTableBytes / 32) damaged(file, "says a size that makes no sense");
    lut.nearest.resize(product(lut.size));
    lut.distance_mm.resize(product(lut.distance_size));
    columns.resize(points);
    return lut;
}

PLANLIGHT_CLONES std::uint32_t highest_of(const std::uint32_t* values, std::size_t count) {
    std::uint32_t highest = 0;
    for (std::size_t i = 0; i < count; ++i) highest = values[i] > highest ? values[i] : highest;
    return highest;
}

std::uint32_t highest_of(const LargeArray<std::uint32_t>& values) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, values.size(), 1 << 18), std::uint32_t{0},
        [&](const auto& range, std::uint32_t highest) {
            return std::max(highest, highest_of(values.data() + range.begin(), range.size()));
        },
        [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); });
}

/// What a reader of the table may rely on. The sentence says what is wrong; empty when nothing is.
std::string fault_of(const SkinLut& lut) {
    if (product(lut.size) == 0 || product(lut.size) != lut.nearest.size())
        return "the table's size and its pointers do not agree";
    if (product(lut.distance_size) != lut.distance_mm.size())
        return "the distance field's size and its values do not agree";
    if (!(lut.voxel_mm > 0) || !std::isfinite(lut.voxel_mm) || !lut.origin_in_ct.allFinite())
        return "the table's geometry makes no sense";
    if (!lut.distance_mm.empty() && (!(lut.distance_voxel_mm > 0) || !std::isfinite(lut.distance_voxel_mm)))
        return "the distance field's geometry makes no sense";
    if (highest_of(lut.nearest) >= lut.skin.size()) return "a pointer of the table points past the skin";
    for (const SkinPoint& p : lut.skin) {
        if (!p.position_in_ct.allFinite() || !p.normal_in_ct.allFinite()) return "a skin point is not finite";
        if (std::isinf(p.thickness_mm) || p.thickness_mm < 0) return "a skin point has a thickness that makes no sense";
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (p.voxel[axis] >= lut.size[axis]) return "a skin point lies outside the table";
    }
    return {};
}

constexpr ChunkedKind kKind{"PLANLUT\n", 2};

}  // namespace

void write_skin_lut(const SkinLut& lut, const fs::path& file) {
    if (const std::string fault = fault_of(lut); !fault.empty())
        throw InputError(file, fault, "Prepare the case again.");
    SkinColumns columns = columns_of(lut.skin);
    auto& arrays_only = const_cast<SkinLut&>(lut);  // ChunkedArray serves reading too; writing does not touch it
    write_safely(
        file, [&](std::ostream& out) { write_chunked(out, kKind, fields_of(lut), arrays_of(arrays_only, columns)); });
}

SkinLut read_skin_lut(const fs::path& file) {
    const std::string content = read_whole(file);
    ChunkedFile chunked(content, kKind, file);
    SkinColumns columns;
    SkinLut lut = lut_of(chunked.fields(), columns, file);
    chunked.read_into(arrays_of(lut, columns));
    lut.skin = points_of(columns);
    if (const std::string fault = fault_of(lut); !fault.empty()) damaged(file, fault);
    return lut;
}

}  // namespace planlight
