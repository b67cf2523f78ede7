#include "registration/projector_measurement/light_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "registration/projector_measurement/fit_response.h"

namespace planlight {

std::vector<LightFinding> findings_of(const ResponseResult& r) {
    std::vector<LightFinding> findings;
    const auto say = [&](std::string what, std::string remedy) {
        findings.push_back({std::move(what), std::move(remedy)});
    };
    if (r.crushes_darks && r.crushes_whites && std::abs(r.dark_end - 16) < 6 && std::abs(r.bright_end - 235) < 8)
        say(fmt::format("greys up to {:.0f} are black and from {:.0f} on white: the projector takes the picture for "
                        "one of limited range",
                        r.dark_end, r.bright_end),
            "Set the HDMI range (\"black level\", \"RGB range\") to full, 0 to 255, on the computer and on the "
            "projector.");
    else if (r.crushes_darks)
        say(fmt::format("the projector crushes the darks: greys up to {:.0f} are black", r.dark_end),
            "Choose another picture mode (\"sRGB\", \"cinema\"), raise its brightness, and switch dynamic contrast "
            "off.");
    else if (r.crushes_whites)
        say(fmt::format("the projector crushes the whites: greys from {:.0f} on are white", r.bright_end),
            "Choose another picture mode (\"sRGB\", \"cinema\"), and lower its contrast.");
    if (!r.not_rising.empty())
        say(fmt::format("a brighter grey gives less light ({})", r.not_rising.front()),
            "Switch dynamic contrast, eco dimming and picture enhancement off.");
    constexpr double kDrift = 0.03;
    if (r.white_drift > kDrift)
        say(fmt::format("white changed by {:.1f} % during the measurement", 100 * r.white_drift),
            "Let the lamp warm up for 15 minutes, switch dynamic contrast and eco mode off, and keep the scene still.");
    constexpr double kMoreThanWhite = 1.06, kLessThanWhite = 0.9;
    if (r.colours) {
        const double sum = (*r.colours)[0] + (*r.colours)[1] + (*r.colours)[2];
        const double noise = 3 * std::hypot(r.colour_sigmas[0], r.colour_sigmas[1], r.colour_sigmas[2]);
        if (sum - noise > kMoreThanWhite)
            say(fmt::format("red, green and blue add up to {:.2f} of white: the cameras are not linear, so the gamma "
                            "is not the projector's alone",
                            sum),
                "Set the cameras' gamma to 1, and switch their automatic gain and contrast off.");
        else if (sum + noise < kLessThanWhite)
            say(fmt::format("red, green and blue add up to {:.2f} of white: the projector adds a white segment", sum),
                "Switch \"brilliant colour\" or the bright picture mode off where colours matter; the scan's grey "
                "pictures do not mind.");
    }
    constexpr double kDiffer = 0.02;
    if (r.cameras_differ > kDiffer)
        say(fmt::format("the two cameras see curves that differ by {:.1f} % of white", 100 * r.cameras_differ),
            "Give both cameras the same settings: gamma 1, no automatic gain or exposure.");
    if (r.tiles > 0 && 2 * r.tiles_at_zero > r.tiles)
        say("black is below the cameras' zero, so the dark end of the curve is not seen",
            "Raise the cameras' black level (offset) until black is a few greys.");
    return findings;
}

std::string meaning_of(const ResponseResult& r) {
    std::string text = fmt::format(
        "The scan reads fringes by their phase in 8 steps, and a gamma of {:.2f} does not shift that: "
        "nothing has to be corrected.",
        r.gamma);
    const double half = fitted_light(r, 128);
    if (half < 0.3 || half > 0.7)
        text += fmt::format(
            " Half grey gives {:.0f} % of white: dim colours of the plan are dimmer on the skin than on a screen.",
            100 * half);
    if (r.crushes_darks || r.crushes_whites)
        text +=
            " The crushed end takes part of each fringe away: the contrast is less and the noise of the points more; "
            "markers "
            "and the Gray code, which are black and white, do not mind.";
    return text;
}

std::vector<LightFinding> findings_of(const CycleResult& r) {
    std::vector<LightFinding> findings;
    const std::string cure =
        r.exposure_to_set_s > 0
            ? fmt::format("Set the exposure to {:.2f} ms{}.", 1e3 * r.exposure_to_set_s,
                          r.cycle_is_told ? "" : " and measure again")
            : "Lengthen the exposure to several cycles, dim the lens instead of the shutter, and measure again.";
    const auto size = [](double variation, bool told) {
        return told ? fmt::format("by {:.1f} %", 100 * variation)
                    : fmt::format("by {:.1f} % as far as these frames met its cycle, how much in all they cannot tell,",
                                  100 * variation);
    };
    if (r.projector_varies)
        findings.push_back(
            {fmt::format("the projector's light varies {} from frame to frame at an exposure of {:.2f} ms",
                         size(r.worst, r.worst_is_told), 1e3 * r.exposure_s),
             cure});
    if (r.room_varies)
        findings.push_back({fmt::format("the room's lamps flicker {} in the cameras",
                                        size(r.runs.front().variation, r.runs.front().size_is_told)),
                            cure + " Or turn them off."});
    if (r.timing.lost > 0)
        findings.push_back({fmt::format("{} frames were lost", r.timing.lost),
                            "Check the cameras' connection and the load of the computer."});
    return findings;
}

std::string meaning_of(const CycleResult& result) {
    std::string text;
    const CycleRun& room = result.runs.front();
    const auto size = [](double variation, double sigma, bool told) {
        return told ? fmt::format("by {:.1f} ± {:.1f} %", 100 * variation, 100 * sigma)
                    : fmt::format("by {:.1f} % in the part of the cycle that these frames met", 100 * variation);
    };
    text += room.varies ? fmt::format("The room's lamps flicker {} of their light",
                                      size(room.variation, room.variation_sigma, room.size_is_told))
            : result.lamps_may_hide
                ? std::string("The room's lamps look steady, which these frames cannot tell for sure")
                : std::string("The room's light is steady");
    double at_most = 0, sigma = 0;
    for (std::size_t i = 1; i < result.runs.size(); ++i) {
        const CycleRun& run = result.runs[i];
        at_most = std::max(at_most, run.at_most);
        if (run.varies && run.variation >= result.worst) sigma = run.variation_sigma;
    }
    if (result.projector_varies)
        text +=
            fmt::format("; the projector's light varies {} from frame to frame (a colour wheel, or dimming by pulses).",
                        size(result.worst, sigma, result.worst_is_told));
    else
        text += fmt::format("; the projector's light {} (within {:.2f} %).",
                            result.wheel_may_hide ? "is steady as far as these frames can tell" : "is steady",
                            100 * at_most);
    if (result.projector_varies && !result.worst_is_told)
        text += fmt::format(
            " It beats too slowly against {:.2f} frames a second for its size to be told; it may be {:.0f} % at this "
            "exposure.",
            result.frames_hz, 100 * at_most);
    if (result.exposure_to_set_s > 0)
        text += fmt::format(
            " An exposure of {:.2f} ms instead of {:.2f} ms holds whole cycles and cures it{}.",
            1e3 * result.exposure_to_set_s, 1e3 * result.exposure_s,
            result.cycle_is_told ? "" : " if the cycle is a usual one (which one, these frames cannot tell)");
    if (!result.unseen_hz.empty()) {
        std::string list;
        for (const double hz : result.unseen_hz) list += fmt::format("{}{:g}", list.empty() ? "" : ", ", hz);
        text += fmt::format(" Cycles of {} Hz cannot be seen at {:.2f} frames a second.", list, result.frames_hz);
    }
    return text;
}

std::vector<LightFinding> findings_of(const LatencyResult& r) {
    std::vector<LightFinding> findings;
    const std::string set =
        fmt::format("Set the delay to {:.0f} ms (`session --light-delay-ms {:.0f}`, or `--projector-file`).",
                    1e3 * r.light_delay_s, 1e3 * r.light_delay_s);
    if (r.promise && r.promise->broken > 0)
        findings.push_back(
            {fmt::format(
                 "light was promised {:.1f} ms after the order and came later for {} of {} pictures, by {:.1f} ms at "
                 "worst: a scan would expose them too early",
                 1e3 * r.promise->delay_s, r.promise->broken, r.promise->orders, 1e3 * r.promise->too_early_s),
             set});
    constexpr double kTooLong_s = 0.010, kHead_mm_s = 20;
    if (r.promise && r.promise->broken == 0 && r.promise->delay_s - r.light_delay_s > kTooLong_s)
        findings.push_back(
            {fmt::format(
                 "light was promised {:.1f} ms after the order and is there after {:.1f} ms: the plan is drawn for a "
                 "head that moves on {:.1f} ms too long, {:.2f} mm at {:.0f} mm/s",
                 1e3 * r.promise->delay_s, 1e3 * r.median_s, 1e3 * (r.promise->delay_s - r.median_s),
                 kHead_mm_s * (r.promise->delay_s - r.median_s), kHead_mm_s),
             set});
    constexpr double kBlind_s = 0.004;
    if (r.blind_s > kBlind_s)
        findings.push_back(
            {fmt::format("the projector changes in step with the cameras, always between two exposures: the delay is "
                         "known to {:.0f} ms only",
                         1e3 * r.blind_s),
             "Set the cameras to another frame rate (5 % off is enough) or to an exposure of nearly a whole frame, and "
             "measure again."});
    if (r.unseen > 0)
        findings.push_back({fmt::format("{} of {} pictures never became light", r.unseen, r.changes),
                            "Set the monitor to the projector's own resolution and refresh rate, and switch frame "
                            "interpolation off."});
    if (r.late > 0)
        findings.push_back(
            {fmt::format("{} of {} pictures came a refresh late", r.late, r.delays.size()),
             "Switch the projector's picture processing off (\"game mode\"), and close other programs that draw."});
    if (r.frames.lost + r.frames.doubled > 0)
        findings.push_back(
            {fmt::format("the cameras lost {} frames and gave {} twice", r.frames.lost, r.frames.doubled),
             "Check the cameras' connection and the load of the computer."});
    return findings;
}

std::string meaning_of(const LatencyResult& r) {
    std::string text = fmt::format(
        "From order to light {:.1f} ± {:.1f} ms, with a spread of {:.1f} ms from picture to picture (standard "
        "deviation); "
        "the latest seen came after {:.1f} ms.",
        1e3 * r.median_s, 1e3 * r.median_sigma_s, 1e3 * r.jitter_s, 1e3 * r.latest_s);
    text += fmt::format(" {} of {} changes fell within an exposure and are known to a part of it, the others {}.",
                        r.exact, r.delays.size(),
                        r.refresh_hz > 0 ? fmt::format("by the projector's refreshes, {:.2f} a second", r.refresh_hz)
                                         : std::string("to the time between two"));
    constexpr double kHead_mm_s = 20;
    text += fmt::format(
        " At {:.0f} mm/s the head moves {:.2f} mm in that time, which the prediction has to make good; its spread "
        "leaves {:.2f} mm.",
        kHead_mm_s, kHead_mm_s * r.median_s, kHead_mm_s * r.jitter_s);
    return text;
}

}  // namespace planlight
