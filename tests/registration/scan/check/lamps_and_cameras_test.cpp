// What lamps or a camera do to all pictures of a capture, which no patient and no delay does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "planning_io/types/error.h"
#include "registration/scan/check/check_sequence.h"
#include "tests/registration/scan/spoilt_sequence.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;
using spoilt_sequence::said, spoilt_sequence::with_noise;

/// Each picture brighter or darker by its own grey, lit or not; against an exposure that changes all in proportion.
TEST(CheckSequence, LampsThatFlickerAreToldFromAnExposureThatChanges) {
    Room room = paper_room(sphere({120, -40, 360}, 80));
    room.light.noise_grey = 0;
    const StripeSettings stripes = stripes_of(room);
    const std::vector<GrayImage> frames = photograph(room, room.left, stripes, 1);
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    for (const double grey : {7.0, 10.0, 14.0}) {
        auto flickering = frames, exposed = frames;
        for (std::size_t f = 0; f < flickering.size(); ++f) {
            const double by = grey * normal(random), times = 1 + 0.02 * grey * normal(random);
            for (std::uint8_t& p : flickering[f].pixels)
                p = static_cast<std::uint8_t>(std::clamp(std::lround(p + by), 0L, 255L));
            for (std::uint8_t& p : exposed[f].pixels)
                p = static_cast<std::uint8_t>(std::clamp(std::lround(p * times), 0L, 255L));
        }
        const SequenceCheck lamps = check_sequence(with_noise(flickering, 1, 5), stripes),
                            exposure = check_sequence(with_noise(exposed, 1, 5), stripes);
        ASSERT_FALSE(lamps.problems.empty()) << grey;
        EXPECT_EQ(lamps.problems[0].cause, SequenceProblem::Cause::flicker) << grey << ": " << said(lamps);
        EXPECT_NE(remedy_of(lamps.problems[0]).find("whole number of 10 ms"), std::string::npos);
        for (const SequenceProblem& problem : exposure.problems)
            EXPECT_NE(problem.cause, SequenceProblem::Cause::flicker) << grey << ": " << said(exposure);
    }
}

TEST(CheckSequence, AScanOfAColourCamerasRawPicturesIsRefusedAsSuch) {
    Room room = paper_room(sphere({120, -40, 360}, 80));
    ScanCapture shot = capture(room, stripes_of(room));
    for (GrayImage& frame : shot.right)
        for (int y = 0; y < frame.height; ++y)
            for (int x = 0; x < frame.width; ++x)
                frame.at(x, y) = static_cast<std::uint8_t>(frame.at(x, y) * (x % 2 != y % 2 ? 0.62
                                                                             : x % 2 == 0   ? 1
                                                                                            : 0.42));
    try {
        scan_from_capture(shot, rig_of(room));
        FAIL() << "was scanned";
    } catch (const CheckFailedError& error) {
        EXPECT_NE(std::string(error.what()).find("the right camera: these are raw pictures of a colour camera"),
                  std::string::npos)
            << error.what();
    }
}

}  // namespace
}  // namespace planlight
