#include <gtest/gtest.h>

#include <filesystem>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/point_pairs_file.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

TEST(PointPairsFile, ReadsBackAndRefusesNamesThatBreakTheTable) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "pairs.csv";
    const std::vector<PointPair> pairs{{"nasion", {1.25, -2.5, 1234.56}, {-0.01, 0, 900}}, {"2", {0, 0, 0}, {1, 2, 3}}};
    write_point_pairs(pairs, file);
    const auto back = read_point_pairs(file);
    ASSERT_EQ(back.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(back[i].name, pairs[i].name);
        EXPECT_LT((back[i].in_ct - pairs[i].in_ct).norm(), 0.01);
        EXPECT_LT((back[i].in_rig - pairs[i].in_rig).norm(), 0.01);
    }
    EXPECT_THROW(write_point_pairs({{"a,b", {0, 0, 0}, {0, 0, 0}}}, file), InputError);
    EXPECT_THROW(write_point_pairs({{"# SPACE=RAS", {0, 0, 0}, {0, 0, 0}}}, file), InputError);
    EXPECT_EQ(read_point_pairs(file).size(), 2u) << "a refused write leaves what was there";
}

// As Notepad and Excel write it: the mark is none of its columns.
TEST(PointPairsFile, AMarkOfUtf8BeforeItChangesNothing) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "pairs.csv";
    write_point_pairs({{"nasion", {1, -2, 3}, {4, 5, 6}}}, file);
    const std::string table = read_whole(file);
    write_safely(file, "\xEF\xBB\xBF" + table);
    EXPECT_EQ(read_point_pairs(file).size(), 1u);
}

}  // namespace
}  // namespace planlight
