#include "app/site_settings.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

// ct is LPS: x to the patient's left, z to the head. Letters are upright for somebody who looks from where the surgeon
// stands, so their tops point away from there.
TEST(SiteSettings, LettersStandUprightForTheSurgeon) {
    const auto up = [](const char* side) {
        SiteSettings site;
        site.surgeon_side = side;
        return drawing_settings(site).up_in_ct;
    };
    EXPECT_EQ(up("feet"), Eigen::Vector3d(0, 0, 1));
    EXPECT_EQ(up("head"), Eigen::Vector3d(0, 0, -1));
    EXPECT_EQ(up("left"), Eigen::Vector3d(-1, 0, 0));
    EXPECT_EQ(up("right"), Eigen::Vector3d(1, 0, 0));
    EXPECT_TRUE(up("view").isZero()) << "only a match tells";
    EXPECT_EQ(drawing_settings({}).up_in_ct, DrawingSettings{}.up_in_ct) << "without settings nothing changes";
}

TEST(SiteSettings, ALengthIsSaidInTheUnitOfTheSite) {
    SiteSettings site;
    EXPECT_EQ(length_text(12.34, site), "12.3 mm");
    site.units = "cm";
    EXPECT_EQ(length_text(12.34, site), "1.23 cm");
    site.units = "inch";
    EXPECT_EQ(length_text(25.4, site), "1.000 inch");
}

}  // namespace
}  // namespace planlight
