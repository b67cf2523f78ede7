#include "tests/planning_io/synthetic_series.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numeric>
#include <random>

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr const char* kRoot = "1.2.826.0.1.3680043.9.9999";

bool is_ct(const SeriesLook& look) {
    return look.modality == "CT";
}

/// MR has no negative values: the phantom's HU from zero on.
std::int16_t stored(std::int16_t hu, const SeriesLook& look) {
    return static_cast<std::int16_t>(is_ct(look) && look.is_signed ? hu : hu + 1024);
}

DicomObject common(const Grid& grid, const SeriesLook& look, const std::string& storage_class, int instance) {
    DicomObject o;
    o.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\AXIAL");
    o.text(0x00080016, "UI", storage_class);
    o.text(0x00080018, "UI",
           fmt::format("{}.9.{}.{}", kRoot, instance + 1, std::hash<std::string>()(look.uid) % 100000));
    o.text(0x00080020, "DA", "20260101");
    o.text(0x00080060, "CS", look.modality);
    o.text(0x0008103e, "LO", look.description);
    o.text(0x00100010, "PN", look.patient);
    o.text(0x00100020, "LO", look.patient_id);
    o.text(0x00185100, "CS", look.position);
    o.text(0x0020000d, "UI", fmt::format("{}.3", kRoot));
    o.text(0x0020000e, "UI", look.uid);
    o.text(0x00200011, "IS", look.number);
    o.text(0x00200013, "IS", std::to_string((instance * 7) % 97 + 1));  // no order in it
    o.text(0x00200052, "UI", fmt::format("{}.5", kRoot));
    o.number(0x00280002, 1);
    o.text(0x00280004, "CS", "MONOCHROME2");
    o.number(0x00280010, static_cast<std::uint16_t>(grid.size[1]));
    o.number(0x00280011, static_cast<std::uint16_t>(grid.size[0]));
    o.number(0x00280100, 16);
    o.number(0x00280101, 16);
    o.number(0x00280102, 15);
    o.number(0x00280103, is_ct(look) && look.is_signed);
    return o;
}

Vector3d position_of(const Grid& grid, int k) {
    return grid.ct_from_voxel * Vector3d(0, 0, k);
}

std::vector<double> orientation_of(const Grid& grid) {
    const Vector3d r = grid.ct_from_voxel.linear().col(0).normalized(),
                   c = grid.ct_from_voxel.linear().col(1).normalized();
    return {r.x(), r.y(), r.z(), c.x(), c.y(), c.z()};
}

std::vector<double> spacing_of(const Grid& grid) {
    return {grid.ct_from_voxel.linear().col(1).norm(), grid.ct_from_voxel.linear().col(0).norm()};
}

std::vector<std::int16_t> slice_of(const std::vector<std::int16_t>& values, const Grid& grid, int k,
                                   const SeriesLook& look) {
    const auto slab = static_cast<std::ptrdiff_t>(grid.size[0]) * grid.size[1];
    std::vector<std::int16_t> slice(values.begin() + k * slab, values.begin() + (k + 1) * slab);
    for (auto& v : slice) v = stored(v, look);
    return slice;
}

}  // namespace

int phantom_hu(const Vector3d& p) {
    const double r =
        std::sqrt(std::pow(p.x() / 72, 2) + std::pow((p.y() - 4) / 84, 2) + std::pow((p.z() - 20) / 90, 2));
    const bool nose = std::abs(p.x() - 3) < 10 && p.y() < -60 && p.y() > -93 && p.z() < 10 && p.z() > -25;
    if (r > 1 && !nose) return -1000;
    if (r > 0.84 && r < 0.92) return 900 + static_cast<int>(std::lround(p.x() + 0.5 * p.z()));
    return 40 + static_cast<int>(std::lround(0.5 * p.x() + 0.2 * p.y() + 0.7 * p.z()));
}

std::vector<std::int16_t> phantom_values(const Grid& grid) {
    std::vector<std::int16_t> values;
    for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < grid.size[0]; ++i)
                values.push_back(static_cast<std::int16_t>(phantom_hu(grid.ct_from_voxel * Vector3d(i, j, k))));
    return values;
}

Grid turned_grid(const Eigen::Matrix3d& turn, double shear_mm) {
    Grid grid;
    const Vector3d half = Vector3d(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1) / 2;
    Eigen::Matrix3d axes = turn * grid.ct_from_voxel.linear();
    axes.col(2) += shear_mm * turn.col(1);
    const Vector3d middle = grid.ct_from_voxel * half;
    grid.ct_from_voxel.linear() = axes;
    grid.ct_from_voxel.translation() = middle - axes * half;
    return grid;
}

std::vector<DicomObject> synthetic_series(const Grid& grid, const SeriesLook& look) {
    const auto values = phantom_values(grid);
    std::vector<DicomObject> objects;
    for (int k = 0; k < grid.size[2]; ++k) {
        DicomObject o = common(grid, look, is_ct(look) ? "1.2.840.10008.5.1.4.1.1.2" : "1.2.840.10008.5.1.4.1.1.4", k);
        const Vector3d p = position_of(grid, k);
        o.decimals(0x00200032, {p.x(), p.y(), p.z()});
        o.decimals(0x00200037, orientation_of(grid));
        o.decimals(0x00280030, spacing_of(grid));
        if (is_ct(look)) {
            o.decimals(0x00281052, {look.is_signed ? 0.0 : -1024.0});
            o.decimals(0x00281053, {1});
            o.text(0x00281054, "LO", "HU");
        }
        o.pixels(slice_of(values, grid, k, look));
        objects.push_back(std::move(o));
    }
    return objects;
}

DicomObject enhanced_object(const Grid& grid, const SeriesLook& look) {
    const auto values = phantom_values(grid);
    DicomObject o = common(grid, look, is_ct(look) ? "1.2.840.10008.5.1.4.1.1.2.1" : "1.2.840.10008.5.1.4.1.1.4.1", 0);
    o.text(0x00280008, "IS", std::to_string(grid.size[2]));
    DicomObject measures, orientation, rescale, shared;
    measures.decimals(0x00280030, spacing_of(grid));
    orientation.decimals(0x00200037, orientation_of(grid));
    rescale.decimals(0x00281052, {look.is_signed || !is_ct(look) ? 0.0 : -1024.0});
    rescale.decimals(0x00281053, {1});
    rescale.text(0x00281054, "LO", is_ct(look) ? "HU" : "US");
    shared.items(0x00209116, {orientation});
    shared.items(0x00289110, {measures});
    shared.items(0x00289145, {rescale});
    o.items(0x52009229, {shared});
    std::vector<int> order(static_cast<std::size_t>(grid.size[2]));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(3));
    std::vector<DicomObject> frames;
    std::vector<std::int16_t> pixels;
    for (const int k : order) {
        const auto slice = slice_of(values, grid, k, look);
        pixels.insert(pixels.end(), slice.begin(), slice.end());
        DicomObject place, frame;
        const Vector3d p = position_of(grid, k);
        place.decimals(0x00200032, {p.x(), p.y(), p.z()});
        frame.items(0x00209113, {place});
        frames.push_back(std::move(frame));
    }
    o.items(0x52009230, std::move(frames));
    o.pixels(pixels);
    return o;
}

std::vector<std::filesystem::path> write_series(const std::vector<DicomObject>& objects,
                                                const std::filesystem::path& folder, DicomEncoding encoding,
                                                const std::string& transfer_syntax) {
    std::filesystem::create_directories(folder);
    std::vector<std::filesystem::path> files;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        files.push_back(folder / fmt::format("I{:04}", (i * 37 + 11) % 1009));  // 1009 is prime: no name twice
        std::ofstream(files.back(), std::ios::binary) << encode_dicom(objects[i], encoding, transfer_syntax);
    }
    return files;
}

}  // namespace planlight::test
