#include <gtest/gtest.h>

#include <cmath>

#include "registration/projector_measurement/fit_response.h"
#include "registration/projector_measurement/light_findings.h"
#include "registration/projector_measurement/record_light.h"
#include "tests/registration/projector_measurement/card_room.h"
#include "tests/registration/projector_measurement/light_scene.h"

namespace planlight {
namespace {

using std::chrono::milliseconds;
using test::grey;

/// Greys with black and white round every four, as the recorder shows them; ends dark.
std::vector<LightOrder> greys_shown(const std::vector<int>& greys, bool pure_colours = true) {
    std::vector<Rgb> colours;
    for (std::size_t i = 0; i < greys.size(); ++i) {
        if (i % 4 == 0) colours.insert(colours.end(), {grey(0), grey(255)});
        colours.push_back(grey(greys[i]));
    }
    if (pure_colours) colours.insert(colours.end(), {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}});
    colours.insert(colours.end(), {grey(0), grey(255), grey(0)});
    return test::steady_orders(colours, milliseconds(400));
}

ResponseResult measured(const test::LightScene& scene, const std::vector<int>& greys = response_greys()) {
    const auto orders = greys_shown(greys);
    return measure_response(scene.record(orders, orders.back().at + milliseconds(400)));
}

bool says(const ResponseResult& result, const std::string& word) {
    for (const LightFinding& finding : findings_of(result))
        if (finding.what.find(word) != std::string::npos && !finding.remedy.empty()) return true;
    return false;
}

std::function<double(Rgb)> curve(std::function<double(double)> of_share) {
    return [=](Rgb c) {
        return 0.3 * of_share(c[0] / 255.0) + 0.5 * of_share(c[1] / 255.0) + 0.2 * of_share(c[2] / 255.0);
    };
}

TEST(Response, GammaIsThatOfThePanelWhateverTheTilesAndTheRoomAre) {
    for (const double gamma : {1.0, 1.8, 2.2, 2.6}) {
        test::LightScene scene;
        scene.light_of = curve([=](double s) { return std::pow(s, gamma); });
        const ResponseResult r = measured(scene);
        ASSERT_FALSE(r.refusal);
        EXPECT_NEAR(r.gamma, gamma, 0.01);
        EXPECT_LT(std::abs(r.gamma - gamma), 4 * r.gamma_sigma);
        EXPECT_TRUE(findings_of(r).empty()) << findings_of(r).front().what;
        ASSERT_TRUE(r.colours);
        EXPECT_NEAR((*r.colours)[1], 0.5, 0.005);
    }
}

TEST(Response, EndsThatLookTheSameAreNamedAndLimitedRangeIsRecognised) {
    test::LightScene scene;
    scene.light_of = curve([](double s) { return std::pow(std::clamp((s * 255 - 20) / 235, 0.0, 1.0), 2.2); });
    const ResponseResult dark = measured(scene);
    EXPECT_NEAR(dark.dark_end, 20, 1.5);
    EXPECT_TRUE(dark.crushes_darks && !dark.crushes_whites);
    EXPECT_TRUE(says(dark, "crushes the darks"));
    scene.light_of = curve([](double s) { return std::pow(std::min(s * 255 / 240, 1.0), 2.2); });
    const ResponseResult bright = measured(scene);
    EXPECT_NEAR(bright.bright_end, 240, 1);
    EXPECT_TRUE(says(bright, "crushes the whites"));
    scene.light_of = curve([](double s) { return std::pow(std::clamp((s * 255 - 16) / 219, 0.0, 1.0), 2.2); });
    EXPECT_TRUE(says(measured(scene), "limited range"));
}

TEST(Response, AnEnhancedCurveIsNoPowerAndAFoldedOneDoesNotRise) {
    test::LightScene scene;
    scene.light_of = curve([](double s) { return s * s * (3 - 2 * s); });  // an S: "dynamic contrast"
    EXPECT_GT(measured(scene).worst_departure, 0.03);
    scene.light_of = curve([](double s) { return s < 0.7 ? s : s < 0.8 ? 1.4 - s : s; });
    const ResponseResult folded = measured(scene);
    EXPECT_FALSE(folded.not_rising.empty());
    EXPECT_TRUE(says(folded, "brighter grey gives less light"));
}

TEST(Response, ACameraThatIsNotLinearIsNoticedByItsColours) {
    test::LightScene scene;
    scene.room_grey = 2;
    scene.camera = [](double g) { return 255 * std::pow(g / 255, 0.45); };
    EXPECT_TRUE(says(measured(scene), "cameras are not linear"));
    test::LightScene white_segment;
    white_segment.light_of = [](Rgb c) {
        return (0.2 * c[0] + 0.3 * c[1] + 0.15 * c[2] + 0.35 * std::min({c[0], c[1], c[2]})) / 255;
    };
    EXPECT_TRUE(says(measured(white_segment), "white segment"));
}

TEST(Response, ALampThatFadesDoesNotBendTheCurveAndOneThatJumpsIsSaid) {
    test::LightScene scene;
    scene.lamp_at = [](double t) { return 1 - 0.01 * t / 10; };
    EXPECT_NEAR(measured(scene).gamma, 1, 0.01);
    EXPECT_FALSE(says(measured(scene), "white changed"));
    scene.lamp_at = [](double t) { return t < 8 ? 1 : 0.85; };
    EXPECT_TRUE(says(measured(scene), "white changed"));
}

TEST(Response, NothingSeenSaturatedAndTooFewGreysAreRefusedWithARemedy) {
    test::LightScene scene;
    scene.white_grey = scene.room_grey + 2;
    auto r = measured(scene);
    ASSERT_TRUE(r.refusal);
    EXPECT_NE(r.refusal->reason.find("see nothing of the projector"), std::string::npos);
    EXPECT_FALSE(r.refusal->remedy.empty());
    test::LightScene bright;
    bright.white_grey = 700;
    bright.saturates_at = 255;
    r = measured(bright);
    ASSERT_TRUE(r.refusal);
    EXPECT_NE(r.refusal->reason.find("too bright"), std::string::npos);
    r = measured(test::LightScene{}, {0, 128, 255});
    ASSERT_TRUE(r.refusal);
    EXPECT_NE(r.refusal->reason.find("only 3 greys"), std::string::npos);
    EXPECT_TRUE(measure_response({}).refusal);
}

TEST(Response, InTheSimulatedRoomGammaEndsAndBlackAreThePanels) {
    simulation::BoardRoomSettings settings;
    settings.preset = simulation::Preset::paper;
    settings.seed = 4;
    settings.light.panel.gamma = 1.9;
    settings.light.panel.dark_end = 10.0 / 255;
    settings.light.panel.black = 0.003;
    test::CardRoom card(settings);
    LightRecording recording = record_response(card.bench);
    const ResponseResult bound = measure_response(recording);
    EXPECT_TRUE(bound.black_level_is_a_bound);
    EXPECT_GT(bound.black_level, settings.light.panel.black);
    card.room.cover_projector(true);
    record_covered(card.bench, recording);
    const ResponseResult r = measure_response(recording);
    ASSERT_FALSE(r.refusal) << r.refusal->reason;
    EXPECT_NEAR(r.gamma, 1.9, 0.005);
    EXPECT_NEAR(r.dark_end, 10, 0.2);
    EXPECT_TRUE(r.crushes_darks);
    EXPECT_FALSE(r.black_level_is_a_bound);
    EXPECT_NEAR(r.black_level, 0.003, 0.0002);
}

}  // namespace
}  // namespace planlight
