#include "projection/figure_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_io/types/statistics.h"
#include "projection/bilinear.h"
#include "projection/biquadratic.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMostRadius_mm = 8;
constexpr double kRim_mm = 1.5;      // of the pattern about the figure
constexpr double kBlur_mm = 0.3;     // sigma of a stroke's edge in a camera's picture
constexpr double kLetters_mm = 0.8;  // about the outlines of a label's letters

double distance_to(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
    const Vector2d way = b - a;
    const double share = std::clamp((p - a).dot(way) / std::max(way.squaredNorm(), 1e-12), 0.0, 1.0);
    return (p - a - share * way).norm();
}

/// A stroke's brightness at a distance from its middle line.
double lit_at(double distance_mm, double width_mm) {
    const auto edge = [](double mm) { return std::erf(mm / (std::numbers::sqrt2 * kBlur_mm)); };
    return (edge(width_mm / 2 - distance_mm) + edge(width_mm / 2 + distance_mm)) / 2;
}

/// A drawing about one of its items, flattened onto the skin's plane there.
class Flattened {
public:
    Flattened(const StrokePlace& frame, double half_mm)
        : frame_(frame), half_mm_(half_mm), size_(2 * static_cast<int>(half_mm / kPatchStep_mm) + 1) {
        light_.assign(static_cast<std::size_t>(size_ * size_), 0);
        weight_.assign(light_.size(), 1);
    }

    void draw(const Stroke& stroke) {
        double way_mm = 0;
        const std::size_t n = stroke.points_in_ct.size();
        for (std::size_t i = 0; i + 1 < n + (stroke.closed ? 1 : 0); ++i) {
            const Vector3d &a = stroke.points_in_ct[i], &b = stroke.points_in_ct[(i + 1) % n];
            const double length_mm = (b - a).norm();
            if (near(a) && !stroke.in_gap(way_mm + length_mm / 2))
                each_cell(flat(a), flat(b), 3 * kBlur_mm + stroke.width_mm / 2, [&](float& light, float&, double mm) {
                    light = std::max(light, static_cast<float>(lit_at(mm, stroke.width_mm)));
                });
            way_mm += length_mm;
        }
    }
    void leave_out(const std::vector<Vector3d>& line, double within_mm) {
        for (std::size_t i = 0; i + 1 < line.size(); ++i)
            if (near(line[i]))
                each_cell(flat(line[i]), flat(line[i + 1]), within_mm,
                          [](float&, float& weight, double) { weight = 0; });
    }
    double lit_share_kept() const {
        double kept = 0, all = 0;
        for (std::size_t k = 0; k < light_.size(); ++k) {
            all += light_[k];
            kept += light_[k] * weight_[k];
        }
        return all > 0 ? kept / all : 0;
    }
    void into(FigurePatch& patch) {
        patch.size = size_;
        patch.light = std::move(light_);
        patch.weight = std::move(weight_);
    }

private:
    bool near(const Vector3d& p) const { return (p - frame_.p_in_ct).squaredNorm() < 9 * half_mm_ * half_mm_; }
    Vector2d flat(const Vector3d& p) const {
        return {(p - frame_.p_in_ct).dot(frame_.along_in_ct), (p - frame_.p_in_ct).dot(frame_.sideways_in_ct)};
    }
    template <class Visit>
    void each_cell(const Vector2d& a, const Vector2d& b, double within_mm, Visit visit) {
        const int half = size_ / 2;
        const auto cell = [&](double mm) {
            return std::clamp(static_cast<int>(mm / kPatchStep_mm) + half, 0, size_ - 1);
        };
        const Vector2d low = a.cwiseMin(b).array() - within_mm - kPatchStep_mm,
                       high = a.cwiseMax(b).array() + within_mm + kPatchStep_mm;
        for (int y = cell(low.y()); y <= cell(high.y()); ++y)
            for (int x = cell(low.x()); x <= cell(high.x()); ++x) {
                const double mm = distance_to(kPatchStep_mm * Vector2d(x - half, y - half), a, b);
                const auto k = static_cast<std::size_t>(y * size_ + x);
                if (mm <= within_mm) visit(light_[k], weight_[k], mm);
            }
    }

    const StrokePlace& frame_;
    double half_mm_;
    int size_;
    std::vector<float> light_, weight_;
};

/// The middle of an item's figure and how far its strokes reach from there; empty when nothing is drawn of it.
struct Figure {
    SkinSurface::Point middle;
    double radius_mm = 0, width_mm = 0;
};

std::optional<Figure> figure_of(const PlanDrawing& drawing, const SkinSurface& skin, int item) {
    Vector3d low = Vector3d::Constant(1e9), high = -low;
    double width_mm = 0;
    const auto own = [&](const Stroke& s) { return s.item == item && s.kind != StrokeKind::label; };
    for (const Stroke& stroke : drawing.strokes) {
        if (!own(stroke)) continue;
        width_mm = std::max(width_mm, stroke.width_mm);
        for (const Vector3d& p : stroke.points_in_ct) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    }
    if (width_mm == 0 || (high - low).norm() > 4 * kMostRadius_mm) return std::nullopt;
    Figure figure{skin.nearest((low + high) / 2), 0, width_mm};
    for (const Stroke& stroke : drawing.strokes)
        if (own(stroke))
            for (const Vector3d& p : stroke.points_in_ct)
                figure.radius_mm = std::max(figure.radius_mm, (p - figure.middle.p_in_ct).norm());
    return figure;
}

StrokeSegment one_place(int item, const StrokePlace& place, double search_mm) {
    return {item, false, {place}, search_mm};
}

/// An item's strokes in pieces (a small ring whole) whose sideways is away from the figure's middle.
std::vector<StrokeSegment> outline_of(const PlanDrawing& drawing, int item, const Vector3d& middle_in_ct,
                                      bool small_ring, const CheckLightSettings& settings) {
    const std::size_t most = small_ring ? 1000 : 3;
    std::vector<StrokeSegment> outline;
    for (const Stroke& stroke : drawing.strokes) {
        if (stroke.item != item || stroke.kind == StrokeKind::label) continue;
        StrokeSegment piece{item, false, {}, settings.search_mm};
        for (StrokePlace place : places_along(stroke, settings.spacing_mm)) {
            if (!place.lit) continue;
            if ((place.p_in_ct - middle_in_ct).dot(place.sideways_in_ct) < 0) {
                place.sideways_in_ct *= -1;
                place.along_in_ct *= -1;
            }
            piece.places.push_back(place);
            if (piece.places.size() < most) continue;
            outline.push_back(piece);
            piece.places.clear();
        }
        if (small_ring && piece.places.size() >= 3) outline.push_back(piece);
    }
    return outline;
}

std::optional<FigurePatch> patch_of(const PlanDrawing& drawing, const SkinSurface& skin, int item, bool alone,
                                    const CheckLightSettings& settings) {
    constexpr double kLeastKept = 0.5;
    const auto figure = figure_of(drawing, skin, item);
    if (!figure || figure->radius_mm > kMostRadius_mm || !skin.real_skin(figure->middle)) return std::nullopt;
    StrokePlace place;
    place.p_in_ct = figure->middle.p_in_ct;
    place.normal_in_ct = skin.mean_normal(figure->middle, std::max(2.0, figure->radius_mm));
    place.along_in_ct = place.normal_in_ct.unitOrthogonal();
    place.sideways_in_ct = place.normal_in_ct.cross(place.along_in_ct);
    place.width_mm = figure->width_mm;
    StrokePlace turned = place;
    turned.along_in_ct = place.sideways_in_ct;
    turned.sideways_in_ct = place.along_in_ct;

    FigurePatch patch;
    patch.item = item;
    patch.sides = {one_place(item, turned, settings.search_mm), one_place(item, place, settings.search_mm)};
    patch.half_mm = figure->radius_mm + kRim_mm;
    patch.small_ring = figure->radius_mm < 3;
    patch.outline = outline_of(drawing, item, place.p_in_ct, patch.small_ring, settings);
    Flattened flat(place, patch.half_mm);
    for (const Stroke& stroke : drawing.strokes) {
        if (stroke.item == item)
            flat.draw(stroke);
        else if (alone)
            flat.leave_out(stroke.points_in_ct, stroke.width_mm + kBlur_mm);
        else
            flat.draw(stroke);
    }
    for (const Label& label : drawing.labels) {
        for (const Label::Outlines& sign : label.signs_in_ct)
            for (const auto& outline : sign) flat.leave_out(outline, kLetters_mm);
        flat.leave_out(label.leader.points_in_ct, kLetters_mm);
    }
    if (flat.lit_share_kept() < kLeastKept) return std::nullopt;
    flat.into(patch);

    const double reach_mm = patch.half_mm + settings.search_mm;
    const auto on_skin = [&](double u, double v) {
        const SkinSurface::Point at =
            skin.nearest(place.p_in_ct + reach_mm * (u * place.along_in_ct + v * place.sideways_in_ct));
        return at.p_in_ct;
    };
    for (int k = 0; k < 9; ++k) patch.skin_in_ct[static_cast<std::size_t>(k)] = on_skin(k % 3 - 1, k / 3 - 1);
    patch.extent = one_place(item, place, settings.search_mm);
    for (const double end_mm : {-figure->radius_mm, 0.0, figure->radius_mm}) {
        StrokePlace at = place;
        at.p_in_ct = skin.nearest(place.p_in_ct + end_mm * place.along_in_ct).p_in_ct;
        patch.extent.places.push_back(at);
    }
    patch.extent.places.erase(patch.extent.places.begin());
    return patch;
}

/// The picture about the figure, on the pattern's cells and `search` cells more to all sides; empty where it reaches
/// out of the picture.
std::vector<float> seen_about(const FigurePatch& patch, int search, const CameraModel& camera,
                              const RigidTransform& rig_from_ct, const GrayImage& picture, double reach_mm) {
    std::array<Vector2d, 9> pixels;
    for (std::size_t k = 0; k < 9; ++k) {
        const auto pixel = project(camera, rig_from_ct * patch.skin_in_ct[k]);
        if (!pixel) return {};
        pixels[k] = *pixel;
    }
    const int size = patch.size + 2 * search;
    std::vector<float> seen;
    seen.reserve(static_cast<std::size_t>(size * size));
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const auto grey = bilinear(picture, biquadratic(pixels, (x - size / 2) * kPatchStep_mm / reach_mm,
                                                            (y - size / 2) * kPatchStep_mm / reach_mm));
            if (!grey) return {};
            seen.push_back(static_cast<float>(*grey));
        }
    return seen;
}

/// The pattern against the picture at one shift: correlation, brightness of a stroke, and what is left.
struct Fit {
    double correlation = -1, stroke_grey = 0, skin_grey = 0, left_grey = 0;
};

Fit fit_at(const FigurePatch& patch, const std::vector<float>& seen, int search, int dx, int dy, int stride) {
    const int size = patch.size + 2 * search;
    double w = 0, t = 0, s = 0, tt = 0, ts = 0, ss = 0;
    for (int y = 0; y < patch.size; y += stride)
        for (int x = 0; x < patch.size; x += stride) {
            const auto k = static_cast<std::size_t>(y * patch.size + x);
            const double weight = patch.weight[k], light = patch.light[k];
            const double grey = seen[static_cast<std::size_t>((y + search + dy) * size + x + search + dx)];
            w += weight;
            t += weight * light;
            s += weight * grey;
            tt += weight * light * light;
            ts += weight * light * grey;
            ss += weight * grey * grey;
        }
    if (!(w > 0)) return {};
    const double vt = tt - t * t / w, vs = ss - s * s / w, c = ts - t * s / w;
    if (!(vt > 0) || !(vs > 0)) return {};
    const double slope = c / vt;
    return {c / std::sqrt(vt * vs), slope, (s - slope * t) / w, std::sqrt(std::max(0.0, vs - slope * c) / w)};
}

/// How sharply the pattern tells its place along both sides: sums of its squared slopes, per mm.
Vector2d sharpness(const FigurePatch& patch) {
    Vector2d sum = Vector2d::Zero();
    for (int y = 1; y + 1 < patch.size; ++y)
        for (int x = 1; x + 1 < patch.size; ++x) {
            const auto k = static_cast<std::size_t>(y * patch.size + x);
            const auto row = static_cast<std::size_t>(patch.size);
            const double u = (patch.light[k + 1] - patch.light[k - 1]) / (2 * kPatchStep_mm),
                         v = (patch.light[k + row] - patch.light[k - row]) / (2 * kPatchStep_mm);
            sum += patch.weight[k] * Vector2d(u * u, v * v);
        }
    return sum;
}

double vertex(double before, double at, double after) {
    const double bend = before - 2 * at + after;
    return bend < 0 ? std::clamp((before - after) / (2 * bend), -0.5, 0.5) : 0;
}

struct Found {
    Vector2d off_mm;
    Fit fit;
};

std::optional<Found> best_shift(const FigurePatch& patch, const std::vector<float>& seen, int search) {
    constexpr int kCoarse = 2;
    constexpr double kLeast = 0.55, kElsewhere_mm = 1, kLessElsewhere = 0.08;
    struct Tried {
        int x, y;
        double correlation;
    };
    std::vector<Tried> tried;
    for (int y = -search; y <= search; y += kCoarse)
        for (int x = -search; x <= search; x += kCoarse)
            tried.push_back({x, y, fit_at(patch, seen, search, x, y, kCoarse).correlation});
    const auto coarse = *std::max_element(tried.begin(), tried.end(),
                                          [](const auto& a, const auto& b) { return a.correlation < b.correlation; });
    Tried best{0, 0, -1};
    for (int y = coarse.y - kCoarse; y <= coarse.y + kCoarse; ++y)
        for (int x = coarse.x - kCoarse; x <= coarse.x + kCoarse; ++x) {
            if (std::abs(x) > search || std::abs(y) > search) continue;
            const double c = fit_at(patch, seen, search, x, y, 1).correlation;
            if (c > best.correlation) best = {x, y, c};
        }
    if (best.correlation < kLeast || std::abs(best.x) >= search || std::abs(best.y) >= search) return std::nullopt;
    for (const Tried& t : tried) {
        const double apart_mm = kPatchStep_mm * std::hypot(t.x - best.x, t.y - best.y);
        if (apart_mm > kElsewhere_mm && t.correlation > best.correlation - kLessElsewhere) return std::nullopt;
    }
    const auto at = [&](int dx, int dy) {
        return fit_at(patch, seen, search, best.x + dx, best.y + dy, 1).correlation;
    };
    const Vector2d part(vertex(at(-1, 0), best.correlation, at(1, 0)), vertex(at(0, -1), best.correlation, at(0, 1)));
    return Found{kPatchStep_mm * (Vector2d(best.x, best.y) + part), fit_at(patch, seen, search, best.x, best.y, 1)};
}

double px_per_mm(const FigurePatch& patch, const CameraModel& camera, const RigidTransform& rig_from_ct) {
    const StrokePlace& place = patch.sides[0].places.front();
    const auto here = project(camera, rig_from_ct * place.p_in_ct);
    double least = 1e9;
    for (const Vector3d& way : {place.along_in_ct, place.sideways_in_ct}) {
        const auto aside = project(camera, rig_from_ct * (place.p_in_ct + 0.5 * way));
        if (!here || !aside) return 0;
        least = std::min(least, (*aside - *here).norm() / 0.5);
    }
    return least;
}

}  // namespace

std::vector<FigurePatch> patches_of(const PlanDrawing& drawing, const SkinSurface& skin,
                                    const std::vector<StrokeSegment>& segments, const CheckLightSettings& settings,
                                    std::optional<std::size_t> bright_item) {
    std::vector<bool> told(drawing.items.size(), false);
    for (const StrokeSegment& segment : segments) told[static_cast<std::size_t>(segment.item)] = true;
    std::vector<FigurePatch> patches;
    for (std::size_t i = 0; i < drawing.items.size(); ++i) {
        if (told[i] || (bright_item && i != *bright_item)) continue;
        if (auto patch = patch_of(drawing, skin, static_cast<int>(i), bright_item.has_value(), settings))
            patches.push_back(std::move(*patch));
    }
    return patches;
}

std::array<CameraLook, 2> find_figure(const FigurePatch& patch, const CameraModel& camera,
                                      const RigidTransform& rig_from_ct, const GrayImage& picture,
                                      const CheckLightSettings& settings) {
    const double scale = px_per_mm(patch, camera, rig_from_ct);
    if (scale < settings.least_px_per_mm || picture.empty()) return {};
    const int search = static_cast<int>(settings.search_mm / kPatchStep_mm);
    const std::vector<float> seen =
        seen_about(patch, search, camera, rig_from_ct, picture, patch.half_mm + settings.search_mm);
    if (seen.empty()) return {};
    const double background = median(std::vector<float>(seen));
    std::array<CameraLook, 2> looks{CameraLook{true, background, {}}, CameraLook{true, background, {}}};
    const auto found = best_shift(patch, seen, search);
    if (!found || found->fit.stroke_grey < settings.least_peak_grey) return looks;
    const double cells_per_pixel = std::max(1.0, std::pow(1 / (scale * kPatchStep_mm), 2));
    const Vector2d sharp = sharpness(patch);
    for (int k = 0; k < 2; ++k)
        looks[static_cast<std::size_t>(k)].light = FoundLight{
            found->off_mm[k],
            found->fit.left_grey / found->fit.stroke_grey * std::sqrt(cells_per_pixel / std::max(sharp[k], 1e-9)),
            found->fit.stroke_grey, found->fit.stroke_grey / std::max(found->fit.skin_grey, 1.0)};
    return looks;
}

}  // namespace planlight
