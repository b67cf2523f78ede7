#include "tests/registration/matching/draped_scene.h"

#include <gtest/gtest.h>

#include "registration/matching/cloud_pieces.h"
#include "registration/matching/find_skin.h"
#include "registration/matching/register_patient.h"
#include "tests/registration/matching/matching_scenes.h"
#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

const TrialSurface& head() {
    static const TrialSurface surface(analytic_head_mesh(1.5));
    return surface;
}

DrapedSceneSettings scene_of(const std::string& draping, unsigned seed) {
    DrapedSceneSettings settings;
    settings.draping = draping;
    settings.from_in_ct = Vector3d(seed % 2 ? 0.4 : -0.3, -1, 0.2).normalized();
    settings.face_in_ct = Vector3d(0, -10, -10);
    settings.opening_mm = 130;
    settings.points = 20000;
    settings.seed = seed;
    return settings;
}

TEST(DrapedScene, CoversMostOfTheScanAndMarksWhatIsSkin) {
    for (const Draping& draping : drapings()) {
        const DrapedScene scene = draped_scene(head(), scene_of(draping.name, 3));
        ASSERT_FALSE(scene.scan.cloud.empty()) << draping.name;
        const double all = static_cast<double>(scene.scan.bare_points + scene.scan.drape_points);
        EXPECT_GT(static_cast<double>(scene.scan.drape_points) / all, 0.3) << draping.name;
        EXPECT_GT(scene.skin_width_mm, 60) << draping.name;
        EXPECT_EQ(scene.is_skin.size(), scene.scan.cloud.size());
    }
}

TEST(RegisterPatient, FindsAFaceAmongEveryKindOfCloth) {
    // Skin 110 to 150 mm wide of a head that has not moved: without a search among the cloth none of these is found.
    for (const Draping& draping : drapings()) {
        const DrapedScene scene = draped_scene(head(), scene_of(draping.name, 5));
        const RegistrationResult result = register_patient(scene.scan.cloud, head_lut());
        EXPECT_EQ(result.verdict, Verdict::yes) << draping.name;
        EXPECT_LT(pose_error(result.patient_from_ct, scene.scan).target_mm, 2) << draping.name;
    }
}

TEST(RegisterPatient, DoesNotFindAPatientInClothAlone) {
    for (const Draping& draping : drapings()) {
        DrapedSceneSettings settings = scene_of(draping.name, 1);
        settings.without_head = true;
        settings.points = 12000;
        const DrapedScene scene = draped_scene(head(), settings);
        EXPECT_NE(register_patient(scene.scan.cloud, head_lut()).verdict, Verdict::yes) << draping.name;
    }
}

TEST(FindSkin, MarksTheSkinAndLeavesTheClothOut) {
    const DrapedScene scene = draped_scene(head(), scene_of("wrapped, with a hole", 2));
    const CloudPieces pieces = cloud_pieces(scene.scan.cloud);
    const MatchingSkin skin(head_lut());
    const auto found = find_skin(scene.scan.cloud, pieces, head_lut(), skin, {});
    ASSERT_TRUE(found.has_value());
    double marked = 0, right = 0, skin_points = 0;
    for (std::size_t i = 0; i < scene.is_skin.size(); ++i) {
        marked += found->is_skin[i];
        right += found->is_skin[i] && scene.is_skin[i];
        skin_points += scene.is_skin[i];
    }
    EXPECT_GT(right, 0.9 * skin_points);  // the rim of the hole is given away
    EXPECT_GT(right, 0.85 * marked);      // cloth within 2 mm of the skin, beside the hole, is taken for it
}

}  // namespace
}  // namespace planlight::test
