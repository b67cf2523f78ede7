#include <gtest/gtest.h>

#include <cmath>

#include "planning_io/case/cloud_rig.h"
#include "planning_io/case/poses_file.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/example_rig.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

RigState a_state() {
    RigState state;
    state.verdict = RigState::Verdict::corrected;
    state.sentence = "the projector moved; \u00fc | \"quoted\"";
    state.remedy = "Calibrate the rig again.";
    state.rig = test::example_rig();
    state.rig.serials.projector = "P 7";
    state.calibrated = name_of(state.rig);
    state.rig.projector = changed(state.rig.projector, DeviceChange::Constant(1e-3));
    state.capture_hash = "0123456789abcdef0123456789abcdef";
    state.devices[2] = {true, false, true, true, 1.5, 0.01, -0.002};
    RigDoubt doubt;
    doubt.what = "the left camera moved";
    doubt.chi_square = 3;
    for (std::size_t d = 0; d < kRigDevices; ++d)
        for (int i = 0; i < 10; ++i) doubt.by[d][i] = std::sin(1 + 7.0 * static_cast<double>(d) + i);
    state.doubts = {doubt};
    state.hidden_light_mm = 0.31;
    return state;
}

void expect_same(const RigState& a, const RigState& b) {
    EXPECT_EQ(a.verdict, b.verdict);
    EXPECT_EQ(a.sentence, b.sentence);
    EXPECT_EQ(a.calibrated, b.calibrated);
    EXPECT_EQ(a.capture_hash, b.capture_hash);
    EXPECT_EQ(hash_of(a.rig), hash_of(b.rig)) << "bit for bit";
    EXPECT_EQ(a.devices[2].moved_mm, b.devices[2].moved_mm);
    EXPECT_EQ(a.devices[2].lens, b.devices[2].lens);
    ASSERT_EQ(a.doubts.size(), b.doubts.size());
    EXPECT_EQ(a.doubts[0].by[0], b.doubts[0].by[0]);
    EXPECT_EQ(a.hidden_light_mm, b.hidden_light_mm);
    EXPECT_EQ(a.accepted_movement_mm, b.accepted_movement_mm);
}

PointCloud a_cloud() {
    PointCloud cloud;
    cloud.points_in_rig = {{1, 2, 3}, {4, 5, 6}};
    return cloud;
}

TEST(RigNames, ACloudCarriesTheRigItWasMadeWith) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "cloud.ply";
    write_cloud(a_cloud(), file, {}, comments_of(a_state()));
    std::vector<std::string> comments;
    EXPECT_EQ(read_cloud(file, {}, &comments).size(), 2u);
    const auto back = rig_state_in(comments, file);
    ASSERT_TRUE(back);
    expect_same(*back, a_state());
    for (const std::string& line : comments) EXPECT_LT(line.size(), 200u) << "other readers of PLY have short lines";
}

TEST(RigNames, ACloudWhoseRigWasEditedIsDamagedAndOneWithoutIsAnothers) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "cloud.ply";
    write_cloud(a_cloud(), file, {}, comments_of(a_state()));
    std::string text = read_whole(file);
    const auto at = text.find("corrected");
    ASSERT_NE(at, std::string::npos);
    text.replace(at, 9, "unknown. ");
    write_safely(file, text);
    std::vector<std::string> comments;
    read_cloud(file, {}, &comments);
    EXPECT_THROW(rig_state_in(comments, file), DamagedFileError);
    comments.erase(comments.begin() + 1);
    EXPECT_THROW(rig_state_in(comments, file), DamagedFileError) << "a line is missing";
    write_cloud(a_cloud(), file);
    read_cloud(file, {}, &comments);
    EXPECT_FALSE(rig_state_in(comments, file)) << "the cloud of another scanner";
}

RegistrationResult a_match(Verdict verdict) {
    RegistrationResult match;
    match.verdict = verdict;
    match.of_case = {"c0ffee", "volume", "mesh"};
    match.rig = a_state();
    return match;
}

TEST(RigNames, ARegistrationCarriesCaseAndRig) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "registration.json";
    write_registration(a_match(Verdict::yes), file);
    const RegistrationResult back = read_registration(file);
    EXPECT_EQ(back.verdict, Verdict::yes);
    EXPECT_EQ(back.of_case, a_match(Verdict::yes).of_case);
    ASSERT_TRUE(back.rig);
    expect_same(*back.rig, a_state());
}

TEST(RigNames, AnEditorMakesNoYesOfAnAsk) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "registration.json";
    write_registration(a_match(Verdict::ask), file);
    const std::string whole = read_whole(file);
    std::string text = whole;
    text.replace(text.find("\"ask\""), 5, "\"yes\"");
    write_safely(file, text);
    EXPECT_THROW(read_registration(file), DamagedFileError);
    const auto checksum = text.find("\"checksum\"");
    ASSERT_NE(checksum, std::string::npos);
    const auto comma = text.rfind(',', checksum);
    text.erase(comma, text.find('\n', checksum) - comma);  // and the checksum taken out as well
    write_safely(file, text);
    const RegistrationResult without = read_registration(file);
    EXPECT_EQ(without.verdict, Verdict::ask);
    EXPECT_NE(without.reasons.back().find("checksum"), std::string::npos);
    std::string spaced = whole;  // other spaces are no other file
    for (std::size_t at = 0; (at = spaced.find("\n  ", at)) != std::string::npos; at += 5) spaced.insert(at + 1, "  ");
    write_safely(file, spaced);
    EXPECT_EQ(read_registration(file).verdict, Verdict::ask);
}

TEST(RigNames, PosesSayTheirRigAndTheirScan) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "poses.json";
    std::vector<TrackedPose> poses(1);
    poses[0].reason = "none";
    write_poses(poses, file, PosesOrigin{name_of(test::example_rig()), "capture", test::example_rig()});
    EXPECT_EQ(read_poses(file).size(), 1u);
    const auto origin = read_poses_origin(file);
    ASSERT_TRUE(origin);
    EXPECT_EQ(origin->calibrated, name_of(test::example_rig()));
    EXPECT_EQ(origin->capture_hash, "capture");
    write_poses(poses, file);
    EXPECT_FALSE(read_poses_origin(file));
}

TEST(RigNames, PosesChangedByHandAreRefusedWhereTheySayWhoMeasuredThem) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "poses.json";
    std::vector<TrackedPose> poses(1);
    poses[0].rig_from_patient = RigidTransform(Eigen::Translation3d(12.625, 0, 0));
    poses[0].bound_95_mm = 0.5;
    write_poses(poses, file, PosesOrigin{name_of(test::example_rig()), "capture", test::example_rig()});
    const std::string whole = read_whole(file);
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = whole;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        write_safely(file, text.replace(at, from.size(), to));
    };
    with("12.625", "12.125");
    EXPECT_THROW(read_poses(file), DamagedFileError);
    with("\"capture\"", "\"another\"");
    EXPECT_THROW(read_poses(file), DamagedFileError);
    with("\"checksum\"", "\"x_checksum\"");
    EXPECT_THROW(read_poses(file), DamagedFileError) << "taken out";
    with("{", "{\n\n \"notes\": \"of the second day\",");
    EXPECT_EQ(read_poses(file)[0].bound_95_mm, 0.5) << "a note and other spaces change nothing";
    write_poses(poses, file);
    write_safely(file, read_whole(file).replace(read_whole(file).find("12.625"), 6, "12.125"));
    EXPECT_EQ(read_poses(file).size(), 1u) << "another program's poses are nobody's to vouch for";
}

}  // namespace
}  // namespace planlight
