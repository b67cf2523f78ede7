#include <gtest/gtest.h>

#include <cmath>

#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/mutate_volumes.h"
#include "tests/planning_io/volume_cases.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

/// Names of tests; long output of a case's functions helps nobody.
std::string name_of(const ::testing::TestParamInfo<VolumeCase>& info) {
    return test_name_of(info.param);
}

class SoundVolume : public ::testing::TestWithParam<VolumeCase> {};
INSTANTIATE_TEST_SUITE_P(Volumes, SoundVolume, ::testing::ValuesIn(sound_volumes()), name_of);

/// The values are whole numbers and the codes lossless, so they must be equal. Positions are written with nine digits,
/// a voxel whose value is rounded the other way there is allowed 1 HU, and one on the phantom's edges may fall on the
/// other side.
TEST_P(SoundVolume, HasThePhantomsValueAtEveryPlaceInCt) {
    const TemporaryFolder folder;
    const Volume volume = read_volume(GetParam().make(folder.path()), GetParam().series);
    EXPECT_EQ(volume.is_hu, GetParam().is_hu);
    EXPECT_EQ(volume.modality, GetParam().modality);
    EXPECT_GT(volume.ct_from_voxel.linear().determinant(), 0);
    ASSERT_EQ(volume.values.size(), 64u * 64u * 24u);
    const double offset = GetParam().is_hu ? 0 : 1024;  // what is not HU is stored from zero on
    long wrong = 0, body = 0;
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const int truth = phantom_hu(volume.ct_from_voxel * Eigen::Vector3d(i, j, k));
                wrong += std::abs(volume.at(i, j, k) - offset - truth) > 1;
                body += truth > -500;
            }
    EXPECT_GT(body, 20000) << "the phantom is in the volume";
    EXPECT_LE(wrong, 40) << "of " << volume.values.size();
}

class SpoiltVolume : public ::testing::TestWithParam<VolumeCase> {};
INSTANTIATE_TEST_SUITE_P(Volumes, SpoiltVolume, ::testing::ValuesIn(spoilt_volumes()), name_of);

TEST_P(SpoiltVolume, IsRefusedWithItsReasonAndARemedy) {
    const TemporaryFolder folder;
    const auto path = GetParam().make(folder.path());
    try {
        read_volume(path, GetParam().series);
        FAIL() << "was read";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find(GetParam().says), std::string::npos) << e.what();
        EXPECT_FALSE(e.remedy.empty());
        EXPECT_EQ(std::string(e.what()).find("Phantom"), std::string::npos)
            << "a patient's name in a sentence: " << e.what();
    }
}

/// `fuzz_volumes --mutations 10000` is the whole of it. A crash of the program would end this test, a child's is
/// counted.
TEST(DamagedVolumes, NeverCrashHangOrChangeAFile) {
    const MutationCounts counts = mutate_volumes(320, 7);
    EXPECT_EQ(counts.not_an_error, 0) << (counts.faults.empty() ? "" : counts.faults.front());
    EXPECT_EQ(counts.slow, 0) << "the child is stopped after 2 s of processor";
    EXPECT_EQ(counts.changed_files, 0);
    EXPECT_EQ(counts.read + counts.refused + counts.damaged + counts.other_errors, counts.mutations);
    EXPECT_GT(counts.damaged, 80) << "the damage is real";
}

}  // namespace
}  // namespace planlight::test
