// Every text of the windows beside the operator's has room in its place: of a review, the cameras, the doctor, a guided
// calibration.
#include <gtest/gtest.h>

#include <algorithm>

#include "app/windows/camera_page_panels.h"
#include "app/windows/doctor_page_panels.h"
#include "app/windows/guide_panels.h"
#include "app/windows/panels.h"
#include "app/windows/review_panels.h"
#include "tests/app/words/drawn_words.h"

namespace planlight {
namespace {

using PagesInPlace = DrawnInPlace;
INSTANTIATE_TEST_SUITE_P(Windows, PagesInPlace, every_language_and_size());

TEST_P(PagesInPlace, TheWindowOfAReviewHasRoomForItsWords) {
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
    for (const Box& box : place.buttons) {
        EXPECT_GE(box.x, 0);
        EXPECT_GE(box.y, place.time_line.bottom());
        EXPECT_LE(box.right(), static_cast<float>(std::get<1>(GetParam()).first));
        EXPECT_LE(box.bottom(), static_cast<float>(std::get<1>(GetParam()).second));
    }
}

TEST_P(PagesInPlace, ThePageOfTheCamerasHasRoom) {
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
    for (const char* note :
         {"it cannot be asked for automatic exposure or a rolling shutter: set it up by its own means",
          "its shutter rolls: a head that moves is seen bent; take one with a global shutter",
          "its picture is mirrored (ReverseX): switch that off by its own program"}) {
        model.left.notes = {note};
        expect_room(note);
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

/// Lines as long as the doctor says them, of each kind so many.
DoctorPageModel examined(std::size_t each) {
    using Health = DoctorPageModel::Health;
    DoctorPageModel model;
    model.title = "Is everything in this room ready for a patient?";
    model.step = "the projector's delay";
    model.took_s = 36;
    for (std::size_t i = 0; i < each; ++i) {
        model.lines.push_back({"right camera, receive buffer", Health::good,
                               "fine stripes keep 83 % of their contrast (blur 1.6 pixels of the projector)", ""});
        model.lines.push_back(
            {"left camera, receive buffer", Health::look,
             "light comes 123 ms after its order (+-12): light cannot follow a head that moves, and goes out when it "
             "does",
             "Switch off what the projector does to its picture (keystone, noise reduction, motion), choose its game "
             "mode, or take another projector."});
        model.lines.push_back({"cameras, same moment", Health::stop,
                               "the right camera sees a flash 40.0 ms later: it runs a frame behind",
                               "Switch that camera off and on. If it stays, give its own transfer_ms in room.json, or "
                               "look at its trigger."});
    }
    return model;
}

TEST_P(PagesInPlace, ThePageOfTheDoctorHasRoom) {
    const auto [width, height] = std::get<1>(GetParam());
    const DoctorPageLayout place =
        doctor_page_layout(static_cast<float>(width), static_cast<float>(height), drawn_.place.scale);
    for (const std::size_t each : {0U, 1U, 12U}) {
        DoctorPageModel model = examined(each);
        for (const auto verdict :
             {DoctorPageModel::Verdict::looking, DoctorPageModel::Verdict::ended, DoctorPageModel::Verdict::good,
              DoctorPageModel::Verdict::look, DoctorPageModel::Verdict::stop}) {
            model.verdict = verdict;
            DoctorPageScroll scroll;
            draw_doctor_page(drawn_.pen, place, model, scroll);
            expect_whole(std::string(doctor_word(verdict)) + " with " + std::to_string(each));
        }
    }
    const float shrunk = std::min(1.0F, static_cast<float>(std::max(width, height)) / 1280);  // below 1280 x 720
    for (const Box* box : {&place.dark, &place.again, &place.close})
        EXPECT_GE(box->height, 71.9F * shrunk) << "for a gloved finger";
}

// Whoever goes down far enough sees the last line, and no further.
TEST_P(PagesInPlace, TheDoctorsLinesAreMovedToTheLastAndNotBeyond) {
    const DoctorPageLayout place =
        doctor_page_layout(static_cast<float>(std::get<1>(GetParam()).first),
                           static_cast<float>(std::get<1>(GetParam()).second), drawn_.place.scale);
    DoctorPageScroll scroll{1000, 1000};
    draw_doctor_page(drawn_.pen, place, examined(40), scroll);
    EXPECT_GT(scroll.wanted, 0);
    EXPECT_LT(scroll.wanted, 80);
    EXPECT_GT(scroll.good, 0);
    EXPECT_LT(scroll.good, 40);
    scroll = {-3, -3};
    draw_doctor_page(drawn_.pen, place, examined(0), scroll);
    EXPECT_EQ(scroll.wanted, 0);
    EXPECT_EQ(scroll.good, 0);
}

TEST_P(PagesInPlace, TheWindowOfAGuidedCalibrationHasRoomForItsWords) {
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

}  // namespace
}  // namespace planlight
