#include <gtest/gtest.h>

#include "registration/matching/initial_match.h"
#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/trial_scan.h"
#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

TEST(InitialMatch, AHeadUnderAClothThatHidesThreeTenthsOfItIsFound) {
    // A cloth lies outside of the body. A search that takes what lies outside for as wrong as what lies inside pulls
    // the cloth onto the skin, and finds five of these eight.
    const TrialSurface surface(analytic_head_mesh(1.5));
    int found = 0;
    constexpr int kScans = 8;
    for (unsigned seed = 1; seed <= kScans; ++seed) {
        TrialScanSettings settings;
        settings.from_in_ct = Eigen::Vector3d(seed % 2 ? 0.7 : -0.3, -1, 0.2).normalized();
        settings.width_mm = 160 + 8. * seed;
        settings.stray_share = 0.1;
        settings.drape_share = 0.3;
        settings.drape_height_mm = 6 + 2. * seed;
        settings.seed = seed;
        const TrialScan scan = trial_scan(surface, settings);
        const InitialMatch match = find_initial_match(scan.cloud, head_lut());
        if (match.candidates.empty()) continue;
        const PoseError error = pose_error(match.candidates[0].ct_from_rig.inverse(), scan);
        found += error.turn_deg < 3 && error.middle_mm < 5;
    }
    EXPECT_GE(found, kScans - 1);
}

}  // namespace
}  // namespace planlight::test
