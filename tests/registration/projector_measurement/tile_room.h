#pragma once

#include <array>
#include <random>

#include "registration/projector_measurement/record_light.h"

namespace planlight::test {

/// A room by formula whose pictures are a few pixels a tile: fast enough for hundreds of rooms. A wheel of three equal
/// segments, lamps that flicker as a sine, a projector that changes at its refreshes; 8 bits and noise.
struct TileRoomSettings {
    double frames_hz = 60, exposure_s = 0.008, first_frame_s = 0;
    double delay_s = 0.04;                           ///< from order to light
    double refresh_hz = 0, refresh_phase = 0;        ///< changes come at (n + phase) / hz only; 0 Hz: at once
    double jitter_s = 0;                             ///< an order waits up to so much longer, evenly distributed
    double wheel_hz = 0, wheel_phase = 0;            ///< turns a second; 0: all colours at once
    double lamps_hz = 0, lamps_depth = 0;            ///< amplitude, share of the lamps' light
    std::array<double, 3> colours{0.3, 0.45, 0.25};  ///< red, green, blue as the cameras see them, of white
    double white_grey = 140, room_grey = 30;         ///< the projector's white; the lamps
    double noise_grey = 1;                           ///< of a pixel
    unsigned seed = 1;
};

/// Its devices and its time; waiting passes it.
class TileRoom : Projector, StereoCamera, Clock {
public:
    explicit TileRoom(const TileRoomSettings& settings) : s_(settings), random_(settings.seed) {}
    LightBench bench();

    /// From order to light, of all orders so far.
    const std::vector<double>& true_delays_s() const { return delays_s_; }

private:
    int width() const override { return 8; }
    int height() const override { return 6; }
    Instant show(const RgbImage& picture, Instant valid_until) override;
    void go_dark() noexcept override { add({}); }
    Instant now() const override { return now_; }
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override;
    void add(Rgb colour);
    double projector_light(double from_s, double to_s) const;

    struct Lit {
        double at_s = 0;
        Rgb colour{};
    };
    TileRoomSettings s_;
    std::mt19937 random_;
    Instant now_{};
    std::vector<Lit> lit_;
    std::vector<double> delays_s_;
};

/// Standard deviation of a colour's light over exposures that begin evenly over a turn of the wheel, share of its mean.
double wheel_variation(double turns_an_exposure, const std::array<double, 3>& shares);

}  // namespace planlight::test
