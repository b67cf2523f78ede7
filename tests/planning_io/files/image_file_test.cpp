#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "planning_io/case/frames_folder.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// Twelve bits at the lower end of sixteen read as nearly black, and a scan then finds a tenth of the skin, or none; at
/// the upper end they are read. A dark picture among brighter ones is nothing to refuse.
TEST(ImageFile, TwelveBitsAtTheLowerEndOfSixteenAreRefused) {
    const test::TemporaryFolder folder;
    const auto pictures = [&](int factor) {
        std::vector<GrayImage> read;
        for (const int value : {0, 4095}) {
            const fs::path file = folder.path() / fmt::format("{}.png", value);
            cv::imwrite(file.string(), cv::Mat(20, 30, CV_16UC1, cv::Scalar(value * factor)));
            read.push_back(read_gray(file));
        }
        return read;
    };
    const fs::path dark = folder.path() / "0.png";
    EXPECT_THROW(check_depth(pictures(1), dark), InputError);
    EXPECT_NO_THROW(check_depth(pictures(16), dark));
    EXPECT_EQ(pictures(16).back().at(3, 3), 255);
    write_png(GrayImage(30, 20), dark);
    EXPECT_NO_THROW(check_depth({read_gray(dark)}, dark)) << "8 bits, dark: for others to judge";
}

// Markers are not found in such frames, and lamps and exposure would be blamed.
TEST(ImageFile, FramesOfTwelveBitsAtTheLowerEndAreRefusedAsWell) {
    const test::TemporaryFolder folder;
    const fs::path frames = folder.path() / "frames";
    write_frames({{GrayImage(30, 20, 9), GrayImage(30, 20, 9), Instant(1000), Instant(50), 1},
                  {GrayImage(30, 20, 9), GrayImage(30, 20, 9), Instant(2000), Instant(50), 2}},
                 frames);
    EXPECT_EQ(read_frames(frames).size(), 2U) << "8 bits, dark: for others to judge";
    const auto store = [&](int value) {
        for (const char* picture : {"000000.png", "000001.png"})
            cv::imwrite((frames / "right" / picture).string(), cv::Mat(20, 30, CV_16UC1, cv::Scalar(value)));
    };
    store(4000);
    EXPECT_THROW(read_frames(frames), InputError);
    store(64000);
    EXPECT_EQ(read_frames(frames).back().right.at(3, 3), 64000 / 257);
}

TEST(ImageFile, PicturesReadBackAndCutOnesAreRefused) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    GrayImage grey(37, 23);
    for (std::size_t i = 0; i < grey.pixels.size(); ++i) grey.pixels[i] = static_cast<std::uint8_t>(i * 7);
    write_png(grey, file);
    EXPECT_EQ(read_gray(file).pixels, grey.pixels);
    EXPECT_EQ(read_rgb(file).at(5, 2), (Rgb{grey.at(5, 2), grey.at(5, 2), grey.at(5, 2)}));
    const std::string whole = read_whole(file);
    for (std::size_t length = 0; length < whole.size(); length += 5) {
        write_safely(file, whole.substr(0, length));
        EXPECT_THROW(read_gray(file), DamagedFileError) << length;
    }
    for (std::size_t at = 0; at < whole.size() - 12; at += 3) {
        std::string flipped = whole;
        flipped[at] = static_cast<char>(flipped[at] ^ 16);
        write_safely(file, flipped);
        EXPECT_THROW(read_gray(file), DamagedFileError) << at;
    }
    RgbImage colour(2, 1);
    colour.at(0, 0) = {255, 0, 0};
    colour.at(1, 0) = {0, 0, 255};
    write_png(colour, file);
    EXPECT_EQ(read_rgb(file).at(0, 0), (Rgb{255, 0, 0}));
    EXPECT_EQ(read_gray(file).at(0, 0), 76);  // 0.299 * 255
    EXPECT_EQ(read_gray(file).at(1, 0), 29);  // 0.114 * 255
    EXPECT_THROW(write_png(GrayImage(), file), DiskError);
}

}  // namespace
}  // namespace planlight
