// What lamps or a camera do to all pictures of a capture, which no patient and no delay does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "planning_io/types/error.h"
#include "registration/scan/check/check_sequence.h"
#include "registration/scan/movement/scan_movement.h"
#include "tests/registration/scan/spoilt_sequence.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;
using spoilt_sequence::changed, spoilt_sequence::said, spoilt_sequence::Sequence, spoilt_sequence::sequence_of,
    spoilt_sequence::with_noise;

const Eigen::Vector3d kCentre(120, -40, 360);

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

/// What a camera makes of light, 255 the most it can show, that encodes its pictures for a screen: read noise and, of
/// 25,000 electrons, shot noise, and then the power of 1 / 2.2.
std::vector<GrayImage> encoded(std::vector<GrayImage> frames, double noise_grey, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> noise(1 << 18);
    for (double& n : noise) n = normal(random);
    for (GrayImage& frame : frames) {
        std::size_t at = random();
        for (auto& p : frame.pixels) {
            const double sigma = std::hypot(noise_grey, 0.1 * std::sqrt(p));
            const double light = std::clamp((p + sigma * noise[at++ % noise.size()]) / 255, 0.0, 1.0);
            p = static_cast<std::uint8_t>(std::lround(255 * std::pow(light, 1 / 2.2)));
        }
    }
    return frames;
}

// 1 grey of noise in the dark becomes 20 in a picture of gamma 2.2: no light, so white need not be the brightest there.
TEST(CheckSequence, ACameraThatEncodesForAScreenIsNotRefusedForItsNoiseInTheDark) {
    const Sequence dim_skin = sequence_of(sphere(kCentre, 80), 18, 60);
    const SequenceCheck dim = check_sequence(encoded(dim_skin.frames, 0.5, 5), dim_skin.stripes);
    EXPECT_TRUE(dim.checked && dim.problems.empty()) << said(dim);
    for (const double ambient_grey : {0.0, 4.0, 18.0}) {
        const Sequence dim_room = sequence_of(sphere(kCentre, 80), ambient_grey);
        ScanCapture shot;
        shot.stripes = dim_room.stripes;
        for (const double noise_grey : {0.3, 0.5, 1.0}) {
            shot.left = encoded(dim_room.frames, noise_grey, 5);
            const SequenceCheck check = check_sequence(shot.left, dim_room.stripes);
            EXPECT_TRUE(check.checked);
            EXPECT_TRUE(check.problems.empty()) << ambient_grey << ", " << noise_grey << ": " << said(check);
            const auto moved = movement_in_pictures(shot, 0.43);
            EXPECT_NEAR(moved.camera_gamma, 2.2, 0.05);
            EXPECT_LT(moved.moved_mm, 0.075)
                << "half of the limit, as `scan` asks of pictures: a still ball without any texture";
        }
        std::swap(shot.left[10], shot.left[14]);
        EXPECT_FALSE(check_sequence(shot.left, dim_room.stripes).problems.empty()) << "and faults are noticed still";
    }
}

// Beside bright lamps the projector adds 50 grey of such a picture to the skin: not twice what noise makes of the dark.
TEST(CheckSequence, ACameraThatEncodesForAScreenIsNotRefusedBesideBrightLamps) {
    const Sequence bright_room = sequence_of(sphere(kCentre, 80), 84, 50);
    for (const double noise_grey : {0.03, 0.05, 0.1, 0.3, 0.6, 1.0}) {
        std::vector<GrayImage> frames = encoded(bright_room.frames, noise_grey, 5);
        const SequenceCheck check = check_sequence(frames, bright_room.stripes);
        EXPECT_TRUE(check.checked);
        EXPECT_TRUE(check.problems.empty()) << noise_grey << ": " << said(check);
        std::swap(frames[0], frames[10]);
        EXPECT_FALSE(check_sequence(frames, bright_room.stripes).problems.empty()) << noise_grey << ": white swapped";
    }
}

/// Hair on what reflects: strands of one to three pixels, many of them dark. Then the camera adds so much of each
/// picture's difference from itself, blurred by 1.5 px, and encodes it by the power of 1 / 2.4.
std::vector<GrayImage> sharpened_hair(std::vector<GrayImage> frames, double sharpening) {
    cv::Mat strands(frames[0].height, frames[0].width, CV_32F);
    std::mt19937 random(3);
    std::uniform_int_distribution<int> wide(1, 3);
    std::uniform_real_distribution<float> bright(0.05f, 1.0f);
    for (int x = 0; x < strands.cols;) {
        const int end = std::min(strands.cols, x + wide(random));
        strands.colRange(x, end) = bright(random);
        x = end;
    }
    for (GrayImage& frame : frames) {
        cv::Mat picture(frame.height, frame.width, CV_8U, frame.pixels.data()), light, soft;
        picture.convertTo(light, CV_32F, 1 / 255.0);
        light = light.mul(strands);
        cv::GaussianBlur(light, soft, {}, 1.5);
        light = cv::max(light + sharpening * (light - soft), 0);
        cv::pow(light, 1 / 2.4, light);
        light.convertTo(picture, CV_8U, 255);
    }
    return frames;
}

// A bright strand takes light from the dark one beside it: darker than in the black picture, in the few that light the
// one and not the other.
TEST(CheckSequence, ACameraThatSharpensAndEncodesIsNotRefusedForHair) {
    const Sequence hair = sequence_of(sphere(kCentre, 80), 6, 40);
    for (const double sharpening : {0.0, 0.4, 0.8, 1.0}) {
        std::vector<GrayImage> frames = sharpened_hair(hair.frames, sharpening);
        const SequenceCheck check = check_sequence(frames, hair.stripes);
        EXPECT_TRUE(check.checked);
        EXPECT_TRUE(check.problems.empty()) << sharpening << ": " << said(check);
        std::size_t noticed = 0;
        for (std::size_t m = 2; m < frames.size(); m += 3) {
            std::vector<GrayImage> spoilt = frames;
            std::swap(spoilt[1], spoilt[m]);
            if (changed(frames, spoilt) < 0.05) continue;  // the pictures look alike on this surface
            EXPECT_FALSE(check_sequence(spoilt, hair.stripes).problems.empty())
                << sharpening << ": black and picture " << m << " swapped";
            ++noticed;
        }
        EXPECT_GT(noticed, 8u) << "of 15";
    }
}

}  // namespace
}  // namespace planlight
