// Run by press_buttons.sh: shows the operator window with a fake model, writes where its controls are into
// FOLDER/actions and FOLDER/views (FOLDER/landmarks once these are clicked), and prints every action and landmark,
// until the window is closed or a minute has passed. Argument: FOLDER.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "app/windows/operator_window.h"
#include "fake_model.h"
#include "tests/support/analytic_head.h"
#include "write_picture.h"

namespace {

using namespace planlight;

void write_place(std::ofstream& places, const std::string& name, const std::array<int, 4>& place) {
    const auto [x, y, width, height] = place;
    places << name << ' ' << x + width / 2 << ' ' << y + height / 2 << ' ' << width << ' ' << height << '\n';
}

/// Both places on the surface of the head, which is the same on both sides, and where it was clicked: on the front of
/// it.
bool on_the_head(const PointPair& pair) {
    return std::abs(test::analytic_head_distance(pair.in_ct)) < 0.5 &&
           std::abs(test::analytic_head_distance(pair.in_rig)) < 0.5 && pair.in_rig.y() < 0;
}

}  // namespace

int main(int, char** argv) {
    using std::chrono::steady_clock;
    const std::string folder = argv[1];
    const OperatorModel model = test::fake_model();
    OperatorWindow window({"Planlight buttons", 1280, 800, std::nullopt, true});
    for (int i = 0; i < 3; ++i) window.frame(model);
    test::write_picture(folder + "/operator.ppm", window.screenshot());
    const auto write_places = [&](const std::string& name, const std::vector<std::string>& words) {
        std::ofstream places(folder + "/" + name + ".part");
        for (const std::string& word : words) write_place(places, word, window.place_of(word));
        places.close();
        std::rename((folder + "/" + name + ".part").c_str(), (folder + "/" + name).c_str());
    };
    {
        std::ofstream places(folder + "/actions");
        for (const auto& [name, action] : {std::pair("scan", OperatorAction::scan),
                                           {"register", OperatorAction::do_register},
                                           {"track", OperatorAction::track},
                                           {"stop", OperatorAction::stop},
                                           {"dark", OperatorAction::dark},
                                           {"confirm", OperatorAction::confirm}}) {
            write_place(places, name, window.place_of(action));
        }
    }
    write_places("views", {"before", "after", "error", "landmarks"});
    const char* const names[] = {"none", "scan", "register", "track",         "stop",
                                 "dark", "quit", "confirm",  "use landmarks", "check skin"};
    const auto start = steady_clock::now();
    const char* const views[] = {"view after", "view before", "view error"};
    FitView last_view = window.fit_view();
    bool opened = false;
    std::size_t clicked = 0;
    double last_azimuth = window.view().azimuth;
    while (steady_clock::now() - start < std::chrono::seconds(60)) {
        const OperatorAction action = window.frame(model);
        if (action != OperatorAction::none) fmt::print("{}\n", names[static_cast<int>(action)]);
        if (window.view().azimuth != last_azimuth)
            fmt::print("turned {}\n", window.view().azimuth > last_azimuth ? "+" : "-");
        last_azimuth = window.view().azimuth;
        if (window.fit_view() != last_view) fmt::print("{}\n", views[static_cast<int>(window.fit_view())]);
        last_view = window.fit_view();
        if (!opened && window.place_of("undo")[2] > 0) {
            opened = true;
            write_places("landmarks", {"undo", "turn", "use", "close", "skin-view", "scan-view"});
        }
        for (const auto pairs = window.landmarks(); clicked != pairs.size(); clicked = pairs.size())
            fmt::print("landmarks {} {}\n", pairs.size(),
                       pairs.empty() || on_the_head(pairs.back()) ? "on the head" : "off");
        std::fflush(stdout);
        if (action == OperatorAction::quit) return 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
    return 1;
}
