#include "planning_io/volume/mgh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "planning_io/files/byte_source.h"
#include "planning_io/files/header_text.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCopyAgain = "Copy or convert the file again.";
constexpr std::size_t kHeader = 284;
constexpr std::uint64_t kMostTags = 16'000'000;  // the command lines that made it follow the voxels
constexpr double kPerpendicular = 1e-3;

class Header {
public:
    explicit Header(ByteSource& source) : file_(source.file()) {
        source.read(bytes_.data(), bytes_.size());
        if (at<std::int32_t>(0) != 1)
            throw DamagedFileError(file_, "is not a FreeSurfer volume of version 1", kCopyAgain);
    }
    template <class T>
    T at(std::size_t offset, std::size_t index = 0) const {
        std::array<unsigned char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), bytes_.data() + offset + index * sizeof(T), sizeof(T));
        if constexpr (std::endian::native == std::endian::little) std::reverse(bytes.begin(), bytes.end());
        return std::bit_cast<T>(bytes);
    }
    const fs::path& file() const { return file_; }

private:
    fs::path file_;
    std::array<unsigned char, kHeader> bytes_{};
};

std::array<int, 3> size_of(const Header& header) {
    std::array<int, 3> size{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        size[axis] = header.at<std::int32_t>(4, axis);
        if (size[axis] < 1 || size[axis] > 100'000)
            throw DamagedFileError(header.file(), fmt::format("has {} voxels along axis {}", size[axis], axis + 1),
                                   kCopyAgain);
    }
    if (const int frames = header.at<std::int32_t>(16); frames != 1)
        throw InputError(header.file(), fmt::format("holds {} volumes", frames),
                         "Save the one to use as a file of its own.");
    return size;
}

VoxelType voxel_type(const Header& header) {
    switch (const int code = header.at<std::int32_t>(20)) {
        case 0:
            return VoxelType::uint8;
        case 1:
            return VoxelType::int32;
        case 3:
            return VoxelType::float32;
        case 4:
            return VoxelType::int16;
        default:
            throw InputError(header.file(),
                             fmt::format("has voxels of type {}, which is not one grey value each", code),
                             "Save it with 16 bit integers or floats.");
    }
}

/// RAS from voxel: the directions of the axes times their spacing, and the place of the middle voxel.
Eigen::Affine3d ras_from_voxel(const Header& header, const std::array<int, 3>& size) {
    if (header.at<std::int16_t>(28) <= 0)
        throw InputError(header.file(), "does not say its frame (its \"good RAS\" is 0)",
                         "Convert the DICOM series again.");
    Eigen::Affine3d affine = Eigen::Affine3d::Identity();
    for (int axis = 0; axis < 3; ++axis)
        for (int row = 0; row < 3; ++row)
            affine(row, axis) = static_cast<double>(header.at<float>(42, static_cast<std::size_t>(3 * axis + row))) *
                                static_cast<double>(header.at<float>(30, static_cast<std::size_t>(axis)));
    const Eigen::Vector3d middle(size[0] / 2.0, size[1] / 2.0, size[2] / 2.0);
    for (int row = 0; row < 3; ++row)
        affine(row, 3) = static_cast<double>(header.at<float>(78, static_cast<std::size_t>(row))) -
                         affine.linear().row(row).dot(middle);
    if (!affine.matrix().allFinite())
        throw InputError(header.file(), "has a frame with a value that is not a number", kCopyAgain);
    return affine;
}

/// The programs that made the volume: the first words of the command lines that follow its voxels, among other tags.
std::string programs_in(const std::string& tags) {
    std::string programs;
    const auto is_text = [](char c) { return c >= ' ' && c <= '~'; };
    for (std::size_t at = 0; at < tags.size();) {
        std::size_t end = at;
        while (end < tags.size() && is_text(tags[end])) ++end;
        const std::string command = tags.substr(at, std::min(end, tags.find(' ', at)) - at);
        if (end > at) programs += command.substr(command.find_last_of('/') + 1) + " ";
        at = end + 1;
    }
    return programs;
}

}  // namespace

Volume parse_mgh(const fs::path& file) {
    ByteSource source(file, 0, is_gzip(file) ? Packing::deflate : Packing::none);
    const Header header(source);
    Volume volume;
    volume.size = size_of(header);
    volume.ct_from_voxel = Eigen::Scaling(-1.0, -1.0, 1.0) * ras_from_voxel(header, volume.size);  // RAS to LPS
    check_grid(volume, file, kPerpendicular);
    check_not_defaced(file, "");
    std::string tags;
    volume.values = read_voxels(source, voxel_type(header), true, volume.index(0, 0, volume.size[2]), kMostTags, &tags);
    check_not_defaced(file, programs_in(tags));
    volume.source = "FreeSurfer file " + file.filename().string();
    return volume;
}

}  // namespace planlight
