#include "registration/scan/check/check_sequence.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "planning_io/types/error.h"
#include "registration/scan/movement/scan_movement.h"
#include "tests/registration/scan/spoilt_sequence.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;
using spoilt_sequence::changed, spoilt_sequence::said, spoilt_sequence::Sequence, spoilt_sequence::sequence_of,
    spoilt_sequence::with_noise;

const Eigen::Vector3d kCentre(120, -40, 360), kPlace(120, -40, 300);

const Sequence& head() {
    static const Sequence s = sequence_of(sphere(kCentre, 80), 18);
    return s;
}
const Sequence& moved_head() {  // by 0.2 mm, most of it in depth, where it changes the code
    static const Sequence s = sequence_of(sphere(kCentre + Eigen::Vector3d(0.05, 0.05, -0.19), 80), 18);
    return s;
}
const Sequence& bright_room() {
    static const Sequence s = sequence_of(plane(kPlace, Eigen::Vector3d(0.35, 0.2, -1).normalized(), 100), 60);
    return s;
}

TEST(CheckSequence, CleanCapturesAreNeverRefused) {
    for (const Sequence* s : {&head(), &bright_room()})
        for (unsigned seed = 0; seed < 12; ++seed) {
            const double sigma = 0.5 + 0.25 * (seed % 12);  // to 3.25 grey
            const SequenceCheck check = check_sequence(with_noise(s->frames, sigma, seed), s->stripes);
            EXPECT_TRUE(check.checked);
            EXPECT_TRUE(check.problems.empty()) << "noise " << sigma << ": " << said(check);
        }
}

TEST(CheckSequence, AHeadThatMovesAFifthOfAMillimetreIsNotRefused) {
    for (std::size_t from = 1; from < head().frames.size(); from += 3) {
        std::vector<GrayImage> frames = head().frames;
        std::copy(moved_head().frames.begin() + static_cast<std::ptrdiff_t>(from), moved_head().frames.end(),
                  frames.begin() + static_cast<std::ptrdiff_t>(from));
        const SequenceCheck check =
            check_sequence(with_noise(frames, 1.5, static_cast<unsigned>(from)), head().stripes);
        EXPECT_TRUE(check.problems.empty()) << from << ": " << said(check);
    }
}

/// Faults of a real rig from frame m on, and of a careless hand.
enum class Fault { late_once, late_from_here, missing, late_by_two, swapped_with_next, inverted, swapped_anywhere };

std::vector<GrayImage> spoil(const Sequence& s, Fault fault, std::size_t m, std::mt19937& random) {
    std::vector<GrayImage> f = s.frames;
    const std::size_t n = f.size();
    switch (fault) {
        case Fault::late_once:
            f[m] = s.frames[m - 1];
            break;
        case Fault::late_from_here:
            for (std::size_t i = m; i < n; ++i) f[i] = s.frames[i - 1];
            break;
        case Fault::missing:
            for (std::size_t i = m; i < n; ++i) f[i] = s.frames[std::min(i + 1, n - 1)];
            break;
        case Fault::late_by_two:
            for (std::size_t i = std::max<std::size_t>(m, 2); i < n; ++i) f[i] = s.frames[i - 2];
            break;
        case Fault::swapped_with_next:
            std::swap(f[m], f[m == n - 1 ? m - 1 : m + 1]);
            break;
        case Fault::inverted: {
            const auto sequence = stripe_sequence(s.stripes);
            while (sequence[m].kind != StripePattern::Kind::gray_bit) m = 2 + random() % (n - 2);
            std::swap(f[m], f[m + 1]);
            break;
        }
        case Fault::swapped_anywhere:
            std::swap(f[m], f[random() % n]);
            break;
    }
    return f;
}

class FaultIsNoticed : public testing::TestWithParam<Fault> {};

TEST_P(FaultIsNoticed, WhereverItHappens) {
    std::mt19937 random(11 + static_cast<unsigned>(GetParam()));
    std::size_t noticed = 0, harmless = 0;
    for (const Sequence* s : {&head(), &bright_room()})
        for (std::size_t m = 1; m < s->frames.size(); m += s == &head() ? 1 : 3) {
            const std::vector<GrayImage> spoilt = spoil(*s, GetParam(), m, random);
            if (changed(s->frames, spoilt) < 0.05) {  // the pictures look alike on this surface
                ++harmless;
                continue;
            }
            const SequenceCheck check =
                check_sequence(with_noise(spoilt, 1.5, static_cast<unsigned>(random())), s->stripes);
            EXPECT_FALSE(check.problems.empty()) << "frame " << m << " of " << (s == &head() ? "head" : "plane");
            noticed += !check.problems.empty();
        }
    EXPECT_GT(noticed, 50u);
    EXPECT_LT(harmless, 5u);
}

INSTANTIATE_TEST_SUITE_P(Faults, FaultIsNoticed,
                         testing::Values(Fault::late_once, Fault::late_from_here, Fault::missing, Fault::late_by_two,
                                         Fault::swapped_with_next, Fault::inverted, Fault::swapped_anywhere));

TEST(CheckSequence, ThePictureIsNamed) {
    std::vector<GrayImage> frames = head().frames;
    const auto sequence = stripe_sequence(head().stripes);
    const std::size_t doubled = 10;  // the frame shows what was there before
    ASSERT_EQ(sequence[doubled].name, "column-gray-4");
    frames[doubled] = frames[doubled - 1];
    const SequenceCheck check = check_sequence(with_noise(frames, 1.5, 3), head().stripes);
    ASSERT_FALSE(check.problems.empty());
    EXPECT_EQ(check.problems[0].frame, doubled);
    EXPECT_NE(check.problems[0].what.find("column-gray-4 looks like column-gray-3-inverse"), std::string::npos)
        << said(check);
}

/// The fringes as skin that scatters and a lens out of focus leave them: `share` of their contrast.
std::vector<GrayImage> with_weak_fringes(const Sequence& scene, double share) {
    const auto sequence = stripe_sequence(scene.stripes);
    std::vector<GrayImage> frames = scene.frames;
    for (const bool rows : {false, true}) {
        std::vector<std::size_t> phases;
        for (std::size_t k = 0; k < sequence.size(); ++k)
            if (sequence[k].kind == StripePattern::Kind::phase && sequence[k].along_rows == rows) phases.push_back(k);
        for (std::size_t i = 0; i < frames[0].pixels.size(); ++i) {
            double mean = 0;
            for (const std::size_t k : phases) mean += frames[k].pixels[i] / static_cast<double>(phases.size());
            for (const std::size_t k : phases)
                frames[k].pixels[i] =
                    static_cast<std::uint8_t>(std::lround(mean + share * (frames[k].pixels[i] - mean)));
        }
    }
    return frames;
}

// Pixel by pixel noise and weak fringes hide what one of eight pictures lacks; over the whole surface they do not.
TEST(CheckSequence, AFringePictureThatIsThereTwiceIsNamedWhereFringesAreWeak) {
    const auto sequence = stripe_sequence(head().stripes);
    const auto is_next = [&](std::size_t k) {
        return k > 0 && sequence[k].kind == StripePattern::Kind::phase && sequence[k - 1].kind == sequence[k].kind &&
               sequence[k].along_rows == sequence[k - 1].along_rows;
    };
    for (const double share : {1.0, 0.5, 0.3})
        for (const double sigma : {0.5, 2.0, 3.0}) {
            const std::vector<GrayImage> sound = with_weak_fringes(head(), share);
            const SequenceCheck clean = check_sequence(with_noise(sound, sigma, 5), head().stripes);
            EXPECT_TRUE(clean.checked && clean.problems.empty()) << share << ", " << sigma << ": " << said(clean);
            for (std::size_t k = 0; k < sequence.size(); ++k) {
                if (!is_next(k)) continue;
                std::vector<GrayImage> frames = sound;
                frames[k] = frames[k - 1];
                const SequenceCheck check = check_sequence(with_noise(frames, sigma, 3), head().stripes);
                EXPECT_FALSE(check.problems.empty()) << sequence[k].name << ", " << share << ", noise " << sigma;
            }
        }
}

/// Light that comes later than is waited for: the first picture is dark still, each of the others is the one before it.
TEST(CheckSequence, LightThatIsLateFromTheBeginningIsCalledLateAndNotUnsteady) {
    std::vector<GrayImage> frames = with_noise(head().frames, 1.5, 3);
    const GrayImage black = frames[1];
    std::rotate(frames.rbegin(), frames.rbegin() + 1, frames.rend());
    frames.front() = black;
    const SequenceCheck check = check_sequence(frames, head().stripes);
    ASSERT_FALSE(check.problems.empty());
    EXPECT_EQ(check.problems.front().cause, SequenceProblem::Cause::timing) << said(check);
}

TEST(CheckSequence, AnExposureThatFollowsThePictureIsNotCalledLate) {
    std::vector<GrayImage> frames = head().frames;
    for (GrayImage& frame : frames) {  // the camera makes half-lit pictures as bright as white
        const double mean =
            std::accumulate(frame.pixels.begin(), frame.pixels.end(), 0.0) / static_cast<double>(frame.pixels.size());
        const double gain = std::clamp(20 / std::max(mean, 1.0), 1.0, 2.0);
        for (std::uint8_t& grey : frame.pixels)
            grey = static_cast<std::uint8_t>(std::min(255.0, std::round(0.6 * gain * grey)));
    }
    const SequenceCheck check = check_sequence(frames, head().stripes);
    ASSERT_FALSE(check.problems.empty());
    EXPECT_EQ(check.problems.front().cause, SequenceProblem::Cause::light) << said(check);
}

TEST(CheckSequence, SwappedFineBitsAreNoticed) {
    const auto sequence = stripe_sequence(head().stripes);
    std::size_t finest = 0;
    for (std::size_t i = 0; i < sequence.size(); ++i)
        if (sequence[i].kind == StripePattern::Kind::gray_bit && !sequence[i].along_rows) finest = i;
    for (const std::size_t back : {2u, 4u}) {
        std::vector<GrayImage> frames = head().frames;
        std::swap(frames[finest], frames[finest - back]);
        std::swap(frames[finest + 1], frames[finest + 1 - back]);
        EXPECT_FALSE(check_sequence(frames, head().stripes).problems.empty()) << back;
    }
}

/// Fringes named from their second shift on are fringes in order, an eighth of a period beside the code.
TEST(CheckSequence, FringesThatBeginWithAnotherShiftAreNoticed) {
    const auto sequence = stripe_sequence(head().stripes);
    for (const bool along_rows : {false, true}) {
        std::vector<std::size_t> phases;
        for (std::size_t i = 0; i < sequence.size(); ++i)
            if (sequence[i].kind == StripePattern::Kind::phase && sequence[i].along_rows == along_rows)
                phases.push_back(i);
        std::vector<GrayImage> frames = head().frames;
        for (std::size_t k = 0; k < phases.size(); ++k)
            frames[phases[k]] = head().frames[phases[(k + 1) % phases.size()]];
        EXPECT_NE(said(check_sequence(frames, head().stripes)).find("beside the code"), std::string::npos)
            << along_rows;
    }
}

TEST(CheckSequence, FramesThatDoNotFitTheSequenceAreAFaultOfTheCaller) {
    auto patterns = stripe_sequence(head().stripes);
    patterns[0].kind = StripePattern::Kind::black;
    EXPECT_THROW(check_sequence(head().frames, head().stripes, patterns), std::invalid_argument) << "no white";
}

TEST(CheckSequence, AScanNamesThePictureAndRefuses) {
    Room room = paper_room(sphere(kCentre, 80));
    ScanCapture shot = capture(room, stripes_of(room));
    shot.right[20] = shot.right[19];
    try {
        scan_from_capture(shot, rig_of(room));
        FAIL() << "a doubled frame was scanned";
    } catch (const CheckFailedError& e) {
        EXPECT_NE(std::string(e.what()).find(stripe_sequence(shot.stripes)[20].name), std::string::npos) << e.what();
    }
    ScanSettings as_it_is;
    as_it_is.check_sequence = false;
    EXPECT_NO_THROW(scan_from_capture(shot, rig_of(room), as_it_is));
}

TEST(CheckSequence, EdgesShadowsAndAModernRigAreNotRefused) {
    const Eigen::Vector3d towards = Eigen::Vector3d(0.1, 0.35, -1).normalized();
    Room room =
        modern_room(nearest_of({sphere(kCentre, 60), plane(kPlace + 80 * Eigen::Vector3d(0, 0, 1), -towards, 90),
                                plane(kPlace + 120 * towards, -towards, 15)}));
    room.light.white_grey = 90;
    const ScanCapture shot = capture(room, stripes_of(room));
    for (const auto* frames : {&shot.left, &shot.right}) {
        const SequenceCheck check = check_sequence(*frames, shot.stripes);
        EXPECT_TRUE(check.checked);
        EXPECT_TRUE(check.problems.empty()) << said(check);
    }
}

// A white drape beside the skin, of which a fault shows nothing: the coarsest bit inverted is there what the next one
// is.
TEST(CheckSequence, AFaultThatOnlySkinShowsIsNoticedBesideABrightDrape) {
    Room room = paper_room(sphere(kCentre, 80));
    room.light.noise_grey = 0;
    const Truth truth = truth_of(room, room.left);
    const StripeSettings stripes = stripes_of(room);
    constexpr double kFirst = 262;  // from 256 to 512 the coarsest bit is dark, the next one lit
    std::vector<double> columns;
    for (const auto& code : truth.code)
        if (code.x() > kFirst && code.x() < 506) columns.push_back(code.x());
    std::sort(columns.begin(), columns.end());
    const auto lit = static_cast<double>(
        std::count_if(truth.code.begin(), truth.code.end(), [](const auto& code) { return !std::isnan(code.x()); }));
    for (const double brighter : {4.5, 6.0}) {
        room.light.white_grey = 36;
        const auto skin = photograph(room, room.left, stripes, 1);
        room.light.white_grey = brighter * 36;
        const auto drape = photograph(room, room.left, stripes, 1);
        for (const double share : {0.02, 0.1, 0.2}) {
            const auto many = static_cast<std::size_t>(share * lit);
            ASSERT_LT(many, columns.size());
            const double last = columns[many];
            std::vector<GrayImage> frames = skin;
            for (std::size_t f = 0; f < frames.size(); ++f)
                for (std::size_t i = 0; i < truth.code.size(); ++i)
                    if (truth.code[i].x() > kFirst && truth.code[i].x() < last)
                        frames[f].pixels[i] = drape[f].pixels[i];
            const auto clean = check_sequence(with_noise(frames, 1.5, 1), stripes);
            EXPECT_TRUE(clean.checked && clean.problems.empty()) << said(clean);
            ASSERT_EQ(stripe_sequence(stripes)[4].name, "column-gray-1");
            frames[4] = frames[3];  // late: the inverse of column-gray-0 again
            frames[5] = frames[2];
            const auto check = check_sequence(with_noise(frames, 1.5, 1), stripes);
            EXPECT_FALSE(check.problems.empty())
                << brighter << " times brighter over " << 100 * share << " %: " << said(check);
        }
    }
}

TEST(CheckSequence, DarknessIsNotChecked) {
    std::vector<GrayImage> frames(head().frames.size(), GrayImage(744, 576, 20));
    const SequenceCheck check = check_sequence(with_noise(frames, 1.5, 1), head().stripes);
    EXPECT_FALSE(check.checked);
    EXPECT_TRUE(check.problems.empty());
    frames.pop_back();
    EXPECT_THROW(check_sequence(frames, head().stripes), std::invalid_argument);
}

}  // namespace
}  // namespace planlight
