#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <random>

#include "planning_io/case/skin_lut_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

void put(const std::filesystem::path& file, const std::string& content) {
    std::ofstream(file, std::ios::binary) << content;  // without waiting for the disk
}

const SkinLut& head_lut() {
    static const SkinLut lut = [] {
        SkinLut made = test::analytic_head_lut(6, 20);
        made.volume_hash = "0123456789abcdef0123456789abcdef";
        made.mesh_hash = "fedcba9876543210fedcba9876543210";
        return made;
    }();
    return lut;
}

void expect_same(const SkinLut& a, const SkinLut& b) {
    EXPECT_EQ(a.size, b.size);
    EXPECT_EQ(a.voxel_mm, b.voxel_mm);
    EXPECT_EQ(a.origin_in_ct, b.origin_in_ct);
    EXPECT_EQ(a.nearest, b.nearest);
    EXPECT_EQ(a.distance_size, b.distance_size);
    EXPECT_EQ(a.distance_voxel_mm, b.distance_voxel_mm);
    EXPECT_EQ(a.distance_mm, b.distance_mm);
    EXPECT_EQ(a.volume_hash, b.volume_hash);
    EXPECT_EQ(a.mesh_hash, b.mesh_hash);
    ASSERT_EQ(a.skin.size(), b.skin.size());
    for (std::size_t i = 0; i < a.skin.size(); ++i) {
        ASSERT_EQ(a.skin[i].position_in_ct, b.skin[i].position_in_ct);
        ASSERT_EQ(a.skin[i].normal_in_ct, b.skin[i].normal_in_ct);
        ASSERT_EQ(a.skin[i].voxel, b.skin[i].voxel);
        ASSERT_EQ(a.skin[i].flags, b.skin[i].flags);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(a.skin[i].thickness_mm),
                  std::bit_cast<std::uint32_t>(b.skin[i].thickness_mm));
    }
}

TEST(SkinLutFile, ReadsBackBitForBit) {
    const test::TemporaryFolder folder;
    SkinLut lut = head_lut();
    lut.skin[3].flags = kSeal;
    lut.skin[5].thickness_mm = 6.25F;  // the others' is unknown, which is no number
    write_skin_lut(lut, folder.path() / "skin.lut");
    expect_same(read_skin_lut(folder.path() / "skin.lut"), lut);
}

TEST(SkinLutFile, EveryFlippedBitIsRefused) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "skin.lut";
    write_skin_lut(head_lut(), file);
    const std::string whole = read_whole(file);
    std::mt19937 random(1);
    const auto refused = [&](std::size_t byte, int bit) {
        std::string flipped = whole;
        flipped[byte] = static_cast<char>(flipped[byte] ^ (1 << bit));
        put(file, flipped);
        try {
            read_skin_lut(file);
            return false;
        } catch (const DamagedFileError&) {
            return true;
        }
    };
    for (std::size_t byte = 0; byte < 400; ++byte)
        ASSERT_TRUE(refused(byte, static_cast<int>(byte % 8))) << "byte " << byte;
    for (int i = 0; i < 2000; ++i) {
        const auto byte = std::uniform_int_distribution<std::size_t>(0, whole.size() - 1)(random);
        ASSERT_TRUE(refused(byte, i % 8)) << "byte " << byte << " bit " << i % 8;
    }
}

TEST(SkinLutFile, CutOrLengthenedFileIsRefused) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "skin.lut";
    write_skin_lut(head_lut(), file);
    const std::string whole = read_whole(file);
    for (std::size_t length = 0; length < 300; ++length) {
        put(file, whole.substr(0, length));
        ASSERT_THROW(read_skin_lut(file), DamagedFileError) << length;
    }
    for (std::size_t cut = 1; cut < whole.size() - 300; cut = cut * 3 / 2 + 1) {
        put(file, whole.substr(0, whole.size() - cut));
        ASSERT_THROW(read_skin_lut(file), DamagedFileError) << whole.size() - cut;
    }
    put(file, whole + '\0');
    EXPECT_THROW(read_skin_lut(file), DamagedFileError);
    EXPECT_THROW(read_skin_lut(folder.path() / "none.lut"), InputError);
}

TEST(SkinLutFile, AThicknessThatMakesNoSenseIsNotWritten) {
    const test::TemporaryFolder folder;
    for (const float thickness : {-1.0F, std::numeric_limits<float>::infinity()}) {
        SkinLut lut = head_lut();
        lut.skin[7].thickness_mm = thickness;
        EXPECT_THROW(write_skin_lut(lut, folder.path() / "skin.lut"), InputError);
    }
}

TEST(SkinLutFile, ATableThatPointsPastItsSkinIsNotWritten) {
    const test::TemporaryFolder folder;
    SkinLut lut = head_lut();
    lut.nearest[7] = static_cast<std::uint32_t>(lut.skin.size());
    EXPECT_THROW(write_skin_lut(lut, folder.path() / "skin.lut"), InputError);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "skin.lut"));
}

// A table of 256^3 over a sphere, as large as a patient's. Timing is recorded, not judged: the machine may be busy.
TEST(SkinLutFile, LoadsAPatientSizedTable) {
    SkinLut lut;
    lut.size = {256, 256, 256};
    lut.voxel_mm = lut.distance_voxel_mm = 1;
    lut.distance_size = {128, 128, 128};
    lut.distance_voxel_mm = 2;
    std::vector<std::uint32_t> skin_of(256 * 256);
    const auto direction_cell = [](const Eigen::Vector3d& d) {
        const auto a = static_cast<int>(255.99 * (d.z() / 2 + 0.5)),
                   b = static_cast<int>(255.99 * (std::atan2(d.y(), d.x()) / 6.2831854 + 0.5));
        return static_cast<std::size_t>(a * 256 + b);
    };
    for (std::size_t c = 0; c < skin_of.size(); ++c) {
        skin_of[c] = static_cast<std::uint32_t>(lut.skin.size());
        lut.skin.push_back(
            {Eigen::Vector3f::Constant(static_cast<float>(c) * 0.01F), Eigen::Vector3f::UnitX(), {1, 2, 3}});
    }
    lut.nearest.resize(std::size_t{256} * 256 * 256);
    lut.distance_mm.resize(std::size_t{128} * 128 * 128);
    std::size_t at = 0;
    for (int k = 0; k < 256; ++k)
        for (int j = 0; j < 256; ++j)
            for (int i = 0; i < 256; ++i)
                lut.nearest[at++] =
                    skin_of[direction_cell((Eigen::Vector3d(i, j, k) - Eigen::Vector3d::Constant(127.5)).normalized())];
    at = 0;
    for (int k = 0; k < 128; ++k)
        for (int j = 0; j < 128; ++j)
            for (int i = 0; i < 128; ++i)
                lut.distance_mm[at++] =
                    static_cast<float>((Eigen::Vector3d(i, j, k) - Eigen::Vector3d::Constant(63.5)).norm() * 2 - 90);
    const test::TemporaryFolder folder;
    write_skin_lut(lut, folder.path() / "skin.lut");
    double best_s = 1e9, best_processor_s = 1e9;
    for (int i = 0; i < 3; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        const std::clock_t begin_processor = std::clock();
        const SkinLut back = read_skin_lut(folder.path() / "skin.lut");
        best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        best_processor_s =
            std::min(best_processor_s, static_cast<double>(std::clock() - begin_processor) / CLOCKS_PER_SEC);
        EXPECT_EQ(back.nearest, lut.nearest);
    }
    RecordProperty("load_s", std::to_string(best_s));
    std::cout << "load and verify 256^3: " << best_s << " s (" << best_processor_s << " s of all processors), file "
              << static_cast<double>(std::filesystem::file_size(folder.path() / "skin.lut")) / 1e6 << " MB\n";
}

}  // namespace
}  // namespace planlight
