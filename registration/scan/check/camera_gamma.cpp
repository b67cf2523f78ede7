#include "registration/scan/check/camera_gamma.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "registration/scan/check/picture_noise.h"

namespace planlight {
namespace {

constexpr int kLeastLight_grey = 20, kSaturated = 250;
constexpr std::size_t kLeastEdges = 500, kMostEdges = 20000;

using Light = std::array<double, 256>;  ///< of every grey value

Light light_of(double gamma) {
    Light light{};
    for (std::size_t g = 0; g < light.size(); ++g) light[g] = 255 * std::pow(static_cast<double>(g) / 255, gamma);
    return light;
}

/// A pixel on the edge of a stripe: half of the light is on it in a bit and in its inverse.
struct Edge {
    std::uint8_t white, black, bit, inverse;
};

std::vector<Edge> edges_of(const std::vector<GrayImage>& frames, const std::vector<UniformLightFrame>& moments) {
    std::vector<Edge> edges;
    const auto& white = frames.at(0).pixels;
    const auto& black = frames.at(1).pixels;
    const double least = std::max<double>(kLeastLight_grey, 5 * noise_in_dark(frames[0], frames[1]));
    for (const UniformLightFrame& moment : moments) {
        if (moment.frames.size() != 2 || moment.name == "white") continue;
        const auto &bit = frames.at(moment.frames[0]).pixels, &inverse = frames.at(moment.frames[1]).pixels;
        for (std::size_t i = 0; i < white.size(); i += 3) {
            const int light = white[i] - black[i];
            if (light < least || white[i] >= kSaturated || 2 * std::abs(bit[i] - inverse[i]) > light) continue;
            edges.push_back({white[i], black[i], bit[i], inverse[i]});
        }
    }
    if (edges.size() <= kMostEdges) return edges;
    std::vector<Edge> some;
    for (std::size_t i = 0; i < kMostEdges; ++i) some.push_back(edges[i * edges.size() / kMostEdges]);
    return some;
}

/// How much brighter bit and inverse are together than white and black, as a share of the contrast.
double surplus(const std::vector<Edge>& edges, double gamma) {
    const Light light = light_of(gamma);
    double sum = 0;
    for (const Edge& e : edges) {
        const double white = light[e.white], black = light[e.black];
        sum += (light[e.bit] + light[e.inverse] - white - black) / (white - black);
    }
    return sum / static_cast<double>(edges.size());
}

}  // namespace

double camera_gamma(const std::vector<GrayImage>& frames, const std::vector<UniformLightFrame>& moments) {
    constexpr double kAlike = 0.05;
    double least = 0.4, most = 4;
    const std::vector<Edge> edges = edges_of(frames, moments);
    if (edges.size() < kLeastEdges || std::abs(surplus(edges, 1)) < kAlike) return 1;
    if (surplus(edges, least) < 0 || surplus(edges, most) > 0) return 1;  // no exponent makes them alike
    for (int halving = 0; halving < 12; ++halving) {
        const double middle = 0.5 * (least + most);
        (surplus(edges, middle) > 0 ? least : most) = middle;
    }
    return 0.5 * (least + most);
}

std::string said_of_gamma(double gamma) {
    constexpr double kLeast = 1.3;
    if (gamma < kLeast) return {};
    return fmt::format(
        "; the camera seems to encode its pictures for a screen (exponent {:.1f}), which may be the cause: set it to "
        "linear "
        "(gamma 1, RAW)",
        gamma);
}

std::vector<float> even_light_picture(const std::vector<GrayImage>& frames, const UniformLightFrame& moment,
                                      double gamma) {
    if (gamma == 1) return sum_uniform_light(frames, moment);
    std::array<float, 256> light{};
    const Light table = light_of(gamma);
    for (std::size_t g = 0; g < light.size(); ++g)
        light[g] = static_cast<float>(table[g] * 2 / static_cast<double>(moment.frames.size()));
    std::vector<float> sum(frames.at(0).pixels.size(), 0);
    for (const std::size_t k : moment.frames)
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += light[frames.at(k).pixels[i]];
    return sum;
}

}  // namespace planlight
