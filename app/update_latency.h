#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "app/evaluation/log_histogram.h"
#include "app/session.h"

namespace planlight {

/// How late the light of a session is, update by update, by the room's clock: from the middle of the exposure that a
/// picture was drawn from to the moment that it stands on the display. The lamp's own delay comes after that.
class UpdateLatency {
public:
    void add(const Session::Update& update);

    std::size_t updates = 0, lit = 0;
    std::size_t skipped = 0;  ///< pairs that came and were not used, for a newer one was there
    std::size_t missed = 0;   ///< exposures of which no pair came
    /// Between two updates, what is no missing frame: more than a second, or cameras that were opened anew. Every
    /// exposure of the rest is an update, skipped or missed: `updates - 1 - pauses + skipped + missed` of them in
    /// `followed_s`.
    std::size_t pauses = 0;
    double followed_s = 0, paused_s = 0;  ///< from the first update's mid-exposure to the last one's
    std::size_t late = 0;                 ///< drawn more than 30 ms after the pair had come
    std::size_t overtaken = 0;            ///< drawn more than a frame's interval after it had come
    /// Why the others were dark, and how often; figures in a reason are left out ("the last pose is … ms old").
    std::map<std::string, std::size_t> dark;
    LogHistogram to_swap_ms;       ///< of what was lit: from mid-exposure to the display
    LogHistogram from_arrival_ms;  ///< of what was lit: from the arrival of the pair to the display

    /// "1500 updates, 1498 lit, ...: 52 / 71 ms (median / 99 %) from mid-exposure to the display, ..."; empty before
    /// the first light.
    std::string sentence() const;
    /// The same as a JSON object.
    std::string json() const;

private:
    Instant last_at_{}, interval_{};
    std::uint64_t last_number_ = 0;
};

}  // namespace planlight
