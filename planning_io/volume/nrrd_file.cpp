#include "planning_io/volume/nrrd_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "planning_io/files/byte_source.h"
#include "planning_io/files/header_text.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kSaveAgain = "Save it again as NRRD with one grey value a voxel, or give the DICOM series.";
constexpr double kPerpendicular = 1e-3;

VoxelType voxel_type(const TextHeader& header) {
    static const std::map<std::string, VoxelType> kTypes = {{"signed char", VoxelType::int8},
                                                            {"int8", VoxelType::int8},
                                                            {"int8_t", VoxelType::int8},
                                                            {"uchar", VoxelType::uint8},
                                                            {"unsigned char", VoxelType::uint8},
                                                            {"uint8", VoxelType::uint8},
                                                            {"uint8_t", VoxelType::uint8},
                                                            {"short", VoxelType::int16},
                                                            {"short int", VoxelType::int16},
                                                            {"signed short", VoxelType::int16},
                                                            {"signed short int", VoxelType::int16},
                                                            {"int16", VoxelType::int16},
                                                            {"int16_t", VoxelType::int16},
                                                            {"ushort", VoxelType::uint16},
                                                            {"unsigned short", VoxelType::uint16},
                                                            {"unsigned short int", VoxelType::uint16},
                                                            {"uint16", VoxelType::uint16},
                                                            {"uint16_t", VoxelType::uint16},
                                                            {"int", VoxelType::int32},
                                                            {"signed int", VoxelType::int32},
                                                            {"int32", VoxelType::int32},
                                                            {"int32_t", VoxelType::int32},
                                                            {"uint", VoxelType::uint32},
                                                            {"unsigned int", VoxelType::uint32},
                                                            {"uint32", VoxelType::uint32},
                                                            {"uint32_t", VoxelType::uint32},
                                                            {"float", VoxelType::float32},
                                                            {"double", VoxelType::float64}};
    const auto type = kTypes.find(lower_case(header.at("type")));
    if (type == kTypes.end())
        throw InputError(header.file, "has voxels of type \"" + header.at("type") + "\"", kSaveAgain);
    return type->second;
}

/// From the file's space to LPS. A left-handed space (LAS) is one that NRRD defines, and as exact as the others.
Vector3d lps_signs(const TextHeader& header) {
    static const std::map<std::string, Vector3d> kSpaces = {
        {"left-posterior-superior", {1, 1, 1}},   {"lps", {1, 1, 1}},
        {"right-anterior-superior", {-1, -1, 1}}, {"ras", {-1, -1, 1}},
        {"left-anterior-superior", {1, -1, 1}},   {"las", {1, -1, 1}}};
    if (!header.has("space"))
        throw InputError(
            header.file, "does not say its frame (\"space\")",
            "Save it with \"space: left-posterior-superior\" from the program that made it, or give the DICOM series.");
    const auto space = kSpaces.find(lower_case(header.at("space")));
    if (space == kSpaces.end())
        throw InputError(header.file, "is in the space \"" + header.at("space") + "\", which is not that of a patient",
                         "Save it in left-posterior-superior or right-anterior-superior.");
    return space->second;
}

/// "(a,b,c)" ...: groups of three numbers.
std::vector<Vector3d> vectors_of(const TextHeader& header, const std::string& name, std::size_t count) {
    std::string text = header.at(name);
    const auto opened = std::count(text.begin(), text.end(), '(');
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
    const auto numbers = numbers_of(text);
    if (numbers.size() != 3 * count || opened != static_cast<std::ptrdiff_t>(count))
        throw DamagedFileError(header.file,
                               fmt::format("has \"{}\" in its header that is not {} of three numbers", name,
                                           counted(static_cast<long long>(count), "vector")),
                               kSaveAgain);
    std::vector<Vector3d> vectors;
    for (std::size_t v = 0; v < count; ++v)
        vectors.emplace_back(numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]);
    return vectors;
}

void check_units(const TextHeader& header) {
    std::string units = header.get("space units", "\"mm\"");
    std::replace(units.begin(), units.end(), '"', ' ');
    std::istringstream words(units);
    for (std::string word; words >> word;)
        if (word != "mm") throw InputError(header.file, "has lengths in \"" + word + "\"", "Save it in millimetres.");
}

/// Three axes of space, of grey values that a scanner measured.
void check_kinds(const TextHeader& header) {
    std::istringstream words(lower_case(header.get("kinds", "")));
    for (std::string word; words >> word;)
        if (word != "domain" && word != "space" && word != "none" && word != "???")
            throw InputError(header.file, "has an axis of kind \"" + word + "\", which is none of space", kSaveAgain);
    if (header.has("segment0_id"))  // "Segment0_ID:=..."
        throw InputError(header.file, "is a segmentation of 3D Slicer, not what a scanner measured",
                         "Give the volume that it was drawn on.");
}

Packing packing_of(const TextHeader& header) {
    const std::string encoding = lower_case(header.at("encoding"));
    if (encoding == "raw") return Packing::none;
    if (encoding == "gzip" || encoding == "gz") return Packing::deflate;
    throw InputError(header.file, "is encoded as \"" + encoding + "\"", "Save it raw or with gzip.");
}

bool is_big_endian(const TextHeader& header, VoxelType type) {
    if (bytes_of(type) == 1) return false;
    const std::string endian = lower_case(header.at("endian"));
    if (endian != "little" && endian != "big")
        throw DamagedFileError(header.file, "has the byte order \"" + endian + "\"", kSaveAgain);
    return endian == "big";
}

}  // namespace

Volume parse_nrrd(const fs::path& file) {
    const TextHeader header = read_text_header(file, ":", "");
    std::ifstream in(file, std::ios::binary);
    std::string magic(8, '\0');
    if (!in.read(magic.data(), 8) || !magic.starts_with("NRRD000"))
        throw DamagedFileError(file, "is not a NRRD file", kSaveAgain);
    if (header.numbers("dimension", 1)[0] != 3)
        throw InputError(file, "has " + header.at("dimension") + " axes, not 3", kSaveAgain);
    const Vector3d signs = lps_signs(header);
    check_units(header);
    check_kinds(header);

    Volume volume;
    const auto sizes = header.numbers("sizes", 3);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(sizes[axis] >= 1) || !(sizes[axis] <= 8192) || sizes[axis] != std::floor(sizes[axis]))
            throw DamagedFileError(file, "has a size of \"" + header.at("sizes") + "\"", kSaveAgain);
        volume.size[axis] = static_cast<int>(sizes[axis]);
    }
    const auto directions = vectors_of(header, "space directions", 3);
    for (int axis = 0; axis < 3; ++axis)
        volume.ct_from_voxel.linear().col(axis) = signs.cwiseProduct(directions[static_cast<std::size_t>(axis)]);
    volume.ct_from_voxel.translation() = signs.cwiseProduct(vectors_of(header, "space origin", 1).front());
    check_grid(volume, file, kPerpendicular);
    check_not_defaced(file, header.get("content", ""));

    const VoxelType type = voxel_type(header);
    const Packing packing = packing_of(header);
    if (header.get("line skip", "0") != "0" || header.get("lineskip", "0") != "0")
        throw InputError(file, "skips lines of its data file", kSaveAgain);
    const double skip = header.has("byte skip")  ? header.numbers("byte skip", 1)[0]
                        : header.has("byteskip") ? header.numbers("byteskip", 1)[0]
                                                 : 0;
    if (!(skip >= 0) || !(skip < 1e9) || skip != std::floor(skip))
        throw InputError(file, fmt::format("skips {} bytes of its data file", skip), kSaveAgain);
    const std::string detached = header.get("data file", header.get("datafile", ""));
    ByteSource source(detached.empty() ? file : data_file_beside(file, detached), detached.empty() ? header.bytes : 0,
                      packing);
    source.skip(static_cast<std::uint64_t>(skip));
    volume.values = read_voxels(source, type, is_big_endian(header, type), volume.index(0, 0, volume.size[2]));
    volume.source = "NRRD file " + file.filename().string();
    return volume;
}

}  // namespace planlight
