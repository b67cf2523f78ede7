// Run by press_review.sh: shows the window of a review with a fake recording of 100 s, a frame a second, writes where
// its controls are into FOLDER/places, and prints what is wanted, until it is closed or a minute has passed. Argument:
// FOLDER.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "app/windows/review_window.h"
#include "app/windows/scene_view.h"
#include "fake_model.h"
#include "write_picture.h"

namespace {

using namespace planlight;

/// Grey with a brighter middle, where the plan is.
std::shared_ptr<const GrayImage> picture() {
    GrayImage grey(400, 300, 60);
    for (int y = 100; y < 200; ++y)
        for (int x = 150; x < 250; ++x) grey.at(x, y) = 140;
    return std::make_shared<const GrayImage>(std::move(grey));
}

ReviewModel fake_review() {
    const OperatorModel fake = test::fake_model();
    ReviewModel model;
    model.title = "REVIEW \u00b7 Somebody";
    model.subtitle = "100 frames were kept";
    auto line = std::make_shared<TimeLine>();
    line->lasted_s = 100;
    for (int i = 0; i < 100; ++i) line->frames_s.push_back(i);
    for (int i = 40; i < 180; ++i) {
        const LightTrust trust = i < 60 ? LightTrust::look : i == 140 ? LightTrust::dark : LightTrust::aligned;
        line->stretches.push_back(
            {0.5 * i, 0.5 * i + 0.5, trust, 0.4 + 0.3 * std::sin(0.2 * i), 0.8 + 0.2 * std::cos(0.1 * i)});
    }
    line->events = {{15, "Scanned: 8000 points."},
                    {20, "Amber: LOOK: the light is not measured."},
                    {30, "Green: The plan is on the skin."},
                    {70, "Dark: the patient is not tracked."}};
    model.line = line;
    model.frame_s = model.now_s = 30;
    model.cameras[0].picture = model.cameras[1].picture = picture();
    for (std::size_t i = 0; i < 2; ++i) {
        model.cameras[i].plan = {{{160, 110}, {240, 110}, {240, 190}, {160, 190}, {160, 110}}};
        model.cameras[i].round_plan = {140, 90, 120, 120};
    }
    model.light = std::make_shared<const RgbImage>(80, 60, Rgb{0, 120, 0});
    model.scene = fake.scene;
    model.by_projector = view_of_plan(*fake.scene.plan);
    const std::array<Eigen::Vector2d, 4> corners{Eigen::Vector2d(160, 110), Eigen::Vector2d(240, 110),
                                                 Eigen::Vector2d(240, 190), Eigen::Vector2d(160, 190)};
    Eigen::Vector3d low = fake.scene.skin->vertices_in_ct.at(0), high = low;
    for (const auto& p : fake.scene.skin->vertices_in_ct) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Eigen::Vector3d middle = (low + high) / 2;  // which a view looks at
    for (std::size_t i = 0; i < corners.size(); ++i) {
        // On the head one place is in the middle of its view, and the others are off it.
        const Eigen::Vector3d p = middle + Eigen::Vector3d(0, 0, 500 * static_cast<double>(i));
        model.places.push_back(
            {{corners[i], corners[i]}, p, 0.5 + 0.7 * static_cast<double>(i), fmt::format("Corner {}", i + 1)});
    }
    model.sum = "Light was found at 4 of 4 places; half of them lie within 0.80 mm of the plan, 95 % within 2.60 mm.";
    return model;
}

const char* name_of(ReviewWish::Kind kind) {
    const char* const names[] = {"none", "frame before", "frame after", "event before", "event after", "begin",
                                 "end",  "to time",      "pick",        "snapshot",     "quit"};
    return names[static_cast<int>(kind)];
}

}  // namespace

int main(int, char** argv) {
    using std::chrono::steady_clock;
    const std::string folder = argv[1];
    ReviewWindow window({"Planlight press review", 1280, 800, std::nullopt, true, {}});
    ReviewModel now = fake_review();
    auto model = std::make_shared<const ReviewModel>(now);
    for (int i = 0; i < 5; ++i) window.frame(model);
    test::write_picture(folder + "/review.ppm", window.screenshot());
    std::ofstream places(folder + "/places.part");
    for (const char* control : {"Beginning", "Event before", "Frame before", "Frame after", "Event after", "End",
                                "Whole picture", "Projector", "time line", "left", "right", "head"}) {
        const auto [x, y, width, height] = window.place_of(control);
        std::string name = control;
        for (char& letter : name) letter = letter == ' ' ? '-' : letter;
        places << name << ' ' << x << ' ' << y << ' ' << width << ' ' << height << '\n';
    }
    places.close();
    std::rename((folder + "/places.part").c_str(), (folder + "/places").c_str());
    std::string last;
    for (const auto began = steady_clock::now(); steady_clock::now() - began < std::chrono::seconds(60);) {
        const ReviewWish wish = window.frame(model);
        std::string said;
        if (wish.kind == ReviewWish::Kind::to_time) {
            said = fmt::format("to time {:.0f}", wish.at_s);
            now.now_s = wish.at_s;
            model = std::make_shared<const ReviewModel>(now);
        } else if (wish.kind == ReviewWish::Kind::pick) {
            const auto pressed = std::find_if(now.places.begin(), now.places.end(),
                                              [&](const auto& place) { return place.p_in_ct == wish.picked_in_ct; });
            now.picked = static_cast<std::size_t>(pressed - now.places.begin());
            said = fmt::format("pick {}", *now.picked + 1);
            model = std::make_shared<const ReviewModel>(now);
        } else if (wish.kind != ReviewWish::Kind::none) {
            said = name_of(wish.kind);
        }
        // A mouse that is held says the same again and again.
        if (!said.empty() && !(said == last && said.starts_with("to time"))) fmt::print("{}\n", said);
        last = said;
        std::fflush(stdout);
        if (wish.kind == ReviewWish::Kind::quit) return 0;
        window.rest(0.02);
    }
    return 1;
}
