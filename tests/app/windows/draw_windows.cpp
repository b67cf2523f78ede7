#include <cstdlib>
#include <sstream>
#include <string>

#include "app/windows/operator_window.h"
#include "app/windows/scene_view.h"
#include "app/words/words.h"
#include "fake_model.h"
#include "write_picture.h"

/// draw_windows scene FILE [azimuth elevation], or draw_windows window FILE [width height status [view of the match: 0
/// to 2 [old, refused, evidence, answer, views, alone,
/// hidden, hidden-page, landmark, risk or plain [language [dark or bright]]]]]; with BANNER its words,
/// "headline|detail|..."
int main(int argc, char** argv) {
    using namespace planlight;
    OperatorModel model = test::fake_model();
    SceneView view = view_of_plan(*model.scene.plan);
    if (std::string(argv[1]) == "scene") {
        if (argc > 4) view.azimuth = std::stod(argv[3]), view.elevation = std::stod(argv[4]);
        test::write_picture(argv[2], render_scene(model.scene, view, 1280, 960));
        return 0;
    }
    WindowSettings settings;
    if (argc > 4) settings.width = std::stoi(argv[3]), settings.height = std::stoi(argv[4]);
    if (argc > 5) model = test::fake_model_with(static_cast<StatusKind>(std::stoi(argv[5])));
    const std::string special = argc > 7 ? argv[7] : "";
    if (argc > 8) settings.words = words_of(argv[8]);
    if (argc > 9 && std::string(argv[9]) == "bright") settings.theme = ThemeKind::bright;
    if (special == "old") {
        model.left.old_s = model.right.old_s = 7;
        model.left.note = "Left camera: no frame came for 7 s. Look at its cable and its power.";
    }
    if (special == "refused") {
        model.left.refused = model.left.live;
        model.right.refused = model.right.live;
        for (std::size_t i = 3; i < 6; ++i) model.left.refused->found[i].pairing = FoundMarker::Pairing::alone;
        model.right.refused->found.resize(3);
        model.status = {StatusKind::refused,
                        "Only 3 markers were found by both cameras; 5 are needed.",
                        {"Paste markers where both cameras see them, or turn the light up, and scan again."}};
    }
    if (special == "alone") {
        model.may_light_item = true;
        model.item_of_moment = 2;
        model.scene.bright_item = 2;
    }
    if (special.starts_with("hidden")) {
        model.may_light_item = true;
        model.rows.at(0).hidden = model.rows.at(2).hidden = true;
        model.rows[0].light_off_mm = model.rows[2].light_off_mm = std::nullopt;
        PlanDrawing shown = *model.scene.plan;
        std::erase_if(shown.strokes, [](const Stroke& stroke) { return stroke.item == 0 || stroke.item == 2; });
        std::erase_if(shown.labels, [](const Label& label) { return label.item == 0 || label.item == 2; });
        model.scene.plan = std::make_shared<PlanDrawing>(shown);
        model.status.details.push_back("2 of 4 items are hidden: they are not lit.");
        model.status.headline = "What is shown of the plan is on the skin.";
    }
    if (special == "risk") {
        model.rows[0].name = "Osteotomy  164 mm";
        for (int i = 1; i <= 4; ++i) {
            PlanRow& row = model.rows[static_cast<std::size_t>(i)];
            row.short_name = "B" + std::to_string(i) + "  ⌀7", row.name = row.short_name + "  6 mm deep";
        }
        model.rows[0].risk = {{"Sinus sagittalis superior", 0, true}, {"Dura", 1.3, false}};
        model.rows[1].risk = {{"Facial nerve", 1.24, false}};
        model.rows[2].risk = model.rows[3].risk = model.rows[4].risk = {{"Facial nerve", 14.2, false}};
        model.rows[5].name = "Trajectory to the upper left fossa, 60.0 mm";
        model.rows[5].risk = {{"Facial nerve", 0, true}};
        model.rows[5].predicted_error_mm = 2.4;
        model.scene.risk_structures = std::make_shared<std::vector<RiskStructure>>(
            std::vector<RiskStructure>{test::risk_structure("Facial nerve", {-30, -50, 30}, 0.15),
                                       test::risk_structure("Sinus sagittalis superior", {20, -40, 50}, 0.2)});
    }
    if (special == "landmark") {
        const Eigen::Vector3d ear(90, 5, -15);
        model.look_at = LookAt{ear, Eigen::Vector3d(1, 0.1, 0).normalized()};
        model.status = {StatusKind::check, "LOOK: is the ring of light on landmark 2 of 2?", {}, {}};
        model.confirm_words = "Light 2 is right";
        model.next = OperatorAction::confirm;
        model.check_skin = true;
    }
    if (const char* const banner = std::getenv("BANNER")) {
        std::istringstream lines(banner);
        std::getline(lines, model.status.headline, '|');
        model.status.details.clear();
        for (std::string detail; std::getline(lines, detail, '|');) model.status.details.push_back(detail);
    }
    OperatorWindow window(settings);
    if (special == "evidence" || special == "alone-page" || special == "hidden-page") window.open_evidence();
    if (special == "views") window.open_views();
    if (special == "answer") window.say("Track is not possible now: register first.");
    window.set_view(view);
    if (argc > 6) window.set_fit_view(static_cast<FitView>(std::stoi(argv[6])));
    for (int i = 0; i < 3; ++i) window.frame(model);
    test::write_picture(argv[2], window.screenshot());
}
