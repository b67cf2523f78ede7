#include "registration/simulation/room_things.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "registration/simulation/dressed_surface.h"
#include "registration/simulation/sheet_on_head.h"
#include "tests/registration/simulation/analytic_volume.h"
#include "tests/support/analytic_head.h"

namespace planlight::simulation {

using Eigen::Vector3d;

namespace {

const Vector3d kEye(0, -900, 60);

const TrueSurface& head() {
    static const TrueSurface surface(test::volume_of_analytic_head(), -300);
    return surface;
}

ThingsMesh laid(const ThingsSettings& settings, unsigned seed) {
    std::mt19937 random(seed);
    return lay_things(head(), Vector3d(0, -90, 20), kEye, settings, random);
}

}  // namespace

TEST(SheetOn, LiesOnABallAndHangsToTheFloor) {
    // Half a ball of 80 mm on a floor: the sheet is nowhere in either, touches the top, and reaches the floor at its
    // rim.
    const Ground ball = [](double x, double y) { return std::sqrt(std::max(0., 80 * 80 - x * x - y * y)); };
    std::mt19937 random(1);
    SheetSettings settings;
    const ThingsMesh sheet = sheet_on(ball, settings, random);
    double highest = 0, lowest = 1e9;
    for (const Eigen::Vector3f& p : sheet.vertices_in_ct) {
        const Vector3d q = p.cast<double>();
        EXPECT_GT(q.z(), ball(q.x(), q.y()) - 0.01);
        highest = std::max(highest, q.z());
        lowest = std::min(lowest, q.z());
    }
    EXPECT_LT(highest, 86);
    EXPECT_LT(lowest, 2);
}

TEST(LayThings, CoversTheHeadFromOutsideAndLeavesTheHoleFree) {
    ThingsSettings settings;
    settings.drape_hole = settings.hand = settings.tube = settings.retractor = settings.hair = true;
    const ThingsMesh mesh = laid(settings, 3);
    std::set<Material> seen(mesh.made_of.begin(), mesh.made_of.end());
    EXPECT_EQ(seen, (std::set<Material>{Material::cloth, Material::glove, Material::plastic, Material::metal,
                                        Material::hair}));
    settings = {};
    settings.drape_hole = true;
    DressedSurface dressed(head());
    dressed.lay(laid(settings, 3));
    int cloth = 0, skin = 0, inside = 0;
    for (double x = -100; x <= 100; x += 5)
        for (double z = -80; z <= 120; z += 5) {
            const auto hit = dressed.first_hit(kEye, (Vector3d(x, -60, z) - kEye).normalized());
            if (!hit) continue;
            (hit->made_of == Material::cloth ? cloth : skin) += 1;
            inside += hit->made_of == Material::cloth && test::analytic_head_distance(hit->p_in_ct) < -1.5;
        }
    EXPECT_GT(cloth, 300);
    EXPECT_GT(skin, 200);
    EXPECT_LT(inside, cloth / 50);  // between knots, 6 mm apart, cloth may cut a sharp corner
}

TEST(LayThings, TheSheetBehindLiesBehindTheFaceAndInItsShadow) {
    ThingsSettings settings;
    settings.drape_behind = true;
    DressedSurface dressed(head());
    dressed.lay(laid(settings, 5));
    const auto face = dressed.first_hit(kEye, (Vector3d(0, -90, 40) - kEye).normalized());
    ASSERT_TRUE(face);
    EXPECT_EQ(face->made_of, Material::none);
    int cloth = 0;
    for (const double x : {-190., 190.}) {
        const auto beside = dressed.first_hit(kEye, (Vector3d(x, -20, 20) - kEye).normalized());
        ASSERT_TRUE(beside);
        cloth += beside->made_of == Material::cloth;
        EXPECT_NEAR(beside->p_in_ct.y() - face->p_in_ct.y(), 70, 40);
        EXPECT_FALSE(dressed.in_shadow(beside->p_in_ct, beside->normal_in_ct, kEye));
        // From the other side the head stands between.
        EXPECT_TRUE(dressed.in_shadow(beside->p_in_ct, beside->normal_in_ct, Vector3d(-2 * x, 0, 20)));
    }
    EXPECT_EQ(cloth, 2);
}

TEST(LayThings, AreDrawnByTheSeedAlone) {
    ThingsSettings settings;
    settings.drape_hole = settings.hand = true;
    const ThingsMesh a = laid(settings, 7), b = laid(settings, 7), c = laid(settings, 8);
    EXPECT_TRUE(a.vertices_in_ct == b.vertices_in_ct);
    EXPECT_FALSE(a.vertices_in_ct == c.vertices_in_ct);
}

}  // namespace planlight::simulation
