#include "registration/scan/decode/merge_exposures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

/// The share of the lit pixels whose white is at the end of the scale.
double saturated_share(const GrayImage& white, const GrayImage& black) {
    constexpr int kLit_grey = 16, kFull_grey = 254;
    std::size_t lit = 0, full = 0;
    for (std::size_t i = 0; i < white.pixels.size(); ++i) {
        if (white.pixels[i] - black.pixels[i] < kLit_grey) continue;
        ++lit;
        full += white.pixels[i] >= kFull_grey;
    }
    return lit == 0 ? 0 : static_cast<double>(full) / static_cast<double>(lit);
}

/// By how much two codes of one pose may differ in the median, projector pixels.
float most_apart_px(std::vector<float> sigma, std::vector<float> other_sigma) {
    constexpr float kMost_px = 0.1F;  // about 0.15 mm of depth in both rooms
    const float a = median(std::move(sigma)), b = median(std::move(other_sigma));
    // Half of all differences lie within 0.67 sigma; Gray codes of different cells also differ by their roundings.
    constexpr float kCells_px = 0.2F;
    const float rounding_px = std::max(a, b) > kCells_px ? 1.5F * std::abs(a - b) : 0;
    return kMost_px + 0.67F * std::hypot(a, b) + rounding_px;
}

/// What both exposures decoded of a part of the picture.
struct Difference {
    std::vector<float> off, sigma, other_sigma;
    void add(float apart, float s, float other) {
        off.push_back(apart);
        sigma.push_back(s);
        other_sigma.push_back(other);
    }
};

/// Throws where the codes of what both exposures decoded differ by more than their noise: the surface lies elsewhere.
/// All of it is asked, and each small part: a head may move on a pillow that rests.
void check_one_pose(const LargeArray<float>& code, const LargeArray<float>& other, const DecodedView& view,
                    const DecodedView& other_view) {
    constexpr std::size_t kEnough = 1000, kEnoughOfTile = 100;
    constexpr int kTile_px = 16;
    constexpr double kMostTiles = 0.1;
    const char* const scan_again = "Scan again; the patient and the rig must rest from the first exposure to the last.";
    const int across = (view.width + kTile_px - 1) / kTile_px, down = (view.height + kTile_px - 1) / kTile_px;
    Difference all;
    std::vector<Difference> tiles(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
    for (std::size_t i = 0; i < code.size(); ++i) {
        if (std::isnan(code[i]) || std::isnan(other[i])) continue;
        const float apart = std::abs(code[i] - other[i]);
        const auto x = i % static_cast<std::size_t>(view.width), y = i / static_cast<std::size_t>(view.width);
        all.add(apart, view.sigma_px[i], other_view.sigma_px[i]);
        tiles[y / kTile_px * static_cast<std::size_t>(across) + x / kTile_px].add(apart, view.sigma_px[i],
                                                                                  other_view.sigma_px[i]);
    }
    if (all.off.size() < kEnough) return;
    const float median_px = median(all.off);
    if (median_px > most_apart_px(std::move(all.sigma), std::move(all.other_sigma)))
        throw CheckFailedError(
            fmt::format(
                "the exposures are not of one pose: their light differs by {:.2f} projector pixels in the median",
                median_px),
            scan_again);
    double asked = 0, elsewhere = 0;
    std::vector<float> apart_px;
    for (Difference& tile : tiles) {
        if (tile.off.size() < kEnoughOfTile) continue;
        ++asked;
        const float px = median(std::move(tile.off));
        if (px <= most_apart_px(std::move(tile.sigma), std::move(tile.other_sigma))) continue;
        ++elsewhere;
        apart_px.push_back(px);
    }
    if (elsewhere > kMostTiles * asked)
        throw CheckFailedError(fmt::format("the exposures are not of one pose: over {:.0f} % of what both see their "
                                           "light differs, by {:.2f} projector pixels in the median",
                                           100 * elsewhere / asked, median(apart_px)),
                               scan_again);
}

/// How much dimmer the projector's light is in the other exposure: the median over what both decoded; 1 where that is
/// little.
float dimmer_by(const DecodedView& view, const DecodedView& other) {
    constexpr std::size_t kEnough = 100;
    std::vector<float> ratio;
    for (std::size_t i = 0; i < view.column.size(); ++i)
        if (!std::isnan(view.column[i]) && !std::isnan(other.column[i]))
            ratio.push_back(dimness_of(other)[i] / dimness_of(view)[i]);
    return ratio.size() < kEnough ? 1 : median(ratio);
}

}  // namespace

void take_better(DecodedView& view, const DecodedView& other) {
    if (view.width != other.width || view.height != other.height || view.column.size() != other.column.size() ||
        view.row.size() != other.row.size())
        throw std::invalid_argument("take_better: views of different sizes or directions");
    check_one_pose(view.column, other.column, view, other);
    if (!view.row.empty()) check_one_pose(view.row, other.row, view, other);
    const float dimmer = dimmer_by(view, other);
    if (view.dimness.empty()) view.dimness.assign(view.sigma_px.begin(), view.sigma_px.end());
    view.decoded = 0;
    for (std::size_t i = 0; i < view.column.size(); ++i) {
        const bool better = !std::isnan(other.column[i]) && !(view.sigma_px[i] <= other.sigma_px[i]);
        if (better) {
            view.column[i] = other.column[i];
            if (!view.row.empty()) view.row[i] = other.row[i];
            view.sigma_px[i] = other.sigma_px[i];
            view.dimness[i] = dimness_of(other)[i] / dimmer;
        }
        view.decoded += !std::isnan(view.column[i]);
    }
    std::size_t left_over = view.column.size() - view.decoded;
    for (const auto& count : {&DecodedView::dark, &DecodedView::saturated}) {
        view.*count = std::min({view.*count, other.*count, left_over});
        left_over -= view.*count;
    }
    view.uncertain = left_over;
}

void add_darker_captures(Projector& projector, StereoCamera& cameras, const Clock& clock,
                         std::vector<ScanCapture>& captures, const std::function<void(int, int)>& progress,
                         const ExposureSettings& settings) {
    if (captures.empty()) throw std::invalid_argument("add_darker_captures: no capture to judge by");
    StripeSettings darker = captures.back().stripes;
    while (static_cast<int>(captures.size()) < settings.most) {
        const ScanCapture& last = captures.back();  // white and black are the first two pictures
        const double left = saturated_share(last.left[0], last.left[1]),
                     right = saturated_share(last.right[0], last.right[1]);
        if (std::max(left, right) <= settings.max_saturated) break;
        darker.brightness = static_cast<int>(std::lround(settings.darker * darker.brightness));
        if (darker.brightness < 16) break;
        captures.push_back(capture_scan(projector, cameras, clock, darker, progress));
    }
}

}  // namespace planlight
