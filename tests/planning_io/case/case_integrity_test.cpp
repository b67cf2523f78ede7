#include <gtest/gtest.h>

#include <filesystem>

#include "planning_io/case/case_folder.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

Case a_case(double edge_mm = 10) {
    Case made;
    made.code = "c0ffee";
    made.created = "2026-01-02T03:04:05Z";
    made.source = "InVesalius project Cranium.inv3";
    made.volume_hash = "0123456789abcdef0123456789abcdef";
    made.skin_threshold = -300;
    made.skin = test::analytic_head_mesh(edge_mm);
    made.lut = test::analytic_head_lut(edge_mm, 20);
    made.lut.volume_hash = made.volume_hash;
    made.lut.mesh_hash = hash_of(made.skin);
    made.plan.trajectories.push_back({"T", {1, 2, 3}, {4, 5, 6}, 0, std::nullopt});
    made.warnings = {"The scan ends at the upper lip."};
    return made;
}

TEST(CaseFolder, ReadsBackAndIsReplacedOnlyWhenAsked) {
    const test::TemporaryFolder folder;
    const Case made = a_case();
    write_case(made, folder.path() / "case");
    const Case back = read_case(folder.path() / "case");
    EXPECT_EQ(back.code, made.code);
    EXPECT_EQ(back.warnings, made.warnings);
    EXPECT_EQ(hash_of(back.skin), hash_of(made.skin));
    EXPECT_EQ(back.lut.nearest, made.lut.nearest);
    EXPECT_EQ(back.plan.trajectories[0].target_in_ct, Vector3d(4, 5, 6));
    EXPECT_THROW(write_case(made, folder.path() / "case"), InputError);
    Case other = made;
    other.code = "decade";
    write_case(other, folder.path() / "case", true);
    EXPECT_EQ(read_case(folder.path() / "case").code, "decade");
    EXPECT_EQ(files_in(folder.path()), 1u) << "nothing is left beside it";
    fs::create_directories(folder.path() / "case" / kRegistrationsFolder / "0001");
    EXPECT_EQ(read_case(folder.path() / "case").code, "decade") << "kept matches do not disturb";
    EXPECT_THROW(write_case(made, folder.path() / "case", true), InputError) << "they would be lost";
    EXPECT_TRUE(fs::exists(folder.path() / "case" / kRegistrationsFolder / "0001"));
    fs::create_directories(folder.path() / "photos");
    write_safely(folder.path() / "photos" / "a.txt", "mine");
    EXPECT_THROW(write_case(made, folder.path() / "photos", true), InputError) << "only a case is ever replaced";
    EXPECT_EQ(read_whole(folder.path() / "photos" / "a.txt"), "mine");
}

// Checksums that are made anew say nothing of which case a file is of.
TEST(CaseFolder, APlanOfAnotherCaseIsRefusedThoughItsChecksumHolds) {
    const test::TemporaryFolder folder;
    Case made = a_case();
    made.plan_hash = hash_of(made.plan);
    const fs::path mine = folder.path() / "mine", other = folder.path() / "other";
    write_case(made, mine);
    EXPECT_NO_THROW(read_case(mine));
    made.plan.trajectories[0].target_in_ct = {4, 5, 12};
    made.plan_hash = hash_of(made.plan);
    write_case(made, other);
    const std::string list = read_whole(mine / "checksums.xxh128"), of_plan = content_hash_of(mine / "plan.mrk.json");
    ASSERT_NE(list.find(of_plan), std::string::npos);
    fs::copy_file(other / "plan.mrk.json", mine / "plan.mrk.json", fs::copy_options::overwrite_existing);
    std::string anew = list;
    anew.replace(list.find(of_plan), of_plan.size(), content_hash_of(mine / "plan.mrk.json"));
    write_safely(mine / "checksums.xxh128", anew);
    try {
        read_case(mine);
        FAIL() << "took another case's plan";
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("is the plan of another case"), std::string::npos) << e.what();
    }
}

TEST(CaseFolder, ALutOfAnotherCaseIsRefusedAndDamageInAnyFileIsFound) {
    const test::TemporaryFolder folder;
    const fs::path mine = folder.path() / "mine", other = folder.path() / "other";
    write_case(a_case(10), mine);
    write_case(a_case(11), other);
    fs::copy_file(other / "skin.lut", mine / "skin.lut", fs::copy_options::overwrite_existing);
    try {
        read_case(mine);
        FAIL() << "took another case's LUT";
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("another case"), std::string::npos) << e.what();
    }
    Case wrong = a_case(10);
    wrong.lut.volume_hash = "ffff";
    EXPECT_THROW(write_case(wrong, folder.path() / "wrong"), InputError);
    EXPECT_FALSE(fs::exists(folder.path() / "wrong"));
    for (const char* name : {"case.json", "skin.ply", "skin.lut", "plan.mrk.json", "checksums.xxh128"}) {
        const std::string whole = read_whole(other / name);
        for (const double part : {0.1, 0.5, 0.99}) {
            std::string flipped = whole;
            char& byte = flipped[static_cast<std::size_t>(part * static_cast<double>(whole.size()))];
            byte = static_cast<char>(byte ^ 1);
            write_safely(other / name, flipped);
            EXPECT_THROW(read_case(other), Error) << name << " at " << part;
        }
        write_safely(other / name, whole);
        fs::rename(other / name, other / "away");
        EXPECT_THROW(read_case(other), Error) << name << " missing";
        fs::rename(other / "away", other / name);
    }
    EXPECT_NO_THROW(read_case(other));
    EXPECT_THROW(read_case(folder.path()), InputError);
}

// Nobody is to mend a patient's skin by hand.
TEST(CaseFolder, ASkinThatCannotBeReadIsTheCasesDamageNotAForeignMeshs) {
    const test::TemporaryFolder folder;
    write_case(a_case(10), folder.path() / "case");
    const fs::path skin = folder.path() / "case" / "skin.ply";
    const std::string whole = read_whole(skin);
    for (const std::string& damaged : {std::string(), whole.substr(0, 100), whole.substr(0, whole.size() / 2),
                                       std::string("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")}) {
        write_safely(skin, damaged);
        try {
            read_case(folder.path() / "case");
            ADD_FAILURE() << "took " << damaged.size() << " bytes";
        } catch (const DamagedFileError& e) {
            EXPECT_NE(e.remedy.find("repare the case again"), std::string::npos) << e.remedy;
        }
    }
}

}  // namespace
}  // namespace planlight
