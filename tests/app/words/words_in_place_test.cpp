// Every text of the operator's window has room in its place, in every language, at the sizes of monitors.
#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <memory>
#include <regex>
#include <tuple>

#include "app/live/not_kept.h"
#include "app/live/session_states.h"
#include "app/windows/camera_page_panels.h"
#include "app/windows/fonts.h"
#include "app/windows/guide_panels.h"
#include "app/windows/layout.h"
#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"
#include "app/windows/review_panels.h"
#include "app/words/words.h"
#include "planning_io/files/disk_refusal.h"
#include "projection/light_cause.h"
#include "tests/app/windows/fake_model.h"
#include "tests/app/words/source_texts.h"

namespace planlight {
namespace {

/// A window without a display: it is laid out and drawn into a list, which nobody sees.
class DrawnWords {
public:
    DrawnWords(const std::string& language, int width, int height)
        : words_(words_of(language)), place(layout_of(width, height)) {
        ImGui::SetCurrentContext(context_);
        ImGui::GetIO().DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
        ImGui::GetIO().IniFilename = nullptr;
        FontLetters letters{words_->letters(), {}};
        for (int kind = 0; kind <= static_cast<int>(StatusKind::waiting); ++kind)
            letters.word += words_->say(status_word(static_cast<StatusKind>(kind)));
        for (const std::string& word : guide_words()) letters.word += words_->say(word);
        pen.fonts = load_fonts(*ImGui::GetIO().Fonts, find_fonts(), place.scale, letters);
        unsigned char* pixels = nullptr;
        int w = 0, h = 0;
        ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &w, &h);
        pen.scale = place.scale;
        pen.words = words_.get();
        pen.cut = &cut;
        pen.lacking = &lacking;
    }
    ~DrawnWords() {
        ImGui::SetCurrentContext(context_);
        end();
        ImGui::DestroyContext(context_);
    }
    DrawnWords(const DrawnWords&) = delete;
    DrawnWords& operator=(const DrawnWords&) = delete;

    /// An empty list to draw into, in which nothing was cut yet.
    void begin() {
        ImGui::SetCurrentContext(context_);
        end();
        ImGui::NewFrame();
        ImGui::Begin("all");
        drawing_ = true;
        pen.list = ImGui::GetWindowDrawList();
        cut.clear();
        lacking.clear();
    }

    void way_buttons(const OperatorModel& model) {
        const float width = (place.buttons.width - 3 * place.gap) / 4;
        Box box = place.buttons;
        box.width = width;
        for (const auto& [label, state] : {std::pair{"Scan", &model.scan},
                                           {"Register", &model.do_register},
                                           {"Track", &model.track},
                                           {"Stop", &model.stop}}) {
            button(pen, box, label, *state, {false, true, "S · Enter"});
            button(pen, box, label, {true, {}}, {false, true, "S · Enter"});
            box.x += width + place.gap;
        }
    }

private:
    void end() {
        if (!drawing_) return;
        ImGui::End();
        ImGui::EndFrame();
        drawing_ = false;
    }
    ImGuiContext* const context_ = ImGui::CreateContext();
    bool drawing_ = false;
    std::shared_ptr<const Words> words_;

public:
    const WindowLayout place;
    std::vector<std::string> cut;
    std::set<unsigned> lacking;
    Pen pen{};
};

/// From the least that a window may have, upright and on end, to the largest monitors.
constexpr std::pair<int, int> kSizes[] = {{800, 600},   {1024, 768}, {1280, 720},  {1366, 768}, {1920, 1080},
                                          {3840, 2160}, {600, 800},  {1080, 1920}, {720, 1280}};

using LanguageAndSize = std::tuple<std::string, std::pair<int, int>>;

/// The window in that language and size; its fonts are made once for all tests.
DrawnWords& drawn_words(const LanguageAndSize& wanted) {
    static std::map<LanguageAndSize, std::unique_ptr<DrawnWords>> made;
    auto& drawn = made[wanted];
    const auto& [language, size] = wanted;
    if (!drawn) drawn = std::make_unique<DrawnWords>(language, size.first, size.second);
    drawn->begin();
    return *drawn;
}

class WordsInPlace : public testing::TestWithParam<LanguageAndSize> {
protected:
    DrawnWords& drawn_ = drawn_words(GetParam());
    void expect_whole(const std::string& where) {
        for (const std::string& text : drawn_.cut) ADD_FAILURE() << where << ": no room for \"" << text << "\"";
        drawn_.cut.clear();
        EXPECT_TRUE(drawn_.lacking.empty()) << where << ": a letter has no sign in the font";
    }
};
INSTANTIATE_TEST_SUITE_P(Windows, WordsInPlace,
                         testing::Combine(testing::Values("en", "de", "ru"), testing::ValuesIn(kSizes)));

TEST_P(WordsInPlace, EveryButtonHasRoomForItsWordAndItsReason) {
    const OperatorModel blank;
    for (const SessionState state : kSessionStates) {
        OperatorModel model;
        enter(state, blank, model);
        drawn_.way_buttons(model);
        expect_whole(view_of(state).name);
    }
    const float scale = drawn_.place.scale;
    const Box corner = corner_button(drawn_.place.scene, scale);
    for (const char* label : {"It fits: use it", "Show landmarks", "Light 2 is right", "Go on with the last match",
                              "Check skin", "Landmarks", "Show the whole plan"})
        button(drawn_.pen, corner, label, {true, {}}, {false, true, "C · Enter"});
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

TEST_P(WordsInPlace, TheWindowOfAReviewHasRoomForItsWords) {
    const ReviewLayout place = review_layout(static_cast<float>(std::get<1>(GetParam()).first),
                                             static_cast<float>(std::get<1>(GetParam()).second));
    ReviewModel model;
    draw_time_line(drawn_.pen, place.time_line, model);
    expect_whole("while it is read");
    auto line = std::make_shared<TimeLine>();
    line->lasted_s = 3723;
    line->stretches = {{0, 3723, LightTrust::look, 1.3, 2.4}};
    line->events = {{10, "Amber: LOOK: the light lies up to 1.3 mm beside the plan."}, {20, "Pressed: dark."}};
    model.line = line;
    model.now_s = 15;
    model.places = {{{}, {0, 0, 0}, 0.31, "B1: 0.31 mm beside the plan (± 0.12 mm, one standard deviation)"}};
    model.sum = "Light was found at 60 of 66 places; half of them lie within 0.10 mm of the plan, 95 % within 0.31 mm.";
    for (const std::optional<std::size_t> picked : {std::optional<std::size_t>(), std::optional<std::size_t>(0)}) {
        model.picked = picked;
        draw_review_words(drawn_.pen, place.words, model);
        draw_time_line(drawn_.pen, place.time_line, model);
        draw_review_light(drawn_.pen, place.head, model, nullptr);
        for (const std::size_t camera : {0U, 1U})
            draw_review_camera(drawn_.pen, camera == 0 ? place.left : place.right, model, camera, false, nullptr, {});
        expect_whole("a review");
    }
    for (const auto& [label, key] :
         {std::pair{"Beginning", "Home"}, std::pair{"Event before", "↑"}, std::pair{"Frame before", "←"},
          std::pair{"Frame after", "→"}, std::pair{"Event after", "↓"}, std::pair{"End", "End"},
          std::pair{"Whole picture", "Z"}, std::pair{"Projector", "V"}})
        for (const bool enabled : {true, false})
            button(drawn_.pen, place.buttons[0], label, {enabled, "it is being read"}, {false, false, key});
    expect_whole("the buttons of a review");
}

TEST_P(WordsInPlace, ThePageOfTheCamerasHasRoom) {
    const auto [width, height] = std::get<1>(GetParam());
    const CameraPageLayout place =
        camera_page_layout(static_cast<float>(width), static_cast<float>(height), drawn_.place.scale);
    CameraPageModel model;
    model.title = "Aim, focus and expose the cameras";
    for (CameraPageModel::Camera* camera : {&model.left, &model.right}) {
        camera->title = camera == &model.left ? "Left camera" : "Right camera";
        camera->sharpness = 123.45, camera->best_sharpness = 150;
        camera->too_bright_percent = camera->too_dark_percent = 100;
        camera->exposure_ms = 133.33, camera->frames_hz = 149.9, camera->asked_hz = 150, camera->lost = 12345;
    }
    const auto expect_room = [&](const std::string& where) {
        draw_camera_page(drawn_.pen, place, model, {nullptr, nullptr});
        expect_whole(where);
    };
    expect_room("before anything is known");
    model.allowed_ms = 1;
    for (const double apart : {0.02, -15.25}) {
        model.apart_ms = apart;
        for (const TestPicture shown : kTestPictures) {
            model.shown = shown;
            expect_room(text_of(shown));
        }
    }
    model.left.notes = {"its gamma stays at 1.0", "its automatic gain cannot be switched off"};
    model.right.trouble = "no whole frame came from it for 500 ms, and 12 with packets lost";
    model.right.trouble_remedy =
        "Look at the network: its receive buffer (net.core.rmem_max), jumbo frames, other traffic.";
    model.no_light = "no projector";
    expect_room("with troubles");
    const float shrunk = std::min(1.0F, static_cast<float>(std::max(width, height)) / 1280);  // below 1280 x 720
    for (const Box* box : {&place.dark, &place.buttons[4]})
        EXPECT_GE(box->height, 71.9F * shrunk) << "for a gloved finger";
    const float share = height <= width ? 0.35F : shrunk < 1 ? 0.12F : 0.2F;
    EXPECT_GE(place.picture[0].height, share * static_cast<float>(height)) << "pictures are what it is for";
}

TEST_P(WordsInPlace, TheWindowOfAGuidedCalibrationHasRoomForItsWords) {
    GuideModel model;
    model.title = "Guided calibration";
    model.left.title = "Left";
    model.right.title = "Right";
    model.by_edge = {12, 0, 3, 10};
    model.distances_mm = {700, 750};
    model.poses = 12, model.least_poses = 10, model.most_poses = 40;
    model.predicted_mm = 0.345, model.good_enough_mm = 0.3;
    model.wanted = {"six more poses", "a tilt with the lower edge nearer"};
    const auto [width, height] = std::get<1>(GetParam());
    const auto draw = [&](const std::string& where) {
        draw_guide(drawn_.pen, guide_layout(width, height, !model.result.empty()), model, {nullptr, nullptr});
        expect_whole(where);
    };
    for (const std::string& word : guide_words()) {
        model.word = word;
        for (const auto& [why, what] :
             {std::pair{"The light came later than this projector is said to be, so that pictures were mixed up.",
                        "Leave the board there: it is captured again, more slowly. `planlight projector` measures the "
                        "delay."},
              std::pair{"The board is too dark for the right camera (paper 12 of 255, print 12 darker).",
                        "Bring it into the projector's light, or lengthen the exposure."},
              std::pair{"Only the right camera sees the board.",
                        "Bring it to where the left camera sees it too, and turn its face less aside."},
              std::pair{"Enter keeps it, Delete discards it.", "Keep the new rig, or go on with the former one?"}}) {
            model.why = why;
            model.what = what;
            draw(word + ": " + why);
        }
    }
    model.result = {"The reprojection error is 0.12 pixels."};
    draw("the result");
}

// A person sees in them whether the board is in the picture.
TEST(GuideLayout, ACamerasPictureIsAThirdOfTheWindowsShorterSideAtLeast) {
    for (const auto& [width, height] : kSizes)
        for (const bool with_result : {false, true}) {
            const GuideLayout place = guide_layout(width, height, with_result);
            SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height));
            const float least = static_cast<float>(std::min(width, height)) / 3;
            EXPECT_GE(place.left.width, least);
            EXPECT_GE(place.left.height, 0.7F * least);
            for (const Box* box : {&place.left, &place.right, &place.projector, &place.progress, &place.tilts,
                                   &place.depths, &place.buttons, &place.banner}) {
                EXPECT_GT(box->width, 0);
                EXPECT_GT(box->height, 0);
                EXPECT_LE(box->right(), static_cast<float>(width));
                EXPECT_LE(box->bottom(), static_cast<float>(height));
            }
        }
}

TEST_P(WordsInPlace, HeaderAndTableHaveRoom) {
    OperatorModel model = test::fake_model();
    model.case_title = model.case_plan = model.case_subtitle = "E. M.";
    for (const char* side : {"LEFT", "RIGHT", "BOTH SIDES", "MIDDLE"})
        for (const StepState state : {StepState::active, StepState::attention, StepState::done}) {
            model.case_side = side;
            model.steps.fill(state);
            model.simulated = true;
            draw_header(drawn_.pen, drawn_.place, model);
            expect_whole(side);
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

/// What the banner says while there is light, as small windows are used as well.
class BannerInPlace : public WordsInPlace {
protected:
    void expect_room(const Status& status) {
        OperatorModel model = test::fake_model();
        model.status = status;
        for (const char* notice : {"", "DARK was pressed: the light is out."}) {
            draw_banner(drawn_.pen, drawn_.place.banner, model, notice);
            expect_whole(status.headline + (*notice ? ", with a notice" : ""));
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Windows, BannerInPlace,
                         testing::Combine(testing::Values("en", "de", "ru"), testing::ValuesIn(kSizes)));

/// All that the gate says, with figures of two digits.
std::vector<Status> rulings_of_the_gate() {
    std::vector<Status> said;
    for (const std::string& literal :
         test::literals_in(std::filesystem::path(PLANLIGHT_SOURCE_FOLDER) / "projection/light_gate.cpp")) {
        if (!test::is_sentence(literal)) continue;
        const std::string text = std::regex_replace(literal, std::regex("\\{[^{}]*\\}"), "12.3");
        if (text.starts_with("LOOK") || text.starts_with("Dark") || text == "The plan is on the skin.")
            said.push_back({StatusKind::check, text, {}});
        else if (!said.empty())
            said.back().details.push_back(text);
    }
    return said;
}

TEST_P(BannerInPlace, EveryRulingOfTheGateHasRoom) {
    const std::vector<Status> said = rulings_of_the_gate();
    ASSERT_GE(said.size(), 10U);
    for (const Status& status : said) expect_room(status);
}

TEST_P(BannerInPlace, AMatchThatIsNotKeptHasRoomBesideEveryRulingOfTheGate) {
    for (const int why : {ENOSPC, EACCES, EROFS, EIO})
        for (Status status : rulings_of_the_gate()) {
            status.details.push_back(short_words_of_not_kept(
                DiskRefusal("/cases/1", "cannot be written", "Look.", {why, std::generic_category()})));
            expect_room(status);
        }
}

TEST_P(BannerInPlace, EveryCauseOfWrongLightHasRoom) {
    for (int fault = 0; fault <= static_cast<int>(LightFault::light_off); ++fault)
        for (const bool ahead : {false, true}) {
            LightCause cause;
            cause.fault = static_cast<LightFault>(fault);
            cause.size = 12.3, cause.low = 12, cause.high = 112, cause.marker = 9, cause.drawn_ahead = ahead;
            expect_room({StatusKind::check, "LOOK: " + cause.headline(), {cause.sentence(), cause.remedy()}});
            expect_room({StatusKind::dark,
                         "Dark: the patient is not tracked: only 3 of 6 markers seen; 4 are needed.",
                         {cause.sentence(), cause.remedy()}});
        }
}

}  // namespace
}  // namespace planlight
