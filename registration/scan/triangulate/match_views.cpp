#include "registration/scan/triangulate/match_views.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "registration/scan/decode/correspondence_map.h"

namespace planlight {
namespace {

/// Which rectangles of a stride of right pixels hold a partner of a left pixel. Set by all threads, in any order.
class Seen {
public:
    Seen(const DecodedView& view, Stride stride)
        : stride_(stride),
          columns_(view.width / stride.x + 1),
          rows_(view.height / stride.y + 1),
          cells_(std::make_unique<std::atomic<bool>[]>(static_cast<std::size_t>(columns_) *
                                                       static_cast<std::size_t>(rows_))) {}
    void mark(const Eigen::Vector2d& pixel) {
        cells_[place(column(pixel), row(pixel))].store(true, std::memory_order_relaxed);
    }
    /// That rectangle's, or one's beside it: the partners of a left grid do not meet every rectangle.
    bool marked(const Eigen::Vector2d& pixel) const {
        const int c = column(pixel), r = row(pixel);
        return set(c, r) || set(std::max(0, c - 1), r) || set(std::min(columns_ - 1, c + 1), r) ||
               set(c, std::max(0, r - 1)) || set(c, std::min(rows_ - 1, r + 1));
    }

private:
    int column(const Eigen::Vector2d& pixel) const {
        return std::clamp(static_cast<int>(pixel.x() / stride_.x + 0.5), 0, columns_ - 1);
    }
    int row(const Eigen::Vector2d& pixel) const {
        return std::clamp(static_cast<int>(pixel.y() / stride_.y + 0.5), 0, rows_ - 1);
    }
    std::size_t place(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }
    bool set(int column, int row) const { return cells_[place(column, row)].load(std::memory_order_relaxed); }
    Stride stride_;
    int columns_, rows_;
    std::unique_ptr<std::atomic<bool>[]> cells_;
};

/// The matches of one line of a picture.
struct Line {
    std::vector<ViewMatch> both, alone;
    std::size_t ragged = 0;
};

/// Calls `make(y, line)` for every `stride`-th line of the picture, in parallel.
template <class Make>
std::vector<Line> for_lines(const DecodedView& view, int stride, const Make& make) {
    std::vector<Line> lines(static_cast<std::size_t>((view.height + stride - 1) / stride));
    tbb::parallel_for(tbb::blocked_range<int>(0, static_cast<int>(lines.size()), 8),
                      [&](const tbb::blocked_range<int>& range) {
                          for (int r = range.begin(); r < range.end(); ++r)
                              make(r * stride, lines[static_cast<std::size_t>(r)]);
                      });
    return lines;
}

void join(const std::vector<Line>& lines, std::vector<ViewMatch> Line::*part, LargeArray<ViewMatch>& all) {
    std::vector<std::size_t> begin{0};
    for (const Line& line : lines) begin.push_back(begin.back() + (line.*part).size());
    all.resize(begin.back());
    tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t i) {
        std::copy((lines[i].*part).begin(), (lines[i].*part).end(),
                  all.begin() + static_cast<std::ptrdiff_t>(begin[i]));
    });
}

/// Along a line the partners follow each other: each search begins where the last match and its derivative say.
class Follower {
public:
    explicit Follower(const CorrespondenceIndex& index) : index_(index) {}
    /// The partner of a code, until the next call; null where there is none.
    const CorrespondenceIndex::Match* find(const Eigen::Vector2d& code) {
        constexpr double kNear_px = 12;
        bool found = false;
        if (known_) {
            const Eigen::Vector2d way = match_.pixel_by_code * (code - match_.code);
            if (way.cwiseAbs().maxCoeff() < kNear_px) found = index_.find_from(code, match_.pixel + way, match_);
        }
        known_ = found || index_.find(code, match_);
        return known_ ? &match_ : nullptr;
    }

private:
    const CorrespondenceIndex& index_;
    CorrespondenceIndex::Match match_;
    bool known_ = false;
};

ViewMatch alone(int x, int y, const Correspondence& local) {
    return {Eigen::Vector2d(x, y), local.code, local.sigma_px, local.whole};
}

void match_line(const DecodedView& left, const CorrespondenceIndex& in_right, int y, int stride, Seen& seen,
                Line& line) {
    Follower partners(in_right);
    Correspondence local;
    const float* column = left.column.data() + static_cast<std::ptrdiff_t>(y) * left.width;
    for (int x = 0; x < left.width; x += stride) {
        if (std::isnan(column[x])) continue;
        if (!fit_correspondence(left, x, y, local)) {
            ++line.ragged;
            continue;
        }
        const CorrespondenceIndex::Match* partner = partners.find(local.code);
        if (!partner) {
            line.alone.push_back(alone(x, y, local));
            continue;
        }
        if (line.both.empty()) line.both.reserve(static_cast<std::size_t>((left.width - x) / stride + 1));
        ViewMatch& match = line.both.emplace_back(alone(x, y, local));
        match.right = partner->pixel;
        match.right_by_code = partner->pixel_by_code;
        match.right_sigma_px = partner->local.sigma_px;
        seen.mark(match.right);
    }
}

void match_right_line(const DecodedView& right, const CorrespondenceIndex& in_left, int y, int stride, Seen& seen,
                      Line& line) {
    Follower partners(in_left);
    Correspondence local;
    const float* column = right.column.data() + static_cast<std::ptrdiff_t>(y) * right.width;
    for (int x = 0; x < right.width; x += stride) {
        if (std::isnan(column[x]) || seen.marked(Eigen::Vector2d(x, y))) continue;
        if (!fit_correspondence(right, x, y, local)) continue;  // ragged pixels were counted in the left view
        if (!partners.find(local.code)) line.alone.push_back(alone(x, y, local));
    }
}

}  // namespace

ViewMatches match_views(const DecodedView& left, const DecodedView& right, int projector_width, int projector_height,
                        Stride stride, bool one_camera) {
    std::optional<CorrespondenceIndex> in_left, in_right;
    tbb::parallel_invoke([&] { in_right.emplace(right, projector_width, projector_height); },
                         [&] {
                             if (one_camera) in_left.emplace(left, projector_width, projector_height);
                         });
    ViewMatches matches;
    matches.stride = stride;
    Seen seen(right, stride);
    const auto lines =
        for_lines(left, stride.y, [&](int y, Line& line) { match_line(left, *in_right, y, stride.x, seen, line); });
    join(lines, &Line::both, matches.both);
    join(lines, &Line::alone, matches.left_only);
    for (const Line& line : lines) matches.ragged += line.ragged;
    if (!one_camera) return matches;
    const auto right_lines = for_lines(
        right, stride.y, [&](int y, Line& line) { match_right_line(right, *in_left, y, stride.x, seen, line); });
    join(right_lines, &Line::alone, matches.right_only);
    return matches;
}

}  // namespace planlight
