#include <gtest/gtest.h>

#include "planning_io/surface/shape_file.h"
#include "tests/planning_io/mutate_shapes.h"
#include "tests/planning_io/surface/surface_file_fixture.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using ShapeFileTest = test::SurfaceFileTest;

TEST_F(ShapeFileTest, PointsAtOnePlaceBecomeTheFirstOfThemWhateverTheirOrder) {
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

TEST_F(ShapeFileTest, APlyThatSaysAnElementTwiceIsRefused) {
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

}  // namespace
}  // namespace planlight
