#include <gtest/gtest.h>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>

#include "planning_io/files/safe_write.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/surface/shape_file.h"
#include "planning_io/surface/surface_file.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/dicom_bytes.h"
#include "tests/planning_io/mutate_shapes.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::DicomBytes;

SurfaceSettings of_ct(const std::string& uid, const std::string& segment = {}) {
    SurfaceSettings settings;
    settings.said.frame_of_reference_uid = uid;
    settings.segment = segment;
    return settings;
}

SurfaceSettings in_lps() {
    SurfaceSettings settings;
    settings.said.space = Space::lps;
    return settings;
}

const TriangleMesh& head() {
    static const TriangleMesh kHead = test::analytic_head_mesh(6);
    return kHead;
}

const Vector3d& corner(const TriangleMesh& mesh, const std::array<std::int32_t, 3>& t, std::size_t c) {
    return mesh.vertices_in_ct[static_cast<std::size_t>(t[c])];
}

/// The share of triangles that look the way the analytic head's surface does.
double share_outward(const TriangleMesh& mesh) {
    std::size_t outward = 0;
    for (const auto& t : mesh.triangles) {
        const Vector3d n = (corner(mesh, t, 1) - corner(mesh, t, 0)).cross(corner(mesh, t, 2) - corner(mesh, t, 0));
        outward +=
            n.dot(test::analytic_head_normal((corner(mesh, t, 0) + corner(mesh, t, 1) + corner(mesh, t, 2)) / 3)) > 0;
    }
    return static_cast<double>(outward) / static_cast<double>(mesh.triangles.size());
}

std::string binary_stl(const TriangleMesh& mesh, std::string header) {
    header.resize(80, ' ');
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    header.append(reinterpret_cast<const char*>(&count), 4);
    for (const auto& t : mesh.triangles) {
        std::array<float, 12> values{};
        for (std::size_t c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis)
                values[3 + 3 * c + static_cast<std::size_t>(axis)] = static_cast<float>(corner(mesh, t, c)[axis]);
        header.append(reinterpret_cast<const char*>(values.data()), 48);
        header.append(2, '\0');
    }
    return header;
}

std::string obj(const TriangleMesh& mesh, const std::string& header) {
    std::string text = header;
    for (const auto& p : mesh.vertices_in_ct) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    for (const auto& t : mesh.triangles) text += fmt::format("f {}//1 {} {}/2/3\n", t[0] + 1, t[1] + 1, t[2] + 1);
    return text;
}

class SurfaceFileTest : public ::testing::Test {
protected:
    fs::path write(const std::string& name, const std::string& content) {
        write_safely(folder_.path() / name, content);
        return folder_.path() / name;
    }
    std::string refusal(const fs::path& file, const SurfaceSettings& settings = {}) {
        try {
            read_surface(file, settings);
        } catch (const Error& e) {
            return std::string(e.what()) + " " + e.remedy;
        }
        return {};
    }
    test::TemporaryFolder folder_;
};

#define EXPECT_SAYS(sentence, words) EXPECT_NE((sentence).find(words), std::string::npos) << (sentence)

TEST_F(SurfaceFileTest, PointsAtOnePlaceBecomeTheFirstOfThemWhateverTheirOrder) {
    // A square of two triangles, each with corners of its own, and one triangle that is a line once they are welded.
    Shape shape;
    shape.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, -0.0, 0}};
    shape.flags = {1, 2, 3, 4, 5, 6, 7, 8};
    shape.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 4}};
    shape.lines.push_back({{7, 3, 5}, {}, {}, {}, {}, {}});
    const WeldedShape read = welded(shape);
    EXPECT_EQ(read.shape.points, (std::vector<Vector3d>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(read.shape.flags, (std::vector<std::uint8_t>{1, 2, 3, 5}));
    EXPECT_EQ(read.shape.triangles, (std::vector<std::array<std::int32_t, 3>>{{0, 1, 2}, {2, 3, 0}}));
    EXPECT_EQ(read.shape.lines[0].points, (std::vector<std::int32_t>{1, 2, 0}));
    EXPECT_EQ(read.degenerate, 1U);
}

TEST_F(SurfaceFileTest, APlyThatSaysAnElementTwiceIsRefused) {
    const std::string head = "ply\nformat ascii 1.0\ncomment SPACE=LPS\n",
                      vertex = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n",
                      face = "element face 1\nproperty list uchar int vertex_indices\n";
    const std::string both = refusal(write("a.ply", head + vertex + vertex + "end_header\n1 2 3\n4 5 6\n"));
    EXPECT_SAYS(both, "\"element vertex\" twice");
    EXPECT_SAYS(refusal(write("b.ply", head + vertex + face + face + "end_header\n1 2 3\n3 0 0 0\n3 0 0 0\n")),
                "\"element face\" twice");
    // A thousand columns a row cannot be there where there are not as many bytes: nothing is made ready for them.
    std::string wide = head + "element vertex 1000\n";
    for (int i = 0; i < 1000; ++i) wide += "property double c" + std::to_string(i) + "\n";
    EXPECT_SAYS(refusal(write("c.ply", wide + "end_header\n" + std::string(5000, '1'))), "cut short");
}

/// `fuzz_shapes --files 20000` built with AddressSanitizer is the whole of it.
TEST(DamagedShapes, AreReadOrRefusedByEveryReader) {
    const test::ShapeMutationCounts counts = test::mutate_shapes(220, 3);
    EXPECT_EQ(counts.not_an_error, 0) << (counts.faults.empty() ? "" : counts.faults.front());
    EXPECT_EQ(counts.read + counts.refused + counts.damaged, counts.readings);
    EXPECT_GT(counts.read, 20) << "some damage does no harm";
    EXPECT_GT(counts.damaged, 200) << "the damage is real";
    EXPECT_LT(counts.slowest_s, 2) << "seconds of processor, of files of some kilobytes";
}

TEST_F(SurfaceFileTest, TheSameHeadFromEveryFormatIsTheSameClosedOutwardSurface) {
    write_mesh(head(), folder_.path() / "head.ply");
    TriangleMesh ras = head();
    for (auto& p : ras.vertices_in_ct) p = Vector3d(-p.x(), -p.y(), p.z());
    for (const fs::path& file :
         {folder_.path() / "head.ply", write("head.stl", binary_stl(head(), "3D Slicer output. SPACE=LPS")),
          write("ras.stl", binary_stl(ras, "SPACE=RAS")), write("head.obj", obj(head(), "# SPACE=LPS\n"))}) {
        const SurfaceFile read = read_surface(file);
        EXPECT_TRUE(read.closed) << file;
        EXPECT_EQ(read.pieces, 1U) << file;
        EXPECT_TRUE(read.notes.empty()) << file;
        ASSERT_EQ(read.mesh.triangles.size(), head().triangles.size()) << file;
        EXPECT_EQ(read.mesh.vertices_in_ct.size(), head().vertices_in_ct.size()) << file;  // STL's corners are welded
        EXPECT_GT(share_outward(read.mesh), 0.999) << file;
        for (const auto& p : read.mesh.vertices_in_ct)
            ASSERT_LT(std::abs(test::analytic_head_distance(p)), 1e-4) << file;  // float's digits
    }
}

TEST_F(SurfaceFileTest, InsideOutAndMixedTrianglesAreTurnedOutwards) {
    TriangleMesh inside_out = head(), mixed = head(), open = head();
    for (auto& t : inside_out.triangles) std::swap(t[1], t[2]);
    for (std::size_t t = 0; t < mixed.triangles.size(); t += 3) std::swap(mixed.triangles[t][0], mixed.triangles[t][2]);
    std::erase_if(open.triangles, [&](const auto& t) { return corner(open, t, 0).z() < 0; });
    for (auto& t : open.triangles) std::swap(t[1], t[2]);
    EXPECT_GT(share_outward(read_surface(write("a.obj", obj(inside_out, "# SPACE=LPS\n"))).mesh), 0.999);
    EXPECT_GT(share_outward(read_surface(write("b.obj", obj(mixed, "# SPACE=LPS\n"))).mesh), 0.999);
    const SurfaceFile half = read_surface(write("c.obj", obj(open, "# SPACE=LPS\n")));
    EXPECT_GT(share_outward(half.mesh), 0.999);
    EXPECT_FALSE(half.closed);
    ASSERT_FALSE(half.notes.empty());
    EXPECT_SAYS(half.notes[0], "is open");
}

TEST_F(SurfaceFileTest, WhatIsNoSurfaceIsRefusedWithNumbers) {
    const SurfaceSettings lps = in_lps();
    EXPECT_SAYS(refusal(write("a.stl", binary_stl(head(), "made by somebody"))), "does not say its coordinate system");
    EXPECT_TRUE(refusal(write("a.stl", binary_stl(head(), "made by somebody")), lps).empty());
    TriangleMesh metres = head();
    for (auto& p : metres.vertices_in_ct) p /= 1000;
    EXPECT_SAYS(refusal(write("m.obj", obj(metres, "# SPACE=LPS\n"))), "mm across, not between 50 and 600 mm");
    TriangleMesh few = head();
    few.triangles.resize(50);
    EXPECT_SAYS(refusal(write("f.obj", obj(few, "# SPACE=LPS\n"))), "holds 50 triangles");
    TriangleMesh fins = head();
    for (int i = 0; i < 40; ++i) {
        fins.vertices_in_ct.push_back(1.2 * corner(head(), head().triangles[static_cast<std::size_t>(50 * i)], 0));
        fins.triangles.push_back({head().triangles[static_cast<std::size_t>(50 * i)][0],
                                  head().triangles[static_cast<std::size_t>(50 * i)][1],
                                  static_cast<std::int32_t>(fins.vertices_in_ct.size()) - 1});
    }
    EXPECT_SAYS(refusal(write("fins.obj", obj(fins, "# SPACE=LPS\n"))), "40 edges");
    const std::string whole = binary_stl(head(), "SPACE=LPS");
    EXPECT_SAYS(refusal(write("cut.stl", whole.substr(0, whole.size() / 2))), "announces");
    // A Moebius strip of 120 mm has one side only.
    std::string strip = "# SPACE=LPS\n";
    for (int i = 0; i < 100; ++i)
        for (const double s : {-10.0, 10.0}) {
            const double a = 2 * M_PI * i / 100;
            strip += fmt::format("v {} {} {}\n", (60 + s * std::cos(a / 2)) * std::cos(a),
                                 (60 + s * std::cos(a / 2)) * std::sin(a), s * std::sin(a / 2));
        }
    for (int i = 0; i < 100; ++i) {
        const int a = 2 * i + 1, b = a + 1, c = i == 99 ? 2 : a + 2, d = i == 99 ? 1 : a + 3;
        strip += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, c, b, d, c);
    }
    EXPECT_SAYS(refusal(write("strip.obj", strip)), "inside that runs over into its outside");
}

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

TEST_F(SurfaceFileTest, ASegmentOfABallIsABallWhereItLies) {
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

TEST_F(SurfaceFileTest, ASegmentationOfAnotherCtOrUnknownSegmentIsRefused) {
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
        std::string data;
        for (int i = 0; i < 120; ++i) {
            if (i > 0) data += '\\';
            data += fmt::format("{:.3f}\\{:.3f}\\{:.3f}", 10 + r * std::cos(2 * M_PI * i / 120),
                                20 + r * std::sin(2 * M_PI * i / 120), z - 30);
        }
        contours.push_back(DicomBytes()
                               .add(0x30060042, "CS", "CLOSED_PLANAR")
                               .add(0x30060046, "IS", "120")
                               .add(0x30060050, "DS", data));
    }
    return DicomBytes()
        .add(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.481.3")
        .add(0x00080060, "CS", "RTSTRUCT")
        .add(0x00200052, "UI", "1.2.3")
        .add_sequence(
            0x30060020,
            {DicomBytes().add(0x30060022, "IS", "1").add(0x30060024, "UI", "1.2.3").add(0x30060026, "LO", "Ball"),
             DicomBytes().add(0x30060022, "IS", "2").add(0x30060024, "UI", "1.2.3").add(0x30060026, "LO", "Line")})
        .add_sequence(0x30060039, {DicomBytes().add_sequence(0x30060040, contours).add(0x30060084, "IS", "1"),
                                   DicomBytes().add_sequence(0x30060040, {contours[10]}).add(0x30060084, "IS", "2")})
        .file("1.2.840.10008.5.1.4.1.1.481.3");
}

TEST_F(SurfaceFileTest, ContoursOfABallAreItsSurface) {
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

TEST_F(SurfaceFileTest, RealContoursOfABodyAreOneSurface) {
    const auto file = test::third_party_data("plans/dicompyler_rtstruct_ct/rtss.dcm");
    if (!file) GTEST_SKIP() << "third-party plans are not here";
    const SurfaceFile read = read_surface(*file, of_ct("2.16.840.1.113662.2.12.0.3057.1241703565.36", "BODY"));
    EXPECT_TRUE(read.closed);
    EXPECT_GT(read.mesh.triangles.size(), 50000U);
    EXPECT_SAYS(refusal(*file, of_ct("2.16.840.1.113662.2.12.0.3057.1241703565.36")), "solids: BODY");
}

TEST_F(SurfaceFileTest, NoFlippedByteOfASegmentationBringsTheProgramDownOrHoldsItUp) {
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

TEST_F(SurfaceFileTest, RealMeshesAreReadOrRefusedWithTheReason) {
    const auto stl = test::third_party_data("plans/mesh/42400-IDGH.stl");
    if (!stl) GTEST_SKIP() << "third-party meshes are not here";
    EXPECT_SAYS(refusal(*stl, in_lps()), "is 12.1 mm across");  // a piece of a blood vessel
    EXPECT_SAYS(refusal(*stl), "does not say its coordinate system");
    EXPECT_SAYS(refusal(*test::third_party_data("plans/mesh/fran_cut.vtk"), in_lps()), "seems to be in metres");
}

}  // namespace
}  // namespace planlight
