#include "planning_io/volume/nifti_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "planning_io/files/byte_source.h"
#include "planning_io/files/header_text.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Affine3d;

constexpr const char* kCopyAgain = "Copy or convert the file again.";
constexpr double kSameFrame_mm = 0.5;
constexpr double kPerpendicular = 1e-3;  // floats and quaternions of single precision

/// The 348 bytes of the header (nifti1.h), in whichever byte order.
class Header {
public:
    Header(ByteSource& source) : file_(source.file()) {
        source.read(bytes_.data(), bytes_.size());
        const auto size = at<std::int32_t>(0);
        swap_ = size != 348;
        if (size == 540 || (swap_ && at<std::int32_t>(0) == 540))
            throw InputError(file_, "is a NIfTI-2 file", "Convert it to NIfTI-1 (.nii.gz), or give the DICOM series.");
        if (at<std::int32_t>(0) != 348)
            throw DamagedFileError(file_, "is not a NIfTI-1 file (its header does not say 348 bytes)", kCopyAgain);
        const std::string magic(reinterpret_cast<const char*>(bytes_.data()) + 344, 3);
        if (magic == "ni1")
            throw InputError(file_, "is half of a pair (.hdr and .img)", "Save it as one file (.nii or .nii.gz).");
        if (magic != "n+1")
            throw InputError(file_, "is an Analyze or damaged file: it does not say which way its axes point",
                             "Convert the DICOM series to NIfTI again.");
    }
    template <class T>
    T at(std::size_t offset, std::size_t index = 0) const {
        std::array<unsigned char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), bytes_.data() + offset + index * sizeof(T), sizeof(T));
        if (swap_) std::reverse(bytes.begin(), bytes.end());
        return std::bit_cast<T>(bytes);
    }
    std::string text(std::size_t offset, std::size_t length) const {
        const std::string all(reinterpret_cast<const char*>(bytes_.data()) + offset, length);
        return all.substr(0, all.find('\0'));
    }
    bool big_endian() const { return swap_ != (std::endian::native == std::endian::big); }
    const fs::path& file() const { return file_; }

private:
    fs::path file_;
    std::array<unsigned char, 348> bytes_{};
    bool swap_ = false;
};

VoxelType voxel_type(const Header& header) {
    switch (const auto code = header.at<std::int16_t>(70)) {
        case 2:
            return VoxelType::uint8;
        case 4:
            return VoxelType::int16;
        case 8:
            return VoxelType::int32;
        case 16:
            return VoxelType::float32;
        case 64:
            return VoxelType::float64;
        case 256:
            return VoxelType::int8;
        case 512:
            return VoxelType::uint16;
        case 768:
            return VoxelType::uint32;
        case 1024:
            return VoxelType::int64;
        case 1280:
            return VoxelType::uint64;
        default:
            throw InputError(header.file(),
                             fmt::format("has voxels of type {}, which is not one grey value each", code),
                             "Save it with 16 bit integers or floats.");
    }
}

double millimetres_of(const Header& header) {
    switch (const int unit = header.at<std::uint8_t>(123) & 7) {
        case 0:
        case 2:
            return 1;  // 0: unsaid; the size is checked to be a head's
        case 1:
            return 1000;
        case 3:
            return 0.001;
        default:
            throw InputError(header.file(), fmt::format("has a unit of length of code {}", unit),
                             "Save it in millimetres.");
    }
}

/// Method 3: rows of the affine as they stand.
std::optional<Affine3d> sform(const Header& header) {
    if (header.at<std::int16_t>(254) <= 0) return std::nullopt;
    Affine3d affine = Affine3d::Identity();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            affine(row, column) = header.at<float>(280, static_cast<std::size_t>(row * 4 + column));
    return affine;
}

/// Method 2: a quaternion, the spacing, and the side of the third axis.
std::optional<Affine3d> qform(const Header& header) {
    if (header.at<std::int16_t>(252) <= 0) return std::nullopt;
    const double b = header.at<float>(256), c = header.at<float>(260), d = header.at<float>(264);
    const double rest = 1 - (b * b + c * c + d * d);
    if (!(rest > -1e-3))
        throw InputError(header.file(),
                         fmt::format("has a quaternion that is none (b^2 + c^2 + d^2 = {:.4f})", 1 - rest), kCopyAgain);
    const Eigen::Quaterniond turn = Eigen::Quaterniond(std::sqrt(std::max(0.0, rest)), b, c, d).normalized();
    Affine3d affine = Affine3d::Identity();
    affine.linear() = turn.toRotationMatrix();
    const double side = header.at<float>(76) < 0 ? -1 : 1;
    for (int axis = 0; axis < 3; ++axis)
        affine.linear().col(axis) *= header.at<float>(80, static_cast<std::size_t>(axis)) * (axis == 2 ? side : 1);
    for (int row = 0; row < 3; ++row) affine(row, 3) = header.at<float>(268, static_cast<std::size_t>(row));
    return affine;
}

double apart_mm(const Affine3d& a, const Affine3d& b, const std::array<int, 3>& size) {
    double most = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d voxel((corner & 1) * (size[0] - 1), ((corner >> 1) & 1) * (size[1] - 1),
                                    (corner >> 2) * (size[2] - 1));
        most = std::max(most, (a * voxel - b * voxel).norm());
    }
    return most;
}

/// Voxel to RAS, in the header's unit.
Affine3d ras_from_voxel(const Header& header, const std::array<int, 3>& size, double mm) {
    const auto s = sform(header), q = qform(header);
    if (!s && !q)
        throw InputError(header.file(), "does not say its frame (neither sform nor qform is set)",
                         "Convert the DICOM series again with a program that writes one, or give the DICOM series.");
    for (const auto& form : {s, q})
        if (form && !form->matrix().allFinite())
            throw InputError(header.file(), "has a frame with a value that is not a number", kCopyAgain);
    if (s && q) {
        if (s->linear().determinant() * q->linear().determinant() < 0)
            throw InputError(header.file(),
                             "has a sform and a qform that mirror each other: left and right cannot be told",
                             "Convert the DICOM series again.");
        if (const double apart = mm * apart_mm(*s, *q, size); apart > kSameFrame_mm)
            throw InputError(header.file(),
                             fmt::format("has two frames, sform and qform, which differ by up to {:.1f} mm", apart),
                             "Keep the one that the plan was made in, and delete the other (set its code to 0).");
    }
    return s ? *s : *q;
}

void check_spacing(const Header& header, const Affine3d& affine) {
    for (int axis = 0; axis < 3; ++axis) {
        const double said = header.at<float>(80, static_cast<std::size_t>(axis)),
                     real = affine.linear().col(axis).norm();
        if (!(said > 0))
            throw InputError(header.file(), fmt::format("has a spacing of {} along axis {}", said, axis + 1),
                             kCopyAgain);
        if (!(std::abs(said - real) <= 0.01 * said))
            throw InputError(
                header.file(),
                fmt::format("has a spacing of {:.4g} along axis {}, but its frame means {:.4g}", said, axis + 1, real),
                "Convert the DICOM series again.");
    }
}

/// nifti1.h: 2 to 24 are statistics, 1002 to 1010 labels, matrices, vectors, points and triangles.
void check_intent(const Header& header) {
    const auto intent = header.at<std::int16_t>(68);
    if ((intent >= 2 && intent <= 24) || (intent >= 1002 && intent <= 1010))
        throw InputError(
            header.file(),
            fmt::format("holds labels, statistics or vectors (intent code {}), not what a scanner measured", intent),
            "Give the volume that they were made from.");
}

std::array<int, 3> size_of(const Header& header) {
    const int axes = header.at<std::int16_t>(40);
    std::array<int, 3> size{};
    for (int axis = 1; axis <= 7; ++axis) {
        const int count = header.at<std::int16_t>(40, static_cast<std::size_t>(axis));
        if (axis <= 3 && (axes < 3 || axes > 7 || count < 1))
            throw DamagedFileError(header.file(), fmt::format("has {} axes, the {}th of {} voxels", axes, axis, count),
                                   kCopyAgain);
        if (axis <= 3)
            size[static_cast<std::size_t>(axis - 1)] = count;
        else if (axis <= axes && count > 1)
            throw InputError(header.file(), fmt::format("holds {} volumes", count),
                             "Save the one to use as a file of its own.");
    }
    return size;
}

}  // namespace

Volume parse_nifti(const fs::path& file) {
    ByteSource source(file, 0, is_gzip(file) ? Packing::deflate : Packing::none);
    const Header header(source);
    Volume volume;
    volume.size = size_of(header);
    const double mm = millimetres_of(header);
    const Affine3d frame = ras_from_voxel(header, volume.size, mm);
    check_spacing(header, frame);
    volume.ct_from_voxel = Eigen::Scaling(-mm, -mm, mm) * frame;  // RAS to LPS
    check_grid(volume, file, kPerpendicular);
    check_not_defaced(file, header.text(148, 80));
    check_intent(header);

    const float slope = header.at<float>(112), offset = header.at<float>(116), begin = header.at<float>(108);
    const bool unsaid = std::isnan(slope) && (std::isnan(offset) || offset == 0);
    if (!unsaid && (!std::isfinite(slope) || (slope != 0 && !std::isfinite(offset))))
        throw InputError(file, fmt::format("scales its values by {} x + {}", slope, offset), kCopyAgain);
    if (!(begin >= 348) || !(begin < 1e8) || begin != std::floor(begin))
        throw DamagedFileError(file, fmt::format("has voxels that begin at byte {}", begin), kCopyAgain);
    source.skip(static_cast<std::uint64_t>(begin) - 348);
    volume.values = read_voxels(source, voxel_type(header), header.big_endian(), volume.index(0, 0, volume.size[2]));
    if (unsaid)
        volume.notes.push_back("its scale is not a number (scl_slope): the values are taken as they are stored");
    else if (slope != 0)
        for (float& v : volume.values) v = v * slope + offset;
    volume.source = "NIfTI file " + file.filename().string();
    if (const int code = sform(header) ? header.at<std::int16_t>(254) : header.at<std::int16_t>(252); code >= 3)
        volume.notes.push_back(fmt::format("its frame is that of a template (code {}), not the scanner's", code));
    return volume;
}

}  // namespace planlight
