// Run by press_buttons.sh: shows the operator window with a fake model, writes where its controls are into FOLDER/places,
// and prints every action, until the window is closed or a minute has passed. Argument: FOLDER.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>

#include "app/windows/operator_window.h"
#include "fake_model.h"
#include "write_picture.h"

int main(int, char** argv) {
    using namespace planlight;
    using std::chrono::steady_clock;
    const std::string folder = argv[1];
    const OperatorModel model = test::fake_model();
    OperatorWindow window({"Planlight buttons", 1280, 800, std::nullopt, true});
    for (int i = 0; i < 3; ++i) window.frame(model);
    test::write_picture(folder + "/operator.ppm", window.screenshot());
    {
        std::ofstream places(folder + "/places.part");
        for (const auto& [name, action] : {std::pair("scan", OperatorAction::scan), {"register", OperatorAction::do_register},
                                           {"track", OperatorAction::track}, {"stop", OperatorAction::stop},
                                           {"dark", OperatorAction::dark}, {"confirm", OperatorAction::confirm}}) {
            const auto [x, y, width, height] = window.place_of(action);
            places << name << ' ' << x + width / 2 << ' ' << y + height / 2 << ' ' << width << ' ' << height << '\n';
        }
        for (const auto& [name, view] : {std::pair("before", FitView::before), {"after", FitView::after},
                                         {"error", FitView::predicted_error}}) {
            const auto [x, y, width, height] = window.place_of(view);
            places << name << ' ' << x + width / 2 << ' ' << y + height / 2 << ' ' << width << ' ' << height << '\n';
        }
    }
    std::rename((folder + "/places.part").c_str(), (folder + "/places").c_str());
    const char* const names[] = {"none", "scan", "register", "track", "stop", "dark", "quit", "confirm"};
    const auto start = steady_clock::now();
    const char* const views[] = {"view after", "view before", "view error"};
    FitView last_view = window.fit_view();
    double last_azimuth = window.view().azimuth;
    while (steady_clock::now() - start < std::chrono::seconds(60)) {
        const OperatorAction action = window.frame(model);
        if (action != OperatorAction::none) fmt::print("{}\n", names[static_cast<int>(action)]);
        if (window.view().azimuth != last_azimuth) fmt::print("turned {}\n", window.view().azimuth > last_azimuth ? "+" : "-");
        last_azimuth = window.view().azimuth;
        if (window.fit_view() != last_view) fmt::print("{}\n", views[static_cast<int>(window.fit_view())]);
        last_view = window.fit_view();
        std::fflush(stdout);
        if (action == OperatorAction::quit) return 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
    return 1;
}
