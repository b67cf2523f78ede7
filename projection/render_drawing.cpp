#include "projection/render_drawing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>

#include "planning_io/types/error.h"
#include "projection/dark_discs.h"
#include "projection/depth_picture.h"
#include "projection/stroke_raster.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMin_width_px = 1.5;
constexpr double kBroken_mm = 1.3;     // dashes and gaps of a circle that is lit in part
constexpr double kSmooth_turn = 0.85;  // cosine: a sharper turn is drawn as a corner

/// A stroke's point as the projector sees it.
struct LitPoint {
    bool lit = false;
    Vector2d pixel;
    Eigen::Matrix<double, 2, 3> pixel_by_ct;
};

Rgb dimmed(Rgb colour, double brightness) {
    for (auto& channel : colour) channel = number_for_light(channel, brightness);
    return colour;
}

/// How bright an item is.
double share_of(int item, const RenderSettings& s) {
    const bool other = s.item_of_moment >= 0 && item != s.item_of_moment;
    return s.brightness * (other ? std::clamp(s.others, 0.0, 1.0) : 1);
}

}  // namespace

struct DrawingRenderer::Parts {
    Parts(const SkinSurface& s, const CameraModel& p)
        : skin(s), projector(p), depth(s.mesh()), raster(p.width, p.height) {}

    void light_points(const Stroke& stroke, const RenderSettings& settings, PointCounts& counts);
    /// Of points that are lit, those that a marker's disc darkens afterwards.
    void count_on_markers(const std::vector<DarkDisc>& discs, PointCounts& counts) const;
    LitPoint light_point(const Vector3d& p_in_ct, const Vector3d& normal_in_ct, double steepest_cosine,
                         PointCounts& counts) const;
    void add_ribbon(const Stroke& stroke, bool broken);
    void draw_stroke(const Stroke& stroke, const RenderSettings& settings, const std::vector<DarkDisc>& discs,
                     RenderCounts& counts, RgbImage& picture);
    bool can_be_lit_whole(const Label& label, const RenderSettings& settings, const std::vector<DarkDisc>& discs);
    /// False where it cannot be lit whole: then nothing of it is.
    bool draw_label(const Label& label, const RenderSettings& settings, const std::vector<DarkDisc>& discs,
                    RgbImage& picture);
    /// True when the stroke is a circle that is lit in part; `counts` is told.
    bool is_partly_lit_ring(const Stroke& stroke, const RenderSettings& settings, RenderCounts& counts) const;
    /// The two edge points of the ribbon at one end of a segment.
    std::array<Vector2d, 2> edges(const Stroke& stroke, std::size_t at, const Vector3d& direction,
                                  const Vector3d* other, double outwards) const;

    const SkinSurface& skin;
    CameraModel projector;
    std::mutex in_use;
    CameraModel projector_from_ct;
    Vector3d light_in_ct;
    DepthPicture depth;
    StrokeRaster raster;
    std::vector<LitPoint> points;
    std::vector<std::vector<Vector2d>> outlines;
};

LitPoint DrawingRenderer::Parts::light_point(const Vector3d& p, const Vector3d& normal, double steepest_cosine,
                                             PointCounts& counts) const {
    LitPoint point;
    ++counts.points;
    const Vector3d to_light = light_in_ct - p;
    const double distance_mm = to_light.norm();
    if (!(normal.dot(to_light) > steepest_cosine * distance_mm)) {
        ++counts.too_steep;
        return point;
    }
    const auto pixel = project(projector_from_ct, p, point.pixel_by_ct);
    if (!pixel || !in_picture(projector_from_ct, *pixel)) {
        ++counts.outside;
        return point;
    }
    point.pixel = *pixel;
    const auto answer = depth.ask(*pixel, (projector_from_ct.device_from_rig * p).z());
    bool hidden = answer == DepthPicture::Answer::hidden;
    if (answer == DepthPicture::Answer::near_an_edge) {
        // Along the light, so that the shadow's edge is not shifted, until clear of the point's own triangles.
        const Vector3d towards = to_light / distance_mm;
        constexpr double kOff_skin_mm = 0.8, kMost_mm = 4;
        const double step_mm = std::min(kMost_mm, kOff_skin_mm / std::max(1e-3, normal.dot(towards)));
        const auto hit = skin.first_hit({p + step_mm * towards, towards});
        hidden = hit && (hit->p_in_ct - p).norm() < distance_mm;
    }
    counts.hidden += hidden ? 1 : 0;
    counts.lit += hidden ? 0 : 1;
    point.lit = !hidden;
    return point;
}

void DrawingRenderer::Parts::light_points(const Stroke& stroke, const RenderSettings& settings, PointCounts& counts) {
    points.clear();
    const double steepest_cosine = std::cos(std::clamp(settings.steepest, 0.0, 1.55));
    for (std::size_t i = 0; i < stroke.points_in_ct.size(); ++i)
        points.push_back(light_point(stroke.points_in_ct[i], stroke.normals_in_ct[i], steepest_cosine, counts));
}

std::array<Vector2d, 2> DrawingRenderer::Parts::edges(const Stroke& stroke, std::size_t at, const Vector3d& direction,
                                                      const Vector3d* other, double outwards) const {
    const LitPoint& point = points[at];
    const bool smooth = other != nullptr && direction.dot(*other) > kSmooth_turn;
    const Vector3d along = smooth ? Vector3d((direction + *other).normalized()) : direction;
    const Vector3d side = stroke.normals_in_ct[at].cross(along).normalized();
    Vector2d half = point.pixel_by_ct * side * (stroke.width_mm / 2);
    const Vector2d along_px = point.pixel_by_ct * along;
    const double width_px =
        2 * std::abs(half.x() * along_px.y() - half.y() * along_px.x()) / std::max(1e-12, along_px.norm());
    if (width_px < kMin_width_px) half *= std::min(4.0, kMin_width_px / std::max(1e-12, width_px));
    Vector2d centre = point.pixel;
    if (other != nullptr && !smooth)
        centre += point.pixel_by_ct * direction * (outwards * stroke.width_mm / 2);  // fills the corner
    return {centre + half, centre - half};
}

void DrawingRenderer::Parts::add_ribbon(const Stroke& stroke, bool broken) {
    const std::size_t count = points.size(), segments = stroke.closed ? count : count - 1;
    const auto direction = [&](std::size_t segment) {
        return Vector3d(
            (stroke.points_in_ct[(segment + 1) % count] - stroke.points_in_ct[segment % count]).normalized());
    };
    const double segment_mm = (stroke.points_in_ct[1] - stroke.points_in_ct[0]).norm();
    double way_mm = 0;
    for (std::size_t i = 0; i < segments; ++i) {
        const std::size_t j = (i + 1) % count;
        const double step_mm = stroke.gap_mm > 0 ? (stroke.points_in_ct[j] - stroke.points_in_ct[i]).norm() : 0;
        way_mm += step_mm;
        if (stroke.in_gap(way_mm - step_mm / 2)) continue;
        if (!points[i].lit || !points[j].lit) continue;
        if (broken && static_cast<int>(static_cast<double>(i) * segment_mm / kBroken_mm) % 2 != 0) continue;
        const Vector3d along = direction(i);
        if (!along.allFinite() || along.isZero()) continue;
        const Vector3d before = i > 0 || stroke.closed ? direction(i + count - 1) : along;
        const Vector3d after = i + 1 < segments || stroke.closed ? direction(i + 1) : along;
        const auto start = edges(stroke, i, along, i > 0 || stroke.closed ? &before : nullptr, -1);
        const auto end = edges(stroke, j, along, i + 1 < segments || stroke.closed ? &after : nullptr, 1);
        raster.add_quad({start[0], end[0], end[1], start[1]});
    }
}

void DrawingRenderer::Parts::count_on_markers(const std::vector<DarkDisc>& discs, PointCounts& counts) const {
    for (const LitPoint& point : points) {
        if (!point.lit || std::ranges::none_of(discs, [&](const DarkDisc& disc) { return disc.covers(point.pixel); }))
            continue;
        --counts.lit;
        ++counts.on_marker;
    }
}

void DrawingRenderer::Parts::draw_stroke(const Stroke& stroke, const RenderSettings& settings,
                                         const std::vector<DarkDisc>& discs, RenderCounts& counts, RgbImage& picture) {
    if (stroke.normals_in_ct.size() != stroke.points_in_ct.size())
        throw InputError("", "a stroke of the drawing has not one normal per point", "Draw the plan again.");
    const double brightness = share_of(stroke.item, settings);
    if (stroke.points_in_ct.size() < 2 || !(stroke.width_mm > 0) || !(brightness > 0)) return;
    PointCounts here;
    light_points(stroke, settings, here);
    count_on_markers(discs, here);
    counts += here;
    const bool of_item = stroke.item >= 0 && static_cast<std::size_t>(stroke.item) < counts.items.size();
    if (of_item && stroke.kind != StrokeKind::check_mark)  // (beside the item, for the cameras)
        counts.items[static_cast<std::size_t>(stroke.item)] += here;
    add_ribbon(stroke, is_partly_lit_ring(stroke, settings, counts));
    raster.flush(dimmed(stroke.colour, brightness), picture);
}

/// Half a word, or half a number, would be read as another.
bool DrawingRenderer::Parts::can_be_lit_whole(const Label& label, const RenderSettings& settings,
                                              const std::vector<DarkDisc>& discs) {
    const double steepest_cosine = std::cos(std::clamp(std::min(settings.steepest, settings.steepest_text), 0.0, 1.55));
    PointCounts not_of_lines;
    const auto lit = [&](const Vector3d& p, const Vector3d& normal) {
        const LitPoint point = light_point(p, normal, steepest_cosine, not_of_lines);
        return point.lit &&
               std::none_of(discs.begin(), discs.end(), [&](const DarkDisc& disc) { return disc.covers(point.pixel); });
    };
    for (std::size_t i = 0; i < label.field_in_ct.size(); ++i)
        if (!lit(label.field_in_ct[i], label.field_normals_in_ct[i])) return false;
    for (std::size_t i = 0; i < label.leader.points_in_ct.size(); ++i)
        if (!lit(label.leader.points_in_ct[i], label.leader.normals_in_ct[i])) return false;
    return !label.field_in_ct.empty();
}

bool DrawingRenderer::Parts::draw_label(const Label& label, const RenderSettings& settings,
                                        const std::vector<DarkDisc>& discs, RgbImage& picture) {
    if (label.field_normals_in_ct.size() != label.field_in_ct.size())
        throw InputError("", "a label of the drawing has not one normal per point", "Draw the plan again.");
    if (!can_be_lit_whole(label, settings, discs)) return false;
    for (const Label::Outlines& sign : label.signs_in_ct) {
        outlines.resize(sign.size());
        for (std::size_t k = 0; k < sign.size(); ++k) {
            outlines[k].clear();
            for (const Vector3d& p : sign[k])
                if (const auto pixel = project(projector_from_ct, p)) outlines[k].push_back(*pixel);
        }
        raster.add_outlines(outlines);
    }
    raster.flush(dimmed(label.colour, settings.brightness), picture);
    RenderCounts not_of_lines;
    if (!label.leader.points_in_ct.empty()) draw_stroke(label.leader, settings, discs, not_of_lines, picture);
    return true;
}

bool DrawingRenderer::Parts::is_partly_lit_ring(const Stroke& stroke, const RenderSettings& settings,
                                                RenderCounts& counts) const {
    const bool is_ring =
        stroke.closed && (stroke.kind == StrokeKind::borehole || stroke.kind == StrokeKind::trajectory);
    if (!is_ring) return false;
    const auto lit = std::count_if(points.begin(), points.end(), [](const LitPoint& p) { return p.lit; });
    const double share = static_cast<double>(lit) / static_cast<double>(points.size());
    if (share >= settings.whole_ring) return false;
    counts.partly_lit.push_back({stroke.item, share});
    return true;
}

double PointCounts::lit_share() const {
    return points > 0 ? static_cast<double>(lit) / static_cast<double>(points) : 0;
}

PointCounts& PointCounts::operator+=(const PointCounts& others) {
    points += others.points;
    lit += others.lit;
    too_steep += others.too_steep;
    hidden += others.hidden;
    outside += others.outside;
    on_marker += others.on_marker;
    return *this;
}

DrawingRenderer::DrawingRenderer(const SkinSurface& skin, const CameraModel& projector)
    : parts_(std::make_unique<Parts>(skin, projector)) {
    if (projector.width <= 0 || projector.height <= 0 || !(projector.focal_x > 0) || !(projector.focal_y > 0))
        throw InputError("", "the projector's calibration has no picture size or focal length",
                         "Calibrate the rig again.");
}
DrawingRenderer::~DrawingRenderer() = default;

int DrawingRenderer::width() const {
    return parts_->projector.width;
}
int DrawingRenderer::height() const {
    return parts_->projector.height;
}

RgbImage DrawingRenderer::render(const PlanDrawing& drawing, const RigidTransform& rig_from_ct,
                                 const RigidTransform& rig_from_patient, const RenderSettings& settings) const {
    RgbImage picture;
    render_into(picture, drawing, rig_from_ct, rig_from_patient, settings);
    return picture;
}

RenderCounts DrawingRenderer::render_into(RgbImage& picture, const PlanDrawing& drawing,
                                          const RigidTransform& rig_from_ct, const RigidTransform& rig_from_patient,
                                          const RenderSettings& settings) const {
    Parts& parts = *parts_;
    const std::lock_guard lock(parts.in_use);
    picture.width = width();
    picture.height = height();
    picture.pixels.resize(static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()));
    picture.fill({0, 0, 0});
    parts.projector_from_ct = parts.projector;
    parts.projector_from_ct.device_from_rig = parts.projector.device_from_rig * rig_from_ct;
    parts.light_in_ct = parts.projector_from_ct.centre_in_rig();
    parts.depth.draw(parts.projector_from_ct);
    RenderCounts counts;
    counts.items.resize(drawing.items.size());
    const std::vector<DarkDisc> discs = dark_discs(parts.projector, rig_from_patient, settings);
    for (const Stroke& stroke : drawing.strokes)
        if (settings.only_item < 0 || stroke.item == settings.only_item)
            parts.draw_stroke(stroke, settings, discs, counts, picture);
    for (const Label& label : drawing.labels) {
        const bool wanted =
            settings.item_of_moment < 0 ? !label.of_moment : label.of_moment && label.item == settings.item_of_moment;
        if (!wanted || (settings.only_item >= 0 && label.item != settings.only_item)) continue;
        const bool lit = parts.draw_label(label, settings, discs, picture);
        (lit ? counts.labels_lit : counts.labels_left_out).push_back(label.item);
    }
    if (drawing.card && settings.card && settings.only_item < 0 && settings.item_of_moment < 0)
        counts.card_lit = parts.draw_label(*drawing.card, settings, discs, picture);
    darken(discs, picture);
    return counts;
}

}  // namespace planlight
