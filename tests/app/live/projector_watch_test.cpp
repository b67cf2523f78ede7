// What the operator reads of a projector that was away.
#include "app/live/projector_watch.h"

#include <gtest/gtest.h>

#include "app/live/session_states.h"

namespace planlight {
namespace {

const ProjectorProblem kUnplugged{"monitor HDMI-2 is no longer connected", "Connect it again."};

/// A session with a match, dark.
OperatorModel dark() {
    OperatorModel model;
    model.status = {StatusKind::dark, "Dark: no light on the patient.", {"Press Track."}, {}};
    model.track.enabled = true;
    return model;
}

std::vector<std::string> details(const ProjectorWatch& watch, OperatorModel model = dark()) {
    watch.put_into(model);
    return model.status.details;
}

TEST(ProjectorWatch, ThatCameBackBetweenTwoLooksIsTheReasonOfTheDarknessUntilTheNextPress) {
    ProjectorWatch watch(1);
    EXPECT_FALSE(watch.look({}, 1));
    EXPECT_EQ(details(watch), dark().status.details);
    EXPECT_TRUE(watch.look({}, 2)) << "started again: the session is made dark";
    EXPECT_FALSE(watch.look({}, 2)) << "once";
    ASSERT_EQ(details(watch).size(), 3U);
    EXPECT_EQ(details(watch)[0], "The projector was away and was started again.");
    EXPECT_EQ(details(watch)[1], "Track looks first whether all is as it was.");
    OperatorModel unmatched = dark();
    unmatched.track.enabled = false;
    EXPECT_EQ(details(watch, unmatched).size(), 2U) << "Track does nothing then, and is not spoken of";
    watch.pressed();
    EXPECT_EQ(details(watch), dark().status.details);
}

/// In the one case in which somebody must reach for its switch the big word must not be DARK.
TEST(ProjectorWatch, ThatCannotBeMadeDarkIsNotSaidToBe) {
    ProjectorWatch watch(1);
    EXPECT_TRUE(watch.look({"Projector process: it cannot be ended", "Switch the projector off by hand.", true}, 1));
    OperatorModel model = dark();
    watch.put_into(model);
    EXPECT_EQ(model.status.kind, StatusKind::refused);
    EXPECT_EQ(model.status.headline, "The projector's light may still be on.");
    EXPECT_EQ(model.status.details, std::vector<std::string>{"Switch the projector off by hand."});
    EXPECT_TRUE(model.light_on);
}

/// A video link that hangs may be gone for the computer, and its picture on the skin for the cameras.
TEST(ProjectorWatch, ThatIsAwayDoesNotTakeThePlaceOfLightThatIsSeen) {
    ProjectorWatch watch(1);
    watch.look(kUnplugged, 1);
    OperatorModel model = dark();
    model.status = light_stays_status();
    model.light_stays = model.light_on = true;
    watch.put_into(model);
    EXPECT_EQ(model.status.kind, StatusKind::refused);
    EXPECT_EQ(model.status.headline, light_stays_status().headline);
    EXPECT_TRUE(model.light_on);
    EXPECT_EQ(model.status.details.back(), "No projector: monitor HDMI-2 is no longer connected.");
}

TEST(ProjectorWatch, ThatIsAwayStandsInPlaceOfTheStatusAndIsToldOfOnceItIsBack) {
    ProjectorWatch watch(1);
    EXPECT_TRUE(watch.look(kUnplugged, 1));
    EXPECT_FALSE(watch.look(kUnplugged, 1)) << "the session was made dark once";
    OperatorModel model = dark();
    watch.put_into(model);
    EXPECT_EQ(model.status.headline, "No projector: monitor HDMI-2 is no longer connected.");
    watch.pressed();  // while it is away a press changes nothing
    EXPECT_FALSE(watch.look({}, 2)) << "it is back, and the session dark already";
    EXPECT_EQ(details(watch).size(), 3U);
}

}  // namespace
}  // namespace planlight
