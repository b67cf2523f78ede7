#include "tests/app/labelled_head.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <random>

#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/files/image_file.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/volume/read_volume.h"
#include "projection/check_light.h"
#include "projection/place_all_labels.h"
#include "tests/app/read_labels.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;
using Eigen::Vector3d;

std::filesystem::path pictures_folder() {
    const char* folder = std::getenv("PLANLIGHT_PICTURES");
    return folder ? folder : "";
}

}  // namespace

void LabelsRead::append(const LabelsRead& more) {
    items += more.items, lit += more.lit, left_out += more.left_out, name_alone += more.name_alone;
    unseen += more.unseen, right += more.right;
    wrong.insert(wrong.end(), more.wrong.begin(), more.wrong.end());
    other_number.insert(other_number.end(), more.other_number.begin(), more.other_number.end());
    cards_lit += more.cards_lit, cards_seen += more.cards_seen, cards_right += more.cards_right;
    cards_wrong.insert(cards_wrong.end(), more.cards_wrong.begin(), more.cards_wrong.end());
    for (const auto& [kind, some] : more.contrast)
        contrast[kind].insert(contrast[kind].end(), some.begin(), some.end());
    check_expected += more.check_expected, check_seen += more.check_seen;
    check_brighter.insert(check_brighter.end(), more.check_brighter.begin(), more.check_brighter.end());
    share_of_text = more.share_of_text;
}

struct LabelledHead::Parts {
    Volume volume = read_volume(*example_patient());
    Preparation prepared = prepare_case(volume, {}, {}, {}, "2001-10-14");
    SkinSurface skin{prepared.prepared.skin};

    std::optional<SkinSurface::Point> from_side(const Vector3d& out, double across_mm, double up_mm) const;
    Plan plan(unsigned seed) const;
};

std::optional<SkinSurface::Point> LabelledHead::Parts::from_side(const Vector3d& out, double across_mm,
                                                                 double up_mm) const {
    Vector3d low = skin.mesh().vertices_in_ct.front(), high = low;
    for (const Vector3d& v : skin.mesh().vertices_in_ct) low = low.cwiseMin(v), high = high.cwiseMax(v);
    const Vector3d middle = (low + high) / 2 + Vector3d(0, 0, 0.15 * (high - low).z());
    const Vector3d across = Vector3d(0, 0, 1).cross(out).normalized(), up = out.cross(across);
    const auto hit = skin.first_hit({middle + 400 * out + across_mm * across + up_mm * up, -out});
    if (!hit || !skin.real_skin(*hit) || hit->normal_in_ct.dot(out) < 0.55) return std::nullopt;
    return hit;
}

/// A closed cut, holes, ways in and a plane on one side of the head, with names and figures of that seed.
Plan LabelledHead::Parts::plan(unsigned seed) const {
    static const std::array<Vector3d, 5> kSides{Vector3d(0, -1, 0.2), Vector3d(1, -0.6, 0.2), Vector3d(0, -1, 0.6),
                                                Vector3d(-1, -0.6, 0.2), Vector3d(1, -1, 0.3)};
    static const std::array<const char*, 12> kNames{"B",    "Hole ", "K",       "Drill ",     "Entry ", "T",
                                                    "EVD ", "P",     "Biopsy ", "Burr hole ", "Screw ", "Target "};
    static const std::array<const char*, 6> kLines{
        "Osteotomy", "Craniotomy", "Skin flap", "Incision left", "Resection margin frontal", "Midline"};
    std::mt19937 random(seed);
    const auto within = [&](double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(random);
    };
    const auto any = [&](const auto& list) { return std::string(list[random() % list.size()]); };
    const Vector3d out = kSides[seed % kSides.size()].normalized();
    Plan plan;
    OsteotomyLine line{any(kLines), {}, true, {}};
    const double wide_mm = within(22, 32), high_mm = within(18, 26);
    for (int k = 0; k < 10; ++k) {
        const double angle = 2 * std::numbers::pi * k / 10;
        if (const auto p = from_side(out, wide_mm * std::cos(angle), high_mm * std::sin(angle)))
            line.points_in_ct.push_back(p->p_in_ct);
    }
    if (line.points_in_ct.size() > 4) plan.osteotomy_lines.push_back(line);
    const std::array<Vector2d, 7> places{Vector2d(-48, 28), Vector2d(46, 30), Vector2d(-46, -26), Vector2d(44, -28),
                                         Vector2d(0, 0),    Vector2d(-4, 42), Vector2d(6, -46)};
    int number = 1;
    for (const Vector2d& place : places) {
        const auto p = from_side(out, place.x() + within(-5, 5), place.y() + within(-5, 5));
        const std::string name = any(kNames) + std::to_string(number++ + 10 * static_cast<int>(random() % 3));
        if (!p) continue;
        const Vector3d leaning = (-p->normal_in_ct + 0.3 * out.unitOrthogonal()).normalized();
        if (number % 3 == 0)
            plan.trajectories.push_back(
                {name, p->p_in_ct, Vector3d(p->p_in_ct + within(25, 79) * leaning), std::round(within(0, 4)), {}});
        else
            plan.boreholes.push_back(
                {name, p->p_in_ct, {}, std::round(2 * within(3, 14)) / 2, std::round(2 * within(3, 14)) / 2, {}});
    }
    return plan;
}

namespace {

/// What an eye where that camera stands sees: the true skin under the light that truly falls there, and 20 % of room
/// light, without the camera's blur, pixels and noise.
Seen seen_by_eye(const simulation::SimulatedRig& rig, const RgbImage& light, const CameraModel& camera, Instant at) {
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(at), ct_from_rig = rig_from_ct.inverse();
    const CameraModel projector = rig.true_rig().projector;
    GrayImage green(light.width, light.height);
    std::transform(light.pixels.begin(), light.pixels.end(), green.pixels.begin(), [](const Rgb& p) { return p[1]; });
    return [&rig, camera, projector, rig_from_ct, ct_from_rig, green, at](const Vector2d& pixel) {
        constexpr double kRoomLight = 0.2, kShadow_mm = 1;
        const auto ray = ray_through(camera, pixel);
        if (!ray) return 0.0;
        const auto skin = rig.true_skin_along(ct_from_rig * ray->origin, ct_from_rig.linear() * ray->direction);
        if (!skin) return 0.0;
        const auto by = project(projector, rig_from_ct * skin->p_in_ct);
        double lit = 0;
        if (by && in_picture(projector, *by)) {
            const auto falls = rig.true_light(*by, at);
            if (falls && (falls->p_in_ct - skin->p_in_ct).norm() < kShadow_mm) lit = between(green, *by);
        }
        const Vector3d to_light = (ct_from_rig * projector.centre_in_rig() - skin->p_in_ct).normalized();
        return kRoomLight * 255 + lit * std::max(0.0, to_light.dot(skin->normal_in_ct));
    };
}

/// Where a stroke's middle and both sides of it are seen, and no other line is near.
void add_contrast(const PlanDrawing& drawing, const SkinSurface& skin, const simulation::SimulatedRig& rig,
                  const StereoFrame& frame, const RigidTransform& rig_from_ct, Instant lit, LabelsRead& result) {
    constexpr double kBeside_mm = 3.5, kOther_mm = 3;
    constexpr std::size_t kEvery = 8;
    const CameraModel camera = rig.true_rig().left_camera;
    const auto seen = [&](const Vector3d& p, const Vector3d& normal) -> std::optional<double> {
        if (!rig.truly_seen(simulation::SimulatedRig::Camera::left, {p, normal}, lit)) return std::nullopt;
        const auto pixel = project(camera, rig_from_ct * p);
        return pixel ? std::optional(between(frame.left, *pixel)) : std::nullopt;
    };
    const auto near_another = [&](const Vector3d& p, const Stroke& own) {
        return std::any_of(drawing.strokes.begin(), drawing.strokes.end(), [&](const Stroke& stroke) {
            return &stroke != &own && std::any_of(stroke.points_in_ct.begin(), stroke.points_in_ct.end(),
                                                  [&](const Vector3d& q) { return (q - p).norm() < kOther_mm; });
        });
    };
    for (const Stroke& stroke : drawing.strokes)
        for (std::size_t i = 1; i + 1 < stroke.points_in_ct.size(); i += kEvery) {
            const Vector3d& p = stroke.points_in_ct[i];
            const Vector3d& normal = stroke.normals_in_ct[i];
            const Vector3d aside = kBeside_mm * normal.cross(stroke.points_in_ct[i + 1] - p).normalized();
            const auto one = skin.nearest(p + aside), other = skin.nearest(p - aside);
            if (near_another(p, stroke) || near_another(one.p_in_ct, stroke) || near_another(other.p_in_ct, stroke))
                continue;
            const auto on = seen(p, normal), left = seen(one.p_in_ct, one.normal_in_ct),
                       right = seen(other.p_in_ct, other.normal_in_ct);
            if (!on || !left || !right) continue;
            const double beside = std::max((*left + *right) / 2, 1.0);
            result.contrast[stroke.kind].push_back((*on - beside) / beside);
        }
}

/// Patients as sites name them: initials, a name, a code.
const std::array<const char*, 4> kCards{"E. M.", "Mustermann, Erika", "1a2b3c4d-9f3e", "Case 117"};

}  // namespace

LabelledHead::LabelledHead() : parts_(std::make_unique<Parts>()) {}
LabelledHead::~LabelledHead() = default;

LabelsRead LabelledHead::read(simulation::Preset preset, unsigned seed, bool eye, double room_light) const {
    LabelsRead result;
    const Plan plan = parts_->plan(seed);
    simulation::RoomSettings settings;
    settings.preset = preset;
    settings.seed = seed;
    settings.ambient = room_light;
    settings.skin_threshold_hu = parts_->prepared.threshold;
    simulation::SimulatedRig rig(parts_->volume, points_of(plan), settings);
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(rig.clock().now());
    DrawingSettings how;
    if (seed % 2 == 0) how.up_in_ct.setZero();  // upright as the camera sees it; else in ct
    how = lit_by(rig.calibration(), rig_from_ct, how);
    how.keep_clear_in_ct = rig.true_markers_in_ct();
    how.card = {kCards[seed % kCards.size()], seed % 2 == 0 ? "LEFT" : "RIGHT"};
    const PlanDrawing drawing = draw_plan(plan, parts_->skin, how);
    RenderSettings render;
    for (const Vector3d& marker : rig.true_markers_in_ct()) render.keep_dark_in_patient.push_back(rig_from_ct * marker);
    const DrawingRenderer renderer(parts_->skin, rig.calibration().projector);
    render.card = true;
    RgbImage light;
    const RenderCounts counts = renderer.render_into(light, drawing, rig_from_ct, RigidTransform::Identity(), render);
    const Instant lit = rig.projector().show(light, rig.clock().now() + 10s);
    const StereoFrame frame = rig.cameras().grab(lit, 2s);
    const auto folder = pictures_folder();
    const std::string name = fmt::format("{}_{}", preset == simulation::Preset::paper ? "paper" : "modern", seed);
    if (!folder.empty()) {
        write_png(light, folder / (name + "_light.png"));
        write_png(frame.left, folder / (name + "_left.png"));
    }
    result.items = static_cast<int>(drawing.items.size());
    result.left_out = static_cast<int>(counts.labels_left_out.size());
    result.share_of_text = share_of_text(drawing);
    const RigCalibration truth = rig.true_rig();
    add_contrast(drawing, parts_->skin, rig, frame, rig_from_ct, lit, result);
    const LightCheck check = check_light(drawing, parts_->skin, rig.calibration(), rig_from_ct, frame);
    result.check_expected = check.expected, result.check_seen = check.seen;
    result.check_brighter = {check.brighter};
    // As it is read from where it is seen best, as a person would look; empty where neither camera sees it whole.
    const auto read_one = [&](const Label& label, const std::string& word) -> std::optional<std::string> {
        const auto sees = [&](simulation::SimulatedRig::Camera camera) {
            for (std::size_t i = 0; i < label.field_in_ct.size(); ++i)
                if (!rig.truly_seen(camera, {label.field_in_ct[i], label.field_normals_in_ct[i]}, lit)) return false;
            return true;
        };
        const bool by_left = sees(simulation::SimulatedRig::Camera::left),
                   by_right = sees(simulation::SimulatedRig::Camera::right);
        if (!by_left && !by_right) return std::nullopt;
        const auto facing = [&](const CameraModel& one) {
            const std::size_t k = label.field_in_ct.size() / 2;
            const Vector3d way = rig_from_ct.inverse() * one.centre_in_rig() - label.field_in_ct[k];
            return way.normalized().dot(label.field_normals_in_ct[k]);
        };
        const bool left = by_left && (!by_right || facing(truth.left_camera) > facing(truth.right_camera));
        const CameraModel& camera = left ? truth.left_camera : truth.right_camera;
        const GrayImage& picture = left ? frame.left : frame.right;
        const Seen seen = eye ? seen_by_eye(rig, light, camera, lit)
                              : Seen([&](const Vector2d& pixel) { return between(picture, pixel); });
        return read_label(label, seen, camera, rig_from_ct,
                          folder.empty() ? folder : folder / fmt::format("{}_{}", name, word));
    };
    const auto written_in = [](const Label& label) {
        std::string written = label.words;
        std::replace(written.begin(), written.end(), '\n', '/');
        return written;
    };
    for (const Label& label : drawing.labels) {
        const bool is_lit = !label.of_moment && std::find(counts.labels_lit.begin(), counts.labels_lit.end(),
                                                          label.item) != counts.labels_lit.end();
        if (!is_lit) continue;
        ++result.lit;
        result.name_alone += label.words == drawing.items[static_cast<std::size_t>(label.item)].lit_name;
        const auto read = read_one(label, fmt::format("label{}", label.item));
        if (!read) {  // part of it is out of the picture; one of which nothing is read is not read right
            ++result.unseen;
            continue;
        }
        const std::string written = written_in(label);
        const Reading reading = compare(written, *read);
        result.right += reading == Reading::right;
        if (reading != Reading::right) result.wrong.push_back(written + " | " + *read);
        if (reading == Reading::other_number) result.other_number.push_back(written + " | " + *read);
    }
    result.cards_lit = counts.card_lit;
    if (!counts.card_lit) return result;
    const auto card = read_one(*drawing.card, "card");
    result.cards_seen = card.has_value();
    if (card && compare(written_in(*drawing.card), *card) == Reading::right)
        result.cards_right = 1;
    else if (card)
        result.cards_wrong.push_back(written_in(*drawing.card) + " | " + *card);
    return result;
}

}  // namespace planlight::test
