#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "planning_io/surface/mesh_file.h"
#include "tests/planning_io/surface/surface_file_fixture.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::corner;
using test::in_lps;
using test::of_ct;
using test::SurfaceFileTest;

const TriangleMesh& head() {
    static const TriangleMesh kHead = test::analytic_head_mesh(6);
    return kHead;
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

TEST_F(SurfaceFileTest, RealMeshesAreReadOrRefusedWithTheReason) {
    const auto stl = test::third_party_data("plans/mesh/42400-IDGH.stl");
    if (!stl) GTEST_SKIP() << "third-party meshes are not here";
    EXPECT_SAYS(refusal(*stl, in_lps()), "is 12.1 mm across");  // a piece of a blood vessel
    EXPECT_SAYS(refusal(*stl), "does not say its coordinate system");
    EXPECT_SAYS(refusal(*test::third_party_data("plans/mesh/fran_cut.vtk"), in_lps()), "seems to be in metres");
}

}  // namespace
}  // namespace planlight
