#include "registration/projector_measurement/record_light.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "registration/projector_measurement/measure_latency.h"

namespace planlight {
namespace {

constexpr Rgb kBlack{0, 0, 0}, kWhite{255, 255, 255};

/// Orders and frames of one recording, the projector dark at its end.
class Recorder {
public:
    Recorder(const LightBench& bench, const RecordSettings& settings, int steps)
        : bench_(bench), settings_(settings), dark_(bench.projector), steps_(steps) {
        recording_.settle = settings.settle;
    }

    void show(Rgb colour, int frames_to_come) {
        constexpr auto kSpare = std::chrono::seconds(2);
        const Instant valid_until =
            bench_.clock.now() + settings_.settle + kSpare + frames_to_come * settings_.patience;
        LightOrder order;
        order.at = bench_.clock.now();
        order.colour = colour;
        const RgbImage picture(bench_.projector.width(), bench_.projector.height(), colour);
        order.promised = bench_.projector.show(picture, valid_until);
        order.returned = bench_.clock.now();
        recording_.orders.push_back(order);
    }
    void grab(Instant not_before) {
        const StereoFrame frame = bench_.cameras.grab(not_before, settings_.patience);
        if (bench_.keep) bench_.keep(frame);
        recording_.frames.push_back(brightness_of(frame));
    }
    /// Every frame from the last one on, until so many began after this moment: the light of an order that comes late
    /// meets none that was passed over.
    void follow(int frames) {
        const Instant from = bench_.clock.now();
        for (int later = 0; later < frames;) {
            const FrameBrightness& last = recording_.frames.back();
            grab(last.opened() + last.exposure);
            later += recording_.frames.back().opened() >= from;
        }
    }
    /// One colour until it is steady, then so many frames.
    void show_steady(Rgb colour, int frames) {
        show(colour, frames);
        for (int i = 0; i < frames; ++i) grab(recording_.orders.back().at + settings_.settle);
        if (bench_.progress) bench_.progress(static_cast<double>(++done_) / steps_);
    }
    void step() {
        if (bench_.progress) bench_.progress(static_cast<double>(++done_) / steps_);
    }
    /// Darkness is the last order, so that nothing after it is taken for the last colour.
    LightRecording finish() {
        recording_.orders.push_back({bench_.clock.now(), {}, {}, kBlack, false});
        bench_.projector.go_dark();
        return std::move(recording_);
    }
    const LightRecording& so_far() const { return recording_; }

private:
    const LightBench& bench_;
    const RecordSettings& settings_;
    DarkOnExit dark_;
    LightRecording recording_;
    int steps_, done_ = 0;
};

Rgb grey(int value) {
    const auto v = static_cast<std::uint8_t>(value);
    return {v, v, v};
}

/// When to give an order so that its light comes in the middle part of an exposure: of the first one that can be met.
Instant aimed(Instant now, const FrameBrightness& last, double interval_s, double latency_s, double part) {
    const double first = seconds(last.opened()) + part * seconds(last.exposure) - latency_s;
    const double turns = std::max(1.0, std::ceil((seconds(now) + 1e-3 - first) / interval_s));
    return from_seconds(first + turns * interval_s);
}

}  // namespace

std::vector<int> response_greys() {
    return {0,   4,   8,   12,  16,  20,  24,  32,  40,  48,  64,  80,  96,  112,
            128, 144, 160, 176, 192, 208, 224, 232, 236, 240, 244, 248, 252, 255};
}

std::vector<bool> flash_code() {
    std::vector<bool> code;
    unsigned state = 1;
    for (int i = 0; i < 63; ++i) {
        code.push_back((state & 1U) != 0);
        state = state >> 1U | (((state ^ state >> 1U) & 1U) << 5U);
    }
    return code;
}

LightRecording record_response(const LightBench& bench, const RecordSettings& settings) {
    constexpr int kGreysBetweenReferences = 4;
    std::vector<int> greys = response_greys();
    std::mt19937 random(settings.seed);
    const int greys_a_pass = static_cast<int>(greys.size());
    Recorder recorder(bench, settings,
                      settings.grey_passes * (greys_a_pass + 2 * (greys_a_pass / kGreysBetweenReferences + 1)) + 5);
    const auto references = [&] {
        recorder.show_steady(kBlack, settings.frames_a_grey);
        recorder.show_steady(kWhite, settings.frames_a_grey);
    };
    for (int pass = 0; pass < settings.grey_passes; ++pass) {
        std::shuffle(greys.begin(), greys.end(), random);
        for (std::size_t i = 0; i < greys.size(); ++i) {
            if (i % kGreysBetweenReferences == 0) references();
            recorder.show_steady(grey(greys[i]), settings.frames_a_grey);
        }
    }
    for (const Rgb colour : {Rgb{255, 0, 0}, Rgb{0, 255, 0}, Rgb{0, 0, 255}})
        recorder.show_steady(colour, 2 * settings.frames_a_grey);
    references();
    return recorder.finish();
}

void record_covered(const LightBench& bench, LightRecording& recording, const RecordSettings& settings) {
    recording.orders.push_back({bench.clock.now(), {}, {}, kBlack, true});
    bench.projector.go_dark();
    constexpr int kFrames = 8;
    for (int i = 0; i < kFrames; ++i) {
        const StereoFrame frame = bench.cameras.grab(recording.orders.back().at + settings.settle, settings.patience);
        if (bench.keep) bench.keep(frame);
        recording.frames.push_back(brightness_of(frame));
    }
}

LightRecording record_cycle(const LightBench& bench, const RecordSettings& settings) {
    constexpr double kLongestPause_s = 0.1;
    std::vector<Rgb> colours{kBlack, kWhite, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}};
    std::mt19937 random(settings.seed);
    std::uniform_real_distribution<double> pause_s(0, kLongestPause_s);
    Recorder recorder(bench, settings, settings.cycle_visits * static_cast<int>(colours.size()));
    for (int visit = 0; visit < settings.cycle_visits; ++visit) {
        std::shuffle(colours.begin(), colours.end(), random);
        for (const Rgb colour : colours) {
            recorder.show_steady(colour, settings.frames_a_visit);
            bench.wait_until(bench.clock.now() + from_seconds(pause_s(random)));
        }
    }
    return recorder.finish();
}

LightRecording record_latency(const LightBench& bench, const RecordSettings& settings) {
    constexpr int kRests = 3, kRestFrames = 4;  // an odd number: one that the projector leaves out does no harm
    std::vector<bool> code = flash_code();
    code.resize(std::min(code.size(), static_cast<std::size_t>(std::max(settings.code_bits, 0))));
    std::mt19937 random(settings.seed);
    std::uniform_real_distribution<double> evenly;
    Recorder recorder(bench, settings, settings.code_passes * static_cast<int>(code.size()) + 2 * kRests);
    for (int i = 0; i < kRests; ++i) {
        recorder.show_steady(kWhite, kRestFrames);
        recorder.show_steady(kBlack, kRestFrames);
    }
    const double interval_s = frame_timing(recorder.so_far()).interval_s;
    bool on = false;
    std::optional<double> latency_s;
    for (int pass = 0; pass < settings.code_passes; ++pass) {
        if (pass == 1) {
            const LatencyResult coarse = measure_latency(recorder.so_far());
            if (!coarse.refusal) latency_s = coarse.median_s;
        }
        for (const bool bit : code) {
            if (bit != on) {
                const FrameBrightness& last = recorder.so_far().frames.back();
                bench.wait_until(
                    latency_s ? aimed(bench.clock.now(), last, interval_s, *latency_s, 0.2 + 0.6 * evenly(random))
                              : bench.clock.now() + from_seconds(interval_s * evenly(random)));
                recorder.show(bit ? kWhite : kBlack, 8 * settings.frames_a_flash);
                on = bit;
            }
            recorder.follow(settings.frames_a_flash);
            recorder.step();
        }
    }
    // What was ordered last is still to be seen.
    recorder.follow(2 * settings.frames_a_flash);
    return recorder.finish();
}

}  // namespace planlight
