#include "tests/registration/projector_measurement/light_scene.h"

#include <algorithm>

namespace planlight::test {

using std::chrono::milliseconds;

LightRecording LightScene::record(const std::vector<LightOrder>& orders, Instant until, unsigned seed) const {
    constexpr int kSlices = 40;
    std::mt19937 random(seed);
    std::normal_distribution<float> unit;
    LightRecording recording;
    recording.orders = orders;
    std::uint64_t number = 0;
    for (Instant opened{}; opened < until; opened += interval, ++number) {
        double projector = 0, room = 0;
        for (int i = 0; i < kSlices; ++i) {
            const Instant at = opened + (2 * i + 1) * exposure / (2 * kSlices);
            const LightOrder* lit = nullptr;
            for (const LightOrder& order : orders)
                if (order.at + delay <= at) lit = &order;
            if (lit && !lit->covered)
                projector += (0.002 + 0.998 * light_of(lit->colour)) * lamp_at(seconds(at)) / kSlices;
            room += room_at(seconds(at)) / kSlices;
        }
        FrameBrightness frame;
        frame.at = opened + exposure / 2;
        frame.exposure = exposure;
        frame.number = number;
        for (int t = 0; t < 2 * kTiles; ++t) {
            const bool lit = t % kTiles >= 5 * kTilesAcross && t % kTiles < 8 * kTilesAcross;
            const double bright = 0.5 + 0.5 * (t % 7) / 6.0;  // tiles differ
            const double light =
                camera(room_grey * bright * room + (lit ? (white_grey - room_grey) * bright * projector : 0));
            frame.tiles.push_back(static_cast<float>(std::min(light, saturates_at)) +
                                  static_cast<float>(noise_grey) * unit(random));
            frame.saturated.push_back(light >= saturates_at ? 1.0F : 0.0F);
            frame.at_zero.push_back(0);
        }
        recording.frames.push_back(std::move(frame));
    }
    return recording;
}

std::vector<LightOrder> steady_orders(const std::vector<Rgb>& colours, Instant each, Instant begins) {
    std::vector<LightOrder> orders;
    for (const Rgb colour : colours) {
        orders.push_back({begins, {}, {}, colour, false});
        begins += each;
    }
    return orders;
}

std::vector<LightOrder> flashes(const std::vector<bool>& bits, Instant bit) {
    std::vector<LightOrder> orders = steady_orders({grey(0), grey(255), grey(0)}, milliseconds(600));
    Instant at = milliseconds(1800);
    bool on = false;
    int changes = 0;
    for (const bool wanted : bits) {
        if (wanted != on) {
            // Changes drift through the exposures, 3.7 ms further each time.
            orders.push_back({at + changes * std::chrono::microseconds(3700), {}, {}, grey(wanted ? 255 : 0), false});
            on = wanted;
            ++changes;
        }
        at += bit;
    }
    orders.push_back({at + changes * std::chrono::microseconds(3700), {}, {}, grey(0), false});
    return orders;
}

}  // namespace planlight::test
