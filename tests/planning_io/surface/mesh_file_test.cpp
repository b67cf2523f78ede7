#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "planning_io/files/safe_write.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

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

// Other programs write normals of any length: a good scan was refused as one without a point on a surface.
TEST(CloudFile, NormalsAreBroughtToUnitLengthAndMissingOnesAreNone) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "cloud.ply";
    const auto write = [&](const std::string& rows, int count) {
        std::string header = "ply\nformat ascii 1.0\ncomment FRAME=rig\nelement vertex " + std::to_string(count) + "\n";
        for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "sigma"})
            header += std::string("property float ") + name + "\n";
        write_safely(file, header + "end_header\n" + rows);
    };
    write("1 2 3  0 0 -0.25  0.1\n4 5 6  0 3e-30 0  0.2\n7 8 9  120 0 160  0.3\n", 3);
    const PointCloud scaled = read_cloud(file);
    ASSERT_EQ(scaled.normals_in_rig.size(), 3U);
    EXPECT_LT((scaled.normals_in_rig[0] - Vector3d(0, 0, -1)).norm(), 1e-12);
    EXPECT_LT((scaled.normals_in_rig[1] - Vector3d(0, 1, 0)).norm(), 1e-12);
    EXPECT_LT((scaled.normals_in_rig[2] - Vector3d(0.6, 0, 0.8)).norm(), 1e-12);
    PointsLeftOut left_out;
    write("1 2 3  0 0 -1  0.1\n4 5 6  0 0 0  0.2\n7 8 9  1 0 0  0.3\n", 3);
    const PointCloud some = read_cloud(file, {}, nullptr, &left_out);
    EXPECT_EQ(left_out.without_normal, 1U);
    EXPECT_EQ(some.points_in_rig, (std::vector<Vector3d>{{1, 2, 3}, {7, 8, 9}}));
    EXPECT_EQ(some.sigma_mm, (std::vector<float>{0.1F, 0.3F}));
    EXPECT_EQ(some.normals_in_rig.size(), 2U);
    write("1 2 3  0 0 0  0.1\n4 5 6  0 0 0  0.2\n7 8 9  1 0 0  0.3\n", 3);
    EXPECT_TRUE(read_cloud(file).normals_in_rig.empty()) << "what most lack is a column that says nothing";
    EXPECT_EQ(read_cloud(file).size(), 3U);
    write("0 0 0  0 0 0  0.1\n0 0 0  0 0 0  0.2\n7 8 9  1 0 0  0.3\n", 3);
    EXPECT_EQ(read_cloud(file).normals_in_rig.size(), 1U) << "of what was measured all have one";
}

// What was not measured is exported at the origin, or at one and the same place.
TEST(CloudFile, PointsAtTheOriginAndRepeatedOnesAreLeftOutAndCounted) {
    const test::TemporaryFolder folder;
    PointCloud cloud;
    cloud.points_in_rig = {{0, 0, 0}, {1, 2, 3}, {0, 0, 0}, {1, 2, 3}, {0, 0, 5}, {1, 2, 3}};
    cloud.sigma_mm = {1, 2, 3, 4, 5, 6};
    write_cloud(cloud, folder.path() / "cloud.ply");
    PointsLeftOut left_out;
    const PointCloud back = read_cloud(folder.path() / "cloud.ply", {}, nullptr, &left_out);
    EXPECT_EQ(back.points_in_rig, (std::vector<Vector3d>{{1, 2, 3}, {0, 0, 5}}));
    EXPECT_EQ(back.sigma_mm, (std::vector<float>{2, 5}));
    EXPECT_EQ(left_out.at_origin, 2U);
    EXPECT_EQ(left_out.repeated, 2U);
}

}  // namespace
}  // namespace planlight
