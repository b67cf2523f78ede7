#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <fstream>
#include <random>

#include "tests/planning_io/rt_struct_bytes.h"
#include "tests/planning_io/surface/surface_file_fixture.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::closed_contour;
using test::corner;
using test::DicomBytes;
using test::of_ct;
using test::rt_struct_of;
using DicomSurfaceTest = test::SurfaceFileTest;

/// A SEG of an oblique stack: a ball of radius 30 mm round (5, -10, 20), voxels 1.5 x 1.2 x 2 mm, slices from the last
/// to the first; segment 2 is a small cube elsewhere.
std::string ball_seg(const std::string& frame_of_reference, const std::string& labels = "Bone") {
    const int columns = 56, rows = 60, slices = 40;
    const Eigen::Matrix3d axes = Eigen::AngleAxisd(0.3, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Vector3d centre(5, -10, 20),
        first = centre - axes * Vector3d(1.5 * columns / 2, 1.2 * rows / 2, 2.0 * slices / 2);
    const auto ds = [](std::initializer_list<double> values) {
        std::string text;
        for (const double v : values) {
            if (!text.empty()) text += '\\';
            text += fmt::format("{:.10g}", v);
        }
        return text;
    };
    std::vector<DicomBytes> per_frame;
    std::string bits;
    std::size_t bit = 0;
    const auto push = [&](bool set) {
        if (bit % 8 == 0) bits += '\0';
        if (set) bits.back() = static_cast<char>(bits.back() | (1 << (bit % 8)));
        ++bit;
    };
    for (int k = slices - 1; k >= 0; --k) {
        const Vector3d position = first + axes.col(2) * 2.0 * k;
        bool any = false;
        for (int pass = 0; pass < 2; ++pass) {  // empty frames are left out, as the standard allows
            for (int j = 0; j < rows; ++j)
                for (int i = 0; i < columns; ++i) {
                    const bool inside = (position + axes * Vector3d(1.5 * i, 1.2 * j, 0) - centre).norm() < 30;
                    any = any || inside;
                    if (pass == 1) push(inside);
                }
            if (!any) break;
        }
        if (!any) continue;
        per_frame.push_back(
            DicomBytes()
                .add_sequence(0x00209113,
                              {DicomBytes().add(0x00200032, "DS", ds({position.x(), position.y(), position.z()}))})
                .add_sequence(0x0062000A, {DicomBytes().add_us(0x0062000B, 1)}));
    }
    const DicomBytes shared =
        DicomBytes()
            .add_sequence(
                0x00209116,
                {DicomBytes().add(0x00200037, "DS",
                                  ds({axes(0, 0), axes(1, 0), axes(2, 0), axes(0, 1), axes(1, 1), axes(2, 1)}))})
            .add_sequence(0x00289110, {DicomBytes().add(0x00180050, "DS", "2").add(0x00280030, "DS", "1.2\\1.5")});
    std::vector<DicomBytes> segments{DicomBytes().add_us(0x00620004, 1).add(0x00620005, "LO", labels)};
    if (labels != "Bone") segments.push_back(DicomBytes().add_us(0x00620004, 2).add(0x00620005, "LO", "Other"));
    return DicomBytes()
        .add(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4")
        .add(0x00080018, "UI", "1.2.3.4.5")
        .add(0x00080060, "CS", "SEG")
        .add(0x00200052, "UI", frame_of_reference)
        .add_us(0x00280002, 1)
        .add(0x00280008, "IS", std::to_string(per_frame.size()))
        .add_us(0x00280010, rows)
        .add_us(0x00280011, columns)
        .add_us(0x00280100, 1)
        .add_us(0x00280101, 1)
        .add_us(0x00280102, 0)
        .add(0x00620001, "CS", "BINARY")
        .add_sequence(0x00620002, segments)
        .add_sequence(0x52009229, {shared})
        .add_sequence(0x52009230, per_frame)
        .add(0x7FE00010, "OB", bits)
        .file("1.2.840.10008.5.1.4.1.1.66.4");
}

TEST_F(DicomSurfaceTest, ASegmentOfABallIsABallWhereItLies) {
    const SurfaceSettings same_ct = of_ct("1.2.3");
    const SurfaceFile read = read_surface(write("ball.dcm", ball_seg("1.2.3")), same_ct);
    EXPECT_TRUE(read.closed);
    EXPECT_EQ(read.pieces, 1U);
    double sum = 0, worst = 0;
    for (const auto& p : read.mesh.vertices_in_ct) {
        const double off = (p - Vector3d(5, -10, 20)).norm() - 30;
        sum += off;
        worst = std::max(worst, std::abs(off));
    }
    EXPECT_NEAR(sum / static_cast<double>(read.mesh.vertices_in_ct.size()), 0, 0.1);  // voxels are cut at their centres
    EXPECT_LT(worst, 1.3);  // two thirds of the longest voxel edge
    for (const auto& t : read.mesh.triangles) {
        const Vector3d n = (corner(read.mesh, t, 1) - corner(read.mesh, t, 0))
                               .cross(corner(read.mesh, t, 2) - corner(read.mesh, t, 0));
        ASSERT_GE(n.dot(corner(read.mesh, t, 0) - Vector3d(5, -10, 20)), 0);
    }
}

TEST_F(DicomSurfaceTest, ASegmentationOfAnotherCtOrUnknownSegmentIsRefused) {
    const fs::path file = write("ball.dcm", ball_seg("1.2.3"));
    EXPECT_SAYS(refusal(file, of_ct("9.9")), "9.9");
    EXPECT_SAYS(refusal(file, of_ct("")), "the volume names none");
    EXPECT_SAYS(refusal(file, of_ct("1.2.3", "Skin")), "holds no segment \"Skin\"; there is: Bone");
    const fs::path two = write("two.dcm", ball_seg("1.2.3", "Skull"));
    EXPECT_SAYS(refusal(two, of_ct("1.2.3")), "holds 2 segments: Skull, Other");
    EXPECT_TRUE(refusal(two, of_ct("1.2.3", "Skull")).empty());
    EXPECT_SAYS(refusal(two, of_ct("1.2.3", "Other")), "0 frames");
    const std::string whole = ball_seg("1.2.3");
    for (std::size_t part = 1; part < 16; ++part)
        EXPECT_FALSE(refusal(write("cut.dcm", whole.substr(0, whole.size() * part / 16)), of_ct("1.2.3")).empty())
            << part;
}

/// An RT Structure Set of one ball of 60 mm radius round (10, 20, -30), contours of 120 corners every 2.5 mm, and of
/// one line.
std::string ball_rt_struct() {
    std::vector<DicomBytes> contours;
    for (double z = -57.5; z < 60; z += 2.5) {
        const double r = std::sqrt(60 * 60 - z * z);
        std::vector<Vector3d> circle;
        for (int i = 0; i < 120; ++i)
            circle.emplace_back(10 + r * std::cos(2 * M_PI * i / 120), 20 + r * std::sin(2 * M_PI * i / 120), z - 30);
        contours.push_back(closed_contour(circle));
    }
    return rt_struct_of("Ball", contours);
}

TEST_F(DicomSurfaceTest, ContoursOfABallAreItsSurface) {
    const fs::path file = write("ball.dcm", ball_rt_struct());
    const SurfaceFile read = read_surface(file, of_ct("1.2.3"));
    EXPECT_TRUE(read.closed);
    EXPECT_EQ(read.pieces, 1U);
    double sum = 0, worst = 0;
    for (const auto& p : read.mesh.vertices_in_ct) {
        if (std::abs(p.z() + 30) > 50) continue;  // the caps are flat, half a slice beyond the last contour
        const double off = (p - Vector3d(10, 20, -30)).norm() - 60;
        sum += off;
        worst = std::max(worst, std::abs(off));
    }
    EXPECT_NEAR(sum / static_cast<double>(read.mesh.vertices_in_ct.size()), 0, 0.1);
    EXPECT_LT(worst, 1.5);  // steps of slices 2.5 mm apart
    EXPECT_SAYS(refusal(file, of_ct("9.9")), "9.9");
    EXPECT_SAYS(refusal(file, of_ct("1.2.3", "Line")), "holds no solid \"Line\"; there is: Ball");
    // As a plan, the line is a line and the ball is left out.
    PlanImportSettings same_ct;
    same_ct.frame_of_reference_uid = "1.2.3";
    const PlanImport plan = import_plan(file, same_ct);
    ASSERT_EQ(plan.plan.osteotomy_lines.size(), 1U);
    EXPECT_EQ(plan.plan.osteotomy_lines[0].name, "Line");
    ASSERT_EQ(plan.notes.size(), 1U);
    EXPECT_SAYS(plan.notes[0], "ROI \"Ball\" has contours at 47 heights");
}

TEST_F(DicomSurfaceTest, RealContoursOfABodyAreOneSurface) {
    const auto file = test::third_party_data("plans/dicompyler_rtstruct_ct/rtss.dcm");
    if (!file) GTEST_SKIP() << "third-party plans are not here";
    const SurfaceFile read = read_surface(*file, of_ct("2.16.840.1.113662.2.12.0.3057.1241703565.36", "BODY"));
    EXPECT_TRUE(read.closed);
    EXPECT_GT(read.mesh.triangles.size(), 50000U);
    EXPECT_SAYS(refusal(*file, of_ct("2.16.840.1.113662.2.12.0.3057.1241703565.36")), "solids: BODY");
}

TEST_F(DicomSurfaceTest, NoFlippedByteOfASegmentationBringsTheProgramDownOrHoldsItUp) {
    const std::string whole = ball_seg("1.2.3");
    std::mt19937 random(3);
    double slowest_s = 0;
    for (int i = 0; i < 200; ++i) {
        std::string flipped = whole;
        const std::size_t within = i % 2 ? whole.size() : 1500;  // half of them in the head
        for (int k = 0; k < 3; ++k) flipped[132 + random() % (within - 132)] = static_cast<char>(random());
        std::ofstream(folder_.path() / "flipped.dcm", std::ios::binary) << flipped;
        const auto began = std::chrono::steady_clock::now();
        refusal(folder_.path() / "flipped.dcm", of_ct("1.2.3"));  // anything but an Error would end the test
        slowest_s =
            std::max(slowest_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    }
    EXPECT_LT(slowest_s, 2);
}

}  // namespace
}  // namespace planlight
