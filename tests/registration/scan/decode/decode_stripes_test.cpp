#include "registration/scan/decode/decode_stripes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "planning_io/types/statistics.h"
#include "registration/scan/decode/gray_code.h"
#include "registration/scan/decode/second_harmonic.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;

const Eigen::Vector3d kPlace(120, -40, 300);
const Eigen::Vector3d kTilted = Eigen::Vector3d(0.35, 0.2, -1).normalized();

struct Shot {
    Room room;
    StripeSettings stripes;
    std::vector<GrayImage> frames;
    DecodedView view;
    Truth truth;
};

const Shot& plane_shot() {
    static const Shot shot = [] {
        Shot s{paper_room(plane(kPlace, kTilted)), {}, {}, {}, {}};
        s.stripes = stripes_of(s.room);
        s.frames = photograph(s.room, s.room.left, s.stripes, 7);
        s.view = decode_stripes(s.frames, s.stripes);
        s.truth = truth_of(s.room, s.room.left);
        return s;
    }();
    return shot;
}

struct Errors {
    std::vector<double> column, row, normalised;
    std::size_t wrong = 0, unlit = 0, lit = 0;
};

Errors errors_of(const DecodedView& view, const Truth& truth) {
    Errors e;
    for (std::size_t i = 0; i < truth.code.size(); ++i) {
        const bool lit = !std::isnan(truth.code[i].x());
        e.lit += lit ? 1 : 0;
        if (std::isnan(view.column[i])) continue;
        if (!lit) {
            ++e.unlit;
            continue;
        }
        const double dc = view.column[i] - truth.code[i].x(), dr = view.row[i] - truth.code[i].y();
        if (std::max(std::abs(dc), std::abs(dr)) > 4) {
            ++e.wrong;
            continue;
        }
        e.column.push_back(dc);
        e.row.push_back(dr);
        e.normalised.push_back(dc / view.sigma_px[i]);
    }
    return e;
}

double mean(const std::vector<double>& v) {
    double sum = 0;
    for (const double x : v) sum += x;
    return sum / static_cast<double>(v.size());
}
double median_size(std::vector<double> v) {
    for (double& x : v) x = std::abs(x);
    return median(v);
}

TEST(DecodeStripes, APlaneThroughGammaBlurAndNoise) {
    const Errors e = errors_of(plane_shot().view, plane_shot().truth);
    ASSERT_GT(e.lit, 200000u);
    EXPECT_GT(static_cast<double>(e.column.size()), 0.97 * static_cast<double>(e.lit));
    EXPECT_LT(static_cast<double>(e.wrong), 1e-4 * static_cast<double>(e.column.size()));
    EXPECT_LT(median_size(e.column), 0.1);
    EXPECT_LT(median_size(e.row), 0.1);
    // A convention off by half a pixel would show as 0.5 here.
    EXPECT_LT(std::abs(mean(e.column)), 0.02);
    EXPECT_LT(std::abs(mean(e.row)), 0.02);
}

/// Three shifts cannot tell a gamma's second harmonic from their fringe: a gamma of 2.2 moved the code by up to a
/// twentieth of a period (3 projector pixels of 64) without a word. It shows in the amplitudes.
TEST(DecodeStripes, AGammaMovesNoFringesOfThreeShifts) {
    for (const double period_px : {16.0, 64.0})
        for (const double gamma : {1.0, 1.8, 2.2}) {
            Room room = paper_room(plane(kPlace, kTilted));
            room.light.gamma = gamma;
            StripeSettings stripes = stripes_of(room);
            stripes.phase_steps = 3;
            stripes.phase_period_px = period_px;
            const auto frames = photograph(room, room.left, stripes, 7);
            const auto share = largest_second_harmonic(frames, stripes);
            ASSERT_TRUE(share);
            // cos^2g has (g - 1) / (g + 2) of it; blur takes most of it from fringes of 16 pixels, and little of 64.
            if (period_px == 64 || gamma == 1) {
                EXPECT_NEAR(*share, (gamma - 1) / (gamma + 2), 0.02) << gamma;
            }
            const Errors e = errors_of(decode_stripes(frames, stripes), truth_of(room, room.left));
            EXPECT_GT(static_cast<double>(e.column.size()), 0.95 * static_cast<double>(e.lit)) << gamma;
            EXPECT_LT(static_cast<double>(e.wrong), 1e-3 * static_cast<double>(e.lit)) << gamma;
            // Noise of 1.5 grey; at the crests up to seven times that of a pure fringe.
            EXPECT_LT(median_size(e.column), 0.008 * period_px) << gamma << " " << period_px;
            EXPECT_LT(median_size(e.row), 0.008 * period_px) << gamma << " " << period_px;
        }
}

TEST(DecodeStripes, NoiseIsMeasuredAndSigmaIsHonest) {
    // 1.5 grey of the camera and the rounding to whole values: 1.53.
    EXPECT_NEAR(plane_shot().view.noise_grey, 1.53, 0.1);
    const Errors e = errors_of(plane_shot().view, plane_shot().truth);
    // Median of |normal| is 0.674; the sampling of the fringes by pixels adds a little that no noise model knows.
    EXPECT_NEAR(median_size(e.normalised), 0.674, 0.12);
}

TEST(DecodeStripes, EveryPixelIsAccountedFor) {
    const DecodedView& v = plane_shot().view;
    EXPECT_EQ(v.decoded + v.dark + v.saturated + v.uncertain, v.column.size());
    EXPECT_EQ(static_cast<std::size_t>(
                  std::count_if(v.column.begin(), v.column.end(), [](float c) { return !std::isnan(c); })),
              v.decoded);
}

TEST(DecodeStripes, WithoutInversesToo) {
    Shot s = plane_shot();
    std::vector<GrayImage> frames;
    const auto sequence = stripe_sequence(s.stripes);
    for (std::size_t i = 0; i < sequence.size(); ++i)
        if (sequence[i].kind != StripePattern::Kind::gray_bit_inverse) frames.push_back(s.frames[i]);
    s.stripes.inverse = false;
    const Errors e = errors_of(decode_stripes(frames, s.stripes), s.truth);
    EXPECT_GT(static_cast<double>(e.column.size()), 0.96 * static_cast<double>(e.lit));
    EXPECT_LT(static_cast<double>(e.wrong), 1e-4 * static_cast<double>(e.column.size()));
}

TEST(DecodeStripes, TheFastSetHasAsFewWrongCodes) {
    Shot s = plane_shot();
    s.stripes = fast_stripes(s.room.projector.width, s.room.projector.height);
    ASSERT_EQ(stripe_sequence(s.stripes).size(), 14u);
    ASSERT_EQ(stripe_sequence(fast_stripes(1920, 1080)).size(), 15u);
    std::size_t decoded = 0, wrong = 0, lit = 0;
    std::vector<double> errors;
    for (const double white_grey : {190.0, 60.0}) {
        s.room.light.white_grey = white_grey;
        const DecodedView v = decode_stripes(photograph(s.room, s.room.left, s.stripes, 9), s.stripes);
        for (std::size_t i = 0; i < s.truth.code.size(); ++i) {
            lit += !std::isnan(s.truth.code[i].x());
            if (std::isnan(v.column[i]) || std::isnan(s.truth.code[i].x())) continue;
            ++decoded;
            const double e = v.column[i] - s.truth.code[i].x();
            if (std::abs(e) > 4)
                ++wrong;
            else
                errors.push_back(e);
        }
    }
    EXPECT_GT(static_cast<double>(decoded), 0.95 * static_cast<double>(lit));
    EXPECT_LT(static_cast<double>(wrong), 1e-4 * static_cast<double>(decoded));
    EXPECT_LT(median_size(errors), 0.1);
    EXPECT_LT(std::abs(mean(errors)), 0.02);
}

TEST(DecodeStripes, ColumnsOnly) {
    Shot s = plane_shot();
    s.stripes.rows = false;
    const std::size_t n = stripe_sequence(s.stripes).size();
    const DecodedView v = decode_stripes(std::span(s.frames).first(n), s.stripes);
    EXPECT_TRUE(v.row.empty());
    EXPECT_GT(v.decoded, plane_shot().view.decoded - 2000);
}

TEST(DecodeStripes, ShadowAndDarknessAreDropped) {
    // A disc in front of the plane throws a shadow on it; the background beyond the plane's rim is empty.
    const Eigen::Vector3d towards = Eigen::Vector3d(0.1, 0.35, -1).normalized();
    Room room = paper_room(nearest_of({plane(kPlace, kTilted, 90), plane(kPlace + 120 * towards, -towards, 25)}));
    const StripeSettings stripes = stripes_of(room);
    const DecodedView v = decode_stripes(photograph(room, room.left, stripes, 3), stripes);
    const Truth truth = truth_of(room, room.left);
    const Errors e = errors_of(v, truth);
    EXPECT_LT(static_cast<double>(e.wrong), 5e-4 * static_cast<double>(e.column.size()));
    // Unlit pixels may only answer where blur brings them a neighbour's light: within 2 pixels of a lit one.
    std::size_t unlit = 0, far_from_light = 0;
    for (int y = 0; y < v.height; ++y)
        for (int x = 0; x < v.width; ++x) {
            const auto at = [&](int px, int py) {
                return static_cast<std::size_t>(py) * static_cast<std::size_t>(v.width) + static_cast<std::size_t>(px);
            };
            if (!std::isnan(truth.code[at(x, y)].x())) continue;
            ++unlit;
            if (std::isnan(v.column[at(x, y)])) continue;
            bool near_light = false;
            for (int dy = -2; dy <= 2; ++dy)
                for (int dx = -2; dx <= 2; ++dx) {
                    const int px = std::clamp(x + dx, 0, v.width - 1), py = std::clamp(y + dy, 0, v.height - 1);
                    near_light |= !std::isnan(truth.code[at(px, py)].x());
                }
            far_from_light += near_light ? 0 : 1;
        }
    EXPECT_GT(unlit, 100000u);
    EXPECT_EQ(far_from_light, 0u);
}

/// A frame smoothed by a Gaussian of `sigma` pixels.
std::vector<float> smoothed(const GrayImage& frame, double sigma) {
    const int reach = static_cast<int>(3 * sigma);
    std::vector<float> weights, along(frame.pixels.size()), out(frame.pixels.size());
    float sum = 0;
    for (int d = -reach; d <= reach; ++d)
        sum += weights.emplace_back(static_cast<float>(std::exp(-d * d / (2 * sigma * sigma))));
    for (int pass = 0; pass < 2; ++pass)
        for (int y = 0; y < frame.height; ++y)
            for (int x = 0; x < frame.width; ++x) {
                float value = 0;
                for (int d = -reach; d <= reach; ++d) {
                    const float w = weights[static_cast<std::size_t>(d + reach)] / sum;
                    if (pass == 0)
                        value += w * static_cast<float>(frame.at(std::clamp(x + d, 0, frame.width - 1), y));
                    else
                        value += w * along[frame.index(x, std::clamp(y + d, 0, frame.height - 1))];
                }
                (pass == 0 ? along : out)[frame.index(x, y)] = value;
            }
    return out;
}

TEST(DecodeStripes, LightByWayOfAnotherWallIsDropped) {
    // A wall 60 pixels aside throws on every pixel 0.6 of its own light, washed out over 4.8 pixels as by matt skin: in
    // the shadow of a disc there is bright light with a weak, sharp enough code in it, and it is the code of the wall.
    const Eigen::Vector3d towards = Eigen::Vector3d(0.1, 0.35, -1).normalized();
    Room room = paper_room(nearest_of({plane(kPlace, kTilted), plane(kPlace + 120 * towards, -towards, 25)}));
    room.light.ambient_grey = 8;
    room.light.white_grey = 150;
    const StripeSettings stripes = stripes_of(room);
    std::vector<GrayImage> frames = photograph(room, room.left, stripes, 3);
    constexpr int kAside_px = 60;
    for (GrayImage& frame : frames) {
        const std::vector<float> wall = smoothed(frame, 4.8);
        for (int y = 0; y < frame.height; ++y)
            for (int x = 0; x < frame.width; ++x) {
                const float detour = 0.6f * wall[frame.index(std::min(x + kAside_px, frame.width - 1), y)];
                frame.at(x, y) =
                    static_cast<std::uint8_t>(std::min(255L, std::lround(static_cast<float>(frame.at(x, y)) + detour)));
            }
    }
    const Truth truth = truth_of(room, room.left);
    const auto wrong_codes = [&](double min_direct_fraction) {
        DecodeSettings settings;
        settings.min_direct_fraction = min_direct_fraction;
        const DecodedView v = decode_stripes(frames, stripes, settings);
        std::size_t wrong = 0;
        for (int y = 0; y < v.height; ++y)
            for (int x = 0; x < v.width; ++x) {
                const std::size_t i =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(v.width) + static_cast<std::size_t>(x);
                if (std::isnan(v.column[i])) continue;
                if (!std::isnan(truth.code[i].x())) continue;
                bool near_light = false;  // the rim of the shadow, where blur mixes both
                for (const auto& [dx, dy] : {std::pair{-5, 0}, {5, 0}, {0, -5}, {0, 5}, {0, 0}}) {
                    const int px = std::clamp(x + dx, 0, v.width - 1), py = std::clamp(y + dy, 0, v.height - 1);
                    near_light |= !std::isnan(truth.code[frames[0].index(px, py)].x());
                }
                wrong += !near_light;
            }
        return std::pair(wrong, v.decoded);
    };
    const auto [wrong_without, decoded_without] = wrong_codes(0);
    const auto [wrong, decoded] = wrong_codes(DecodeSettings{}.min_direct_fraction);
    EXPECT_GT(wrong_without, 1000u);  // the detour would be taken for a place
    EXPECT_LT(wrong * 10, wrong_without);
    EXPECT_GT(decoded + 2 * wrong_without, decoded_without);  // what is lit directly stays
}

TEST(DecodeStripes, SaturatedPixelsAreDropped) {
    Room room = plane_shot().room;
    room.light.white_grey = 420;
    const StripeSettings stripes = stripes_of(room);
    const DecodedView v = decode_stripes(photograph(room, room.left, stripes, 3), stripes);
    EXPECT_GT(v.saturated, 100000u);
    EXPECT_LT(static_cast<double>(errors_of(v, plane_shot().truth).wrong),
              1e-4 * static_cast<double>(v.decoded + 10000));
}

TEST(DecodeStripes, DimAndNoisyDropsRatherThanGuesses) {
    Room room = plane_shot().room;
    room.light.white_grey = 25;
    room.light.noise_grey = 2.5;
    const StripeSettings stripes = stripes_of(room);
    const DecodedView v = decode_stripes(photograph(room, room.left, stripes, 3), stripes);
    const Errors e = errors_of(v, plane_shot().truth);
    EXPECT_GT(e.column.size(), 50000u);
    EXPECT_GT(v.uncertain, 100u);
    EXPECT_LT(static_cast<double>(e.wrong), 1e-4 * static_cast<double>(e.column.size()));
}

TEST(DecodeStripes, ADisturbedGrayFrameDropsPixelsInsteadOfMovingThem) {
    // A frame the projector had not finished: the picture and its inverse mixed half and half.
    Shot s = plane_shot();
    for (std::size_t i = 0; i < s.frames[6].pixels.size(); ++i) {
        const auto mixed = static_cast<std::uint8_t>((s.frames[6].pixels[i] + s.frames[7].pixels[i]) / 2);
        s.frames[6].pixels[i] = s.frames[7].pixels[i] = mixed;
    }
    const Errors e = errors_of(decode_stripes(s.frames, s.stripes), s.truth);
    EXPECT_LT(static_cast<double>(e.column.size()), 0.2 * static_cast<double>(e.lit));
    EXPECT_LT(static_cast<double>(e.wrong), 1e-4 * static_cast<double>(e.lit));
}

/// A picture of 1500 x 7 pixels, dark but for every 517th, which is lit from a place of its own; `drawn` is what the
/// projector shows there (0 to 1).
constexpr int kSparseWidth = 1500, kSparseHeight = 7;
constexpr std::size_t kEvery = 517;
Eigen::Vector2i place_of(std::size_t i) {
    return {static_cast<int>(i * 37 % 800), static_cast<int>(i * 53 % 600)};
}

template <class Drawn>
GrayImage sparse_picture(unsigned seed, const Drawn& drawn) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> noise(18, 22);
    GrayImage picture(kSparseWidth, kSparseHeight);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const double light = i % kEvery == 0 ? 150 * drawn(place_of(i)) : 0;
        picture.pixels[i] = static_cast<std::uint8_t>(noise(random) + std::lround(light));
    }
    return picture;
}

void expect_only_the_lit(const DecodedView& view, double allowed_px) {
    std::size_t lit = 0;
    for (std::size_t i = 0; i < view.column.size(); ++i) {
        if (i % kEvery != 0) {
            EXPECT_TRUE(std::isnan(view.column[i]) && std::isnan(view.row[i]) && std::isnan(view.sigma_px[i])) << i;
            continue;
        }
        ++lit;
        EXPECT_NEAR(view.column[i], place_of(i).x(), allowed_px) << i;
        EXPECT_NEAR(view.row[i], place_of(i).y(), allowed_px) << i;
    }
    EXPECT_EQ(view.decoded, lit);
    EXPECT_EQ(view.decoded + view.dark + view.saturated + view.uncertain, view.column.size());
}

// The decoders leave what holds no light early: never with a lit pixel in it.
TEST(DecodeStripes, AFewLitPixelsInTheDarkAreFound) {
    StripeSettings stripes;
    stripes.width = 800, stripes.height = 600;
    std::vector<GrayImage> frames;
    for (const StripePattern& pattern : stripe_sequence(stripes)) {
        const RgbImage shown = draw_stripes(stripes, pattern);
        frames.push_back(sparse_picture(static_cast<unsigned>(frames.size()), [&](const Eigen::Vector2i& place) {
            return shown.at(place.x(), place.y())[1] / 255.0;
        }));
    }
    expect_only_the_lit(decode_stripes(frames, stripes), 0.3);
}

TEST(GrayCode, AFewLitPixelsInTheDarkAreFound) {
    StripeSettings stripes;
    stripes.width = 800, stripes.height = 600;
    std::vector<GrayImage> frames;
    for (const StripePattern& pattern : gray_code_patterns(stripes)) {
        const bool inverse = pattern.kind == StripePattern::Kind::gray_bit_inverse;
        frames.push_back(sparse_picture(static_cast<unsigned>(frames.size()), [&](const Eigen::Vector2i& place) {
            if (pattern.kind == StripePattern::Kind::white || pattern.kind == StripePattern::Kind::black)
                return pattern.kind == StripePattern::Kind::white ? 1.0 : 0.0;
            const int at = pattern.along_rows ? place.y() : place.x(), gray = at ^ (at >> 1);
            return ((gray >> (9 - pattern.index)) & 1) != (inverse ? 1 : 0) ? 1.0 : 0.0;  // 10 bits, coarsest first
        }));
    }
    expect_only_the_lit(decode_gray_code(frames, 800, 600), 0);
}

TEST(DecodeStripes, AMissingOrForeignFrameIsRefused) {
    Shot s = plane_shot();
    EXPECT_THROW(decode_stripes(std::span(s.frames).first(s.frames.size() - 1), s.stripes), std::invalid_argument);
    EXPECT_THROW(decode_stripes({}, s.stripes), std::invalid_argument);
    s.frames[5] = GrayImage(743, 576);
    EXPECT_THROW(decode_stripes(s.frames, s.stripes), std::invalid_argument);
    s.frames[5] = GrayImage(744, 576);
    s.frames[5].pixels.resize(100);
    EXPECT_THROW(decode_stripes(s.frames, s.stripes), std::invalid_argument);
}

}  // namespace
}  // namespace planlight
