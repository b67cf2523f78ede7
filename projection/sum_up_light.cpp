#include "projection/sum_up_light.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"

namespace planlight {

using Eigen::Matrix3d;
using Eigen::Vector3d;

bool side_by_side(const SeenSegment& a, const SeenSegment& b, std::size_t step, const CheckLightSettings& settings) {
    constexpr double kTogether = 2.2, kSameWay = 0.7;  // of a dashed line each dash is a stretch, 10 mm from the next
    return !a.tick && !b.tick && a.item == b.item && a.sideways_in_ct.dot(b.sideways_in_ct) > kSameWay &&
           (a.p_in_ct - b.p_in_ct).norm() < kTogether * settings.segment_mm * static_cast<double>(step);
}

namespace {

/// The shift along the skin that explains an item's segments best: least squares over their sides, with Huber weights.
void find_shift(const std::vector<const SeenSegment*>& seen, ItemLight& item) {
    constexpr int kRounds = 5;
    constexpr double kHuber = 1.5, kToldShare = 0.1;
    Vector3d shift = Vector3d::Zero();
    Matrix3d information = Matrix3d::Zero(), inverse = Matrix3d::Zero();
    for (int round = 0; round < kRounds; ++round) {
        information.setZero();
        Vector3d right = Vector3d::Zero();
        for (const SeenSegment* s : seen) {
            const double off = (s->off_mm - s->sideways_in_ct.dot(shift)) / s->sigma_mm;
            const double w =
                (round == 0 || std::abs(off) < kHuber ? 1 : kHuber / std::abs(off)) / std::pow(s->sigma_mm, 2);
            information += w * s->sideways_in_ct * s->sideways_in_ct.transpose();
            right += w * s->off_mm * s->sideways_in_ct;
        }
        // Only in the directions that the sides tell: a straight line tells one, a circle two.
        const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(information);
        inverse.setZero();
        int told = 0;
        for (int k = 0; k < 3; ++k) {
            if (axes.eigenvalues()[k] < kToldShare * axes.eigenvalues()[2]) continue;
            inverse += axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose() / axes.eigenvalues()[k];
            ++told;
        }
        item.one_direction_only = told < 2;
        shift = inverse * right;
    }
    item.shift_in_ct = shift;
    item.off_mm = shift.norm();
    const Vector3d way = item.off_mm > 1e-6 ? Vector3d(shift / item.off_mm) : seen.front()->sideways_in_ct;
    item.sigma_mm = std::sqrt(way.dot(inverse * way));
}

/// Two directions along the skin are told when the sides of what was seen span them.
bool tells_whole(const std::vector<SeenSegment>& segments) {
    constexpr double kTold = 0.05;  // of the best told direction's weight
    constexpr int kLeast = 3;
    Matrix3d sides = Matrix3d::Zero();
    int seen = 0;
    for (const SeenSegment& s : segments) {
        if (!s.seen) continue;
        sides += s.sideways_in_ct * s.sideways_in_ct.transpose();
        ++seen;
    }
    const auto axes = Eigen::SelfAdjointEigenSolver<Matrix3d>(sides, Eigen::EigenvaluesOnly).eigenvalues();
    return seen >= kLeast && axes[1] > kTold * axes[2] && axes[1] > 1;
}

void sum_up(LightCheck& check) {
    std::vector<double> sizes, sigmas, backgrounds, brighter;
    for (const SeenSegment& s : check.segments) {
        if (s.background > 0) backgrounds.push_back(s.background);
        if (!s.tick || s.seen) ++check.expected;
        if (!s.seen) continue;
        if (!s.tick) ++check.lit_seen;
        sizes.push_back(std::abs(s.off_mm));
        sigmas.push_back(s.sigma_mm);
        brighter.push_back(s.brighter);
    }
    check.fainter = quantile(brighter, 0.2);
    check.brighter = quantile(std::move(brighter), 0.9);
    check.seen = static_cast<int>(sizes.size());
    check.off_mm = quantile(sizes, 0.95);
    check.most_mm = quantile(sizes, 2.0 / 3);
    check.median_mm = median(std::move(sizes));
    check.sigma_mm = median(std::move(sigmas));
    check.background = median(std::move(backgrounds));
    check.told_whole = tells_whole(check.segments);
}

/// Of an item's stretches, in their order. Beside one that lies aside another may lie so far aside that it is not
/// found.
double part_off_mm(const std::vector<const SeenSegment*>& stretches, std::size_t step,
                   const CheckLightSettings& settings) {
    double most_mm = 0;
    for (std::size_t k = 1; k < stretches.size(); ++k) {
        const SeenSegment &a = *stretches[k - 1], &b = *stretches[k];
        if (!side_by_side(a, b, step, settings) || (a.seen && b.seen && a.off_mm * b.off_mm < 0)) continue;
        const double off_a = std::abs(a.off_mm), off_b = std::abs(b.off_mm);  // 0 where it is not seen
        most_mm = std::max(most_mm, a.seen && b.seen ? std::min(off_a, off_b) : std::max(off_a, off_b));
    }
    return most_mm;
}

void sum_up_items(LightCheck& check, std::size_t step, const CheckLightSettings& settings) {
    for (std::size_t i = 0; i < check.items.size(); ++i) {
        std::vector<const SeenSegment*> seen, stretches;
        for (const SeenSegment& s : check.segments) {
            if (s.item != static_cast<int>(i)) continue;
            if (!s.tick) stretches.push_back(&s);
            if (!s.tick || s.seen) ++check.items[i].segments;
            if (s.seen) seen.push_back(&s);
        }
        check.items[i].seen = static_cast<int>(seen.size());
        if (!seen.empty()) find_shift(seen, check.items[i]);
        check.items[i].part_off_mm = part_off_mm(stretches, step, settings);
    }
}

}  // namespace

void sum_up_light(std::size_t step, const CheckLightSettings& settings, LightCheck& check) {
    sum_up_items(check, step, settings);
    std::erase_if(check.segments,
                  [&](const SeenSegment& s) { return check.items[static_cast<std::size_t>(s.item)].dim; });
    sum_up(check);
}

}  // namespace planlight
