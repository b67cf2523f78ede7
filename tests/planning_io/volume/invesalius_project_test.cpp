#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <random>

#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "planning_io/volume/invesalius_project.h"
#include "planning_io/volume/read_volume.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

constexpr double kSkinThreshold_hu = -142;  // with which the example's second surface was made

const Volume& example_volume() {
    static const Volume volume = read_volume(*test::example_patient());
    return volume;
}

/// Trilinear value and its gradient in ct; empty outside.
std::optional<std::pair<double, Eigen::Vector3d>> sample(const Volume& volume, const Eigen::Vector3d& p_in_ct) {
    const Eigen::Vector3d v = volume.ct_from_voxel.inverse() * p_in_ct;
    const Eigen::Vector3i cell = v.array().floor().cast<int>();
    for (int axis = 0; axis < 3; ++axis)
        if (cell[axis] < 0 || cell[axis] + 1 >= volume.size[static_cast<std::size_t>(axis)]) return std::nullopt;
    double value = 0;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Array3i bit(corner & 1, (corner >> 1) & 1, corner >> 2);
        const Eigen::Array3d f = v.array() - cell.cast<double>().array();
        const Eigen::Array3d w = bit.cast<double>() * f + (1 - bit.cast<double>()) * (1 - f);
        const Eigen::Array3d slope = 2 * bit.cast<double>() - 1;
        const double c = volume.at(cell.x() + bit.x(), cell.y() + bit.y(), cell.z() + bit.z());
        value += w.prod() * c;
        gradient +=
            c * Eigen::Vector3d(slope.x() * w.y() * w.z(), w.x() * slope.y() * w.z(), w.x() * w.y() * slope.z());
    }
    return std::pair(value, Eigen::Vector3d(volume.ct_from_voxel.linear().inverse().transpose() * gradient));
}

/// First-order distance of the points to the iso-surface of the volume, mm; median over those in the volume with a
/// slope.
double median_distance(const Volume& volume, const TriangleMesh& surface) {
    std::vector<double> distances;
    for (std::size_t i = 0; i < surface.vertices_in_ct.size(); i += 7) {
        const auto there = sample(volume, surface.vertices_in_ct[i]);
        if (!there) continue;
        const double slope = there->second.norm();
        distances.push_back(slope > 1 ? std::abs(there->first - kSkinThreshold_hu) / slope : 100.0);
    }
    if (distances.size() < 1000) return 1e9;
    return median(distances);
}

class InvesaliusProject : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
};

TEST_F(InvesaliusProject, HasTheShapeSpacingAndUnitsOfTheExamplePatient) {
    const Volume& volume = example_volume();
    EXPECT_EQ(volume.size, (std::array<int, 3>{256, 256, 108}));
    EXPECT_NEAR(volume.spacing_mm().x(), 0.957, 1e-3);
    EXPECT_NEAR(volume.spacing_mm().y(), 0.957, 1e-3);
    EXPECT_NEAR(volume.spacing_mm().z(), 1.5, 1e-9);
    EXPECT_EQ(volume.modality, "CT");
    EXPECT_TRUE(volume.is_hu);
    EXPECT_GT(volume.ct_from_voxel.linear().determinant(), 0);
    const auto [low, high] = std::minmax_element(volume.values.begin(), volume.values.end());
    EXPECT_EQ(*low, -1024);
    EXPECT_EQ(*high, 2986);  // of the int16 matrix itself, read without us
}

// The project's own skin, made by InVesalius from the same voxels: only the right orientation brings it onto our
// iso-surface.
TEST_F(InvesaliusProject, VolumeLiesOnTheProjectsOwnSkinAndAMirroredOneDoesNot) {
    const auto surfaces = read_invesalius_surfaces(*test::example_patient());
    ASSERT_EQ(surfaces.size(), 2u);
    const Volume& volume = example_volume();
    const double third_of_a_voxel_mm = 0.957 / 3;
    const double as_read = median_distance(volume, surfaces[1]);
    RecordProperty("median_mm", std::to_string(as_read));
    EXPECT_LT(as_read, third_of_a_voxel_mm);
    for (int axis = 0; axis < 3; ++axis) {
        Volume mirrored = volume;  // the same box of space, its contents mirrored
        const auto [nx, ny, nz] = volume.size;
        for (int k = 0; k < nz; ++k)
            for (int j = 0; j < ny; ++j)
                for (int i = 0; i < nx; ++i)
                    mirrored.values[mirrored.index(i, j, k)] =
                        volume.at(axis == 0 ? nx - 1 - i : i, axis == 1 ? ny - 1 - j : j, axis == 2 ? nz - 1 - k : k);
        EXPECT_GT(median_distance(mirrored, surfaces[1]), 4 * third_of_a_voxel_mm) << "axis " << axis;
    }
}

// LPS: the face looks along -y (voxel row 0), the crown lies at +z.
TEST_F(InvesaliusProject, CrownIsUpAndTheNoseLooksForward) {
    const Volume& volume = example_volume();
    const auto area_of_head = [&](int k) {
        int count = 0;
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) count += volume.at(i, j, k) > -300;
        return count;
    };
    EXPECT_LT(area_of_head(volume.size[2] - 1), area_of_head(volume.size[2] / 2) / 4);  // the top slices leave the head
    EXPECT_GT(area_of_head(0), 4 * area_of_head(volume.size[2] - 1));
    // At the height of the nose, the 10 mm behind the most forward skin are narrow; behind the head is the wide
    // headrest.
    const int nose = 30;
    const auto width_within_10_mm_of = [&](int j_first, int step) {
        int low = volume.size[0], high = -1, rows = 0;
        for (int j = j_first; rows < 10; j += step, ++rows)
            for (int i = 0; i < volume.size[0]; ++i)
                if (volume.at(i, j, nose) > -300) low = std::min(low, i), high = std::max(high, i);
        return 0.957 * (high - low);
    };
    const auto first_row = [&](int j, int step) {
        const auto has_body = [&](int row) {
            for (int i = 0; i < volume.size[0]; ++i)
                if (volume.at(i, row, nose) > -300) return true;
            return false;
        };
        while (!has_body(j)) j += step;
        return j;
    };
    EXPECT_LT(width_within_10_mm_of(first_row(0, 1), 1), 40);
    EXPECT_GT(width_within_10_mm_of(first_row(volume.size[1] - 1, -1), -1), 80);
}

TEST_F(InvesaliusProject, HashChangesWithOneVoxelAndWithTheGeometry) {
    Volume volume = example_volume();
    const std::string hash = hash_of(volume);
    EXPECT_EQ(hash.size(), 32u);
    volume.values[123456] += 1;
    EXPECT_NE(hash_of(volume), hash);
    volume.values[123456] -= 1;
    EXPECT_EQ(hash_of(volume), hash);
    volume.ct_from_voxel.translation().x() += 1e-6;
    EXPECT_NE(hash_of(volume), hash);
}

TEST_F(InvesaliusProject, CutOrDamagedProjectIsRefusedAsDamaged) {
    const test::TemporaryFolder folder;
    const std::string whole = read_whole(*test::example_patient());
    const auto file = folder.path() / "damaged.inv3";
    for (const double fraction : {0.0001, 0.02, 0.4, 0.999999}) {
        write_safely(file, whole.substr(0, static_cast<std::size_t>(fraction * static_cast<double>(whole.size()))));
        EXPECT_THROW(read_volume(file), DamagedFileError) << "cut at " << fraction;
    }
    std::mt19937 random(5);
    for (int i = 0; i < 8; ++i) {
        std::string flipped = whole;
        const auto at =
            std::uniform_int_distribution<std::size_t>(20, whole.size() - 1)(random);  // past gzip's name and date
        flipped[at] = static_cast<char>(flipped[at] ^ (1 << (i % 8)));
        write_safely(file, flipped);
        EXPECT_THROW(read_volume(file), DamagedFileError) << "flipped at " << at;
    }
}

TEST(InvesaliusProjectRefusal, WhatIsNoArchiveIsRefusedInWords) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "letter.inv3";
    write_safely(file, "Dear colleague, here is the scan.\n" + std::string(5000, '.'));
    try {
        read_volume(file);
        FAIL() << "read a letter";
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("not an archive"), std::string::npos) << e.what();
        EXPECT_FALSE(e.remedy.empty());
    }
    EXPECT_THROW(read_volume(folder.path() / "nothing.inv3"), InputError);
}

}  // namespace
}  // namespace planlight
