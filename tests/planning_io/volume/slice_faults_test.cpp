#include "planning_io/volume/slice_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

// Volumes as scanners make them: a ball of tissue, with noise in every voxel.
namespace planlight {
namespace {

constexpr int kSize = 64;

float voxel_of_ball(int i, int j, double k, std::mt19937& random) {
    std::normal_distribution<float> noise(0, 12);
    const double r = std::hypot(i - 31.5, std::hypot(j - 31.5, k - 31.5));
    return (r < 26 ? 40.F : -1000.F) + noise(random);
}

/// Slice k of the volume is that at `place(k)` of the ball.
template <class Place>
Volume stacked(int slices, const Place& place) {
    std::mt19937 random(7);
    Volume volume;
    volume.size = {kSize, kSize, slices};
    for (int k = 0; k < slices; ++k)
        for (int j = 0; j < kSize; ++j)
            for (int i = 0; i < kSize; ++i) volume.values.push_back(voxel_of_ball(i, j, place(k), random));
    return volume;
}

TEST(SliceFaults, AWholeVolumeHasNone) {
    Volume volume = stacked(kSize, [](int k) { return k; });
    note_slice_faults(volume);
    EXPECT_TRUE(volume.notes.empty()) << volume.notes.front();
}

TEST(SliceFaults, MissingSlicesAreSaidWithTheirPlace) {
    Volume volume = stacked(kSize - 6, [](int k) { return k < 15 ? k : k + 6; });
    note_slice_faults(volume);
    ASSERT_EQ(volume.notes.size(), 1U);
    EXPECT_NE(volume.notes[0].find("its slices 15 and 16 along axis 3"), std::string::npos) << volume.notes[0];
    EXPECT_NE(volume.notes[0].find("missing between them"), std::string::npos) << volume.notes[0];
}

TEST(SliceFaults, ABorderOfOneValueRoundNoiseIsNone) {  // as a program pads a volume
    Volume volume = stacked(kSize, [](int k) { return k; });
    for (int k = 0; k < kSize; ++k)
        for (int j = 0; j < kSize; ++j)
            for (int i = 0; i < kSize; ++i)
                if (k >= kSize - 6 || k < 5 || j < 6) volume.values[volume.index(i, j, k)] = -3000;
    note_slice_faults(volume);
    EXPECT_TRUE(volume.notes.empty()) << volume.notes.front();
}

// A program set all outside of the head to one value, and the field is wide: nine tenths of each slice are alike.
TEST(SliceFaults, AWideCleanBackgroundHidesNone) {
    const Volume ball = stacked(kSize, [](int k) { return k; });
    for (const bool twice : {true, false}) {
        constexpr int kWide = 4 * kSize;
        Volume volume;
        for (int k = 0; k < kSize + 6; ++k) {
            if (!twice && k >= kSize - 6) break;
            const int from = twice ? (k < 26 ? k : k - 6) : (k < 15 ? k : k + 6);
            for (int j = 0; j < kWide; ++j)
                for (int i = 0; i < kWide; ++i) {
                    const bool inside = std::hypot(i - 31.5, std::hypot(j - 31.5, from - 31.5)) < 29;
                    volume.values.push_back(inside ? ball.at(i, j, from) : -1024);
                }
            ++volume.size[2];
        }
        volume.size[0] = volume.size[1] = kWide;
        note_slice_faults(volume);
        ASSERT_FALSE(volume.notes.empty()) << twice;
        EXPECT_NE(volume.notes[0].find(twice ? "6 of its 70 slices along axis 3 are there twice" : "missing between"),
                  std::string::npos)
            << volume.notes[0];
    }
}

TEST(SliceFaults, SlicesThatAreThereTwiceAreSaid) {
    Volume volume = stacked(kSize, [](int k) { return k; });
    const auto slab = static_cast<std::ptrdiff_t>(volume.index(0, 0, 1));
    const std::vector<float> again(volume.values.begin() + 20 * slab, volume.values.begin() + 26 * slab);
    volume.values.insert(volume.values.begin() + 26 * slab, again.begin(), again.end());
    volume.size[2] += 6;
    note_slice_faults(volume);
    ASSERT_EQ(volume.notes.size(), 1U);
    EXPECT_NE(volume.notes[0].find("6 of its 70 slices along axis 3 are there twice"), std::string::npos)
        << volume.notes[0];
    EXPECT_NE(volume.notes[0].find("from slice 27 on"), std::string::npos) << volume.notes[0];
}

/// The note that two slices are exchanged, or nothing.
std::string exchange_said(Volume volume) {
    note_slice_faults(volume);
    for (const std::string& note : volume.notes)
        if (note.find("exchanged") != std::string::npos) return note;
    return {};
}

TEST(SliceFaults, TwoSlicesThatWereExchangedAreSaidWithTheirPlace) {
    for (const int apart : {1, 2, 5, 16}) {
        const std::string said = exchange_said(stacked(kSize, [apart](int k) {
            return k == 14 ? 14 + apart : k == 14 + apart ? 14 : k;
        }));
        EXPECT_NE(said.find("its slices 15 and " + std::to_string(15 + apart) + " along axis 3"), std::string::npos)
            << apart << " apart: " << said;
    }
}

TEST(SliceFaults, EverySecondSliceDarkerIsNoExchange) {  // as a scanner takes them that excites them by turns
    Volume volume = stacked(kSize, [](int k) { return k; });
    const std::size_t slab = volume.index(0, 0, 1);
    for (std::size_t v = 0; v < volume.values.size(); ++v)
        if (v / slab % 2 == 1) volume.values[v] = -1000 + 0.9F * (volume.values[v] + 1000);
    EXPECT_EQ(exchange_said(volume), "");
}

TEST(SliceFaults, NoiseAloneIsNoExchange) {
    EXPECT_EQ(exchange_said(stacked(kSize, [](int) { return 31; })), "");
}

TEST(SliceFaults, ASliceThatWasLostIsSaidAndEmptyOnesAtTheEndsAreNot) {
    Volume volume = stacked(kSize, [](int k) { return k; });
    const auto slab = static_cast<std::ptrdiff_t>(volume.index(0, 0, 1));
    std::fill(volume.values.end() - 2 * slab, volume.values.end(), -1000.F);
    std::fill(volume.values.begin(), volume.values.begin() + 3 * slab, -1000.F);
    note_slice_faults(volume);
    EXPECT_TRUE(volume.notes.empty()) << volume.notes.front();
    std::fill(volume.values.begin() + 40 * slab, volume.values.begin() + 41 * slab, 0.F);
    note_slice_faults(volume);
    ASSERT_FALSE(volume.notes.empty());
    EXPECT_NE(volume.notes[0].find("its slice 41 along axis 3 shows one value only"), std::string::npos)
        << volume.notes[0];
}

TEST(SliceFaults, AComputedVolumeMayHaveAnyNumberOfEqualSlices) {
    Volume volume;
    volume.size = {kSize, kSize, kSize};
    for (int k = 0; k < kSize; ++k)
        for (int j = 0; j < kSize; ++j)
            for (int i = 0; i < kSize; ++i)
                volume.values.push_back(std::hypot(i - 31.5, j - 31.5) < 20 ? 40.F : -1000.F);
    note_slice_faults(volume);
    EXPECT_TRUE(volume.notes.empty());
}

}  // namespace
}  // namespace planlight
