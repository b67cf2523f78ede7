#include "projection/check_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "planning_io/types/error.h"
#include "projection/check_items.h"
#include "projection/mid_plane.h"
#include "projection/plan_alternatives.h"
#include "projection/plan_sides.h"
#include "projection/skin_points.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kFinestFit_mm = 0.2;  // of any plan on a skin of triangles

std::vector<Vector3d> all_points(const Trajectory& t) {
    return {t.entry_in_ct, t.target_in_ct};
}
std::vector<Vector3d> all_points(const CutPlane& c) {
    return {c.origin_in_ct};
}
template <class Item>
std::vector<Vector3d> all_points(const Item& item) {
    return skin_points(item);
}

class PlanChecker {
public:
    PlanChecker(const SkinSurface& skin, const std::optional<VolumeBox>& volume, const PlanCheckSettings& settings)
        : skin_(skin), volume_(volume), settings_(settings) {
        drawing_.max_distance_to_skin_mm = settings.near_skin_mm;
    }

    template <class Item>
    void look_at(const Item& item) {
        ++items_;
        if (!item.name.empty()) ++names_[item.name];
        const auto some = faults(item, skin_, drawing_);
        verdict_.warnings.insert(verdict_.warnings.end(), some.begin(), some.end());
        if (!finite(item)) {
            stop(item.name, "its numbers are not finite");
            ++far_items_;
            return;
        }
        check_in_volume(item.name, all_points(item));
        check_near_skin(item.name, skin_points(item));
        note_on_surface(item);
        check_side(item.name, all_points(item));
        check_own(item);
        check_place(item);
    }

    void look_at(const RiskStructure& structure) {
        const auto& points = structure.surface.vertices_in_ct;
        if (!structure.name.empty()) ++structures_[structure.name];
        if (points.empty()) return stop(structure.name, "the risk structure has no surface");
        check_cut_off(structure.name, points);
        check_side(structure.name, points);
        check_in_body(structure.name, points);
    }

    PlanVerdict verdict() {
        for (const auto& [name, count] : structures_)
            if (count > 1)
                verdict_.warnings.push_back(fmt::format("{}: {} risk structures have this name", name, count));
        for (const auto& [name, count] : names_)
            if (count > 1) verdict_.warnings.push_back(fmt::format("{}: {} items have this name", name, count));
        if (items_ == 0) verdict_.warnings.push_back("the plan is empty");
        if (!points_.empty()) verdict_.median_to_skin_mm = distance_quantile(points_, skin_, 0.5);
        if (items_ > 0) verdict_.share_far = static_cast<double>(far_items_) / items_;
        constexpr int kFew = 4;  // of two items one may lie anywhere
        if (items_ > 0 && (verdict_.share_far > settings_.max_share_far ||
                           (items_ >= kFew && verdict_.share_far == settings_.max_share_far)))
            verdict_.stops.push_back(fmt::format(
                "{} of {} items lie more than {:.0f} mm from the skin{}", far_items_, items_, settings_.near_skin_mm,
                points_.empty() ? "" : fmt::format(" (median of all points {:.1f} mm)", verdict_.median_to_skin_mm)));
        check_in_air("lines and boreholes", surface_points_, settings_.in_air_mm);
        check_in_air("entries", entries_, std::numeric_limits<double>::infinity());
        check_alternatives();
        check_other_space();
        check_under_something();
        return std::move(verdict_);
    }

private:
    template <typename... Args>
    void stop(const std::string& name, fmt::format_string<Args...> text, Args&&... args) {
        verdict_.stops.push_back((name.empty() ? "an item without a name" : name) + ": " +
                                 fmt::format(text, std::forward<Args>(args)...));
    }
    double to_skin_mm(const Vector3d& p) const { return (skin_.nearest(p).p_in_ct - p).norm(); }

    void check_in_volume(const std::string& name, const std::vector<Vector3d>& points) {
        if (!volume_) return;
        double out_mm = 0;
        Vector3d worst = Vector3d::Zero();
        for (const auto& p : points)
            if (const double beyond = outside_mm(p); beyond > out_mm) out_mm = beyond, worst = p;
        if (out_mm > settings_.outside_volume_mm) {
            verdict_.outside_volume = true;
            stop(name, "its point ({:.0f}, {:.0f}, {:.0f}) lies {:.0f} mm outside the volume", worst.x(), worst.y(),
                 worst.z(), out_mm);
        }
    }

    /// How far a point lies outside the box of voxel centres, mm; 0 within.
    double outside_mm(const Vector3d& p) const {
        const Vector3d v = volume_->ct_from_voxel.inverse() * p,
                       spacing = volume_->ct_from_voxel.linear().colwise().norm().transpose();
        double out_mm = 0;
        for (int axis = 0; axis < 3; ++axis)
            out_mm =
                std::max(out_mm, std::max(-v[axis], v[axis] - (volume_->size[static_cast<std::size_t>(axis)] - 1)) *
                                     spacing[axis]);
        return out_mm;
    }

    void check_cut_off(const std::string& name, const std::vector<Vector3d>& points) {
        if (!volume_) return;
        const auto out = static_cast<double>(std::count_if(points.begin(), points.end(), [&](const Vector3d& p) {
            return outside_mm(p) > settings_.outside_volume_mm;
        }));
        const double share = out / static_cast<double>(points.size());
        if (share > settings_.structure_cut) {
            verdict_.outside_volume = true;
            stop(name, "{:.0f} % of the risk structure lies outside the volume", 100 * share);
        } else if (share > 0)
            verdict_.warnings.push_back(name + ": a part of the risk structure lies outside the volume");
    }

    /// Of some of its points: each asks the whole skin.
    void check_in_body(const std::string& name, const std::vector<Vector3d>& points) {
        constexpr std::size_t kSome = 400;
        const std::size_t step = 1 + points.size() / kSome;
        double outside = 0, all = 0, least_mm = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < points.size(); i += step, ++all) {
            const bool in = in_the_body(skin_, points[i]);
            least_mm = std::min(least_mm, in ? 0 : to_skin_mm(points[i]));
            outside += !in && to_skin_mm(points[i]) > 1;
        }
        if (least_mm > settings_.above_skin_mm)
            stop(name, "the risk structure lies wholly outside the body, {:.1f} mm from the skin at least", least_mm);
        else if (outside > settings_.structure_outside * all)
            verdict_.warnings.push_back(
                fmt::format("{}: {:.0f} % of the risk structure lies outside the body", name, 100 * outside / all));
    }

    void check_near_skin(const std::string& name, const std::vector<Vector3d>& points) {
        double far_mm = 0;
        const Vector3d* farthest = nullptr;
        for (const auto& p : points)
            if (const double mm = to_skin_mm(p); mm >= far_mm) far_mm = mm, farthest = &p;
        points_.insert(points_.end(), points.begin(), points.end());
        if (far_mm > settings_.near_skin_mm) ++far_items_;
        if (farthest) depths_.emplace_back(name, in_the_body(skin_, *farthest) ? far_mm : 0);
        if (far_mm > settings_.too_far_mm)
            stop(name, "it is {:.1f} mm from the skin, too far to be drawn (at most {:.0f} mm)", far_mm,
                 settings_.too_far_mm);
    }

    void note_on_surface(const Trajectory& t) { entries_.push_back(t.entry_in_ct); }
    void note_on_surface(const CutPlane&) {}
    template <class Item>
    void note_on_surface(const Item& item) {
        const std::vector<Vector3d> points = skin_points(item);
        surface_points_.insert(surface_points_.end(), points.begin(), points.end());
    }

    /// Plans are made on skin or bone, and entries of some programs a little before it. Where nearly all lie in the air
    /// the plan is of another scan or in another frame, or the skin is not all there.
    void check_in_air(const char* what, const std::vector<Vector3d>& points, double stopped_from_mm) {
        constexpr std::size_t kFew = 3, kSome = 100;
        constexpr double kNearlyAll = 0.9;
        if (points.size() < kFew) return;
        std::vector<double> over_mm;
        std::size_t all = 0;
        for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / kSome, ++all)
            if (const double mm = to_skin_mm(points[i]); mm > settings_.above_skin_mm && !in_the_body(skin_, points[i]))
                over_mm.push_back(mm);
        if (static_cast<double>(over_mm.size()) < kNearlyAll * static_cast<double>(all)) return;
        const auto middle = over_mm.begin() + static_cast<std::ptrdiff_t>(over_mm.size() / 2);
        std::nth_element(over_mm.begin(), middle, over_mm.end());
        const std::string said =
            fmt::format("the plan's {} lie in the air, a median of {:.1f} mm over the skin", what, *middle);
        (*middle > stopped_from_mm ? verdict_.stops : verdict_.warnings).push_back(said);
    }

    /// Where it would be drawn there is skin, and that on its axis. What is far, or points out, has been stopped.
    template <class Item>
    void check_place(const Item& item) {
        for (const Vector3d& p : skin_points(item))
            if (to_skin_mm(p) > settings_.too_far_mm) return;
        if (points_out(item)) return;
        if (const auto why = no_place_of(item, skin_)) stop(item.name, "{}", *why);
    }
    void check_place(const CutPlane&) {}
    template <class Item>
    bool points_out(const Item&) const {
        return false;
    }
    bool points_out(const Borehole& b) const {
        constexpr double kGrazes = 0.2;
        return b.axis_in_ct && b.axis_in_ct->dot(skin_.nearest(b.position_in_ct).normal_in_ct) > kGrazes;
    }

    void check_side(const std::string& name, const std::vector<Vector3d>& points) {
        const auto claimed = side_named(name);
        if (!claimed || points.empty()) return;
        if (!looked_for_mid_plane_) {
            mid_plane_ = find_mid_plane(skin_);
            looked_for_mid_plane_ = true;
            if (!mid_plane_)
                verdict_.warnings.push_back(
                    "the middle of the head was not found: sides in names could not be checked");
        }
        if (!mid_plane_) return;
        double left_mm = 0;  // of the item's first point (an entry), or of the middle of a line
        for (const auto& p : points) left_mm += mid_plane_->left_mm(p) / static_cast<double>(points.size());
        const double wrong_mm = *claimed == Side::left ? -left_mm : left_mm;
        if (wrong_mm > settings_.side_margin_mm)
            stop(name, "it is named {} and lies {:.0f} mm {} of the middle of the head",
                 *claimed == Side::left ? "left" : "right", wrong_mm, *claimed == Side::left ? "right" : "left");
    }

    void check_own(const Trajectory& t) {
        const double entry_mm = to_skin_mm(t.entry_in_ct), target_mm = to_skin_mm(t.target_in_ct);
        const bool target_inside = in_the_body(skin_, t.target_in_ct);
        if (t.length_mm() < 1) return stop(t.name, "entry and target are only {:.2f} mm apart", t.length_mm());
        if (entry_mm > settings_.near_skin_mm && in_the_body(skin_, t.entry_in_ct) &&
            (target_mm < settings_.near_skin_mm || !target_inside))
            return stop(
                t.name,
                "entry and target are swapped: the entry lies {:.1f} mm under the skin, the target {:.1f} mm from it",
                entry_mm, target_mm);
        if (!target_inside && target_mm > 1)
            stop(t.name, "its target lies outside the body, {:.1f} mm from the skin", target_mm);
        if (t.length_mm() > settings_.max_depth_mm)
            stop(t.name, "it is {:.0f} mm deep (at most {:.0f} mm)", t.length_mm(), settings_.max_depth_mm);
    }
    void check_own(const Borehole& b) {
        if (b.depth_mm > settings_.max_depth_mm)
            stop(b.name, "it is {:.0f} mm deep (at most {:.0f} mm)", b.depth_mm, settings_.max_depth_mm);
        if (points_out(b)) stop(b.name, "its axis points out of the body");
    }
    void check_own(const OsteotomyLine&) {}
    void check_own(const CutPlane& c) {
        if (!is_plane(c) || trace(skin_, c, drawing_.max_segment_mm).empty()) ++far_items_;
    }

    /// A plan whose axes were exchanged or flipped fits the skin when they are put right again.
    void check_alternatives() {
        if (points_.empty()) return;
        Vector3d low = skin_.mesh().vertices_in_ct.front(), high = low;
        for (const auto& p : skin_.mesh().vertices_in_ct) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        Vector3d centre = (low + high) / 2;
        if (volume_)
            centre = volume_->ct_from_voxel *
                     (Vector3d(volume_->size[0] - 1, volume_->size[1] - 1, volume_->size[2] - 1) / 2);
        const auto fits = [&](const std::optional<Alternative>& other) {
            return other && other->fit_mm <= settings_.turned_fit_mm &&
                   verdict_.median_to_skin_mm >= settings_.turned_gain * std::max(other->fit_mm, kFinestFit_mm);
        };
        if (const auto half_turn = half_turned(points_, skin_); fits(half_turn)) {
            verdict_.stops.push_back(turned_words(*half_turn, "are"));
        } else if (const auto other = best_alternative(points_, skin_, centre); fits(other)) {
            if (small_and_even(points_, skin_))
                verdict_.warnings.push_back(
                    turned_words(*other, "may be") +
                    ", unless it was planned on the bone: a small plan fits somewhere by chance");
            else
                verdict_.stops.push_back(turned_words(*other, "are"));
        }
    }
    std::string turned_words(const Alternative& other, const char* are) const {
        return fmt::format(
            "the plan lies a median of {:.1f} mm off the skin; with {} it would lie within {:.1f} mm: its axes {} "
            "exchanged or flipped",
            verdict_.median_to_skin_mm, other.words, other.fit_mm, are);
    }

    /// A few places come to lie evenly by chance; more do not.
    void check_other_space() {
        constexpr std::size_t kMany = 5;
        const auto other = fits_in_other_space(points_, skin_);
        if (!other) return;
        const std::string said = fmt::format(
            "the plan lies {:.1f} to {:.1f} mm under the skin (negative: over it); with (x, y, z) read as (-x, -y, z) "
            "all of it would lie {:.1f} to {:.1f} mm under it, on the other side of the head: its coordinate system "
            "seems to be the other one of LPS and RAS",
            other->as_given.least_mm, other->as_given.most_mm, other->turned.least_mm, other->turned.most_mm);
        (other->places >= kMany ? verdict_.stops : verdict_.warnings).push_back(said);
    }

    /// Most of the plan on the skin, an item deep under it: something lies on the skin there, or it was planned on
    /// bone.
    void check_under_something() {
        constexpr double kOnSkin_mm = 2.5, kUnder_mm = 5, kMost = 0.6;
        constexpr std::size_t kFewest = 3;
        if (depths_.size() < kFewest || !settings_.on_skin) return;
        double on_skin = 0;
        for (const auto& [name, depth_mm] : depths_) on_skin += depth_mm < kOnSkin_mm;
        if (on_skin < kMost * static_cast<double>(depths_.size())) return;
        for (const auto& [name, depth_mm] : depths_)
            if (depth_mm > kUnder_mm && depth_mm <= settings_.near_skin_mm)
                verdict_.warnings.push_back(fmt::format(
                    "{}: it lies {:.1f} mm under the skin, most of the plan within {:.1f} mm of it: unless it was "
                    "planned on the bone, something lies on the skin there (a dressing, a pad, a marker), and the "
                    "light is not drawn where it belongs",
                    name.empty() ? "an item without a name" : name, depth_mm, kOnSkin_mm));
    }

    const SkinSurface& skin_;
    const std::optional<VolumeBox>& volume_;
    const PlanCheckSettings& settings_;
    DrawingSettings drawing_;
    PlanVerdict verdict_;
    int items_ = 0, far_items_ = 0;
    std::map<std::string, int> names_, structures_;
    std::vector<std::pair<std::string, double>> depths_;  ///< of each item, the deepest of its points, mm
    std::vector<Vector3d> points_;
    std::vector<Vector3d> surface_points_, entries_;  ///< of lines and boreholes; of trajectories
    std::optional<MidPlane> mid_plane_;
    bool looked_for_mid_plane_ = false;
};

}  // namespace

PlanVerdict check_plan(const Plan& plan, const SkinSurface& skin, const std::optional<VolumeBox>& volume,
                       const PlanCheckSettings& settings) {
    PlanChecker checker(skin, volume, settings);
    for (const auto& o : plan.osteotomy_lines) checker.look_at(o);
    for (const auto& b : plan.boreholes) checker.look_at(b);
    for (const auto& t : plan.trajectories) checker.look_at(t);
    for (const auto& c : plan.cut_planes) checker.look_at(c);
    for (const auto& structure : plan.risk_structures) checker.look_at(structure);
    return checker.verdict();
}

void refuse_stopped_plan(const PlanVerdict& verdict) {
    if (verdict.stops.empty()) return;
    constexpr std::size_t kMostSaid = 4;
    std::string said;
    for (std::size_t i = 0; i < std::min(kMostSaid, verdict.stops.size()); ++i)
        said += (i > 0 ? "; " : "") + verdict.stops[i];
    if (verdict.stops.size() > kMostSaid) said += fmt::format("; and {} more", verdict.stops.size() - kMostSaid);
    throw InputError(
        {}, "The plan does not fit this patient: " + said,
        "Check that it was made on this CT, its coordinate system and its units; a plan on bone is projected on the "
        "bone (`planlight prepare --surface`).");
}

}  // namespace planlight
