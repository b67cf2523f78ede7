#include "fake_model.h"

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

Stroke loop(StrokeKind kind, int item, const Rgb& colour, const Eigen::Vector3d& centre_in_ct, double radius_mm,
            double wave) {
    Stroke stroke{kind, item, colour, 0.8, true, {}, {}};
    const Eigen::Vector3d normal = analytic_head_normal(centre_in_ct), u = normal.unitOrthogonal(), v = normal.cross(u);
    for (int i = 0; i < 120; ++i) {
        const double angle = 2 * std::numbers::pi * i / 120, r = radius_mm * (1 + wave * std::cos(3 * angle));
        const Eigen::Vector3d p = on_analytic_head(centre_in_ct + r * (std::cos(angle) * u + std::sin(angle) * v));
        stroke.points_in_ct.push_back(p);
        stroke.normals_in_ct.push_back(analytic_head_normal(p));
    }
    return stroke;
}

PlanDrawing plan_on_forehead() {
    PlanDrawing plan;
    const Eigen::Vector3d middle = on_analytic_head({-35, -85, 55});
    plan.strokes.push_back(loop(StrokeKind::osteotomy_line, 0, {40, 235, 110}, middle, 24, 0.15));
    const Stroke cut = plan.strokes.front();
    for (int i = 0; i < 4; ++i)
        plan.strokes.push_back(loop(StrokeKind::borehole, i + 1, {70, 170, 250},
                                    cut.points_in_ct[static_cast<std::size_t>(15 + 30 * i)], 3.5, 0));
    plan.strokes.push_back(loop(StrokeKind::trajectory, 5, {255, 180, 30}, on_analytic_head({45, -80, 50}), 3, 0));
    return plan;
}

GrayImage head_picture(double shift) {
    GrayImage picture(744, 576, 12);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const double u = (x - 380 - shift) / 190.0, v = (y - 290) / 230.0, r2 = u * u + v * v;
            if (r2 < 1) picture.at(x, y) = static_cast<std::uint8_t>(30 + 130 * std::sqrt(1 - r2));
        }
    return picture;
}

CameraPicture camera(const std::string& title, double shift) {
    CameraPicture result{title, {}, 0, {}, {}};
    GrayImage picture = head_picture(shift);
    for (int i = 0; i < 6; ++i) {
        const Eigen::Vector2d at(300 + shift + 90 * (i % 3), 190 + 110 * (i / 3) + 20 * (i % 2));
        for (int y = -12; y <= 12; ++y)
            for (int x = -12; x <= 12; ++x)
                if (x * x + y * y < 144)
                    picture.at(static_cast<int>(at.x()) + x, static_cast<int>(at.y()) + y) =
                        x * x + y * y < 36 ? 10 : 235;
        result.live.found.push_back({at, 6});
    }
    result.live.picture = std::make_shared<GrayImage>(std::move(picture));
    return result;
}

SceneModel scene() {
    SceneModel result;
    result.skin = std::make_shared<TriangleMesh>(analytic_head_mesh(2.5));
    result.cloud = std::make_shared<PointCloud>(view_of_analytic_head({-150, -600, 120}, 220, 9000, 7));
    std::mt19937 random(1);
    std::normal_distribution<float> error(0.0F, 0.4F);
    auto distance = std::make_shared<std::vector<float>>();
    for (std::size_t i = 0; i < result.cloud->size(); ++i) distance->push_back(std::abs(error(random)));
    result.cloud_distance_mm = distance;
    result.plan = std::make_shared<PlanDrawing>(plan_on_forehead());
    auto markers = std::make_shared<std::vector<SceneMarker>>();
    for (const Eigen::Vector3d& near : {Eigen::Vector3d(-70, -50, 20), Eigen::Vector3d(0, -95, 75),
                                        Eigen::Vector3d(62, -60, 20), Eigen::Vector3d(-20, -90, 20)}) {
        const Eigen::Vector3d p = on_analytic_head(near);
        markers->push_back({p, analytic_head_normal(p), markers->size() != 2});
    }
    result.markers = markers;
    auto light = std::make_shared<std::vector<LightLine>>();
    Stroke lit = result.plan->strokes.front();
    for (Eigen::Vector3d& p : lit.points_in_ct) p = on_analytic_head(p + Eigen::Vector3d(0.6, 0, 0.3));
    light->push_back({lit.points_in_ct, true});
    result.light = light;
    return result;
}

/// A match 4 mm aside before the fine match; its predicted error grows with the distance from the face.
FitViews fit_of(const SceneModel& scene) {
    FitViews fit;
    fit.before_ct_from_rig = Eigen::Translation3d(-4, 0, 0) * scene.ct_from_rig;
    fit.before_distance_mm = std::make_shared<std::vector<float>>(scene.cloud->size(), 1.2F);
    auto predicted = std::make_shared<std::vector<float>>();
    for (const Eigen::Vector3d& p : scene.skin->vertices_in_ct)
        predicted->push_back(static_cast<float>(0.5 + (p.y() + 90) / 60));
    fit.predicted_mm = predicted;
    return fit;
}

/// The whole head as scanned, so that every place can be clicked on both sides.
LandmarkViews landmarks_of(const SceneModel& scene) {
    static const SkinSurface skin(*scene.skin);
    return {&skin,
            std::make_shared<ClickableScan>(ClickableScan{SkinSurface(*scene.skin), RigidTransform::Identity()})};
}

OperatorModel make_model() {
    OperatorModel model;
    model.case_title = "E. M., 0051";
    model.case_plan = "Right frontal, version 3 · series of 2012-09-14";
    model.case_subtitle = "Case 93e8e8b7-93c2 · 1 osteotomy, 4 boreholes, 1 trajectory";
    model.case_side = "RIGHT";
    model.steps = {StepState::done, StepState::done, StepState::done,
                   StepState::done, StepState::done, StepState::active};
    model.scene = scene();
    model.left = camera("Left camera", -40);
    model.right = camera("Right camera", 40);
    model.rows = {{{40, 235, 110}, "Osteotomy, 148.0 mm", {}, 0.7, 0.3}};
    for (int i = 1; i <= 4; ++i)
        model.rows.push_back(
            {{70, 170, 250}, "Borehole " + std::to_string(i) + ", ⌀ 7.0 mm", 6.0, 0.6 + 0.05 * i, 0.2});
    model.rows.push_back({{255, 180, 30}, "Trajectory, 60.0 mm", 60.0, 1.2, 0.3});
    model.evidence = {"One answer: the runner-up is 2.4 times worse · this patient · not the mirror image",
                      "Surface sufficient: weakest direction 0.2 mm · patient still during the scan",
                      "Projector unmoved since 09:41 · last check 0.4 s ago"};
    model.status = {StatusKind::aligned,
                    "The plan on the skin may be used.",
                    {"Trajectory target: 1.2 mm at 60.0 mm depth: check before drilling deep."}};
    model.figures = {0.3, 60.0, 4.1, 1.2, 41.0};
    model.scan = {true, ""};
    model.do_register = {true, ""};
    model.track = {false, "is running"};
    model.stop = {true, ""};
    model.fit = fit_of(model.scene);
    model.confirm = true;
    model.landmarks = landmarks_of(model.scene);
    return model;
}

}  // namespace

OperatorModel fake_model() {
    static const OperatorModel model = make_model();  // its head takes a third of a second
    return model;
}

RiskStructure risk_structure(const std::string& name, const Eigen::Vector3d& middle_in_ct, double size) {
    RiskStructure made{name, analytic_head_mesh(4)};
    for (auto& p : made.surface.vertices_in_ct) p = middle_in_ct + size * p;
    made.surface.normals_in_ct.clear();
    return made;
}

OperatorModel fake_model_with(StatusKind kind) {
    OperatorModel model = fake_model();
    model.status = {kind, "", {}};
    if (kind == StatusKind::check) {
        model.status.headline = "Look at the light on two landmarks before the plan is used.";
        model.status.details = {"Surface is nearly round: the head could turn by 1.9° unseen.",
                                "Marker 3 is hidden: five of six are seen."};
        model.steps[4] = StepState::attention;
        model.steps[5] = StepState::waiting;
        model.rows[2].predicted_error_mm = 2.4;
    } else if (kind == StatusKind::dark) {
        model.status.headline = "The projector is dark: no fresh pose for 82.0 ms.";
        model.status.details = {"Only two markers are seen by the left camera: take away what hides them."};
        model.figures = {};
    } else if (kind == StatusKind::scanning || kind == StatusKind::ready) {
        model.status.headline = kind == StatusKind::ready ? "Ready to scan." : "Pattern 12 of 44. Keep the head still.";
        model.steps = {StepState::done,    StepState::done,    StepState::active,
                       StepState::waiting, StepState::waiting, StepState::waiting};
        model.scan = {false, "is running"};
        model.do_register = {false, "scan first"};
        model.track = {false, "register first"};
        model.scene.cloud_distance_mm = nullptr;
        model.scene.light = nullptr;
        for (PlanRow& row : model.rows) row.predicted_error_mm = row.light_off_mm = std::nullopt;
        model.figures = {};
        model.left.live = {};
        model.left.note = "waiting for the first picture";
        model.evidence.clear();
    } else if (kind == StatusKind::refused) {
        model.status.headline = "This is not the patient of the plan, or too little skin is seen.";
        model.status.details = {"The best pose explains 61.0 % of the scan; a mirrored one explains 60.0 %."};
    }
    return model;
}

}  // namespace planlight::test
