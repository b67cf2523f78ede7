#pragma once

#include <optional>
#include <string>
#include <vector>

#include "projection/light_gate.h"

namespace planlight {

/// What a recorded session did over its time, in seconds since the room was entered.
struct TimeLine {
    double lasted_s = 0;
    /// What the gate ruled over a stretch of time, at most `kLongest_s` long: its colour at the beginning, the worst of
    /// the rest.
    struct Stretch {
        double from_s = 0, to_s = 0;
        LightTrust trust = LightTrust::dark;
        double off_mm = -1;        ///< of the light, as the cameras measured it (95 %); -1: not measured
        double predicted_mm = -1;  ///< 95 % bound of the worst item, by match and pose; -1: not known
    };
    static constexpr double kLongest_s = 0.5;
    std::vector<Stretch> stretches;  ///< while the plan is followed; in between it is dark
    struct Event {
        double at_s = 0;
        std::string what;
    };
    std::vector<Event> events;
    std::vector<double> frames_s;  ///< of the frames that were kept, in their order
};

/// The kept frame nearest to that time; 0 where none was kept.
std::size_t frame_near(const TimeLine& line, double at_s);
/// The last event at that time or before it; empty: none.
std::optional<std::size_t> event_at(const TimeLine& line, double at_s);
/// When the next event is, and the one before, of those that are not at that time itself; empty: none is.
std::optional<double> next_event_s(const TimeLine& line, double at_s);
std::optional<double> event_before_s(const TimeLine& line, double at_s);
/// What the gate had ruled then; null: the plan was not followed.
const TimeLine::Stretch* stretch_at(const TimeLine& line, double at_s);

}  // namespace planlight
