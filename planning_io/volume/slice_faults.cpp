#include "planning_io/volume/slice_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "planning_io/files/content_hash.h"
#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

/// Of a slice across an axis, thinned where it is large, row by row.
struct ThinSlice {
    std::size_t width = 0;
    std::vector<float> values;
};

ThinSlice slice_of(const Volume& volume, std::size_t axis, int at) {
    constexpr int kMost = 256;
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int step_u = (volume.size[u] + kMost - 1) / kMost, step_v = (volume.size[v] + kMost - 1) / kMost;
    std::array<int, 3> p{};
    p[axis] = at;
    ThinSlice slice{static_cast<std::size_t>((volume.size[u] + step_u - 1) / step_u), {}};
    for (p[v] = 0; p[v] < volume.size[v]; p[v] += step_v)
        for (p[u] = 0; p[u] < volume.size[u]; p[u] += step_u) slice.values.push_back(volume.at(p[0], p[1], p[2]));
    return slice;
}

/// Sums of blocks of pixels, in which noise is small.
std::vector<double> blocks_of(const ThinSlice& slice) {
    constexpr std::size_t kBlock = 4;
    const std::size_t width = slice.width / kBlock, height = slice.values.size() / slice.width / kBlock;
    std::vector<double> blocks(width * height, 0);
    for (std::size_t y = 0; y < height * kBlock; ++y)
        for (std::size_t x = 0; x < width * kBlock; ++x)
            blocks[y / kBlock * width + x / kBlock] += slice.values[y * slice.width + x];
    return blocks;
}

double mean_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
    return sum / static_cast<double>(std::max<std::size_t>(1, a.size()));
}

/// The slices across one axis, each against the one before it.
struct SliceRow {
    std::vector<std::string> hashes;
    std::vector<std::vector<double>> blocks;
    std::vector<bool> plain;    ///< whether a slice shows one value only
    std::vector<double> noise;  ///< share of the voxels beside the background that differ from the slice before; not of
                                ///< pairs of slices that are nearly all background
    std::vector<double> apart;  ///< mean difference of blocks from the slice before
};

/// What a program or scanner sets outside of the body or of the field, in one value: the least, and the most frequent.
std::array<float, 2> background_of(const Volume& volume) {
    std::unordered_map<float, std::size_t> counts;
    constexpr std::size_t kMost = 500'000;
    const std::size_t step = std::max<std::size_t>(1, volume.values.size() / kMost);
    for (std::size_t i = 0; i < volume.values.size(); i += step) ++counts[volume.values[i]];
    const auto most = std::ranges::max_element(counts, {}, [](const auto& value) { return value.second; });
    return {*std::ranges::min_element(volume.values), most == counts.end() ? 0.F : most->first};
}

SliceRow row_along(const Volume& volume, std::size_t axis, const std::array<float, 2>& background) {
    constexpr double kLeastAsked = 0.01;
    SliceRow row;
    const auto is_background = [&](float v) { return v == background[0] || v == background[1]; };
    ThinSlice before;
    for (int k = 0; k < volume.size[axis]; ++k) {
        ThinSlice slice = slice_of(volume, axis, k);
        row.blocks.push_back(blocks_of(slice));
        row.plain.push_back(std::adjacent_find(slice.values.begin(), slice.values.end(), std::not_equal_to<>()) ==
                            slice.values.end());
        ContentHash hash;
        hash.add_values(slice.values.data(), slice.values.size());
        row.hashes.push_back(hash.hex());
        if (k > 0) {
            std::size_t differ = 0, asked = 0;
            for (std::size_t i = 0; i < slice.values.size(); ++i) {
                asked += !is_background(slice.values[i]) || !is_background(before.values[i]);
                differ += slice.values[i] != before.values[i];
            }
            if (static_cast<double>(asked) > kLeastAsked * static_cast<double>(slice.values.size()))
                row.noise.push_back(static_cast<double>(differ) / static_cast<double>(asked));
            row.apart.push_back(mean_difference(row.blocks[row.blocks.size() - 2], row.blocks.back()));
        }
        before = std::move(slice);
    }
    return row;
}

/// Neighbours of a scanner differ by noise nearly everywhere in the body; those of a computed volume may be alike.
bool is_of_a_scanner(const SliceRow& row) {
    constexpr double kLeastNoise = 0.15;
    return median(row.noise) >= kLeastNoise;
}

/// Slices that are there twice: how many, and the first of them, or 0.
std::pair<int, std::size_t> repeated_in(const SliceRow& row) {
    constexpr std::size_t kMostLag = 64;
    std::pair<int, std::size_t> repeated{0, 0};
    for (std::size_t k = 1; k < row.hashes.size(); ++k) {
        if (row.plain[k]) continue;  // all air, say: one is as the other
        const auto here = row.hashes.begin() + static_cast<std::ptrdiff_t>(k),
                   from = here - static_cast<std::ptrdiff_t>(std::min(k, kMostLag));
        if (std::find(from, here, *here) != here && repeated.first++ == 0) repeated.second = k;
    }
    return repeated;
}

/// The first slice that shows one value only between others that do not; 0 without one.
std::size_t empty_in(const SliceRow& row) {
    const auto first = std::find(row.plain.begin(), row.plain.end(), false);
    const auto last = std::find(row.plain.rbegin(), row.plain.rend(), false).base();
    const auto empty = first < last ? std::find(first, last, true) : last;
    return empty < last ? static_cast<std::size_t>(empty - row.plain.begin()) : 0;
}

/// Where neighbours differ far more than those around them do: the second of the two, and how many times as much.
/// Without a fault 1.5 at most along any axis of 23 heads, 1.7 of a mask; 4.0 where 9 mm are missing (`measure_heads`,
/// column "jumps").
std::pair<std::size_t, double> jump_in(const SliceRow& row) {
    constexpr std::size_t kAround = 4;
    constexpr double kLeastOfUsual = 0.3;
    std::pair<std::size_t, double> worst{0, 0};
    const double usual = median(row.apart);
    for (std::size_t k = kAround; k + kAround < row.apart.size(); ++k) {
        if (row.plain[k] || row.plain[k + 1]) continue;  // a border of one value, which a program put there
        double most = kLeastOfUsual * usual;
        for (std::size_t d = 1; d <= kAround; ++d) most = std::max({most, row.apart[k - d], row.apart[k + d]});
        if (most > 0 && row.apart[k] >= usual && row.apart[k] / most > worst.second)
            worst = {k + 1, row.apart[k] / most};
    }
    return worst;
}

/// Two slices of a row, and how many times better it fits together with them exchanged.
struct Exchange {
    std::size_t first = 0, second = 0;
    double times = 0;
};

/// The exchange of two slices after which the row fits together best. Without a fault 1.05 at most along any axis of 23
/// heads (`measure_heads`, column "exchange"), for in noise alone one order is as good as another; where two slices
/// were exchanged 1.4 to 2 and more.
///
/// Pairs beside it that lie as far apart tell how well the head lets slices fit to others than their neighbours; and an
/// exchange leaves neighbours that differ more than is usual there, which a scanner does not that takes every second
/// slice first and darker.
Exchange exchange_in(const SliceRow& row) {
    constexpr std::size_t kMostApart = 16, kFirst = 6, kFrom = 2, kTo = 4, kAround = 8;
    constexpr double kUnusual = 1.2;
    const std::size_t count = row.blocks.size();
    std::vector<std::vector<double>> apart(kMostApart + 2, std::vector<double>(count, 0));  // by lag, from the lower on
    for (std::size_t lag = 1; lag < apart.size(); ++lag)
        for (std::size_t k = 0; k + lag < count; ++k)
            apart[lag][k] = mean_difference(row.blocks[k], row.blocks[k + lag]);
    const auto gain = [&](std::size_t k, std::size_t lag) {
        double as_given = apart[1][k - 1] + apart[1][k + lag], exchanged = apart[lag + 1][k - 1] + apart[lag + 1][k];
        if (lag > 1) {  // neighbours stay neighbours
            as_given += apart[1][k] + apart[1][k + lag - 1];
            exchanged += apart[lag - 1][k + 1] + apart[lag - 1][k];
        }
        return exchanged > 0 ? as_given / exchanged : 1;
    };
    const auto is_unusual = [&](std::size_t k, std::size_t lag) {
        const auto at = [&](std::size_t i) { return row.apart.begin() + static_cast<std::ptrdiff_t>(i); };
        const double usual = median(
            std::vector<double>(at(k - std::min(k, kAround)), at(std::min(row.apart.size(), k + lag + kAround))));
        return row.apart[k - 1] + row.apart[k + lag] > 2 * kUnusual * usual;
    };
    Exchange best;
    for (std::size_t lag = 1; lag <= kMostApart; ++lag)
        for (std::size_t k = kFirst; k + lag + kFirst < count; ++k) {
            double around = 1;
            for (std::size_t d = kFrom; d <= kTo; ++d) around = std::max({around, gain(k - d, lag), gain(k + d, lag)});
            if (const double times = gain(k, lag) / around; times > best.times && is_unusual(k, lag))
                best = {k, k + lag, times};
        }
    return best;
}

}  // namespace

void note_slice_faults(Volume& volume, std::optional<std::size_t> stacked) {
    constexpr double kMostApart = 2.5, kExchanged = 1.3;
    const auto background = background_of(volume);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (stacked && axis != *stacked) continue;
        const SliceRow row = row_along(volume, axis, background);
        if (!is_of_a_scanner(row)) continue;
        if (const std::size_t empty = empty_in(row); empty > 0)
            volume.notes.push_back(fmt::format(
                "its slice {} along axis {} shows one value only, as where a slice was lost: the skin there is "
                "not the patient's; export the series again",
                empty + 1, axis + 1));
        if (const auto [count, first] = repeated_in(row); count > 0)
            volume.notes.push_back(
                fmt::format("{} of its {} slices along axis {} are there twice, bit for bit, from slice {} on: behind "
                            "them the head is in the wrong place; export the series again",
                            count, volume.size[axis], axis + 1, first + 1));
        else if (const auto [second, times] = jump_in(row); times > kMostApart)
            volume.notes.push_back(fmt::format(
                "its slices {} and {} along axis {} differ {:.1f} times as much as those around them: slices "
                "seem to be missing between them, and then all behind is in the wrong place; export the "
                "series again",
                second, second + 1, axis + 1, times));
        if (const Exchange exchange = exchange_in(row); exchange.times > kExchanged)
            volume.notes.push_back(
                fmt::format("its slices {} and {} along axis {} fit {:.1f} times better to their neighbours the other "
                            "way round: they seem to be exchanged, and the skin there is not the patient's; export the "
                            "series again",
                            exchange.first + 1, exchange.second + 1, axis + 1, exchange.times));
    }
}

std::array<double, 3> largest_slice_jumps(const Volume& volume) {
    std::array<double, 3> jumps{};
    const auto background = background_of(volume);
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (const SliceRow row = row_along(volume, axis, background); is_of_a_scanner(row))
            jumps[axis] = jump_in(row).second;
    return jumps;
}

std::array<double, 3> best_slice_exchanges(const Volume& volume) {
    std::array<double, 3> times{};
    const auto background = background_of(volume);
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (const SliceRow row = row_along(volume, axis, background); is_of_a_scanner(row))
            times[axis] = exchange_in(row).times;
    return times;
}

}  // namespace planlight
