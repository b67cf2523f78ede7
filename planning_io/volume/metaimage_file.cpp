#include "planning_io/volume/metaimage_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "planning_io/files/byte_source.h"
#include "planning_io/files/header_text.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSaveAgain = "Save it again as MetaImage with one grey value a voxel, or give the DICOM series.";
constexpr double kPerpendicular = 1e-3;

/// The value of whichever of the names the file uses (MetaIO reads them all alike).
std::string one_of(const TextHeader& header, std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (header.has(name)) return name;
    return "";
}

/// As MetaIO writes and reads them.
bool is_true(const TextHeader& header, const char* name) {
    const std::string word = lower_case(header.get(name, "false"));
    if (word == "true" || word == "t" || word == "1") return true;
    if (word == "false" || word == "f" || word == "0") return false;
    throw DamagedFileError(header.file, fmt::format("says \"{} = {}\", neither True nor False", name, word),
                           kSaveAgain);
}

VoxelType voxel_type(const TextHeader& header) {
    static const std::map<std::string, VoxelType> kTypes = {
        {"MET_CHAR", VoxelType::int8},       {"MET_UCHAR", VoxelType::uint8},       {"MET_SHORT", VoxelType::int16},
        {"MET_USHORT", VoxelType::uint16},   {"MET_INT", VoxelType::int32},         {"MET_UINT", VoxelType::uint32},
        {"MET_LONG_LONG", VoxelType::int64}, {"MET_ULONG_LONG", VoxelType::uint64}, {"MET_FLOAT", VoxelType::float32},
        {"MET_DOUBLE", VoxelType::float64}};
    const auto type = kTypes.find(header.at("elementtype"));
    if (type == kTypes.end())
        throw InputError(header.file, "has voxels of type " + header.at("elementtype"), kSaveAgain);
    return type->second;
}

/// ITK's letters of the side each axis comes from: "RAI" is the identity of LPS.
std::string letters_of(const Eigen::Matrix3d& directions) {
    std::string letters;
    for (int axis = 0; axis < 3; ++axis) {
        Eigen::Index along = 0;
        directions.col(axis).cwiseAbs().maxCoeff(&along);
        letters += (directions(along, axis) > 0 ? "RAI" : "LPS")[along];
    }
    return letters;
}

Eigen::Matrix3d directions_of(const TextHeader& header) {
    const std::string name = one_of(header, {"transformmatrix", "rotation", "orientation"});
    const std::string letters = header.get("anatomicalorientation", "");
    if ((name.empty() && letters.empty()) || letters.find('?') != std::string::npos)
        throw InputError(header.file,
                         "does not say its frame (" +
                             (letters.empty() ? std::string("no TransformMatrix, no AnatomicalOrientation")
                                              : "AnatomicalOrientation = " + letters) +
                             ")",
                         "Save it from a program that knows the patient's directions, or give the DICOM series.");
    Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();
    if (!name.empty()) {
        const auto numbers = header.numbers(name, 9);
        directions =
            Eigen::Map<const Eigen::Matrix3d>(numbers.data());  // the file's rows are the directions of the axes
    }
    for (int axis = 0; axis < 3; ++axis)
        if (const double length = directions.col(axis).norm(); !(std::abs(length - 1) < 1e-3))
            throw InputError(header.file,
                             fmt::format("has a direction of length {:.4f} in its TransformMatrix", length),
                             kSaveAgain);
    if (const std::string meant = letters_of(directions); !letters.empty() && letters != meant)
        throw InputError(header.file,
                         "says AnatomicalOrientation = " + letters + ", but its TransformMatrix means " + meant +
                             ": left and right cannot be told",
                         kSaveAgain);
    return directions;
}

}  // namespace

Volume parse_metaimage(const fs::path& file) {
    const TextHeader header = read_text_header(file, "=", "elementdatafile");
    if (header.numbers("ndims", 1)[0] != 3)
        throw InputError(file, "has " + header.at("ndims") + " axes, not 3", kSaveAgain);
    if (header.get("elementnumberofchannels", "1") != "1")
        throw InputError(file, "has " + header.at("elementnumberofchannels") + " values a voxel", kSaveAgain);
    if (header.has("binarydata") && !is_true(header, "binarydata"))
        throw InputError(file, "holds its voxels as text", kSaveAgain);

    Volume volume;
    const auto sizes = header.numbers("dimsize", 3);
    const auto spacing = header.numbers(header.has("elementspacing") ? "elementspacing" : "elementsize", 3);
    const std::string origin_name = one_of(header, {"offset", "position", "origin"});
    if (origin_name.empty()) throw InputError(file, "does not say where it is (\"Offset\")", kSaveAgain);
    const auto origin = header.numbers(origin_name, 3);
    const Eigen::Matrix3d directions = directions_of(header);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(sizes[axis] >= 1) || !(sizes[axis] <= 8192) || sizes[axis] != std::floor(sizes[axis]))
            throw DamagedFileError(file, "has a size of \"" + header.at("dimsize") + "\"", kSaveAgain);
        if (!(spacing[axis] > 0))
            throw InputError(file, fmt::format("has a spacing of {} along axis {}", spacing[axis], axis + 1),
                             kSaveAgain);
        volume.size[axis] = static_cast<int>(sizes[axis]);
        volume.ct_from_voxel.linear().col(static_cast<int>(axis)) =
            spacing[axis] * directions.col(static_cast<int>(axis));
        volume.ct_from_voxel.translation()[static_cast<int>(axis)] = origin[axis];
    }
    if (!header.get("distanceunits", "mm").empty() && lower_case(header.get("distanceunits", "mm")) != "mm")
        throw InputError(file, "has lengths in " + header.at("distanceunits"), "Save it in millimetres.");
    check_grid(volume, file, kPerpendicular);
    check_not_defaced(file, header.get("comment", ""));

    const std::string modality = header.get("modality", "");
    for (const char* other : {"MET_MOD_NM", "MET_MOD_US", "MET_MOD_PET"})
        if (modality == other)
            throw InputError(file, "is of modality " + modality + ", neither CT nor MR", "Give a CT or MR volume.");

    const std::string data = header.at("elementdatafile");
    const bool local = data == "LOCAL" || data == "Local" || data == "local";
    const Packing packing = is_true(header, "compresseddata") ? Packing::deflate : Packing::none;
    const double skip = header.has("headersize") ? header.numbers("headersize", 1)[0] : 0;
    if (!(skip >= 0) || !(skip < 1e9) || skip != std::floor(skip) || (local && skip != 0))
        throw InputError(file, fmt::format("has a HeaderSize of {}", skip), kSaveAgain);
    ByteSource source(local ? file : data_file_beside(file, data),
                      local ? header.bytes : static_cast<std::uint64_t>(skip), packing);
    const bool big =
        is_true(header, header.has("binarydatabyteordermsb") ? "binarydatabyteordermsb" : "elementbyteordermsb");
    volume.values = read_voxels(source, voxel_type(header), big, volume.index(0, 0, volume.size[2]));
    volume.source = "MetaImage file " + file.filename().string();
    if (modality == "MET_MOD_CT" || modality == "MET_MOD_MR") {
        volume.modality = modality.substr(8);
        volume.is_hu = volume.modality == "CT" && has_air_in_hu(volume);
    }
    return volume;
}

}  // namespace planlight
