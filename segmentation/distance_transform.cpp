#include "segmentation/distance_transform.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace planlight {
namespace {

/// Squared distances along one line, of those that stand on it (Felzenszwalb & Huttenlocher 2012): the lower envelope
/// of parabolas, over those that are nearer than the most.
struct Envelope {
    float step_mm;
    double longest_mm;

    struct Parabolas {
        std::vector<int> place;
        std::vector<float> from;  ///< where each begins to be the lowest
        std::vector<float> height;
    };

    void replace(std::vector<float>& line, Parabolas& lowest) const {
        const float most = static_cast<float>(longest_mm * longest_mm);
        const auto [least, highest] = std::minmax_element(line.begin(), line.end());
        if (!(*least < most) || !(*highest > 0)) return;  // far from all, or the target itself: stays as it is
        const int n = static_cast<int>(line.size()),
                  reach = static_cast<int>(longest_mm / static_cast<double>(step_mm));
        auto& [place, from, height] = lowest;
        place.clear(), from.clear(), height.clear();
        for (int i = 0; i < n; ++i) {
            const float here = line[static_cast<std::size_t>(i)];
            if (!(here < most)) continue;
            float begins = -1e30F;
            for (; !place.empty(); place.pop_back(), from.pop_back(), height.pop_back()) {
                const int last = place.back();
                begins = ((here - height.back()) / (step_mm * step_mm) + static_cast<float>(i * i - last * last)) /
                         static_cast<float>(2 * (i - last));
                if (begins > from.back()) break;
                begins = -1e30F;
            }
            place.push_back(i), from.push_back(begins), height.push_back(here);
        }
        for (std::size_t i = 0, p = 0; i < line.size(); ++i) {
            while (p + 1 < place.size() && from[p + 1] <= static_cast<float>(i)) ++p;
            const int away = static_cast<int>(i) - place[p];
            line[i] = std::abs(away) <= reach
                          ? std::min(most, height[p] + step_mm * step_mm * static_cast<float>(away * away))
                          : most;
        }
    }
};

}  // namespace

std::vector<float> distance_from(const Mask& mask, std::uint8_t target, const VoxelGrid& grid, double longest_mm) {
    const float most = static_cast<float>(longest_mm * longest_mm);
    std::vector<float> squared(mask.size());
    for (std::size_t v = 0; v < mask.size(); ++v) squared[v] = mask[v] == target ? 0 : most;
    std::array<std::size_t, 3> strides{1, grid.row(), grid.slab()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t stride = strides[axis], n = static_cast<std::size_t>(grid.size[axis]);
        const Envelope envelope{static_cast<float>(grid.spacing_mm[static_cast<int>(axis)]), longest_mm};
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mask.size() / n), [&](const auto& lines) {
            std::vector<float> line(n);
            Envelope::Parabolas parabolas;
            for (std::size_t l = lines.begin(); l < lines.end(); ++l) {
                const std::size_t begin = l / stride * stride * n + l % stride;
                for (std::size_t i = 0; i < n; ++i) line[i] = squared[begin + i * stride];
                envelope.replace(line, parabolas);
                for (std::size_t i = 0; i < n; ++i) squared[begin + i * stride] = line[i];
            }
        });
    }
    for (float& d : squared) d = std::sqrt(d);
    return squared;
}

}  // namespace planlight
