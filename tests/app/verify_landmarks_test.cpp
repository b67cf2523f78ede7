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
    EXPECT_EQ(words_of_place(head, {0, -90, 0}), "at the front of the head") << "LPS: y grows to the back";
    EXPECT_EQ(words_of_place(head, {60, -60, -20}), "at the front of the head, on the patient's left");
    EXPECT_EQ(words_of_place(head, {-52, -52, 52}),
              "at the front of the head, on the patient's right, towards the crown");
    EXPECT_EQ(words_of_place(head, {0, 63, -63}), "at the back of the head, towards the neck");
}

}  // namespace
}  // namespace planlight
