// Every text of the operator's window has room in its place, in every language, at the sizes of monitors.
#include <gtest/gtest.h>

#include "app/live/session_states.h"
#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"
#include "tests/app/windows/fake_model.h"
#include "tests/app/words/drawn_words.h"

namespace planlight {
namespace {

class WordsInPlace : public DrawnInPlace {
protected:
    void way_buttons(const OperatorModel& model) {
        const WindowLayout& place = drawn_.place;
        const float width = (place.buttons.width - 3 * place.gap) / 4;
        Box box = place.buttons;
        box.width = width;
        for (const auto& [label, state] : {std::pair{"Scan", &model.scan},
                                           {"Register", &model.do_register},
                                           {"Track", &model.track},
                                           {"Stop", &model.stop}}) {
            button(drawn_.pen, box, label, *state, {false, true, keys_of_button(KeyMeaning::scan, true)});
            button(drawn_.pen, box, label, {true, {}}, {false, true, keys_of_button(KeyMeaning::scan, true)});
            box.x += width + place.gap;
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Windows, WordsInPlace, every_language_and_size());

TEST_P(WordsInPlace, EveryButtonHasRoomForItsWordAndItsReason) {
    const OperatorModel blank;
    for (const SessionState state : kSessionStates) {
        OperatorModel model;
        enter(state, blank, model);
        way_buttons(model);
        expect_whole(view_of(state).name);
    }
    const float scale = drawn_.place.scale;
    const Box corner = corner_button(drawn_.place.scene, scale);
    for (const char* label : {"It fits: use it", "Show landmarks", "Light 2 is right", "Go on with the last match",
                              "Check skin", "Landmarks", "Show the whole plan"})
        button(drawn_.pen, corner, label, {true, {}}, {false, true, keys_of_button(KeyMeaning::confirm, true)});
    expect_whole("in the corner of the view");
    Box fit = fit_row(drawn_.place.scene, scale);
    fit.width = (fit.width - 16 * scale) / 3;
    for (const char* label : {"Before", "After", "Error"})
        button(drawn_.pen, fit, label, {true, {}}, {true, false, "1"});
    expect_whole("over the view");
    draw_dark_button(drawn_.pen, drawn_.place.dark, false, false, key_text(KeyMeaning::dark));
    expect_whole("DARK");
}

TEST_P(WordsInPlace, EveryStateHasRoomForItsSentences) {
    const OperatorModel blank, lit = test::fake_model();
    for (const SessionState state : kSessionStates) {
        OperatorModel model = lit;
        enter(state, blank, model);
        draw_banner(drawn_.pen, drawn_.place.banner, model);
        model.status = dark_status(state);
        draw_banner(drawn_.pen, drawn_.place.banner, model);
        expect_whole(view_of(state).name);
    }
}

TEST_P(WordsInPlace, TheLightsWordsHaveRoomBesideItsFigures) {
    OperatorModel model = test::fake_model();
    for (const auto& [kind, headline, details] :
         {std::tuple{StatusKind::aligned, "The plan is on the skin.",
                     "Measured by the cameras: 95 % of the light within 0.3 mm of the plan."},
          std::tuple{StatusKind::check, "LOOK at the light on two landmarks.",
                     "The cameras measure it within 0.3 mm of the plan."},
          std::tuple{StatusKind::check, "LOOK: the light lies up to 1.3 mm beside the plan.",
                     "Wait until the patient lies still; if it stays so, scan again."},
          std::tuple{StatusKind::dark, "Dark: the patient is not tracked: only 3 of 6 markers seen; 4 are needed.",
                     "The light comes back by itself when the pose is good."}}) {
        model.status = {kind, headline, {details}};
        if (kind == StatusKind::dark) model.figures = {};
        draw_banner(drawn_.pen, drawn_.place.banner, model);
        expect_whole(headline);
    }
}

TEST_P(WordsInPlace, HeaderAndTableHaveRoom) {
    OperatorModel model = test::fake_model();
    model.case_title = model.case_plan = model.case_subtitle = "E. M.";
    for (const char* side : {"LEFT", "RIGHT", "BOTH SIDES", "MIDDLE"})
        for (const StepState state : {StepState::active, StepState::attention, StepState::done}) {
            model.case_side = side;
            model.steps.fill(state);
            for (const RoomKind kind : {RoomKind::simulated, RoomKind::recorded}) {
                model.room_kind = kind;
                draw_header(drawn_.pen, drawn_.place, model);
                expect_whole(side);
            }
        }
    for (PlanRow& row : model.rows) row.name = "B";
    model.evidence.clear();
    draw_table(drawn_.pen, drawn_.place.table, model, {}, false);
    expect_whole("table");
    model.rows.at(0).risk = {{"Dura", 0, true}, {"Facial nerve", 1.2, false}};
    model.rows.at(1).risk = {{"Facial nerve", 1.27, false}};
    draw_table(drawn_.pen, drawn_.place.table, model, {}, false);
    expect_whole("table with risk structures");
    CameraPicture camera{"Right camera", {}, 0, "no picture yet", {}};
    draw_camera(drawn_.pen, drawn_.place.left_camera, camera, false, nullptr);
    expect_whole("camera");
}

// The name gives way, and in its middle; version, date and what the room is do not.
TEST_P(WordsInPlace, TheHeaderOfALongNameCutsNothingElse) {
    OperatorModel model = test::fake_model();
    model.case_title = "Maximiliana-Alexandrina von und zu Hohenlohe-Schillingsfürst, born 1951, 00514711";
    model.case_plan = "Right frontal craniotomy after the tumour board, version 3 · series of 2012-09-14";
    for (const RoomKind kind : {RoomKind::real, RoomKind::simulated, RoomKind::recorded}) {
        model.room_kind = kind;
        draw_header(drawn_.pen, drawn_.place, model);
        for (const std::string& text : drawn_.cut) EXPECT_LT(width(), 1280) << "no room for \"" << text << "\"";
        drawn_.cut.clear();
    }
}

TEST_P(WordsInPlace, NoLineEndsBetweenANumberAndItsUnit) {
    constexpr std::size_t kAnyLines = 99;
    const std::string text = "Half of them lie within 0.09 mm of the plan, 95 % within 0.23 mm.";
    for (float room = 60; room < 900; room += 7)
        for (const std::string& line : broken(drawn_.pen.fonts.body, text, room, kAnyLines)) {
            EXPECT_FALSE(line.starts_with("mm") || line.starts_with("%")) << line;
        }
}

// Whatever stands in the other columns: the name matters most.
TEST_P(WordsInPlace, AnItemsNameIsReadInTheTable) {
    OperatorModel model = test::fake_model();
    for (PlanRow& row : model.rows) {
        row.depth_mm = 188.8;
        row.predicted_error_mm = row.light_off_mm = 12.8;
        row.risk = {{"Facial nerve", 1.27, false}, {"Dura", 1.3, false}};
    }
    model.rows.back().hidden = true;
    EXPECT_GE(table_name_width(drawn_.pen, drawn_.place.table, model),
              text_width(drawn_.pen.fonts.body, "Osteotomy  164 mm"));
}

// Rows are of one line and of two: the one that is sought is among those that are drawn, and the last is reached.
TEST_P(WordsInPlace, ARowThatIsSoughtIsSeenAndTheTableEndsWithTheLast) {
    OperatorModel model = test::fake_model();
    const PlanRow plain = model.rows.at(1);
    for (std::size_t i = 0; i < 40; ++i) {
        model.rows.push_back(plain);
        if (i % 3 == 0) model.rows.back().risk = {{"Facial nerve", 0, true}};
    }
    const Box& box = drawn_.place.table;
    const int count = static_cast<int>(model.rows.size()),
              last = draw_table(drawn_.pen, box, model, {count, {}, false}, false);
    EXPECT_EQ(draw_table(drawn_.pen, box, model, {0, {}, false}, false), 0);
    EXPECT_GT(last, 0);
    EXPECT_LT(last, count - 1) << "no empty room below the last row";
    int first = 0;
    for (std::size_t row = 0; row < model.rows.size(); ++row) {
        first = draw_table(drawn_.pen, box, model, {first, row, true}, false);
        EXPECT_LE(first, static_cast<int>(row));
        EXPECT_LE(first, last);
    }
    EXPECT_EQ(first, last);
    EXPECT_EQ(draw_table(drawn_.pen, box, model, {last, 3, true}, false), 3);
}

}  // namespace
}  // namespace planlight
