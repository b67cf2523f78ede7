#include "segmentation/detach_objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

#include "planning_io/types/statistics.h"
#include "segmentation/outside_air.h"

namespace planlight {
namespace {

constexpr double kEarReach_mm = 40;  // from the thick head along the piece; an adult ear stands out by 15-30 mm
constexpr double kSpeck_ml = 0.05;
constexpr int kLevels = 4;  // thresholds tried to make a contact let go

enum State : std::uint8_t { kAir = 0, kBody = 1, kHanging = 2, kInPiece = 3, kGone = 4, kKept = 5 };

/// How far the piece reaches from the body, along itself, mm (Dijkstra over face neighbours, stopped beyond the ear's
/// reach). Face steps overestimate diagonals by up to sqrt(3); steps are scaled by 0.7 for the mean. Negative: no
/// contact.
double reach_mm(const Mask& state, const VoxelGrid& grid, const std::vector<std::size_t>& piece,
                std::vector<float>& distance, double scale) {
    using Entry = std::pair<float, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    constexpr float kUnseen = 1e9F;
    for (const std::size_t v : piece) distance[v] = kUnseen;
    for (const std::size_t v : piece)
        for_face_neighbours(grid, v, [&](std::size_t n) {
            if (state[n] == kBody && distance[v] > 0) {
                distance[v] = 0;
                queue.emplace(0.0F, v);
            }
        });
    double reach = queue.empty() ? -1 : 0;
    const auto step = static_cast<float>(scale * grid.spacing_mm.mean());
    while (!queue.empty()) {
        const auto [far, v] = queue.top();
        queue.pop();
        if (far > distance[v]) continue;
        reach = far;
        if (reach > kEarReach_mm) break;
        for_face_neighbours(grid, v, [&](std::size_t n) {
            if (state[n] != kInPiece || distance[n] <= far + step) return;
            distance[n] = far + step;
            queue.emplace(far + step, n);
        });
    }
    return reach;
}

/// Body plus the voxels of `piece` near its kept part: gives back the fringe that a raised threshold took.
void take_back_fringe(Mask& state, const VoxelGrid& grid, std::vector<std::size_t> front, int steps, State to) {
    for (int s = 0; s < steps; ++s) {
        std::vector<std::size_t> next;
        for (const std::size_t v : front)
            for_face_neighbours(grid, v, [&](std::size_t n) {
                if (state[n] != kHanging) return;
                state[n] = to;
                next.push_back(n);
            });
        front = std::move(next);
    }
}

class Pieces {
public:
    Pieces(Mask& state, const std::vector<float>& values, double threshold, double soft, const VoxelGrid& grid,
           Contact contact)
        : state_(state),
          values_(values),
          threshold_(threshold),
          soft_(soft),
          grid_(grid),
          kept_as_(contact == Contact::with_core ? kKept : kBody),
          distance_(state.size(), 0.0F) {}

    /// Judges every hanging piece; `state` becomes body or gone.
    void judge() {
        for (std::size_t v = 0; v < state_.size(); ++v)
            if (state_[v] == kHanging) {
                std::vector<std::size_t> piece;
                flood(state_, grid_, {v}, kHanging, kInPiece, &piece);
                judge(std::move(piece), 0);
            }
    }
    double torn_ml = 0;  ///< of what touched the head and was cut off

private:
    void judge(std::vector<std::size_t> piece, int level) {
        const double reach = reach_mm(state_, grid_, piece, distance_, kept_as_ == kKept ? 0.9 : 0.7);
        if (reach >= 0 && reach <= kEarReach_mm) {
            for (const std::size_t v : piece) state_[v] = kept_as_;
            return;
        }
        if (reach < 0 || level == kLevels) {
            if (reach >= 0) torn_ml += static_cast<double>(piece.size()) * grid_.voxel_ml();
            for (const std::size_t v : piece) state_[v] = kGone;
            return;
        }
        judge_at_higher_threshold(piece, level + 1);
    }

    void judge_at_higher_threshold(const std::vector<std::size_t>& piece, int level) {
        const double cut = threshold_ + (soft_ - threshold_) * 0.2 * level;
        for (const std::size_t v : piece) state_[v] = values_[v] >= cut ? kHanging : kGone;
        std::vector<std::size_t> kept;
        for (const std::size_t v : piece) {
            if (state_[v] != kHanging) continue;
            std::vector<std::size_t> part;
            flood(state_, grid_, {v}, kHanging, kInPiece, &part);
            judge(part, level);
            for (const std::size_t p : part)
                if (state_[p] == kept_as_) kept.push_back(p);
        }
        if (level != 1) return;
        for (const std::size_t v : piece)
            if (state_[v] == kGone && values_[v] < cut) state_[v] = kHanging;
        take_back_fringe(state_, grid_, std::move(kept), 2, kept_as_);
        for (const std::size_t v : piece)
            if (state_[v] == kHanging) state_[v] = kGone;
    }

    Mask& state_;
    const std::vector<float>& values_;
    double threshold_, soft_;
    const VoxelGrid& grid_;
    State kept_as_;
    std::vector<float> distance_;
};

double median_value(const std::vector<float>& values, const Mask& where) {
    std::vector<float> sample;
    for (std::size_t i = 0; i < where.size(); i += 13)
        if (where[i]) sample.push_back(values[i]);
    if (sample.empty()) return 0;
    return median(std::move(sample));
}

void count_removed(const Mask& dense, const VoxelGrid& grid, DetachedBody& result) {
    Mask left(dense.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = dense[i] && !result.body[i];
    for (std::size_t i = 0; i < left.size(); ++i) {
        if (left[i] != 1) continue;
        const double ml = static_cast<double>(flood(left, grid, {i}, 1, 2)) * grid.voxel_ml();
        if (ml < kSpeck_ml) continue;
        ++result.pieces_removed;
        result.removed_ml += ml;
    }
}

}  // namespace

DetachedBody detach_objects(const Mask& dense, const std::vector<float>& values, double threshold,
                            const VoxelGrid& grid, double detach_radius_mm, Contact contact) {
    DetachedBody result;
    Mask filled = outside_air(dense, grid);
    for (auto& v : filled) v = !v;
    // Half a voxel more: a bridge ends half a voxel before the centre of the first voxel of air.
    const double radius_mm = detach_radius_mm + grid.spacing_mm.maxCoeff() / 2;
    const LargestPiece core = largest_piece(erode(filled, grid, radius_mm), grid);
    if (core.voxels == 0) return result;

    // One voxel more than the opening gives back: the rounding of its ball to voxels.
    const Mask near = dilate(core.mask, grid, radius_mm + grid.spacing_mm.maxCoeff());
    Mask state(filled.size());
    std::vector<std::size_t> seeds;
    for (std::size_t i = 0; i < state.size(); ++i) {
        state[i] = !filled[i] ? kAir : near[i] ? kInPiece : kHanging;
        if (core.mask[i]) seeds.push_back(i);
    }
    flood(state, grid, std::move(seeds), kInPiece, kBody);
    for (auto& v : state)
        if (v == kInPiece) v = kHanging;  // near, but across a gap

    Pieces pieces(state, values, threshold, median_value(values, core.mask), grid, contact);
    pieces.judge();
    for (auto& v : state) v = v == kBody || v == kKept;
    result.body = std::move(state);
    count_removed(dense, grid, result);
    if (pieces.torn_ml >= kSpeck_ml)
        result.warnings.push_back(
            fmt::format("Something of {:.1f} ml that touches the head was cut off; look at the skin where it was.",
                        pieces.torn_ml));
    return result;
}

}  // namespace planlight
