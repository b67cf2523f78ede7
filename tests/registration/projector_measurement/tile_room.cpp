#include "tests/registration/projector_measurement/tile_room.h"

#include <algorithm>
#include <cmath>

namespace planlight::test {
namespace {

/// Of a segment [begins, begins + 1/3) of each turn: how much of it lies before `turns`, in turns.
double lit_until(double turns, double begins) {
    const double whole = std::floor(turns);
    return whole / 3 + std::clamp(turns - whole - begins, 0.0, 1.0 / 3);
}

/// Share of a colour's mean light between two moments, in turns.
double segment_light(double from, double to, int segment) {
    return 3 * (lit_until(to, segment / 3.0) - lit_until(from, segment / 3.0)) / (to - from);
}

}  // namespace

double wheel_variation(double turns_an_exposure, const std::array<double, 3>& shares) {
    constexpr int kPhases = 3000;
    double sum = 0, squares = 0;
    for (int i = 0; i < kPhases; ++i) {
        const double from = static_cast<double>(i) / kPhases;
        double light = 0;
        for (int c = 0; c < 3; ++c)
            light += shares[static_cast<std::size_t>(c)] * segment_light(from, from + turns_an_exposure, c);
        sum += light / kPhases, squares += light * light / kPhases;
    }
    return std::sqrt(std::max(0.0, squares - sum * sum)) / sum;
}

LightBench TileRoom::bench() {
    return {*this, *this, *this, [this](Instant at) { now_ = std::max(now_, at); }, {}, {}};
}

void TileRoom::add(Rgb colour) {
    double at_s = seconds(now_) + s_.delay_s + s_.jitter_s * std::uniform_real_distribution<double>()(random_);
    if (s_.refresh_hz > 0)
        at_s = (std::ceil(at_s * s_.refresh_hz - s_.refresh_phase) + s_.refresh_phase) / s_.refresh_hz;
    if (!lit_.empty()) at_s = std::max(at_s, lit_.back().at_s);
    lit_.push_back({at_s, colour});
    delays_s_.push_back(at_s - seconds(now_));
}

Instant TileRoom::show(const RgbImage& picture, Instant) {
    add(picture.pixels.front());
    return now_ + from_seconds(s_.delay_s);
}

/// Mean over that time, white without a wheel = 1.
double TileRoom::projector_light(double from_s, double to_s) const {
    double light = 0;
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        const double from = std::max(from_s, lit_[i].at_s),
                     to = std::min(to_s, i + 1 < lit_.size() ? lit_[i + 1].at_s : to_s);
        if (to <= from) continue;
        for (int c = 0; c < 3; ++c) {
            const auto which = static_cast<std::size_t>(c);
            const double wheel = s_.wheel_hz > 0 ? segment_light(from * s_.wheel_hz + s_.wheel_phase,
                                                                 to * s_.wheel_hz + s_.wheel_phase, c)
                                                 : 1;
            light += (to - from) * s_.colours[which] * lit_[i].colour[which] / 255.0 * wheel;
        }
    }
    return light / (to_s - from_s);
}

StereoFrame TileRoom::grab(Instant not_before, std::chrono::milliseconds) {
    const double wanted_s = seconds(std::max(not_before, now_));
    const double number = std::max(0.0, std::ceil((wanted_s - s_.first_frame_s) * s_.frames_hz - 1e-6));
    const double from_s = s_.first_frame_s + number / s_.frames_hz, to_s = from_s + s_.exposure_s;
    const double turn = 2 * M_PI * s_.lamps_hz;
    const double lamps =
        turn > 0 ? 1 + s_.lamps_depth * (std::sin(turn * to_s) - std::sin(turn * from_s)) / (turn * s_.exposure_s) : 1;
    const double grey = s_.white_grey * projector_light(from_s, to_s) + s_.room_grey * lamps;
    std::normal_distribution<double> noise(0, s_.noise_grey);
    StereoFrame frame;
    frame.at = from_seconds((from_s + to_s) / 2);
    frame.exposure = from_seconds(s_.exposure_s);
    frame.number = static_cast<std::uint64_t>(number);
    for (GrayImage* picture : {&frame.left, &frame.right}) {
        *picture = GrayImage(4 * kTilesAcross, 4 * kTilesDown);
        for (auto& pixel : picture->pixels)
            pixel = static_cast<std::uint8_t>(std::clamp(std::lround(grey + noise(random_)), 0L, 255L));
    }
    now_ = from_seconds(to_s);
    return frame;
}

}  // namespace planlight::test
