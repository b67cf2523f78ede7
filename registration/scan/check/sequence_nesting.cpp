#include "registration/scan/check/sequence_nesting.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "registration/scan/check/sequence_fringes.h"

namespace planlight::sequence {
namespace {

constexpr std::size_t kPlaces = 200000;  // about so many are looked at

/// The bits at a pixel; bit k of the words is the k-th of the code, the coarsest 0.
struct Code {
    std::uint32_t set = 0, clear = 0;  ///< lit; lit or dark without doubt
    int contrast = 0;                  ///< white - black; 0: too little light, or too much
};

/// A place, and kFlat_px beside (0) and below it (1).
struct Place {
    Code here;
    std::array<Code, 2> next;
};

class Reader {
public:
    Reader(std::span<const GrayImage> frames, const Samples& s, const Direction& direction)
        : frames_(frames), s_(s), direction_(direction) {}

    Code at(std::size_t pixel) const {
        const int white = frames_[s_.white].pixels[pixel], contrast = white - frames_[s_.black].pixels[pixel];
        if (contrast < s_.least_change || white >= kBright_grey) return {};
        Code code{0, 0, contrast};
        for (std::size_t k = 0; k < direction_.gray.size(); ++k) {
            const int value =
                s_.difference(direction_, k, [&](std::size_t frame) { return int{frames_[frame].pixels[pixel]}; });
            code.set |= static_cast<std::uint32_t>(value > 0) << k;
            code.clear |= static_cast<std::uint32_t>(2 * std::abs(value) > contrast) << k;
        }
        return code;
    }

    std::vector<Place> places() const {
        const GrayImage& picture = frames_[0];
        const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(picture.pixels.size() / kPlaces))));
        std::vector<Place> places;
        for (int y = 0; y + kFlat_px < picture.height; y += step)
            for (int x = 0; x + kFlat_px < picture.width; x += step)
                if (const Code here = at(picture.index(x, y)); here.contrast > 0)
                    places.push_back({here, {at(picture.index(x + kFlat_px, y)), at(picture.index(x, y + kFlat_px))}});
        return places;
    }

private:
    std::span<const GrayImage> frames_;
    const Samples& s_;
    const Direction& direction_;
};

/// A step of the surface, an edge of a shadow or of a stain are likely to change the light.
bool under_same_light(const Code& a, const Code& b) {
    return b.contrast > 0 && 4 * std::abs(a.contrast - b.contrast) <= a.contrast;
}

/// What was seen where one bit changes, of a finer one.
struct AtEdges {
    std::size_t steady = 0, wrong = 0, together = 0;
};

struct Seen {
    std::size_t bits = 0, places = 0;
    std::size_t resolved = 0;  ///< so many bits are, from the coarsest on
    std::array<std::size_t, 2> pairs{};
    std::vector<std::size_t> clear;
    std::vector<std::array<std::size_t, 2>> clear_pairs, changes;
    std::vector<AtEdges> edges;               ///< [coarser * bits + finer]
    std::array<std::size_t, 2> up{}, down{};  ///< how the code goes on beside and below
    double way(std::size_t side) const {      ///< 1: upwards everywhere, -1: downwards
        const auto all = static_cast<double>(up[side] + down[side]);
        return all == 0 ? 0 : (static_cast<double>(up[side]) - static_cast<double>(down[side])) / all;
    }
};

void look_at_edges(const Code& a, const Code& b, std::size_t side, Seen& seen) {
    const std::uint32_t clear = a.clear & b.clear, changed = (a.set ^ b.set) & clear;
    ++seen.pairs[side];
    for (std::size_t k = 0; k < seen.bits; ++k) seen.clear_pairs[k][side] += clear >> k & 1;
    for (std::uint32_t left = changed; left != 0; left &= left - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(left));
        ++seen.changes[k][side];
        for (std::size_t j = k + 1; j < seen.bits; ++j) {
            AtEdges& at = seen.edges[k * seen.bits + j];
            if ((clear >> j & 1) == 0) continue;
            if ((changed >> j & 1) != 0)
                ++at.together;
            else
                ++at.steady, at.wrong += ((a.set >> j & 1) != 0) != (j == k + 1);
        }
    }
}

/// Stripes of six pixels at least: between two places kFlat_px apart there is one edge at the most. `margin`: by how
/// much it is missed or kept.
bool resolved(const Seen& seen, std::size_t bit, double margin = 0) {
    const auto &changes = seen.changes[bit], &pairs = seen.clear_pairs[bit];
    const double dense = std::max(share_of(changes[0], pairs[0]), share_of(changes[1], pairs[1]));
    return share_of(seen.clear[bit], seen.places) > 0.6 + margin && dense < 0.5 - margin;
}

int number_of(std::uint32_t set, std::size_t bits) {
    int number = 0, bit = 0;
    for (std::size_t k = 0; k < bits; ++k) {
        bit ^= static_cast<int>(set >> k & 1);
        number = 2 * number + bit;
    }
    return number;
}

/// Counts how the code goes on where it goes on by one.
void look_along(const Code& a, const Code& b, std::size_t side, Seen& seen) {
    const std::uint32_t all = (1u << seen.resolved) - 1;
    if ((a.clear & b.clear & all) != all) return;
    const int step = number_of(b.set, seen.resolved) - number_of(a.set, seen.resolved);
    seen.up[side] += step == 1;
    seen.down[side] += step == -1;
}

Seen look(std::span<const GrayImage> frames, const Samples& s, const Direction& direction) {
    const std::vector<Place> places = Reader(frames, s, direction).places();
    Seen seen;
    seen.bits = direction.gray.size();
    seen.places = places.size();
    seen.clear.assign(seen.bits, 0);
    seen.changes.assign(seen.bits, {});
    seen.clear_pairs = seen.changes;
    seen.edges.assign(seen.bits * seen.bits, {});
    for (const Place& place : places) {
        for (std::size_t k = 0; k < seen.bits; ++k) seen.clear[k] += place.here.clear >> k & 1;
        for (std::size_t side = 0; side < 2; ++side)
            if (under_same_light(place.here, place.next[side])) look_at_edges(place.here, place.next[side], side, seen);
    }
    while (seen.resolved < direction.wide && resolved(seen, seen.resolved)) ++seen.resolved;
    for (const Place& place : places)
        for (std::size_t side = 0; side < 2; ++side)
            if (under_same_light(place.here, place.next[side])) look_along(place.here, place.next[side], side, seen);
    return seen;
}

void check_edges(const Samples& s, const Direction& direction, const Seen& seen, SequenceCheck& check) {
    constexpr double kMostTogether = 0.6, kMostWrong = 0.35;
    // Half a line across what is lit: fewer edges may be those of shadows and steps.
    const double line = std::max(50.0, 0.5 * kFlat_px * std::sqrt(static_cast<double>(seen.pairs[0])));
    for (std::size_t k = 0; k < seen.resolved; ++k)
        for (std::size_t j = k + 1; j < seen.resolved; ++j) {
            const AtEdges& at = seen.edges[k * seen.bits + j];
            const std::size_t all = at.steady + at.together;
            const std::string &coarse = s.name(direction.gray[k]), &fine = s.name(direction.gray[j]);
            if (static_cast<double>(all) >= line && share_of(at.together, all) > kMostTogether)
                check.problems.push_back({direction.gray[j], fmt::format("{} changes where {} does", fine, coarse),
                                          share_of(at.together, all), SequenceProblem::Cause::order});
            else if (static_cast<double>(at.steady) >= line && share_of(at.wrong, at.steady) > kMostWrong)
                check.problems.push_back({direction.gray[j],
                                          fmt::format("{} is not {} where {} changes, as in a Gray code{}{}", fine,
                                                      j == k + 1 ? "lit" : "dark", coarse,
                                                      explain(s, direction.gray[j]), explain(s, direction.gray[k])),
                                          share_of(at.wrong, at.steady), SequenceProblem::Cause::order});
        }
}

/// A coarse bit that cannot be resolved where a finer one can.
void check_finest_last(const Samples& s, const Direction& direction, const Seen& seen, SequenceCheck& check) {
    constexpr double kMargin = 0.1;
    for (std::size_t k = 0; k + 1 < seen.bits; ++k)
        for (std::size_t j = k + 1; j < direction.wide && !resolved(seen, k, -kMargin); ++j)
            if (resolved(seen, j, kMargin)) {
                check.problems.push_back(
                    {direction.gray[k],
                     fmt::format("{} has finer stripes than {}", s.name(direction.gray[k]), s.name(direction.gray[j])),
                     1 - share_of(seen.clear[k], seen.places), SequenceProblem::Cause::order});
                break;
            }
}

/// Two pictures that look the same, and not just evenly lit or dark.
void check_twins(const Samples& s, const Direction& direction, SequenceCheck& check) {
    constexpr double kLeast = 0.1;
    for (const auto* frames : {&direction.gray, &direction.inverse})
        for (const std::size_t frame : *frames) {
            std::size_t lit = 0, dark = 0;
            for (std::size_t i = 0; i < s.lit; ++i) {
                const int light = s.here[frame][i] - s.here[s.black][i];
                lit += 4 * light > 3 * s.contrast[i];
                dark += 4 * light < s.contrast[i];
            }
            if (share_of(lit, s.lit) < kLeast || share_of(dark, s.lit) < kLeast) continue;
            if (const auto twin = twin_of(s, frame)) {
                check.problems.push_back({frame, fmt::format("{} looks like {}", s.name(frame), s.name(*twin)), 1});
                return;
            }
        }
}

void check_one_way(const Samples& s, const Direction& direction, const Seen& seen, SequenceCheck& check) {
    constexpr double kMost = 0.06;
    const std::size_t side = std::abs(seen.way(0)) * static_cast<double>(seen.up[0] + seen.down[0]) >=
                                     std::abs(seen.way(1)) * static_cast<double>(seen.up[1] + seen.down[1])
                                 ? 0
                                 : 1;
    const std::size_t all = seen.up[side] + seen.down[side], against = std::min(seen.up[side], seen.down[side]);
    if (all < kEnough || share_of(against, all) <= kMost) return;
    check.problems.push_back(
        {direction.gray[0],
         fmt::format("the code of {} to {} turns back on the surface: a coarse one is another picture",
                     s.name(direction.gray.front()), s.name(direction.gray.back())),
         share_of(against, all), SequenceProblem::Cause::order});
}

}  // namespace

void check_nesting(std::span<const GrayImage> frames, const Samples& s, SequenceCheck& check) {
    std::array<Seen, 2> seen;
    for (std::size_t d = 0; d < 2; ++d) {
        const Direction& direction = s.directions[d];
        if (direction.gray.size() < 2 || direction.gray.size() > 31) continue;
        seen[d] = look(frames, s, direction);
        const std::size_t before = check.problems.size();
        check_finest_last(s, direction, seen[d], check);
        check_edges(s, direction, seen[d], check);
        check_twins(s, direction, check);
        if (check.problems.size() == before) check_one_way(s, direction, seen[d], check);
    }
    if (!check.problems.empty() || seen[0].bits == 0 || seen[1].bits == 0) return;
    // Cameras and projector look at the same side of the surface: the code is turned at most, never a mirror image.
    const double turned = seen[0].way(0) * seen[1].way(1) - seen[0].way(1) * seen[1].way(0);
    if (turned > -0.3) return;
    check.problems.push_back(
        {s.directions[0].gray[0],
         fmt::format("the code is a mirror image: {} or {} is inverted, or the pictures are mirrored",
                     s.name(s.directions[0].gray[0]), s.name(s.directions[1].gray[0])),
         1, SequenceProblem::Cause::mirrored});
}

}  // namespace planlight::sequence
