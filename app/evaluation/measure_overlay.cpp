#include "app/evaluation/measure_overlay.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace planlight {
namespace {

using Eigen::Vector3d;

/// The true skin points that one stroke lights, with the light of their pixels as weight.
struct Light {
    std::vector<Vector3d> points_in_ct, normals_in_ct;
    std::vector<double> weights, incidences_deg;
    bool whole = true;
    bool all_lit = false;  ///< every point of the stroke

    /// Lit whole, and nowhere more steeply than the drawing promises its shapes.
    bool as_promised() const {
        constexpr double kSteepest_deg = 65;
        return all_lit && std::all_of(incidences_deg.begin(), incidences_deg.end(),
                                      [](double deg) { return deg <= kSteepest_deg; });
    }
    bool empty() const { return points_in_ct.empty(); }
    Vector3d mean() const {
        Vector3d sum = Vector3d::Zero();
        double weight = 0;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            sum += weights[i] * points_in_ct[i];
            weight += weights[i];
        }
        return sum / weight;
    }
};

Light light_of(const Stroke& stroke, const simulation::SimulatedRig& rig, const DrawingRenderer& renderer,
               RenderSettings render, const DrawnPicture& picture) {
    PlanDrawing alone;
    alone.strokes = {stroke};
    alone.strokes.front().colour = {255, 255, 255};
    render.only_item = -1;
    render.brightness = 1;
    RgbImage image;
    Light light;
    std::size_t elsewhere = 0;  // pixels of its light that meet no skin
    const RenderCounts counts =
        renderer.render_into(image, alone, picture.rig_from_ct, picture.rig_from_patient, render);
    light.all_lit = counts.lit == counts.points;
    const simulation::PanelSettings panel;  // of every simulated room but those that try others
    const Vector3d eye_in_ct =
        rig.true_rig_from_ct(picture.lit_at).inverse() * rig.true_rig().projector.centre_in_rig();
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const auto value = image.at(x, y)[1];
            if (value == 0) continue;
            const auto lit = rig.true_light({x, y}, picture.lit_at);
            if (!lit) {
                ++elsewhere;
                continue;
            }
            light.points_in_ct.push_back(lit->p_in_ct);
            light.normals_in_ct.push_back(lit->normal_in_ct);
            light.weights.push_back(std::pow(value / 255.0, panel.gamma));
            const double cosine = (eye_in_ct - lit->p_in_ct).normalized().dot(lit->normal_in_ct);
            light.incidences_deg.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi);
        }
    light.whole = counts.partly_lit.empty() && 9 * elsewhere <= light.weights.size();
    return light;
}

/// A line as the plan wants it, on the true skin: dense points with arc length.
struct WantedLine {
    std::vector<Vector3d> points_in_ct;
    std::vector<double> arc_mm;

    WantedLine(const std::vector<Vector3d>& planned, bool closed, const simulation::SimulatedRig& rig) {
        const std::size_t segments = closed ? planned.size() : planned.size() - 1;
        for (std::size_t i = 0; i < segments; ++i) {
            const Vector3d a = rig.nearest_true_skin(planned[i]),
                           b = rig.nearest_true_skin(planned[(i + 1) % planned.size()]);
            const int steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / 0.5)));
            for (int s = 0; s < steps; ++s) add(rig.nearest_true_skin(a + (b - a) * s / steps));
        }
        add(rig.nearest_true_skin(closed ? planned.front() : planned.back()));
    }
    void add(const Vector3d& p) {
        arc_mm.push_back(points_in_ct.empty() ? 0 : arc_mm.back() + (p - points_in_ct.back()).norm());
        points_in_ct.push_back(p);
    }
    struct Foot {
        double arc_mm, sideways_mm;
    };
    /// Where along the line a lit point lies, and how far beside it (left of the line positive).
    Foot foot_of(const Vector3d& p, const Vector3d& normal) const {
        double best = std::numeric_limits<double>::max();
        Foot foot{0, 0};
        for (std::size_t i = 0; i + 1 < points_in_ct.size(); ++i) {
            const Vector3d along = points_in_ct[i + 1] - points_in_ct[i];
            const double length = along.norm();
            if (length < 1e-9) continue;
            const double t = std::clamp((p - points_in_ct[i]).dot(along) / (length * length), 0.0, 1.0);
            const Vector3d off = p - (points_in_ct[i] + t * along);
            if (off.squaredNorm() >= best) continue;
            best = off.squaredNorm();
            foot = {arc_mm[i] + t * length, off.dot(normal.cross(along / length))};
        }
        return foot;
    }
};

/// `sideways_mm(p, normal)` and `place(p)`: how far beside the line, and where along it.
template <class FootOf>
void measure_line(const Light& light, StrokeKind kind, const std::string& item, const FootOf& foot_of,
                  OverlayErrors& errors) {
    constexpr double kBin_mm = 2, kFullWeight = 2;
    struct Bin {
        double sideways = 0, incidence = 0, weight = 0;
    };
    std::map<int, Bin> bins;
    for (std::size_t i = 0; i < light.weights.size(); ++i) {
        const WantedLine::Foot foot = foot_of(light.points_in_ct[i], light.normals_in_ct[i]);
        Bin& bin = bins[static_cast<int>(std::floor(foot.arc_mm / kBin_mm))];
        bin.sideways += light.weights[i] * foot.sideways_mm;
        bin.incidence += light.weights[i] * light.incidences_deg[i];
        bin.weight += light.weights[i];
    }
    for (const auto& [place, bin] : bins) {
        if (bin.weight < kFullWeight) continue;
        errors.position_mm.push_back(std::abs(bin.sideways / bin.weight));
        errors.places.push_back({kind, bin.incidence / bin.weight, errors.position_mm.back(), 0, true, item});
    }
}

/// How far a point of the skin lies beside a cut plane, along the skin; the way along it is across the plane's first
/// axis and normal both, whichever is longer: good enough for bins.
WantedLine::Foot beside_plane(const CutPlane& plane, const Vector3d& p, const Vector3d& normal) {
    const Vector3d q = p - plane.origin_in_ct, along = plane.normal_in_ct.cross(normal);
    const double across = std::max(0.1, along.norm());  // the plane cuts the skin at this sine
    const Vector3d second = plane.normal_in_ct.cross(plane.first_axis_in_ct);
    return {std::atan2(second.dot(q), plane.first_axis_in_ct.dot(q)) * q.norm(), plane.normal_in_ct.dot(q) / across};
}

/// Centre and radius of a lit ring, by a least-squares circle in its mean tangent plane (Kasa 1976).
struct Ring {
    Vector3d centre_in_ct;
    double radius_mm;
};
std::optional<Ring> fit_ring(const Light& light) {
    if (light.points_in_ct.size() < 12) return std::nullopt;
    const Vector3d mean = light.mean();
    Vector3d normal = Vector3d::Zero();
    for (const auto& n : light.normals_in_ct) normal += n;
    normal.normalize();
    const Vector3d e1 = normal.unitOrthogonal(), e2 = normal.cross(e1);
    const auto n = static_cast<Eigen::Index>(light.points_in_ct.size());
    Eigen::MatrixX3d A(n, 3);
    Eigen::VectorXd b(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Vector3d q = light.points_in_ct[k] - mean;
        const double x = q.dot(e1), y = q.dot(e2), w = std::sqrt(light.weights[k]);
        A.row(i) << w * x, w * y, w;
        b[i] = w * (x * x + y * y);
    }
    const Vector3d s = A.colPivHouseholderQr().solve(b);
    const double cx = s.x() / 2, cy = s.y() / 2;
    return Ring{mean + cx * e1 + cy * e2, std::sqrt(std::max(0.0, s.z() + cx * cx + cy * cy))};
}

/// Where a planned axis passes through the true skin nearest to the planned point; else the skin point nearest to it.
Vector3d wanted_place(const Vector3d& planned, const std::optional<Vector3d>& axis,
                      const simulation::SimulatedRig& rig) {
    const Vector3d nearest = rig.nearest_true_skin(planned);
    if (!axis || !(axis->norm() > 0.5)) return nearest;
    constexpr double kBefore_mm = 15;
    const Vector3d inwards = axis->normalized();
    const auto hit = rig.true_skin_along(planned - kBefore_mm * inwards, inwards);
    return hit && (hit->p_in_ct - planned).norm() < 3 * (nearest - planned).norm() + 1 ? hit->p_in_ct : nearest;
}

void measure_ring(const Light& light, StrokeKind kind, const std::string& item, const Vector3d& wanted_in_ct,
                  double diameter_mm, bool shapes, OverlayErrors& errors) {
    const auto ring = fit_ring(light);
    if (!ring) return;
    Vector3d normal = Vector3d::Zero();
    double incidence_deg = 0;
    for (std::size_t i = 0; i < light.weights.size(); ++i) {
        normal += light.normals_in_ct[i];
        incidence_deg += light.incidences_deg[i] / static_cast<double>(light.weights.size());
    }
    normal.normalize();
    const Vector3d off = ring->centre_in_ct - wanted_in_ct;
    const double off_mm = (off - off.dot(normal) * normal).norm();
    const double larger_percent = diameter_mm > 0 ? 200 * ring->radius_mm / diameter_mm - 100 : 0;
    errors.places.push_back({kind, incidence_deg, off_mm, larger_percent, light.whole, item});
    if (!light.whole) return;  // drawn as what it is: no circle
    errors.position_mm.push_back(off_mm);
    if (shapes && diameter_mm > 0) errors.diameter_percent.push_back(std::abs(larger_percent));
}

/// The direction of a lit straight stroke: the longest principal axis.
Vector3d direction_of(const Light& light) {
    const Vector3d mean = light.mean();
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < light.weights.size(); ++i) {
        const Vector3d q = light.points_in_ct[i] - mean;
        scatter += light.weights[i] * q * q.transpose();
    }
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(2);
}

double length_mm(const Stroke& stroke) {
    double length = 0;
    for (std::size_t i = 0; i + 1 < stroke.points_in_ct.size(); ++i)
        length += (stroke.points_in_ct[i + 1] - stroke.points_in_ct[i]).norm();
    return length;
}

void measure_right_angles(const std::vector<Vector3d>& arms, std::vector<double>& angles_deg) {
    for (std::size_t i = 0; i < arms.size(); ++i)
        for (std::size_t j = i + 1; j < arms.size(); ++j) {
            const double angle_deg = std::acos(std::min(1.0, std::abs(arms[i].dot(arms[j])))) * 180 / std::numbers::pi;
            if (angle_deg > 45) angles_deg.push_back(90 - angle_deg);
        }
}

void measure_ticks(const std::vector<Light>& ticks, const WantedLine& wanted, double every_mm, OverlayErrors& errors) {
    std::vector<std::pair<double, bool>> arcs;  // where along the line, and whether lit as promised
    for (const auto& tick : ticks)
        arcs.emplace_back(wanted.foot_of(tick.mean(), tick.normals_in_ct.front()).arc_mm, tick.as_promised());
    std::sort(arcs.begin(), arcs.end());
    for (std::size_t i = 0; i + 1 < arcs.size(); ++i) {
        const double gap = arcs[i + 1].first - arcs[i].first;
        if (gap >= 1.5 * every_mm || gap <= 0.5 * every_mm) continue;
        errors.tick_mm.push_back(std::abs(gap - every_mm));
        if (arcs[i].second && arcs[i + 1].second) errors.promised_tick_mm.push_back(errors.tick_mm.back());
    }
}

template <class Items>
auto named(const Items& items, const std::string& name) {
    return std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.name == name; });
}

}  // namespace

void OverlayErrors::append(const OverlayErrors& more) {
    position_mm.insert(position_mm.end(), more.position_mm.begin(), more.position_mm.end());
    diameter_percent.insert(diameter_percent.end(), more.diameter_percent.begin(), more.diameter_percent.end());
    tick_mm.insert(tick_mm.end(), more.tick_mm.begin(), more.tick_mm.end());
    angle_deg.insert(angle_deg.end(), more.angle_deg.begin(), more.angle_deg.end());
    long_angle_deg.insert(long_angle_deg.end(), more.long_angle_deg.begin(), more.long_angle_deg.end());
    promised_tick_mm.insert(promised_tick_mm.end(), more.promised_tick_mm.begin(), more.promised_tick_mm.end());
    promised_angle_deg.insert(promised_angle_deg.end(), more.promised_angle_deg.begin(), more.promised_angle_deg.end());
    places.insert(places.end(), more.places.begin(), more.places.end());
    unseen_strokes += more.unseen_strokes;
}

OverlayErrors measure_overlay(const simulation::SimulatedRig& rig, const Plan& plan, const PlanDrawing& drawing,
                              const DrawingRenderer& renderer, const RenderSettings& render,
                              const DrawnPicture& picture, bool shapes) {
    constexpr double kTickEvery_mm = 10, kLongCross_mm = 8;
    OverlayErrors errors;
    for (std::size_t index = 0; index < drawing.items.size(); ++index) {
        const DrawnItem& item = drawing.items[index];
        std::vector<Light> ticks;
        std::vector<Vector3d> arms, long_arms;
        bool promised = true;  // of the long arms
        int crosses = 0;
        std::optional<WantedLine> line;
        if (const auto osteotomy = named(plan.osteotomy_lines, item.name);
            item.kind == StrokeKind::osteotomy_line && osteotomy != plan.osteotomy_lines.end())
            line.emplace(osteotomy->points_in_ct, osteotomy->closed, rig);
        for (const Stroke& stroke : drawing.strokes) {
            const bool wanted = stroke.item == static_cast<int>(index) && stroke.kind != StrokeKind::label &&
                                stroke.kind != StrokeKind::check_mark && (shapes || (stroke.kind != StrokeKind::tick));
            if (!wanted) continue;
            const Light light = light_of(stroke, rig, renderer, render, picture);
            if (light.empty()) {
                ++errors.unseen_strokes;
                continue;
            }
            if (stroke.kind == StrokeKind::tick) {
                ticks.push_back(light);
            } else if (stroke.kind == StrokeKind::osteotomy_line && line) {
                measure_line(
                    light, stroke.kind, item.name, [&](auto& p, auto& n) { return line->foot_of(p, n); }, errors);
            } else if (stroke.kind == StrokeKind::cut_plane) {
                const auto plane = named(plan.cut_planes, item.name);
                if (plane == plan.cut_planes.end()) continue;
                measure_line(
                    light, stroke.kind, item.name, [&](auto& p, auto& n) { return beside_plane(*plane, p, n); },
                    errors);
            } else if (stroke.kind == StrokeKind::borehole) {
                const auto hole = named(plan.boreholes, item.name);
                if (hole == plan.boreholes.end()) continue;
                if (stroke.closed)
                    measure_ring(light, stroke.kind, item.name,
                                 wanted_place(hole->position_in_ct, hole->axis_in_ct, rig), hole->diameter_mm, shapes,
                                 errors);
                else if (shapes && length_mm(stroke) >= kLongCross_mm) {
                    long_arms.push_back(direction_of(light));
                    promised = promised && light.as_promised();
                } else if (shapes)
                    arms.push_back(direction_of(light));
            } else if (stroke.kind == StrokeKind::trajectory && stroke.closed) {
                const auto trajectory = named(plan.trajectories, item.name);
                crosses = 0;
                if (trajectory != plan.trajectories.end())
                    measure_ring(
                        light, stroke.kind, item.name,
                        wanted_place(trajectory->entry_in_ct, trajectory->target_in_ct - trajectory->entry_in_ct, rig),
                        trajectory->diameter_mm >= 6 ? trajectory->diameter_mm : 0, shapes, errors);
            } else if (stroke.kind == StrokeKind::trajectory && shapes && crosses < 2) {
                ++crosses;  // the two bars of its cross come before the shadow of its way
                long_arms.push_back(direction_of(light));
                promised = promised && light.as_promised();
            }
        }
        if (line) measure_ticks(ticks, *line, kTickEvery_mm, errors);
        measure_right_angles(arms, errors.angle_deg);
        measure_right_angles(long_arms, errors.angle_deg);
        measure_right_angles(long_arms, errors.long_angle_deg);
        if (promised) measure_right_angles(long_arms, errors.promised_angle_deg);
    }
    return errors;
}

}  // namespace planlight
