#include "registration/projector_measurement/light_recording.h"
#include "planning_io/types/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace planlight {
namespace {

constexpr double kLeastContrast_grey = 6;
constexpr double kSaturatedShare = 0.002, kZeroShare = 0.02;
constexpr std::size_t kLeastTiles = 4;

void add_tiles(const GrayImage& picture, FrameBrightness& out) {
    if (picture.empty()) return;
    struct Sum {
        std::uint64_t grey = 0, count = 0, saturated = 0, zero = 0;
    };
    std::array<Sum, kTiles> sums{};
    for (int y = 0; y < picture.height; ++y) {
        const int row = y * kTilesDown / picture.height;
        const std::uint8_t* pixel = &picture.pixels[picture.index(0, y)];
        for (int across = 0; across < kTilesAcross; ++across) {
            Sum& sum = sums[static_cast<std::size_t>(row * kTilesAcross + across)];
            const int from = across * picture.width / kTilesAcross, to = (across + 1) * picture.width / kTilesAcross;
            unsigned grey = 0, saturated = 0, zero = 0;
            for (int x = from; x < to; ++x) {
                grey += pixel[x];
                saturated += pixel[x] >= 254;
                zero += pixel[x] == 0;
            }
            sum.grey += grey;
            sum.saturated += saturated;
            sum.zero += zero;
            sum.count += static_cast<std::uint64_t>(to - from);
        }
    }
    for (const Sum& sum : sums) {
        const double count = static_cast<double>(std::max<std::uint64_t>(sum.count, 1));
        out.tiles.push_back(static_cast<float>(static_cast<double>(sum.grey) / count));
        out.saturated.push_back(static_cast<float>(static_cast<double>(sum.saturated) / count));
        out.at_zero.push_back(static_cast<float>(static_cast<double>(sum.zero) / count));
    }
}

/// One light, tile by tile.
struct TileLight {
    std::vector<double> grey, saturated, at_zero;
    std::size_t frames = 0;
};

/// Of every tile what `share` of the frames are darker than: medians do not mind an order that the projector left out.
TileLight quantile(const std::vector<const FrameBrightness*>& frames, double share) {
    TileLight light;
    light.frames = frames.size();
    if (frames.empty()) return light;
    const auto value = [&](std::vector<float> FrameBrightness::*what, std::size_t tile) {
        std::vector<float> values;
        for (const FrameBrightness* frame : frames) values.push_back((frame->*what)[tile]);
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
        std::nth_element(values.begin(), at, values.end());
        return static_cast<double>(*at);
    };
    for (std::size_t t = 0; t < frames.front()->tiles.size(); ++t) {
        light.grey.push_back(value(&FrameBrightness::tiles, t));
        light.saturated.push_back(value(&FrameBrightness::saturated, t));
        light.at_zero.push_back(value(&FrameBrightness::at_zero, t));
    }
    return light;
}

/// One colour at rest.
TileLight at_rest(const LightRecording& recording, const std::vector<std::vector<std::size_t>>& steady, Rgb colour) {
    std::vector<const FrameBrightness*> frames;
    for (std::size_t o = 0; o < recording.orders.size(); ++o)
        if (recording.orders[o].colour == colour && !recording.orders[o].covered)
            for (const std::size_t f : steady[o]) frames.push_back(&recording.frames[f]);
    return quantile(frames, 0.5);
}

/// From frame to frame, within each order of that colour.
double deviation(const LightRecording& recording, const std::vector<std::vector<std::size_t>>& steady,
                 const std::vector<std::size_t>& tiles, Rgb colour) {
    double square = 0;
    std::size_t freedom = 0;
    for (std::size_t o = 0; o < recording.orders.size(); ++o) {
        if (recording.orders[o].colour != colour || recording.orders[o].covered || steady[o].size() < 2) continue;
        double sum = 0, sum_of_squares = 0;
        for (const std::size_t f : steady[o]) {
            const double v = mean_of(recording.frames[f], tiles);
            sum += v, sum_of_squares += v * v;
        }
        const auto n = static_cast<double>(steady[o].size());
        square += std::max(0.0, sum_of_squares - sum * sum / n);
        freedom += steady[o].size() - 1;
    }
    return freedom > 0 ? std::sqrt(square / static_cast<double>(freedom)) : 0;
}

/// The tiles that are brighter under white than under black, or why there are none.
LitTiles tiles_between(const TileLight& black, const TileLight& white) {
    LitTiles lit;
    double best = 0;
    for (std::size_t t = 0; t < white.grey.size(); ++t) {
        const double contrast = white.grey[t] - black.grey[t];
        best = std::max(best, contrast);
        const bool saturated = white.saturated[t] > kSaturatedShare;
        if (contrast < kLeastContrast_grey && !(saturated && contrast > 1)) continue;
        if (saturated) {
            ++lit.saturated;
            continue;
        }
        lit.tiles.push_back(t);
        lit.at_zero += black.at_zero[t] > kZeroShare;
        lit.black += black.grey[t];
        lit.white += white.grey[t];
    }
    if (lit.tiles.size() + lit.saturated < kLeastTiles)
        lit.refusal = {
            fmt::format("the cameras see nothing of the projector: white is at most {:.1f} grey brighter than black",
                        best),
            "Lay a white card, or the calibration board, where the light falls and both cameras look, take the lid "
            "off the lens, and turn the room's light down."};
    else if (lit.tiles.size() < kLeastTiles)
        lit.refusal = {
            fmt::format("the light is too bright for the cameras: {} of {} lit tiles are saturated under white",
                        lit.saturated, lit.saturated + lit.tiles.size()),
            "Shorten the exposure or close the aperture until white is below 250."};
    if (lit.refusal) {
        lit.tiles.clear();
        return lit;
    }
    lit.black /= static_cast<double>(lit.tiles.size());
    lit.white /= static_cast<double>(lit.tiles.size());
    return lit;
}

}  // namespace

FrameBrightness brightness_of(const StereoFrame& frame) {
    FrameBrightness out;
    out.at = frame.at;
    out.exposure = frame.exposure;
    out.number = frame.number;
    add_tiles(frame.left, out);
    add_tiles(frame.right, out);
    return out;
}

std::vector<std::vector<std::size_t>> steady_frames(const LightRecording& recording) {
    std::vector<std::vector<std::size_t>> steady(recording.orders.size());
    std::size_t order = 0;
    for (std::size_t f = 0; f < recording.frames.size(); ++f) {
        const FrameBrightness& frame = recording.frames[f];
        while (order + 1 < recording.orders.size() && recording.orders[order + 1].at < frame.closed()) ++order;
        if (order >= recording.orders.size() || frame.closed() < recording.orders[order].at) continue;
        if (frame.opened() >= recording.orders[order].at + recording.settle) steady[order].push_back(f);
    }
    return steady;
}

double mean_of(const FrameBrightness& frame, const std::vector<std::size_t>& tiles) {
    double sum = 0;
    for (const std::size_t t : tiles) sum += static_cast<double>(frame.tiles[t]);
    return tiles.empty() ? 0 : sum / static_cast<double>(tiles.size());
}

LitTiles find_lit_tiles(const LightRecording& recording) {
    constexpr Rgb kBlack{0, 0, 0}, kWhite{255, 255, 255};
    const auto steady = steady_frames(recording);
    const TileLight black = at_rest(recording, steady, kBlack), white = at_rest(recording, steady, kWhite);
    LitTiles lit;
    if (black.frames == 0 || white.frames == 0) {
        lit.refusal = {
            fmt::format("no frame saw a steady {} picture", black.frames == 0 ? "black" : "white"),
            fmt::format("Show white and black for {:.1f} s at least, and check that the cameras' times are on the "
                        "orders' clock.",
                        2 * seconds(recording.settle))};
        return lit;
    }
    lit = tiles_between(black, white);
    if (!lit.refusal)
        lit.noise =
            std::max(deviation(recording, steady, lit.tiles, kBlack), deviation(recording, steady, lit.tiles, kWhite));
    return lit;
}

LitTiles find_flashing_tiles(const LightRecording& recording) {
    std::vector<const FrameBrightness*> frames;
    for (const FrameBrightness& frame : recording.frames) frames.push_back(&frame);
    LitTiles lit;
    if (frames.size() < 20) {
        lit.refusal = {fmt::format("only {} frames were recorded", frames.size()), "Record the whole flash code."};
        return lit;
    }
    lit = tiles_between(quantile(frames, 0.25), quantile(frames, 0.75));
    if (lit.refusal) return lit;
    // From the medians of both halves: the few frames that saw a change are no noise.
    std::array<std::vector<double>, 2> off;
    for (const FrameBrightness* frame : frames) {
        const double v = mean_of(*frame, lit.tiles);
        const bool bright = v > (lit.black + lit.white) / 2;
        off[bright].push_back(std::abs(v - (bright ? lit.white : lit.black)));
    }
    for (std::vector<double>& side : off) {
        if (side.empty()) continue;
        const auto middle = median(side);
        lit.noise = std::max(lit.noise, 1.4826 * middle);
    }
    return lit;
}

FrameTiming frame_timing(const LightRecording& recording) {
    FrameTiming timing;
    std::vector<double> gaps;
    for (std::size_t f = 1; f < recording.frames.size(); ++f)
        gaps.push_back(seconds(recording.frames[f].at - recording.frames[f - 1].at));
    if (gaps.size() < 2) return timing;
    // Gaps of one interval, then all that are a few whole ones: jitter of the time stamps averages out.
    constexpr double kMostIntervals = 50;
    timing.interval_s = median(gaps);
    for (const double most : {1.0, kMostIntervals}) {
        double lasted_s = 0, intervals = 0;
        for (const double gap : gaps) {
            const double ratio = gap / timing.interval_s, whole = std::round(ratio);
            if (whole >= 1 && whole <= most && std::abs(ratio - whole) < 0.2) lasted_s += gap, intervals += whole;
        }
        if (intervals > 0) timing.interval_s = lasted_s / intervals;
    }
    for (std::size_t f = 1; f < recording.frames.size(); ++f) {
        const FrameBrightness &before = recording.frames[f - 1], &now = recording.frames[f];
        if (now.number == before.number || now.at <= before.at) {
            ++timing.doubled;
            continue;
        }
        if (gaps[f - 1] < 1.5 * timing.interval_s) continue;
        const bool waited = std::any_of(recording.orders.begin(), recording.orders.end(), [&](const LightOrder& order) {
            return order.at >= before.opened() && order.at <= now.opened();
        });
        if (!waited) timing.lost += static_cast<std::size_t>(std::lround(gaps[f - 1] / timing.interval_s)) - 1;
    }
    return timing;
}

}  // namespace planlight
