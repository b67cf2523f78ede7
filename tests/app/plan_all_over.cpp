#include "tests/app/plan_all_over.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kStep_mm = 26, kReach_mm = 80, kSteepest_deg = 74;

class OverASide {
public:
    OverASide(const SkinSurface& skin, const Vector3d& towards) : skin_(skin), out_(towards.normalized()) {
        Vector3d low = skin.mesh().vertices_in_ct.front(), high = low;
        for (const Vector3d& v : skin.mesh().vertices_in_ct) low = low.cwiseMin(v), high = high.cwiseMax(v);
        middle_ = (low + high) / 2;
        across_ = out_.unitOrthogonal();
        up_ = out_.cross(across_);
    }
    /// The skin met by a straight way from outside, beside the middle by (across, up).
    std::optional<SkinSurface::Point> at(double across_mm, double up_mm) const {
        const auto hit = skin_.first_hit({middle_ + 400 * out_ + across_mm * across_ + up_mm * up_, -out_});
        if (!hit || !skin_.real_skin(*hit)) return std::nullopt;
        if (hit->normal_in_ct.dot(out_) < std::cos(kSteepest_deg * M_PI / 180)) return std::nullopt;
        if ((hit->p_in_ct - middle_).dot(out_) < -10) return std::nullopt;
        return hit;
    }
    const Vector3d& out() const { return out_; }
    const Vector3d& across() const { return across_; }
    const Vector3d& up() const { return up_; }

private:
    const SkinSurface& skin_;
    Vector3d out_, middle_, across_, up_;
};

void add_item(Plan& plan, const SkinSurface::Point& p, int number, const Vector3d& aside) {
    const Vector3d leaning = (-p.normal_in_ct + 0.35 * aside).normalized();
    switch (number % 4) {
        case 0:
            plan.boreholes.push_back({fmt::format("H{}", number), p.p_in_ct, {}, 7, 6, {}});
            break;
        case 1:
            plan.boreholes.push_back({fmt::format("A{}", number), p.p_in_ct, leaning, 14, 6, {}});
            break;
        case 2:
            plan.trajectories.push_back(
                {fmt::format("T{}", number), p.p_in_ct, Vector3d(p.p_in_ct + 40 * leaning), 8, {}});
            break;
        default:
            plan.boreholes.push_back({fmt::format("W{}", number), p.p_in_ct, {}, 14, 6, {}});
    }
}

/// Pieces of a line at one height: where the skin is missed, or jumps, it ends.
void add_lines(Plan& plan, const OverASide& side, double up_mm) {
    OsteotomyLine line;
    const auto end = [&] {
        if (line.points_in_ct.size() > 3) {
            line.name = fmt::format("L{}", plan.osteotomy_lines.size());
            plan.osteotomy_lines.push_back(line);
        }
        line.points_in_ct.clear();
    };
    for (double across_mm = -kReach_mm; across_mm <= kReach_mm; across_mm += 4) {
        const auto p = side.at(across_mm, up_mm);
        if (!p || (!line.points_in_ct.empty() && (p->p_in_ct - line.points_in_ct.back()).norm() > 14)) end();
        if (p) line.points_in_ct.push_back(p->p_in_ct);
    }
    end();
}

}  // namespace

Plan plan_all_over(const SkinSurface& skin, const Vector3d& towards) {
    const OverASide side(skin, towards);
    Plan plan;
    int number = 0;
    for (double up_mm = -kReach_mm; up_mm <= kReach_mm; up_mm += kStep_mm) {
        for (double across_mm = -kReach_mm; across_mm <= kReach_mm; across_mm += kStep_mm)
            if (const auto p = side.at(across_mm, up_mm)) add_item(plan, *p, number++, side.across());
        add_lines(plan, side, up_mm + kStep_mm / 2);
    }
    if (const auto p = side.at(0, 0))
        plan.cut_planes.push_back(
            {"C", p->p_in_ct, (side.up() + 0.3 * side.across()).normalized(), side.out(), 160, 160, {}});
    if (!plan.cut_planes.empty()) {  // the first axis in the plane
        CutPlane& c = plan.cut_planes.front();
        c.first_axis_in_ct = (side.out() - side.out().dot(c.normal_in_ct) * c.normal_in_ct).normalized();
    }
    return plan;
}

}  // namespace planlight::test
