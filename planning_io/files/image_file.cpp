#include "planning_io/files/image_file.h"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>

#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

std::vector<unsigned char> encoded(const cv::Mat& picture, const fs::path& file) {
    std::vector<unsigned char> bytes;
    if (picture.empty() || !cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1}))
        throw DiskError(file, "an empty picture cannot be written", "Give a picture with at least one pixel.");
    return bytes;
}

void write_encoded(const cv::Mat& picture, const fs::path& file, ReadableBy readable_by = ReadableBy::umask) {
    const std::vector<unsigned char> bytes = encoded(picture, file);
    write_safely(
        file,
        [&](std::ostream& out) {
            out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        },
        readable_by);
}

cv::Mat bgr_of(const RgbImage& picture) {
    cv::Mat bgr(picture.height, picture.width, CV_8UC3);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const Rgb& from = picture.at(x, y);
            bgr.at<cv::Vec3b>(y, x) = {from[2], from[1], from[0]};
        }
    return bgr;
}

/// A PNG's chunks in order up to IEND; a cut file has none, and the decoder would fill the rest with grey.
bool png_is_whole(const std::string& bytes) {
    if (!bytes.starts_with("\x89PNG")) return true;
    return bytes.size() > 20 && bytes.compare(bytes.size() - 8, 4, "IEND") == 0;
}

/// 1 or 3 channels (BGR), 8 bit.
cv::Mat decode(const fs::path& file) {
    const std::string bytes = read_whole(file);
    const char* remedy = "Capture or copy the picture again (PNG or TIFF).";
    cv::Mat picture;
    try {
        if (!bytes.empty() && png_is_whole(bytes))
            picture = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data())),
                                   cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
    } catch (const cv::Exception&) {
        picture.release();
    }
    if (picture.empty()) throw DamagedFileError(file, "is not a whole picture", remedy);
    if (picture.depth() == CV_16U) {
        cv::Mat eight;
        picture.convertTo(eight, CV_8U, 1.0 / 257);
        picture = eight;
    }
    if (picture.depth() != CV_8U || (picture.channels() != 1 && picture.channels() != 3))
        throw InputError(file, "is neither an 8-bit nor a 16-bit grey or colour picture",
                         "Convert the picture to an 8-bit PNG.");
    return picture;
}

}  // namespace

void write_png(const GrayImage& picture, const fs::path& file) {
    write_encoded(cv::Mat(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.pixels.data())),
                  file);
}

void write_png(const RgbImage& picture, const fs::path& file, ReadableBy readable_by) {
    write_encoded(bgr_of(picture), file, readable_by);
}

std::string png_bytes(const RgbImage& picture) {
    const std::vector<unsigned char> bytes = encoded(bgr_of(picture), "picture");
    return {bytes.begin(), bytes.end()};
}

GrayImage read_gray(const fs::path& file) {
    const cv::Mat picture = decode(file);
    GrayImage grey(picture.cols, picture.rows);
    if (picture.channels() == 1) {
        for (int y = 0; y < picture.rows; ++y)
            std::copy_n(picture.ptr<std::uint8_t>(y), picture.cols,
                        grey.pixels.begin() + static_cast<std::ptrdiff_t>(grey.index(0, y)));
        return grey;
    }
    for (int y = 0; y < picture.rows; ++y)
        for (int x = 0; x < picture.cols; ++x) {
            const auto& bgr = picture.at<cv::Vec3b>(y, x);  // ITU-R BT.601 luma
            grey.at(x, y) = static_cast<std::uint8_t>(std::lround(0.299 * bgr[2] + 0.587 * bgr[1] + 0.114 * bgr[0]));
        }
    return grey;
}

RgbImage read_rgb(const fs::path& file) {
    const cv::Mat picture = decode(file);
    RgbImage rgb(picture.cols, picture.rows);
    for (int y = 0; y < picture.rows; ++y)
        for (int x = 0; x < picture.cols; ++x) {
            if (picture.channels() == 1) {
                const std::uint8_t value = picture.at<std::uint8_t>(y, x);
                rgb.at(x, y) = {value, value, value};
                continue;
            }
            const auto& bgr = picture.at<cv::Vec3b>(y, x);
            rgb.at(x, y) = {bgr[2], bgr[1], bgr[0]};
        }
    return rgb;
}

bool brighter_than_low_bits(const GrayImage& picture) {
    constexpr std::uint8_t kTwelveBits = 4095 / 257 + 1;
    return std::ranges::any_of(picture.pixels, [](std::uint8_t value) { return value > kTwelveBits; });
}

void check_depth(const std::vector<GrayImage>& pictures, const fs::path& file) {
    if (std::ranges::any_of(pictures, brighter_than_low_bits)) return;
    const std::string bytes = read_whole(file);
    const cv::Mat picture =
        cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data())),
                     cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
    if (picture.depth() == CV_16U)
        throw InputError(
            file, "has 16 bits, and no picture of this camera is brighter than 4095 of 65535",
            "If the camera has 10 or 12 bits, store them at the upper end (times 64, or 16), or as 8 bits; else "
            "expose longer.");
}

void check_same_size(const GrayImage& picture, const GrayImage& first, const std::filesystem::path& file) {
    if (picture.width != first.width || picture.height != first.height)
        throw InputError(file,
                         fmt::format("is {} x {} pixels, the first picture of this camera is {} x {}", picture.width,
                                     picture.height, first.width, first.height),
                         "Capture all pictures with the same settings.");
}

}  // namespace planlight
