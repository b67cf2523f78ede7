#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "registration/scan/check/check_sequence.h"
#include "registration/scan/decode/gray_code.h"
#include "tests/registration/scan/spoilt_sequence.h"

// Gray codes to single projector pixels before a camera that does not resolve the finest of them, as most captures of
// others are. They are sound, whatever their stripes look like on the camera's lattice.
namespace planlight {
namespace {

using spoilt_sequence::said;
using Kind = StripePattern::Kind;

struct View {
    double cell_px = 1;  ///< camera pixels a projector pixel
    double turned = 0;   ///< radians
    double blur_px = 0.4;
    double camera_gamma = 1;
    bool inverse = true;
    double bent = 0;  ///< how much narrower the cells are at the picture's sides
};

constexpr int kWidth = 280, kHeight = 220;
constexpr double kDisk_px = 105;

/// What a pixel's square and the blur bring together, and how much light there is.
struct Sample {
    std::array<int, 9> number{};  ///< of the code, across the stripes
    double light = 0;
};

std::vector<Sample> samples_of(const View& view, bool rows) {
    const double c = std::cos(view.turned), s = std::sin(view.turned);
    std::vector<Sample> samples;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double px = x - kWidth / 2.0, py = y - kHeight / 2.0, r2 = px * px + py * py;
            Sample sample;
            if (r2 < kDisk_px * kDisk_px)
                sample.light =
                    (120 + 25 * std::sin(0.11 * px) * std::cos(0.07 * py)) * (1 - r2 / (4 * kDisk_px * kDisk_px));
            for (std::size_t k = 0; k < 9; ++k) {
                const double across = (rows ? -s * px + c * py : c * px + s * py) +
                                      (static_cast<double>(k) / 4 - 1) * (0.5 + view.blur_px);
                const double place = across / view.cell_px * (1 + view.bent * across * across / (kWidth * kWidth));
                sample.number[k] = static_cast<int>(std::floor(place + (rows ? 300 : 500)));
            }
            samples.push_back(sample);
        }
    return samples;
}

/// A lit disk on a dark picture.
std::vector<GrayImage> frames_of(const View& view, const std::vector<StripePattern>& patterns, int bits,
                                 unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1.2);
    std::vector<double> noise(4093);
    for (double& n : noise) n = normal(random);
    const std::array samples{samples_of(view, false), samples_of(view, true)};
    std::vector<GrayImage> frames;
    std::size_t next = 0;
    for (const StripePattern& pattern : patterns) {
        GrayImage frame(kWidth, kHeight);
        for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
            const Sample& sample = samples[pattern.along_rows][i];
            double lit = pattern.kind == Kind::white ? 1 : 0;
            if (pattern.kind == Kind::gray_bit || pattern.kind == Kind::gray_bit_inverse)
                for (const int n : sample.number)
                    lit +=
                        ((((n ^ (n >> 1)) >> (bits - 1 - pattern.index)) & 1) != 0) == (pattern.kind == Kind::gray_bit)
                            ? 1.0 / 9
                            : 0;
            const double light = 5 + sample.light * (lit + 0.04);
            const double grey = (view.camera_gamma == 1 ? light : 255 * std::pow(light / 255, 1 / view.camera_gamma)) +
                                noise[next++ % noise.size()];
            frame.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
        }
        next += 17;
        frames.push_back(std::move(frame));
    }
    return frames;
}

struct Code {
    StripeSettings stripes;
    std::vector<StripePattern> patterns;
};

Code code_of(bool inverse) {
    Code code;
    code.stripes.width = 1024, code.stripes.height = 768;
    code.stripes.phase_steps = 0, code.stripes.phase_period_px = 2;
    code.stripes.inverse = inverse;
    code.patterns = gray_code_patterns(code.stripes);
    return code;
}

TEST(FineStripes, ThatTheCameraDoesNotResolveAreNoFault) {
    unsigned seed = 0;
    std::vector<std::string> refused;
    int looked = 0;
    for (const bool inverse : {true, false})
        for (const double gamma : {1.0, 2.2})
            for (const double turned : {0.0, 0.12})
                for (double cell_px = 0.45; cell_px < 3.3; cell_px *= 1.17) {
                    View view{cell_px, turned, seed % 3 * 0.4, gamma, inverse, seed % 2 * 0.8};
                    const Code code = code_of(inverse);
                    const auto check =
                        check_sequence(frames_of(view, code.patterns, 10, ++seed), code.stripes, code.patterns);
                    EXPECT_TRUE(check.checked);
                    ++looked;
                    if (!check.problems.empty())
                        refused.push_back(
                            fmt::format("cell {:.2f} px, turned {}, blur {}, gamma {}, inverse {}, bent {}: {}",
                                        cell_px, turned, view.blur_px, gamma, inverse, view.bent, said(check)));
                }
    EXPECT_EQ(refused, std::vector<std::string>{}) << refused.size() << " of " << looked;
}

// What is wide enough to be seen is still judged: coarse pictures exchanged, late and doubled, each by its name.
TEST(FineStripes, DoNotHideFaultsAmongTheCoarseOnes) {
    const Code code = code_of(true);
    for (const double cell_px : {0.5, 0.75, 1.0, 1.5, 2.1}) {
        const auto sound = frames_of({cell_px, 0.05, 0.3, 1, true, 0.3}, code.patterns, 10, 5);
        const auto at = [&](const std::string& name) {
            return static_cast<std::size_t>(std::find_if(code.patterns.begin(), code.patterns.end(),
                                                         [&](const auto& p) { return p.name == name; }) -
                                            code.patterns.begin());
        };
        auto exchanged = sound;
        std::swap(exchanged[at("column-gray-4")], exchanged[at("column-gray-5")]);
        std::swap(exchanged[at("column-gray-4-inverse")], exchanged[at("column-gray-5-inverse")]);
        EXPECT_FALSE(check_sequence(exchanged, code.stripes, code.patterns).problems.empty())
            << "exchanged, " << cell_px;
        auto coarse_for_fine = sound;
        std::swap(coarse_for_fine[at("row-gray-4")], coarse_for_fine[at("row-gray-9")]);
        EXPECT_FALSE(check_sequence(coarse_for_fine, code.stripes, code.patterns).problems.empty())
            << "exchanged with the finest, " << cell_px;
        auto late = sound;
        for (std::size_t i = late.size(); i-- > at("column-gray-3");) late[i] = sound[i - 1];
        EXPECT_FALSE(check_sequence(late, code.stripes, code.patterns).problems.empty()) << "late, " << cell_px;
        auto doubled = sound;
        doubled[at("row-gray-4")] = sound[at("row-gray-3")];
        EXPECT_FALSE(check_sequence(doubled, code.stripes, code.patterns).problems.empty()) << "doubled, " << cell_px;
    }
}

}  // namespace
}  // namespace planlight
