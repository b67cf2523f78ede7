#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "planning_io/case/capture_folder.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/case/frames_folder.h"
#include "planning_io/case/light_file.h"
#include "planning_io/case/poses_file.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/point_pairs_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/example_rig.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(SafeWrite, AFailedWriteLeavesTheOldFileAndNothingElse) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "a.txt";
    write_safely(file, "old");
    EXPECT_THROW(write_safely(file, [](std::ostream& out) { out.setstate(std::ios::badbit); }), DiskError);
    EXPECT_THROW(write_safely(file, [](std::ostream&) { throw std::runtime_error("stop"); }), std::runtime_error);
    EXPECT_EQ(read_whole(file), "old");
    EXPECT_EQ(files_in(folder.path()), 1u);
    EXPECT_THROW(write_safely(folder.path() / "no" / "folder.txt", "x"), DiskError);
    if (fs::is_character_file("/dev/full")) {
        EXPECT_THROW(write_safely("/dev/full", "x"), DiskError) << "a full disk is told";
        EXPECT_TRUE(fs::is_character_file("/dev/full")) << "a device is never replaced by a file";
    }
    EXPECT_THROW(write_safely(folder.path(), "x"), DiskError);
    fs::create_symlink(file, folder.path() / "link");
    write_safely(folder.path() / "link", "new");
    EXPECT_EQ(read_whole(file), "new");
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
    EXPECT_THROW(read_whole(folder.path()), InputError);
    EXPECT_THROW(read_whole(folder.path() / "none"), InputError);
}

/// Twelve bits at the lower end of sixteen read as nearly black, and a scan then finds a tenth of the skin, or none; at
/// the upper end they are read. A dark picture among brighter ones is nothing to refuse.
TEST(ImageFile, TwelveBitsAtTheLowerEndOfSixteenAreRefused) {
    const test::TemporaryFolder folder;
    const auto pictures = [&](int factor) {
        std::vector<GrayImage> read;
        for (const int value : {0, 4095}) {
            const fs::path file = folder.path() / fmt::format("{}.png", value);
            cv::imwrite(file.string(), cv::Mat(20, 30, CV_16UC1, cv::Scalar(value * factor)));
            read.push_back(read_gray(file));
        }
        return read;
    };
    const fs::path dark = folder.path() / "0.png";
    EXPECT_THROW(check_depth(pictures(1), dark), InputError);
    EXPECT_NO_THROW(check_depth(pictures(16), dark));
    EXPECT_EQ(pictures(16).back().at(3, 3), 255);
    write_png(GrayImage(30, 20), dark);
    EXPECT_NO_THROW(check_depth({read_gray(dark)}, dark)) << "8 bits, dark: for others to judge";
}

TEST(ImageFile, PicturesReadBackAndCutOnesAreRefused) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    GrayImage grey(37, 23);
    for (std::size_t i = 0; i < grey.pixels.size(); ++i) grey.pixels[i] = static_cast<std::uint8_t>(i * 7);
    write_png(grey, file);
    EXPECT_EQ(read_gray(file).pixels, grey.pixels);
    EXPECT_EQ(read_rgb(file).at(5, 2), (Rgb{grey.at(5, 2), grey.at(5, 2), grey.at(5, 2)}));
    const std::string whole = read_whole(file);
    for (std::size_t length = 0; length < whole.size(); length += 5) {
        write_safely(file, whole.substr(0, length));
        EXPECT_THROW(read_gray(file), DamagedFileError) << length;
    }
    for (std::size_t at = 0; at < whole.size() - 12; at += 3) {
        std::string flipped = whole;
        flipped[at] = static_cast<char>(flipped[at] ^ 16);
        write_safely(file, flipped);
        EXPECT_THROW(read_gray(file), DamagedFileError) << at;
    }
    RgbImage colour(2, 1);
    colour.at(0, 0) = {255, 0, 0};
    colour.at(1, 0) = {0, 0, 255};
    write_png(colour, file);
    EXPECT_EQ(read_rgb(file).at(0, 0), (Rgb{255, 0, 0}));
    EXPECT_EQ(read_gray(file).at(0, 0), 76);  // 0.299 * 255
    EXPECT_EQ(read_gray(file).at(1, 0), 29);  // 0.114 * 255
    EXPECT_THROW(write_png(GrayImage(), file), DiskError);
}

TEST(MeshFile, ReadsBackBitForBitWithNormalsFlagsAndThickness) {
    const test::TemporaryFolder folder;
    TriangleMesh mesh = test::analytic_head_mesh(12);
    mesh.flags.assign(mesh.vertices_in_ct.size(), kSkin);
    mesh.flags[5] = kCutPlane;
    mesh.thickness_mm.assign(mesh.vertices_in_ct.size(), 4.25F);
    mesh.thickness_mm[5] = std::numeric_limits<float>::quiet_NaN();
    write_mesh(mesh, folder.path() / "m.ply");
    const TriangleMesh back = read_mesh(folder.path() / "m.ply");
    EXPECT_EQ(back.vertices_in_ct, mesh.vertices_in_ct);
    EXPECT_EQ(back.triangles, mesh.triangles);
    EXPECT_EQ(back.normals_in_ct, mesh.normals_in_ct);
    EXPECT_EQ(back.flags, mesh.flags);
    ASSERT_EQ(back.thickness_mm.size(), mesh.thickness_mm.size());
    EXPECT_TRUE(std::isnan(back.thickness_mm[5]));
    EXPECT_EQ(back.thickness_mm[6], 4.25F);
    EXPECT_EQ(hash_of(back), hash_of(mesh));
    std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
    EXPECT_NE(hash_of(back), hash_of(mesh));
    const std::string whole = read_whole(folder.path() / "m.ply");
    for (const std::size_t cut : {1u, 5u, 1000u, 20000u}) {
        write_safely(folder.path() / "m.ply", whole.substr(0, whole.size() - cut));
        EXPECT_THROW(read_mesh(folder.path() / "m.ply"), DamagedFileError);
    }
    mesh.thickness_mm[7] = -1;
    write_mesh(mesh, folder.path() / "m.ply");
    EXPECT_THROW(read_mesh(folder.path() / "m.ply"), DamagedFileError);
}

TEST(MeshFile, AnotherProgramsPlyNeedsItsSpace) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "m.ply";
    const auto text = [](const std::string& comment) {
        return "ply\nformat ascii 1.0\n" + comment +
               "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
               "element face 1\nproperty list uchar uint vertex_index\nend_header\n1 2 3 9\n2 2 3 9\n2 3 3 9\n1 3 3.5 "
               "9\n4 0 1 2 3\n";
    };
    write_safely(file, text(""));
    EXPECT_THROW(read_mesh(file), InputError);
    write_safely(file, text("comment SPACE=LPS\ncomment SPACE=RAS\n"));
    EXPECT_THROW(read_mesh(file), InputError);
    write_safely(file, text("comment 3D Slicer output. SPACE=RAS\n"));
    const TriangleMesh mesh = read_mesh(file);
    EXPECT_EQ(mesh.vertices_in_ct[3], Vector3d(-1, -3, 3.5));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::int32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
    std::string outside = text("comment SPACE=LPS\n");
    outside[outside.size() - 2] = '4';
    write_safely(file, outside);
    EXPECT_THROW(read_mesh(file), DamagedFileError);
    write_safely(file, "solid stl");
    EXPECT_THROW(read_mesh(file), InputError);
}

TEST(CloudFile, ReadsBackWithAndWithoutItsOptionalColumns) {
    const test::TemporaryFolder folder;
    PointCloud cloud;
    cloud.points_in_rig = {{1.0 / 3, 2, 3}, {4, 5, 600.25}};
    write_cloud(cloud, folder.path() / "bare.ply");
    EXPECT_EQ(read_cloud(folder.path() / "bare.ply").points_in_rig, cloud.points_in_rig);
    EXPECT_TRUE(read_cloud(folder.path() / "bare.ply").normals_in_rig.empty());
    cloud.normals_in_rig = {{0, 0, -1}, {0, 0.6, -0.8}};
    cloud.sigma_mm = {0.1F, 0.2F};
    cloud.pixels_in_projector = {{1.25, 3}, {1919.5, 7.0 / 3}};
    write_cloud(cloud, folder.path() / "full.ply");
    const PointCloud back = read_cloud(folder.path() / "full.ply");
    EXPECT_EQ(back.points_in_rig, cloud.points_in_rig);
    EXPECT_EQ(back.normals_in_rig, cloud.normals_in_rig);
    EXPECT_EQ(back.sigma_mm, cloud.sigma_mm);
    EXPECT_EQ(back.pixels_in_projector, cloud.pixels_in_projector);
    TriangleMesh mesh;
    mesh.vertices_in_ct = cloud.points_in_rig;
    write_mesh(mesh, folder.path() / "mesh.ply");
    EXPECT_THROW(read_cloud(folder.path() / "mesh.ply"), InputError) << "a mesh in ct is no cloud in rig";
    EXPECT_THROW(read_mesh(folder.path() / "full.ply"), InputError);
}

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

TEST(RigFile, ReadsBackValueForValueAndRefusesNonsense) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "rig.json";
    RigCalibration rig = test::example_rig();
    write_rig(rig, file);
    EXPECT_EQ(read_rig(file).serials, DeviceSerials{}) << "a file without serials, as all were";
    rig.serials = {"L-1", "", "P \"9\""};
    write_rig(rig, file);
    const RigCalibration back = read_rig(file);
    EXPECT_EQ(back.serials, rig.serials);
    EXPECT_EQ(back.left_camera.device_from_rig.matrix(), rig.left_camera.device_from_rig.matrix());
    EXPECT_EQ(back.right_camera.k3, 0.001);
    EXPECT_EQ(back.projector.centre_y, 541.1);
    EXPECT_EQ(back.made_on, "2026-01-02");
    const auto refused = [&](auto change) {
        RigCalibration bad = test::example_rig();
        change(bad);
        EXPECT_THROW(write_rig(bad, file), InputError);
    };
    refused([](RigCalibration& r) { r.left_camera.focal_x = 0; });
    refused([](RigCalibration& r) { r.projector.focal_y = -2000; });
    refused([](RigCalibration& r) { r.right_camera.width = 0; });
    refused([](RigCalibration& r) { r.right_camera.k1 = std::nan(""); });
    refused([](RigCalibration& r) { r.right_camera.device_from_rig.linear() *= 1.001; });
    refused([](RigCalibration& r) { r.right_camera.device_from_rig.linear().row(0) *= -1; });
    refused([](RigCalibration& r) { r.right_camera = r.left_camera; });
    refused([](RigCalibration& r) {
        r.projector.device_from_rig = Eigen::AngleAxisd(3.1, Vector3d::UnitY()) * r.projector.device_from_rig;
    });
    std::string text = read_whole(file);
    text.replace(text.find("\"focal_x\""), 9, "\"focal_X\"");
    write_safely(file, text);
    try {
        read_rig(file);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find(
                      "left_camera has a name that means nothing here, \"focal_X\"; is \"focal_x\" meant?"),
                  std::string::npos)
            << e.what();
    }
    write_safely(file, R"({"format": "planlight rig", "version": 2})");
    EXPECT_THROW(read_rig(file), DamagedFileError);
}

TEST(Recordings, CaptureFramesRegistrationAndPosesReadBack) {
    const test::TemporaryFolder folder;
    CaptureFolder capture;
    capture.projector_width = 1920;
    capture.projector_height = 1080;
    capture.rows = false;
    capture.names = {"white", "gray_0", "phase_0"};
    for (std::uint8_t i = 0; i < 3; ++i)
        capture.left.emplace_back(8, 6, i), capture.right.emplace_back(8, 6, static_cast<std::uint8_t>(100 + i));
    capture.began = Instant(123456789012345);
    write_capture(capture, folder.path() / "capture");
    const CaptureFolder back = read_capture(folder.path() / "capture");
    EXPECT_EQ(back.names, capture.names);
    EXPECT_EQ(back.right[2].pixels, capture.right[2].pixels);
    EXPECT_EQ(back.began, capture.began);
    EXPECT_FALSE(back.rows);
    EXPECT_THROW(write_capture(capture, folder.path() / "capture"), InputError) << "never over another recording";
    write_png(GrayImage(9, 6), folder.path() / "capture" / "left" / "phase_0.png");
    EXPECT_THROW(read_capture(folder.path() / "capture"), InputError) << "a picture of another size";
    capture.names[1] = "../../escape";
    EXPECT_THROW(write_capture(capture, folder.path() / "other"), InputError);

    std::vector<StereoFrame> frames(2);
    frames[0] = {GrayImage(4, 4, 1), GrayImage(4, 4, 2), Instant(1000), Instant(50), 7};
    frames[1] = {GrayImage(4, 4, 3), GrayImage(4, 4, 4), Instant(2000), Instant(50), 9};
    write_frames(frames, folder.path() / "frames");
    const auto frames_back = read_frames(folder.path() / "frames");
    ASSERT_EQ(frames_back.size(), 2u);
    EXPECT_EQ(frames_back[1].number, 9u);
    EXPECT_EQ(frames_back[1].right.pixels, frames[1].right.pixels);
    EXPECT_EQ(frames_back[0].at, Instant(1000));

    RegistrationResult result;
    result.verdict = Verdict::ask;
    result.reasons = {"The chin is missing."};
    result.patient_from_ct = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.3, Vector3d(1, 2, 2) / 3);
    result.points = 12345;
    result.covariance.of_turn_and_shift = Eigen::Matrix<double, 6, 6>::Random();
    result.covariance.of_turn_and_shift.diagonal().setConstant(3);
    result.covariance.centre_in_ct = {7, 8, 9};
    result.runner_up_ratio = std::numeric_limits<double>::infinity();
    result.landmarks_off_mm = 2.5;
    result.moved_in_scan_mm = 0.07;  // and the viewpoint was not said
    result.skin.apart_mm = 4, result.skin.alike_over_mm = 25;
    result.skin.offset_mm = -0.35, result.skin.spread_mm = 0.08;
    result.skin.places = {{{10.126, -20, 30}, -0.31254, 0.02}, {{14, -20, 30.5}, -0.4, 0.05}};
    write_registration(result, folder.path() / "registration.json");
    const auto result_back = read_registration(folder.path() / "registration.json");
    EXPECT_EQ(result_back.verdict, Verdict::ask);
    EXPECT_EQ(result_back.patient_from_ct.matrix(), result.patient_from_ct.matrix());
    EXPECT_EQ(result_back.reasons, result.reasons);
    EXPECT_EQ(result_back.covariance.of_turn_and_shift, result.covariance.of_turn_and_shift);
    EXPECT_EQ(result_back.covariance.centre_in_ct, result.covariance.centre_in_ct);
    EXPECT_EQ(predicted_error(result_back.covariance, {0, 0, 50}).bound_95_mm,
              predicted_error(result.covariance, {0, 0, 50}).bound_95_mm);
    EXPECT_GT(result_back.runner_up_ratio, 1e100);
    EXPECT_EQ(result_back.landmarks_off_mm, 2.5);
    EXPECT_EQ(result_back.moved_in_scan_mm, 0.07);
    EXPECT_FALSE(result_back.blocked_fraction);
    ASSERT_EQ(result_back.skin.places.size(), 2u);
    EXPECT_EQ(result_back.skin.offset_mm, -0.35);
    EXPECT_EQ(result_back.skin.alike_over_mm, 25);
    EXPECT_LT((result_back.skin.places[0].p_in_ct - result.skin.places[0].p_in_ct).norm(), 0.01);
    EXPECT_NEAR(result_back.skin.places[0].mm, -0.31254, 1e-4);
    EXPECT_EQ(result_back.skin.places[1].sigma_mm, 0.05);

    std::vector<TrackedPose> poses(2);
    poses[0].rig_from_patient = result.patient_from_ct;
    poses[0].at = Instant(5);
    poses[0].predicted_error_mm = 0.1, poses[0].bound_95_mm = 0.17;
    poses[1].reason = "fewer than 3 markers in the left picture";
    write_poses(poses, folder.path() / "poses.json");
    const auto poses_back = read_poses(folder.path() / "poses.json");
    EXPECT_EQ(poses_back[0].rig_from_patient->matrix(), result.patient_from_ct.matrix());
    EXPECT_EQ(poses_back[0].bound_95_mm, 0.17);
    EXPECT_FALSE(poses_back[1].rig_from_patient);
    EXPECT_EQ(poses_back[1].reason, poses[1].reason);
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

}  // namespace
}  // namespace planlight
