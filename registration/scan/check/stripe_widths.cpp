#include "registration/scan/check/stripe_widths.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace planlight::sequence {

double Changes::share() const {
    return std::max(share_of(changed[0], looked[0]), share_of(changed[1], looked[1]));
}

std::vector<Changes> changes_of(const Samples& s, const Direction& direction) {
    std::vector<Changes> all(direction.gray.size());
    for (std::size_t bit = 0; bit < all.size(); ++bit) {
        Changes& changes = all[bit];
        std::size_t clear = 0;
        for (std::size_t i = 0; i < s.lit; ++i) {
            const int here = s.difference(direction, bit, [&](std::size_t frame) { return int{s.here[frame][i]}; });
            clear += 2 * std::abs(here) > s.contrast[i];
            for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
                if ((side == 0 ? s.contrast_right : s.contrast_below)[i] < kLit_grey) continue;
                const std::size_t place = side == 0 ? 1 : 3;
                const int there =
                    s.difference(direction, bit, [&](std::size_t frame) { return int{s.around[frame][place][i]}; });
                ++changes.looked[side];
                changes.changed[side] +=
                    (here > 0) != (there > 0) && std::min(std::abs(here), std::abs(there)) * 4 > s.contrast[i];
            }
        }
        changes.clear = share_of(clear, s.lit) > 0.6;
    }
    return all;
}

std::size_t wide_bits(const std::vector<Changes>& changes) {
    constexpr std::size_t kFewest = 60;  // changes; of fewer the number says little
    constexpr double kWide = 0.5;        // stripes of 6 pixels change at every second place 3 pixels off
    std::vector<double> finest;          // log2 of how often a bit 0 would change, as each bit says
    for (std::size_t k = 0; k < changes.size(); ++k)
        if (changes[k].all() >= kFewest) finest.push_back(std::log2(changes[k].share()) - static_cast<double>(k));
    if (finest.size() < 3) return changes.size();
    const auto middle = finest.begin() + static_cast<std::ptrdiff_t>(finest.size() / 2);
    std::nth_element(finest.begin(), middle, finest.end());
    std::size_t wide = 0;
    while (wide < changes.size() && *middle + static_cast<double>(wide) <= std::log2(kWide)) ++wide;
    return wide;
}

}  // namespace planlight::sequence
