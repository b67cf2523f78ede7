// Fringes of another period than capture.json says: every place is read wrongly by the same ratio, and only the end of
// the projector's picture tells.
#include "registration/scan/check/panel_ends.h"

#include <gtest/gtest.h>

#include "planning_io/types/error.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;
using Eigen::Vector3d;

/// A head on a wide cloth that the light ends on.
Room head_on_cloth() {
    Room room =
        paper_room(nearest_of({sphere({20, -10, 420}, 80), plane({0, 0, 480}, Vector3d(0.1, 0.05, -1).normalized())}));
    room.light.ambient_grey = 40;
    return room;
}

std::string said(const ScanCapture& capture) {
    const DecodedView view = decode_stripes(capture.left, capture.stripes);
    const auto problem = check_panel_ends(view, capture.left[0], capture.left[1], capture.stripes);
    return problem ? problem->what : "";
}

TEST(PanelEnds, FringesOfAnotherPeriodAreSeenAtThePicturesEnd) {
    const Room room = head_on_cloth();
    ScanCapture shown = capture(room, stripes_of(room));
    EXPECT_EQ(said(shown), "");
    for (const double period : {13.0, 14.0, 15.0}) {
        shown.stripes.phase_period_px = period;
        EXPECT_NE(said(shown).find("the light ends in a straight edge"), std::string::npos) << period << said(shown);
    }
    for (const double period : {17.0, 18.0}) {
        shown.stripes.phase_period_px = period;
        EXPECT_NE(said(shown).find("light is seen beyond the code's last"), std::string::npos) << period << said(shown);
    }
    EXPECT_THROW(scan_from_capture(shown, rig_of(room)), CheckFailedError);
    shown.check_sequence = false;
    EXPECT_NO_THROW(scan_from_capture(shown, rig_of(room)));
}

// Edges of shadows, of things and of the camera's own picture end the code as well.
TEST(PanelEnds, ShadowsAndThingsAreNone) {
    const Vector3d up = Vector3d(0.1, 0.05, -1).normalized();
    for (const Surface& surface :
         {sphere({0, 0, 400}, 90), plane({40, 0, 420}, up, 90),
          nearest_of({sphere({60, 0, 380}, 40), plane({0, 0, 480}, up)}),
          nearest_of({sphere({-70, 30, 380}, 60), sphere({60, -20, 400}, 70), plane({0, 0, 520}, up)})}) {
        Room room = paper_room(surface);
        room.light.ambient_grey = 40;
        EXPECT_EQ(said(capture(room, stripes_of(room))), "");
    }
}

}  // namespace
}  // namespace planlight
