#include "app/evaluation/chain_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/case_model.h"
#include "app/live/scene_of_session.h"
#include "app/windows/camera_picture.h"
#include "app/windows/scene_view.h"

namespace planlight {
namespace {

constexpr Rgb kSeen{60, 220, 120};
constexpr int kSceneWidth = 960, kSceneHeight = 720;
/// Updates after the start of a stage at which its picture is taken: the light must have reached the skin.
constexpr int kSettled = 6;

/// Two pictures side by side, cut to the lower height.
RgbImage side_by_side(const RgbImage& a, const RgbImage& b) {
    RgbImage both(a.width + b.width, std::min(a.height, b.height));
    for (int y = 0; y < both.height; ++y) {
        for (int x = 0; x < a.width; ++x) both.at(x, y) = a.at(x, y);
        for (int x = 0; x < b.width; ++x) both.at(a.width + x, y) = b.at(x, y);
    }
    return both;
}

RgbImage coloured(const GrayImage& gray) {
    RgbImage picture(gray.width, gray.height);
    std::transform(gray.pixels.begin(), gray.pixels.end(), picture.pixels.begin(), [](auto v) { return Rgb{v, v, v}; });
    return picture;
}

/// A camera picture with a ring round every marker that was found.
RgbImage with_markers(const GrayImage& gray, const std::vector<PatientTracker::Seen>& seen) {
    RgbImage picture = coloured(brightened(gray));
    for (const auto& found : found_markers(seen)) {
        const double radius = 1.6 * found.radius_px;
        const int steps = static_cast<int>(8 * radius) + 8;
        for (int ring = 0; ring < 3; ++ring)
            for (int i = 0; i < steps; ++i) {
                const double angle = 2 * 3.14159265358979 * i / steps;
                const int x = static_cast<int>(std::lround(found.pixel.x() + (radius + ring) * std::cos(angle)));
                const int y = static_cast<int>(std::lround(found.pixel.y() + (radius + ring) * std::sin(angle)));
                if (x >= 0 && y >= 0 && x < picture.width && y < picture.height) picture.at(x, y) = kSeen;
            }
    }
    return picture;
}

/// Decoded projector columns as hues that repeat every 64 columns; undecoded pixels black.
RgbImage code_map(const DecodedView& view) {
    RgbImage picture(view.width, view.height);
    for (std::size_t i = 0; i < view.column.size(); ++i) {
        if (!std::isfinite(view.column[i])) continue;
        const double hue = 6 * (view.column[i] / 64 - std::floor(view.column[i] / 64));
        const auto channel = [&](double shift) {
            const double h = std::fmod(hue + shift, 6.0);
            const double v = h < 1 ? h : h < 3 ? 1 : h < 4 ? 4 - h : 0;
            return static_cast<std::uint8_t>(40 + 200 * v);
        };
        picture.pixels[i] = {channel(2), channel(0), channel(4)};
    }
    return picture;
}

}  // namespace

ChainPictures::ChainPictures(const Case& the_case, const CaseDrawing& drawing) : case_(the_case), drawing_(drawing) {
    SceneModel scene;
    scene.on_paper = true;
    scene.skin = std::make_shared<TriangleMesh>(the_case.skin);
    scene.plan = std::make_shared<PlanDrawing>(drawing.drawing);
    add("Skin and plan", "The outer skin from the CT with the plan drawn in the skin's own metric.",
        render_scene(scene, view_of_plan(drawing.drawing), kSceneWidth, kSceneHeight));
}

void ChainPictures::watch(ChainWatcher& watcher) {
    watcher.scanned = [this](const Session& session, const simulation::SimulatedRig&) { take_scan(session); };
    watcher.registered = [this](const Session& session, const simulation::SimulatedRig&) { take_match(session); };
    watcher.updated = [this](const Session& session, const simulation::SimulatedRig& rig, const Session::Update& update,
                             const std::string& stage) { take_light(session, rig, update, stage); };
}

void ChainPictures::take_scan(const Session& session) {
    const ScanCapture& capture = *session.capture();
    const ScanResult& scan = *session.scanned();
    const auto sequence = stripe_sequence(capture.stripes);
    const auto named = [&](const std::string& name) {
        const auto found =
            std::find_if(sequence.begin(), sequence.end(), [&](const auto& p) { return p.name == name; });
        return found == sequence.end() ? std::size_t{0} : static_cast<std::size_t>(found - sequence.begin());
    };
    add("Coded light",
        "One Gray-code stripe picture and one phase picture as the left camera sees them (Fig. 2, left).",
        side_by_side(coloured(capture.left[named("column-gray-4")]), coloured(capture.left[named("column-phase-0")])));
    add("Decoded projector columns",
        fmt::format("Left camera, colours repeat every 64 columns; {} pixels decoded, the rest dropped.",
                    scan.left.decoded),
        code_map(scan.left));
}

void ChainPictures::take_match(const Session& session) {
    const RegistrationResult& found = *session.registration();
    const ScanResult& scan = *session.scanned();
    const SceneView view = view_of_plan(drawing_.drawing);
    SceneModel scene;
    scene.on_paper = true;
    scene.ct_from_rig = found.patient_from_ct.inverse();
    scene.cloud = std::make_shared<PointCloud>(scan.raw.cloud);
    scene.cloud_distance_mm = distances_to_skin_mm(*scene.cloud, scene.ct_from_rig, case_.lut);
    RgbImage raw = render_scene(scene, view, kSceneWidth, kSceneHeight);
    scene.cloud = std::make_shared<PointCloud>(scan.clean.kept);
    scene.cloud_distance_mm = distances_to_skin_mm(*scene.cloud, scene.ct_from_rig, case_.lut);
    add("Cloud before and after the outliers were removed",
        fmt::format("{} raw points, {} kept (Fig. 2, middle and right).", scan.raw.cloud.size(),
                    scan.clean.kept.size()),
        side_by_side(raw, render_scene(scene, view, kSceneWidth, kSceneHeight)));
    if (found.verdict == Verdict::no) return;
    scene.skin = std::make_shared<TriangleMesh>(case_.skin);
    const RigidTransform after = scene.ct_from_rig;
    const double offset_mm = scene.skin_offset_mm = found.skin_offset_mm.value_or(0);
    scene.ct_from_rig = found.initial_patient_from_ct.inverse();
    scene.cloud_distance_mm = distances_to_skin_mm(*scene.cloud, scene.ct_from_rig, case_.lut, offset_mm);
    RgbImage before = render_scene(scene, view, kSceneWidth, kSceneHeight);
    scene.ct_from_rig = after;
    scene.cloud_distance_mm = distances_to_skin_mm(*scene.cloud, scene.ct_from_rig, case_.lut, offset_mm);
    add("Scan on skin before and after the fine match",
        fmt::format(
            "Residual {:.2f} mm rms, {:.0f} % of the points on the skin (Fig. 3). Distances are to the skin where this "
            "scan found it as a whole: {:+.2f} mm outside of the CT's.",
            found.residual_rms_mm, 100 * found.inlier_fraction, offset_mm),
        side_by_side(before, render_scene(scene, view, kSceneWidth, kSceneHeight)));
    scene.cloud = nullptr;
    scene.cloud_distance_mm = nullptr;
    scene.skin_error_mm = predicted_on_skin_mm(case_.skin, found);
    add("How far off the match may be",
        "95 % bound at every point of the skin, from how far the skin moved since the CT as the residuals tell it.",
        render_scene(scene, view, kSceneWidth, kSceneHeight));
}

void ChainPictures::take_light(const Session& session, const simulation::SimulatedRig& rig,
                               const Session::Update& update, const std::string& stage) {
    int& updates = stage == "at rest" ? rest_updates_ : moving_updates_;
    if (++updates != kSettled || !update.overlay.lit || (stage != "at rest" && stage != "moving")) return;
    add("Cameras, " + stage,
        "Left and right camera: the plan as light on the patient, rings round the markers that were found (Fig. 4). "
        "Brightened for the page.",
        side_by_side(with_markers(update.frame.left, session.tracker().seen_left()),
                     with_markers(update.frame.right, session.tracker().seen_right())));
    if (stage == "at rest")
        add("Projector picture", "What the second window shows: the plan bent so that it lies true on the skin.",
            update.overlay.picture);
    SceneModel scene;
    scene.on_paper = true;
    scene.skin = std::make_shared<TriangleMesh>(case_.skin);
    scene.plan = std::make_shared<PlanDrawing>(session.drawing());
    scene.light = true_light_lines(session.drawing(), rig.calibration(), update.overlay, rig);
    add("Light on the skin, " + stage, "White: where the light truly falls. Coloured: where the plan wants it.",
        render_scene(scene, view_of_plan(drawing_.drawing), kSceneWidth, kSceneHeight));
}

void ChainPictures::add(const std::string& title, const std::string& caption, RgbImage picture) {
    pictures_.push_back({title, caption, std::move(picture)});
}

}  // namespace planlight
