#include "app/verify_landmarks.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

/// As large as a head, with its corners where a head has crown, chin, nose, nape and ears.
SkinSurface octahedron() {
    TriangleMesh mesh;
    mesh.vertices_in_ct = {{90, 0, 0}, {-90, 0, 0}, {0, 90, 0}, {0, -90, 0}, {0, 0, 90}, {0, 0, -90}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return SkinSurface(mesh);
}

TEST(VerifyLandmarks, WordsSayWhereOnTheHeadAPlaceIs) {
    const SkinSurface head = octahedron();
    EXPECT_EQ(words_of_place(head, {0, -90, 0}), "front") << "LPS: y grows to the back";
    EXPECT_EQ(words_of_place(head, {60, -60, -20}), "front, left");
    EXPECT_EQ(words_of_place(head, {-52, -52, 52}), "front, right, high");
    EXPECT_EQ(words_of_place(head, {0, 63, -63}), "back, low");
}

}  // namespace
}  // namespace planlight
