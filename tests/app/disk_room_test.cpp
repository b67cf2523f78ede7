// Before a session: which disk has no room, and which option names another.
#include <gtest/gtest.h>

#include "app/disk_room.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

constexpr double kRoom_gb = 40, kNone_gb = 0.012;

TEST(DiskRoom, IsNotSpokenOfWhereThereIsEnough) {
    EXPECT_TRUE(warnings_of_full_disks(DiskRoom{"recordings", kRoom_gb}, {"matches", kRoom_gb}).empty());
    EXPECT_TRUE(warnings_of_full_disks(std::nullopt, {"matches", kRoom_gb}).empty());
}

TEST(DiskRoom, ForTheRecordingNamesItsFolderAndItsOption) {
    const auto said = warnings_of_full_disks(DiskRoom{"recordings", kNone_gb}, {"matches", kRoom_gb});
    ASSERT_EQ(said.size(), 1U);
    EXPECT_EQ(said[0],
              "Only 12 MB are free in recordings: the recording ends where the disk is full; the light goes on. Make "
              "room on the disk, or name another folder with --recordings.");
}

TEST(DiskRoom, ForTheMatchIsAskedOfItsOwnFolderAlsoWithoutARecording) {
    for (const auto& recordings : {std::optional<DiskRoom>(), std::optional(DiskRoom{"recordings", kRoom_gb})}) {
        const auto said = warnings_of_full_disks(recordings, {"matches", kNone_gb});
        ASSERT_EQ(said.size(), 1U);
        EXPECT_EQ(said[0],
                  "Only 12 MB are free in matches: a match and its scan may not be kept there; the light goes on. Make "
                  "room on the disk, or name another folder with --keep.");
    }
    EXPECT_EQ(warnings_of_full_disks(DiskRoom{"recordings", kNone_gb}, {"matches", kNone_gb}).size(), 2U);
}

TEST(DiskRoom, OfAFolderThatIsNotThereYetIsThatOfItsDisk) {
    const test::TemporaryFolder folder;
    const DiskRoom there = disk_room_of(folder.path()), not_yet = disk_room_of(folder.path() / "case" / "matches");
    EXPECT_GT(not_yet.free_gb, 0);
    EXPECT_NEAR(not_yet.free_gb, there.free_gb, 1 + 0.1 * there.free_gb) << "others write on this disk as well";
    EXPECT_EQ(not_yet.folder, folder.path() / "case" / "matches");
}

}  // namespace
}  // namespace planlight
