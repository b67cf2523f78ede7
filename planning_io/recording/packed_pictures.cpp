#include "planning_io/recording/packed_pictures.h"

#include <zstd.h>

#include <array>
#include <stdexcept>
#include <vector>

#include "planning_io/files/checked_chunks.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr int kMostPixels = 20000;  // of one side of a picture
constexpr int kLevel = 1;

[[noreturn]] void refuse(const std::filesystem::path& file) {
    throw DamagedFileError(file, "a picture in it is none, or has an impossible size", "Copy the file again.");
}

/// Neighbours on skin are alike: differences along the rows (of `step` bytes) are smaller than the greys.
std::string packed(const std::uint8_t* values, std::size_t count, std::size_t step) {
    std::vector<std::uint8_t> differences(count);
    for (std::size_t i = 0; i < std::min(count, step); ++i) differences[i] = values[i];
    for (std::size_t i = step; i < count; ++i) differences[i] = static_cast<std::uint8_t>(values[i] - values[i - step]);
    std::string bytes(ZSTD_compressBound(count), '\0');
    const std::size_t size = ZSTD_compress(bytes.data(), bytes.size(), differences.data(), count, kLevel);
    if (ZSTD_isError(size))
        throw std::runtime_error(std::string("a picture cannot be packed: ") + ZSTD_getErrorName(size));
    bytes.resize(size);
    return bytes;
}

void unpack(std::string_view bytes, std::uint8_t* values, std::size_t count, std::size_t step,
            const std::filesystem::path& file) {
    const std::size_t size = ZSTD_decompress(values, count, bytes.data(), bytes.size());
    if (ZSTD_isError(size) || size != count) refuse(file);
    for (std::size_t i = step; i < count; ++i) values[i] = static_cast<std::uint8_t>(values[i] + values[i - step]);
}

struct Size {
    int width, height;
    std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Both sides, refused before any memory is asked for.
Size next_size(FieldReader& fields, const std::filesystem::path& file) {
    const auto width = fields.next<std::int32_t>(), height = fields.next<std::int32_t>();
    if (width < 0 || height < 0 || width > kMostPixels || height > kMostPixels || (width == 0) != (height == 0))
        refuse(file);
    return {width, height};
}

void add(FieldWriter& fields, const GrayImage& picture) {
    fields.add(static_cast<std::int32_t>(picture.width));
    fields.add(static_cast<std::int32_t>(picture.height));
    fields.add_text(packed(picture.pixels.data(), picture.pixels.size(), 1));
}

GrayImage next_picture(FieldReader& fields, const std::filesystem::path& file) {
    const Size size = next_size(fields, file);
    const std::string bytes = fields.next_text();
    // Even black packs to a byte for some thousands: a size that the bytes cannot hold is no picture.
    if (size.pixels() / (std::size_t{1} << 17) > bytes.size()) refuse(file);
    GrayImage picture(size.width, size.height);
    unpack(bytes, picture.pixels.data(), picture.pixels.size(), 1, file);
    return picture;
}

}  // namespace

std::string pack_frame(const StereoFrame& frame) {
    FieldWriter fields;
    fields.add(static_cast<std::int64_t>(frame.at.count()));
    fields.add(static_cast<std::int64_t>(frame.exposure.count()));
    fields.add(static_cast<std::uint64_t>(frame.number));
    add(fields, frame.left);
    add(fields, frame.right);
    return fields.bytes();
}

StereoFrame unpack_frame(std::string_view bytes, const std::filesystem::path& file) try {
    FieldReader fields(bytes, file);
    StereoFrame frame;
    frame.at = Instant(fields.next<std::int64_t>());
    frame.exposure = Instant(fields.next<std::int64_t>());
    frame.number = fields.next<std::uint64_t>();
    frame.left = next_picture(fields, file);
    frame.right = next_picture(fields, file);
    fields.expect_end();
    return frame;
} catch (const DamagedFileError&) {
    refuse(file);
}

std::string pack_picture(const RgbImage& picture) {
    FieldWriter fields;
    fields.add(static_cast<std::int32_t>(picture.width));
    fields.add(static_cast<std::int32_t>(picture.height));
    fields.add_text(picture.pixels.empty() ? std::string{}
                                           : packed(picture.pixels.front().data(), 3 * picture.pixels.size(), 3));
    return fields.bytes();
}

RgbImage unpack_picture(std::string_view bytes, const std::filesystem::path& file) try {
    FieldReader fields(bytes, file);
    const Size size = next_size(fields, file);
    const std::string stored = fields.next_text();
    fields.expect_end();
    if (3 * size.pixels() / (std::size_t{1} << 17) > stored.size()) refuse(file);
    RgbImage picture(size.width, size.height);
    if (!picture.pixels.empty()) unpack(stored, picture.pixels.front().data(), 3 * picture.pixels.size(), 3, file);
    return picture;
} catch (const DamagedFileError&) {
    refuse(file);
}

std::string hash_of(const StereoFrame& frame) {
    ContentHash hash;
    for (const GrayImage* picture : {&frame.left, &frame.right}) {
        const std::array<std::int32_t, 2> size{picture->width, picture->height};
        hash.add_values(size.data(), size.size());
        hash.add_bytes(picture->pixels.data(), picture->pixels.size());
    }
    return hash.hex();
}

std::string hash_of(const RgbImage& picture) {
    ContentHash hash;
    const std::array<std::int32_t, 2> size{picture.width, picture.height};
    hash.add_values(size.data(), size.size());
    hash.add_bytes(picture.pixels.data(), 3 * picture.pixels.size());
    return hash.hex();
}

}  // namespace planlight
