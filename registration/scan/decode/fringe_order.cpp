#include "registration/scan/decode/fringe_order.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "planning_io/types/processor_clones.h"

namespace planlight::fringe_order {
namespace {

constexpr std::size_t kLanes = 16;
typedef float Lanes __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Mask __attribute__((vector_size(4 * kLanes)));

constexpr float kSlack_sigma = 4.5f;
constexpr float kNoPlace = 1e9f;  ///< of an order that lies outside the projector's picture

/// Off the nearest whole number, for numbers under 2^22.
PLANLIGHT_INLINE void off_whole(Lanes& turns) {
    constexpr float kRound = 12582912;  // 1.5 * 2^23: adding it leaves no place for a fraction
    turns -= (turns + kRound) - kRound;
}

}  // namespace

PLANLIGHT_CLONES void find_order(const float* phase_px, const float* amplitude, const Fringes& others,
                                 const Sureness& sure, float period, float size, float* __restrict pixel,
                                 std::size_t n) {
    const int orders = static_cast<int>(std::ceil(size / period)) + 1;
    const std::size_t count = others.count;
    for (std::size_t begin = 0; begin < n; begin += kLanes) {
        // Behind the last pixel of a block its arrays go on.
        Lanes first, first_amplitude, turns[kMostFrequencies], weight[kMostFrequencies];
        std::memcpy(&first, phase_px + begin, sizeof first);
        std::memcpy(&first_amplitude, amplitude + begin, sizeof first);
        const Lanes own = others.first_sigma_turns / first_amplitude;
        // How far outside the picture noise can put a pixel of its rim.
        const Lanes slack = period * (kSlack_sigma * own + sure.allowed_turns);
        for (std::size_t k = 0; k < count; ++k) {
            Lanes its_amplitude, phase;
            std::memcpy(&phase, others.turns[k] + begin, sizeof phase);
            std::memcpy(&its_amplitude, others.amplitude[k] + begin, sizeof its_amplitude);
            const Lanes sigma = others.sigma_turns[k] / its_amplitude, carried = others.by_period[k] * own;
            weight[k] = 1 / (sigma * sigma + carried * carried + sure.allowed_turns * sure.allowed_turns);
            turns[k] = first * (others.by_period[k] / period) - phase;
        }
        Lanes best = Lanes{} + kNoPlace, second = best, best_order = {};
        for (int order = 0; order < orders; ++order) {
            Lanes sum = {};
            const auto whole = static_cast<float>(order);
            for (std::size_t k = 0; k < count; ++k) {
                Lanes off = turns[k] + whole * others.by_period[k];
                off_whole(off);
                sum += weight[k] * off * off;
            }
            const Lanes place = first + whole * period;
            sum = (place >= -0.5f - slack) & (place < size - 0.5f + slack) ? sum : Lanes{} + kNoPlace;
            const Mask better = sum < best;
            const Lanes loser = better ? best : sum;
            second = loser < second ? loser : second;
            best = better ? sum : best;
            best_order = better ? Lanes{} + whole : best_order;
        }
        const Lanes found = first + best_order * period;
        // NaN (no light at all) fails every comparison.
        const Mask good = (best <= sure.most_chi_square) & (second - best >= sure.least_lead) & (found >= -0.5f) &
                          (found < size - 0.5f);
        const Lanes out = good ? found : Lanes{} + std::numeric_limits<float>::quiet_NaN();
        std::memcpy(pixel + begin, &out, sizeof out);
    }
}

}  // namespace planlight::fringe_order
