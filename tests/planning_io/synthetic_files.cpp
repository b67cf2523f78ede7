#include "tests/planning_io/synthetic_files.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

namespace planlight::test {
namespace {

std::string packed(const std::string& plain, int window) {
    z_stream z{};
    deflateInit2(&z, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&z, plain.size()) + 64, '\0');
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
    z.avail_in = static_cast<uInt>(plain.size());
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    deflate(&z, Z_FINISH);
    out.resize(z.total_out);
    deflateEnd(&z);
    return out;
}

std::string three(const Eigen::Vector3d& v, const char* between) {
    return fmt::format("{:.9g}{}{:.9g}{}{:.9g}", v.x(), between, v.y(), between, v.z());
}

}  // namespace

std::string nifti_header(const Grid& grid) {
    std::string h(348, '\0');
    put<std::int32_t>(h, 0, 348);
    put<std::int16_t>(h, 40, 3);
    const Eigen::Matrix3d axes = grid.ct_from_voxel.linear();
    for (std::size_t a = 0; a < 3; ++a) {
        put<std::int16_t>(h, 42 + 2 * a, static_cast<std::int16_t>(grid.size[a]));
        put<float>(h, 80 + 4 * a, static_cast<float>(axes.col(static_cast<int>(a)).norm()));
    }
    for (std::size_t a = 3; a < 7; ++a) put<std::int16_t>(h, 42 + 2 * a, 1);
    put<std::int16_t>(h, 70, 4);
    put<std::int16_t>(h, 72, 16);
    put<float>(h, 76, 1);
    put<float>(h, 108, 352);
    put<std::uint8_t>(h, 123, 2);
    put<std::int16_t>(h, 254, 1);
    const Eigen::Matrix4d ras = (Eigen::Scaling(-1.0, -1.0, 1.0) * grid.ct_from_voxel).matrix();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            put<float>(h, 280 + 4 * static_cast<std::size_t>(row * 4 + column), static_cast<float>(ras(row, column)));
    h.replace(344, 4, std::string("n+1\0", 4));
    return h;
}

std::string nifti_bytes(const std::string& header, const Grid& grid) {
    return header + std::string(4, '\0') + int16_bytes(grid);
}

std::string nrrd_header(const Grid& grid, const std::string& encoding) {
    const Eigen::Affine3d& a = grid.ct_from_voxel;
    std::string directions;
    for (int axis = 0; axis < 3; ++axis)
        directions += fmt::format("{}({})", axis ? " " : "", three(a.linear().col(axis), ","));
    return fmt::format(
        "NRRD0004\n# made by a test\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\nspace "
        "directions: {}\n"
        "kinds: domain domain domain\nendian: little\nencoding: {}\nspace origin: ({})\n\n",
        grid.size[0], grid.size[1], grid.size[2], directions, encoding, three(a.translation(), ","));
}

std::string metaimage_header(const Grid& grid, bool is_packed) {
    const Eigen::Matrix3d axes = grid.ct_from_voxel.linear();
    const Eigen::Matrix3d unit = axes.colwise().normalized();
    return fmt::format(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = "
        "{}\nTransformMatrix = {} {} {}\n"
        "Offset = {}\nCenterOfRotation = 0 0 0\nElementSpacing = {}\nDimSize = {} {} {}\nElementType = "
        "MET_SHORT\nElementDataFile = LOCAL\n",
        is_packed ? "True" : "False", three(unit.col(0), " "), three(unit.col(1), " "), three(unit.col(2), " "),
        three(grid.ct_from_voxel.translation(), " "), three(axes.colwise().norm().transpose(), " "), grid.size[0],
        grid.size[1], grid.size[2]);
}

std::string int16_bytes(const Grid& grid, bool big_endian) {
    const auto values = phantom_values(grid);
    std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * 2);
    if (big_endian)
        for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
    return bytes;
}

std::string gzipped(const std::string& plain) {
    return packed(plain, 15 + 16);
}
std::string zlibbed(const std::string& plain) {
    return packed(plain, 15);
}

std::string mgh_bytes(const Grid& grid, const std::string& tags) {
    std::string bytes(284, '\0');
    const auto put_big = [&](std::size_t at, auto value) {
        put(bytes, at, value);
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + sizeof value));
    };
    put_big(0, std::int32_t{1});
    for (std::size_t axis = 0; axis < 3; ++axis) put_big(4 + 4 * axis, std::int32_t{grid.size[axis]});
    put_big(16, std::int32_t{1});
    put_big(20, std::int32_t{4});  // int16
    put_big(28, std::int16_t{1});  // it says its axes
    const Eigen::Affine3d ras = Eigen::Scaling(-1.0, -1.0, 1.0) * grid.ct_from_voxel;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        put_big(30 + 4 * at, static_cast<float>(ras.linear().col(axis).norm()));
        for (int row = 0; row < 3; ++row)
            put_big(42 + 12 * at + 4 * static_cast<std::size_t>(row),
                    static_cast<float>(ras.linear().col(axis).normalized()[row]));
        put_big(78 + 4 * at, static_cast<float>((ras * Eigen::Vector3d(grid.size[0] / 2.0, grid.size[1] / 2.0,
                                                                       grid.size[2] / 2.0))[axis]));
    }
    return bytes + int16_bytes(grid, true) + tags;
}

std::string invesalius_plist(const Grid& grid) {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE plist PUBLIC \"-//Apple//DTD PLIST 1.0//EN\" "
        "\"http://www.apple.com/DTDs/PropertyList-1.0.dtd\">\n"
        "<plist "
        "version=\"1.0\"><dict><key>modality</key><string>CT</string><key>name</key><string>Phantom</string>"
        "<key>orientation</key><integer>1</integer><key>affine</key><string></string>"
        "<key>spacing</key><array><real>3</real><real>3</real><real>4</real></array>"
        "<key>matrix</key><dict><key>dtype</key><string>int16</string><key>filename</key><string>matrix.dat</"
        "string><key>shape</key><array>"
        "<integer>{}</integer><integer>{}</integer><integer>{}</integer></array></dict></dict></plist>\n",
        grid.size[2], grid.size[1], grid.size[0]);
}

void write_invesalius_project(const std::filesystem::path& file, const Grid& grid, const std::string& plist) {
    archive* tar = archive_write_new();
    archive_write_set_format_ustar(tar);
    archive_write_add_filter_gzip(tar);
    archive_write_open_filename(tar, file.c_str());
    const std::pair<const char*, std::string> entries[] = {{"project/main.plist", plist},
                                                           {"project/matrix.dat", int16_bytes(grid)}};
    for (const auto& [name, content] : entries) {
        archive_entry* entry = archive_entry_new();
        archive_entry_set_pathname(entry, name);
        archive_entry_set_size(entry, static_cast<la_int64_t>(content.size()));
        archive_entry_set_filetype(entry, AE_IFREG);
        archive_entry_set_perm(entry, 0644);
        archive_write_header(tar, entry);
        archive_write_data(tar, content.data(), content.size());
        archive_entry_free(entry);
    }
    archive_write_close(tar);
    archive_write_free(tar);
}

}  // namespace planlight::test
