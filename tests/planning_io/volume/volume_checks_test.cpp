#include "planning_io/volume/volume_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// A cube of voxels by their distance from its middle and from its third axis.
template <class Value>
Volume cube_of(int size, Value value) {
    Volume volume;
    volume.size = {size, size, size};
    const double middle = (size - 1) / 2.0;
    for (int k = 0; k < size; ++k)
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i) {
                const double from_axis = std::hypot(i - middle, j - middle);
                volume.values.push_back(value(std::hypot(from_axis, k - middle), from_axis));
            }
    return volume;
}

/// A ball in air.
Volume ball_of(float body, float air) {
    return cube_of(40, [&](double r, double) { return r < 15 ? body : air; });
}

TEST(ModalityByValues, SoftTissueInAirIsACtInHuAndOtherValuesAnMr) {
    Volume ct = ball_of(40, -1000), mr = ball_of(300, 0);
    tell_modality_by_values(ct);
    tell_modality_by_values(mr);
    EXPECT_TRUE(ct.is_hu);
    EXPECT_EQ(ct.modality, "CT");
    EXPECT_FALSE(mr.is_hu);
    EXPECT_EQ(mr.modality, "MR");
}

TEST(ModalityByValues, AnMrFromWhich1024WasTakenIsNoCtAndItsHeadIsThere) {
    Volume mr = ball_of(150 - 1024, -1024);
    tell_modality_by_values(mr);
    EXPECT_FALSE(mr.is_hu);
    EXPECT_EQ(mr.modality, "MR");
    ASSERT_EQ(mr.notes.size(), 1U);
    EXPECT_NE(mr.notes[0].find("hardly anything in it is denser"), std::string::npos) << mr.notes[0];
    EXPECT_NO_THROW(check_for_skin(mr, "mr.nii"));
}

/// An MR whose voxels outside of a circle were set to -1024.
TEST(ModalityByValues, PaddingOfAnMrIsNoAirOfACt) {
    std::mt19937 random(3);
    Volume mr = cube_of(40, [&](double r, double from_axis) {
        const float noise = static_cast<float>(random() % 20);
        return from_axis > 19 ? -1024.F : (r < 13 ? 300.F : 0.F) + noise;
    });
    Volume same_ct = mr;  // as a CT: the air inside the circle is air
    for (float& v : same_ct.values)
        if (v >= 0 && v < 20) v -= 1000;
    tell_modality_by_values(mr);
    EXPECT_EQ(mr.modality, "MR");
    EXPECT_GE(*std::min_element(mr.values.begin(), mr.values.end()), 0);
    ASSERT_EQ(mr.notes.size(), 2U);
    EXPECT_NE(mr.notes[0].find("padding of an MR"), std::string::npos) << mr.notes[0];
    tell_modality_by_values(same_ct);
    EXPECT_EQ(same_ct.modality, "CT");
}

// As unsigned pixels without their intercept: a skull with brain in it and skin round it, with noise.
TEST(ModalityByValues, ACtToWhichAThousandWasAddedIsACt) {
    std::mt19937 random(5);
    std::normal_distribution<float> noise(0, 12);
    for (const float added : {1024.F, 1000.F}) {
        Volume ct = cube_of(60, [&](double r, double) {
            const float hu = r > 25 ? -1000.F : r > 22 ? -20.F : r > 20 ? 900.F : 35.F;
            return std::max(0.F, hu + added + noise(random));
        });
        const float skin = ct.values[ct.index(30, 30, 53)];
        tell_modality_by_values(ct);
        EXPECT_EQ(ct.modality, "CT");
        EXPECT_TRUE(ct.is_hu);
        EXPECT_FLOAT_EQ(ct.values[ct.index(30, 30, 53)], skin - 1024);
        ASSERT_EQ(ct.notes.size(), 1U);
        EXPECT_NE(ct.notes[0].find("1024"), std::string::npos);
    }
}

// The same head as a T1-weighted MR shows it: bright scalp, dark skull, grey and white matter.
TEST(ModalityByValues, AnMrOfTheSameGreysIsNoCt) {
    std::mt19937 random(5);
    std::normal_distribution<float> noise(0, 40);
    for (const float scale : {0.6F, 0.8F, 1.F, 1.2F, 1.5F}) {
        Volume mr = cube_of(60, [&](double r, double) {
            const float grey = r > 25 ? 20.F : r > 22 ? 1600.F : r > 20 ? 200.F : r > 15 ? 800.F : 1100.F;
            return std::max(0.F, scale * (grey + noise(random)));
        });
        tell_modality_by_values(mr);
        EXPECT_EQ(mr.modality, "MR") << scale;
    }
}

TEST(ModalityByValues, NothingButAirHasNoSkin) {
    Volume air = ball_of(-1000, -1000);
    tell_modality_by_values(air);
    EXPECT_THROW(check_for_skin(air, "air.nii"), InputError);
}

}  // namespace
}  // namespace planlight
