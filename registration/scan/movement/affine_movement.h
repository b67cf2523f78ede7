#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "planning_io/types/image.h"

// How the lit surface of one picture lies in another, by an affine map. Private to registration/scan.
namespace planlight::affine_movement {

/// Which frames make a picture of the surface, and where they do.
struct Moment {
    std::vector<std::size_t> frames;  ///< their sum is even light
    bool lit_only = false;  ///< a bit without its inverse: only where it is lit, together with the black picture
    int clear_px = 4;       ///< and so far from its stripes' edges
    /// What each frame counts, 1 in the mean, so that light that is not equally bright in all of them leaves no stripes
    /// in the sum; empty: all count alike.
    std::vector<float> weights = {};
};

/// A camera's frames as light. `light`: of every grey value.
struct Pictures {
    const std::vector<GrayImage>& frames;
    std::size_t white = 0, black = 1;
    std::array<float, 256> light;

    float mean_at(std::size_t frame, int x, int y) const;  ///< 3 x 3, at a pixel off the rim
    /// That of twice the even light.
    float even_at(const Moment& moment, int x, int y) const;
};

inline constexpr int kAffine = 6,
                     kNumbers = 8;  ///< of a fit: the map, then how the projector's light and the room's changed

using Affine = Eigen::Matrix<double, kAffine, 1>;

/// Where the surface of one moment lies on that of the first: x' = x + (m0 + m1 u + m2 v, m3 + m4 u + m5 v), pixels.
struct Laid {
    Affine map = Affine::Zero();
    /// By the scatter of what is left over between patches of the picture, so that what goes together in a patch (a
    /// stripe that is left, a glint, clipped light) is not taken for many measurements.
    Eigen::Matrix<double, kAffine, kAffine> covariance = Eigen::Matrix<double, kAffine, kAffine>::Zero();
    /// How much brighter all light was than at the first moment, as a share of the projector's.
    double light_change = 0;
    /// The same of that one of the moment's frames which differs most from their mean, without a sign.
    double uneven_light = 0;
    /// By pixel of the surface, whether it was looked at; empty: all. What a map says beyond is guessed.
    std::vector<bool> seen;
    bool determined = false;
};

/// The pixels at which a movement of the lit surface shows: lit, far from all that is saturated in any frame, no edge
/// of the head.
class Surface {
public:
    Surface(const Pictures& pictures, const Moment& first, const std::vector<Moment>& moments);

    bool enough() const { return pixels_.size() >= kLeastPixels; }

    /// With weights by which its light is most like that of the first moment, moved, in what differs over a few pixels:
    /// stripes of frames that are not equally bright. How bright they are together is left to `lay`.
    Moment steadied(Moment moment) const;

    /// Least squares over the pixels (Lucas & Kanade 1981, one map for all), with projector and room as bright as they
    /// are now. More freedom for the light (smoothly over the picture, by the brightness) leaves a surface without
    /// texture nothing but its rim to be measured by, where stripes are dense and a camera's curve leaves most: worse,
    /// not better.
    Laid lay(const Moment& later) const;

    /// How far 95 % of the surface that both looked at lies apart under two maps, and the standard deviation of that;
    /// pixels. Empty where that is under a tenth of it.
    struct Way {
        double px = 0, sigma_px = 0;
    };
    std::optional<Way> between(const Laid& a, const Laid& b) const;

private:
    static constexpr std::size_t kLeastPixels = 2000, kMostPixels = 150000;
    using Row = Eigen::Matrix<double, kNumbers, 1>;
    struct Pixel {
        int x, y, patch;
        float first, dx, dy, light;  ///< even light of the first moment, its slope, white less black
        float room;                  ///< black, without what it is everywhere
    };
    /// What the weights of a moment are found by: how the first moment and its slopes differ between the two sides of a
    /// pixel.
    struct AcrossPixels {
        struct Pair {
            int x0, y0, x1, y1;
        };
        std::vector<Pair> pairs;
        Eigen::VectorXd first;
        Eigen::Matrix<double, Eigen::Dynamic, kAffine> slopes;  ///< times what a movement is made of
    };
    AcrossPixels across_pixels() const;
    /// What each number of a map changes at a pixel where the light has this slope.
    Affine by_map(int x, int y, double dx, double dy) const;
    Row by_numbers(const Pixel& p) const;
    void choose(const std::vector<std::uint8_t>& spoilt, const Moment& first);
    bool is_lit(const Pixel& p, const Moment& moment) const;

    const Pictures& pictures_;
    const Moment first_;
    std::vector<Pixel> pixels_;
    AcrossPixels across_;
    Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();
    double scale_ = 1;  ///< half the size of what is lit, pixels
    int patches_ = 0;
};

}  // namespace planlight::affine_movement
