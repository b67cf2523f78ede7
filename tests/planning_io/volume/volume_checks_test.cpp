#include "planning_io/volume/volume_checks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// A ball in air.
Volume ball_of(float body, float air) {
    Volume volume;
    volume.size = {40, 40, 40};
    for (int k = 0; k < 40; ++k)
        for (int j = 0; j < 40; ++j)
            for (int i = 0; i < 40; ++i)
                volume.values.push_back(std::hypot(i - 19.5, std::hypot(j - 19.5, k - 19.5)) < 15 ? body : air);
    return volume;
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

TEST(ModalityByValues, NothingButAirHasNoSkin) {
    Volume air = ball_of(-1000, -1000);
    tell_modality_by_values(air);
    EXPECT_THROW(check_for_skin(air, "air.nii"), InputError);
}

}  // namespace
}  // namespace planlight
