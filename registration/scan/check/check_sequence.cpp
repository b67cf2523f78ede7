#include "registration/scan/check/check_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "planning_io/types/processor_clones.h"
#include "planning_io/types/statistics.h"
#include "registration/scan/check/sequence_fringes.h"
#include "registration/scan/check/sequence_nesting.h"
#include "registration/scan/check/sequence_samples.h"
#include "registration/scan/check/stripe_widths.h"

namespace planlight {
namespace {

using namespace sequence;

void check_ends(const Samples& s, SequenceCheck& check) {
    check.pixels = s.changing;
    check.checked = s.changing >= kEnough;
    constexpr double kMost = 0.05, kNearlyAll = 0.9;
    if (const double share = share_of(s.not_white, s.changing); check.checked && share > kMost)
        check.problems.push_back({s.white, "white is not the brightest", share,
                                  // White as dark as black everywhere: its light had not arrived yet.
                                  share_of(s.dark_white, s.changing) > kNearlyAll ? SequenceProblem::Cause::timing
                                                                                  : SequenceProblem::Cause::light});
    if (check.checked && share_of(s.not_black, s.changing) > kMost)
        check.problems.push_back(
            {s.black, "black is not the darkest", share_of(s.not_black, s.changing), SequenceProblem::Cause::light});
}

/// Marks the pixels whose neighbours in all four directions have the same difference of two frames: no edge, no blur.
PLANLIGHT_CLONES void keep_flat(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* next_a,
                                const std::uint8_t* next_b, const std::int16_t* contrast, std::uint8_t* __restrict flat,
                                std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const auto off = static_cast<std::int16_t>((next_a[i] - next_b[i]) - (a[i] - b[i]));
        const auto allowed = static_cast<std::int16_t>(contrast[i] / 4 + 4),
                   size = off < 0 ? static_cast<std::int16_t>(-off) : off;
        flat[i] = static_cast<std::uint8_t>(flat[i] & (size <= allowed ? 1 : 0));
    }
}

void check_pairs(const Samples& s, const Direction& direction, SequenceCheck& check) {
    Bytes flat(s.lit);
    for (std::size_t k = 0; k < direction.inverse.size(); ++k) {
        const std::size_t gray = direction.gray[k], inverse = direction.inverse[k];
        const Bytes &a = s.here[gray], &b = s.here[inverse], &white = s.here[s.white], &black = s.here[s.black];
        std::fill(flat.begin(), flat.end(), std::uint8_t{1});
        for (std::size_t side = 0; side < 4; ++side)
            keep_flat(a.data(), b.data(), s.around[gray][side].data(), s.around[inverse][side].data(),
                      s.contrast.data(), flat.data(), s.lit);
        std::size_t looked = 0, wrong = 0,
                    far_off = 0;  // far off: more than an edge that moved, or a camera's gamma, can make
        for (std::size_t i = 0; i < s.lit; ++i) {
            const int off = std::abs(a[i] + b[i] - white[i] - black[i]);
            far_off += off > 0.6 * s.contrast[i] + 3 * s.noise_grey;
            if (!flat[i]) continue;
            ++looked;
            wrong += off > 0.35 * s.contrast[i] + 3 * s.noise_grey;
        }
        constexpr double kMost = 0.02, kMostFarOff = 0.1;
        // Fine stripes have no flat places, or only such as look flat from three pixels away.
        if (k >= direction.wide || looked < kEnough || share_of(wrong, looked) <= kMost) {
            if (s.lit < kEnough || share_of(far_off, s.lit) <= kMostFarOff) continue;
            wrong = far_off, looked = s.lit;
        }
        check.problems.push_back({gray,
                                  fmt::format("{} and its inverse do not complete each other{}{}", s.name(gray),
                                              explain(s, gray), explain(s, inverse)),
                                  share_of(wrong, looked), SequenceProblem::Cause::light});
    }
}

/// How much brighter a picture and its inverse are than white and black together; 0 unless by the same grey where there
/// is much light of the projector and where there is little: an exposure, a gain or a late picture goes with the light.
double even_offset(const Samples& s, std::size_t gray, std::size_t inverse) {
    constexpr double kLeast_grey = 3, kLeastRatio = 1.25, kAlike = 0.3, kSpread = 0.5;
    const double usual = median(std::vector<double>(s.contrast.begin(), s.contrast.end()));
    std::array<std::vector<double>, 2> off, contrast;  // of the dimmer half, of the brighter one
    for (std::size_t i = 0; i < s.lit; ++i) {
        const std::size_t half = s.contrast[i] > usual ? 1 : 0;
        off[half].push_back(s.here[gray][i] + s.here[inverse][i] - s.here[s.white][i] - s.here[s.black][i]);
        contrast[half].push_back(s.contrast[i]);
    }
    if (std::min(off[0].size(), off[1].size()) < kEnough / 2 || median(contrast[1]) < kLeastRatio * median(contrast[0]))
        return 0;
    const double dim = median(off[0]), bright = median(off[1]), mean = (dim + bright) / 2;
    if (std::abs(mean) < kLeast_grey || std::abs(bright - dim) > kAlike * std::abs(mean)) return 0;
    std::vector<double> apart;
    for (const auto& half : off)
        for (const double o : half) apart.push_back(std::abs(o - mean));
    return median(std::move(apart)) < kSpread * std::abs(mean) + s.noise_grey ? mean : 0;
}

/// Two pictures and their inverses at least, and a fifth of all, are brighter or darker by the same grey everywhere.
bool lamps_flicker(const Samples& s) {
    std::size_t pairs = 0, even = 0;
    for (const Direction& direction : s.directions)
        for (std::size_t k = 0; k < direction.inverse.size(); ++k) {
            ++pairs;
            even += even_offset(s, direction.gray[k], direction.inverse[k]) != 0;
        }
    return even >= 2 && 5 * even >= pairs;
}

void blame_lamps(const Samples& s, SequenceCheck& check) {
    using Cause = SequenceProblem::Cause;
    const auto by_light = [](const SequenceProblem& p) { return p.cause == Cause::light || p.cause == Cause::fringes; };
    if (std::none_of(check.problems.begin(), check.problems.end(), by_light) || !lamps_flicker(s)) return;
    for (SequenceProblem& problem : check.problems)
        if (by_light(problem)) problem.cause = Cause::flicker;
}

/// Of two bits the finer one changes more often, where it changes on enough lines to count on.
void check_order(const Samples& s, const Direction& direction, const std::vector<Changes>& changes,
                 const GrayImage& picture, SequenceCheck& check) {
    constexpr double kFewestLines = 4;  // over the picture
    const std::size_t bits = std::min(changes.size(), direction.wide);
    double most = 0,
           share = 0;  // the finest bit changes every other half period; the one before half as often, and so on
    int side_px = 0;
    for (std::size_t k = 0; k < bits; ++k) {
        most = std::max(most, static_cast<double>(changes[k].all()));
        if (changes[k].share() <= share) continue;
        share = changes[k].share();
        const bool across = share_of(changes[k].changed[0], changes[k].looked[0]) >=
                            share_of(changes[k].changed[1], changes[k].looked[1]);
        side_px = across ? picture.width : picture.height;
    }
    for (std::size_t k = 0; k + 1 < bits; ++k) {
        const double part = std::pow(2.0, -static_cast<double>(bits - 1 - k));
        if (part * share / kFlat_px * side_px < kFewestLines || part * most < 60 || !changes[k + 1].clear) continue;
        if (static_cast<double>(changes[k].all()) > 1.25 * static_cast<double>(changes[k + 1].all()))
            check.problems.push_back(
                {direction.gray[k],
                 fmt::format("{} has finer stripes than {}", s.name(direction.gray[k]), s.name(direction.gray[k + 1])),
                 share_of(changes[k].all(), changes[k].looked[0] + changes[k].looked[1]),
                 SequenceProblem::Cause::order});
    }
}

/// A Gray code that has no fringes, or no inverses, to be judged by.
bool judges_itself(const Samples& s) {
    return std::any_of(s.directions.begin(), s.directions.end(),
                       [](const Direction& d) { return !d.gray.empty() && (d.phase.empty() || d.inverse.empty()); });
}

}  // namespace

std::string remedy_of(const SequenceProblem& problem) {
    using Cause = SequenceProblem::Cause;
    switch (problem.cause) {
        case Cause::timing:
            return "Scan again; if it comes back, check the delay between projector and cameras.";
        case Cause::order:
            return "Check the names of the pictures: coarsest bit first, columns before rows; else the delay between "
                   "projector and cameras.";
        case Cause::light:
            return "See that the patient lies still and nobody moves lamps, and switch off what changes by itself (the "
                   "camera's automatic exposure and gain, the projector's dynamic contrast); else check the delay "
                   "between projector and cameras and the names of the pictures.";
        case Cause::flicker:
            return "Lamps flicker, for the pictures are brighter or darker by the same grey everywhere: set the "
                   "cameras' exposure to a whole number of 10 ms (mains of 50 Hz) or of 8.33 ms (60 Hz), or darken the "
                   "room; and see that no lamp is switched while the patterns run.";
        case Cause::mirrored:
            return "See that no picture is mirrored and that the bits are not named as their inverses (white where a "
                   "bit is 1).";
        case Cause::fringes:
            return "See that nobody stepped before the cameras and no lamp was switched while the patterns ran, and "
                   "that period, number and order of the shifts are those of capture.json; else check the delay "
                   "between projector and cameras.";
    }
    return {};
}

SequenceCheck check_sequence(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    return check_sequence(frames, stripes, stripe_sequence(stripes));
}

SequenceCheck check_sequence(std::span<const GrayImage> frames, const StripeSettings& stripes,
                             const std::vector<StripePattern>& patterns, bool patchy) {
    Samples samples = gather_samples(frames, stripes, patterns);
    SequenceCheck check;
    check_ends(samples, check);
    check.checked = check.checked && (samples.lit >= kEnough || !check.problems.empty());
    if (!check.checked || !check.problems.empty()) {
        blame_lamps(samples, check);
        return check;
    }
    for (Direction& direction : samples.directions) {
        const std::vector<Changes> changes = changes_of(samples, direction);
        direction.wide = wide_bits(changes);
        std::vector<std::vector<Fringe>> fringes{fringes_of(samples, direction.phase)};
        for (const auto& phases : direction.further) fringes.push_back(fringes_of(samples, phases));
        check_pairs(samples, direction, check);
        if (!direction.phase.empty()) {
            check_fringes(samples, direction.phase, fringes[0], check);
            if (check.problems.empty()) check_doubled(samples, direction.phase, fringes[0], check);
        }
        for (std::size_t k = 0; k < direction.further.size(); ++k)
            check_fringes(samples, direction.further[k], fringes[k + 1], check);
        check_frequencies(samples, direction, fringes, check);
        const std::size_t problems = check.problems.size();
        check_parity(samples, direction, fringes[0], check);
        if (check.problems.size() == problems) check_offset(samples, direction, fringes[0], check);
        if (!patchy) check_order(samples, direction, changes, frames[0], check);
    }
    if (judges_itself(samples)) check_nesting(frames, samples, check);
    blame_lamps(samples, check);
    return check;
}

}  // namespace planlight
