// Run by press_buttons.sh: shows the operator window with a fake model, writes where its controls are into
// FOLDER/actions and FOLDER/views (FOLDER/landmarks once these are clicked, FOLDER/question once it is asked whether to
// close it), and prints every action, answer and landmark, until the window is closed or three minutes have passed. A
// file FOLDER/close makes the window system ask the window to close, as Alt+F4 does. Argument: FOLDER.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "app/windows/operator_window.h"
#include "fake_model.h"
#include "tests/support/analytic_head.h"
#include "write_picture.h"

// Last, for its macros.
#include <X11/Xlib.h>
#undef Status

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

/// As a window manager does it for Alt+F4.
void ask_to_close(const char* title) {
    Display* const display = XOpenDisplay(nullptr);
    Window root = 0, parent = 0, *windows = nullptr;
    unsigned count = 0;
    XQueryTree(display, DefaultRootWindow(display), &root, &parent, &windows, &count);
    for (unsigned i = 0; i < count; ++i) {
        char* name = nullptr;
        if (XFetchName(display, windows[i], &name) == 0) continue;
        if (std::string(name) == title) {
            XEvent event{};
            event.xclient.type = ClientMessage;
            event.xclient.window = windows[i];
            event.xclient.message_type = XInternAtom(display, "WM_PROTOCOLS", False);
            event.xclient.format = 32;
            event.xclient.data.l[0] = static_cast<long>(XInternAtom(display, "WM_DELETE_WINDOW", False));
            XSendEvent(display, windows[i], False, NoEventMask, &event);
        }
        XFree(name);
    }
    XFree(windows);
    XCloseDisplay(display);
}

/// How often the window is drawn while `times` looks find this model.
std::size_t drawn_in(OperatorWindow& window, const OperatorModel& model, int times) {
    const std::size_t before = window.frames_drawn();
    for (int i = 0; i < times; ++i) {
        window.frame(model);
        window.rest(0.03);
    }
    return window.frames_drawn() - before;
}

}  // namespace

int main(int, char** argv) {
    using std::chrono::steady_clock;
    const std::string folder = argv[1];
    OperatorModel model = test::fake_model();
    OperatorWindow window({"Planlight buttons", 1280, 800, std::nullopt, true, {}});
    for (int i = 0; i < 30; ++i) window.frame(model);
    const std::size_t without_need = drawn_in(window, model, 60);
    model.status.headline += " And more.";
    fmt::print("drawn {} and {} times\n", without_need, drawn_in(window, model, 20));
    model.light_on = true;
    model.may_light_item = true;
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
    write_places("views", {"before", "after", "error", "landmarks", "evidence", "views"});
    const char* const names[] = {"none", "scan",    "register",      "track",      "stop",      "dark",
                                 "quit", "confirm", "use landmarks", "check skin", "light item"};
    const auto start = steady_clock::now();
    const char* const views[] = {"view after", "view before", "view error"};
    FitView last_view = window.fit_view();
    bool opened = false, landmarks_open = false, asked = false, page = false, view_buttons = false;
    std::string answer;
    std::size_t clicked = 0;
    double last_azimuth = window.view().azimuth;
    while (steady_clock::now() - start < std::chrono::seconds(180)) {
        const std::size_t drawn_before = window.frames_drawn();
        const OperatorAction action = window.frame(model);
        if (action == OperatorAction::dark && window.frames_drawn() != drawn_before) {
            fmt::print("dark after a whole frame was drawn\n");
        } else if (action == OperatorAction::light_item) {
            model.item_of_moment = window.item_wanted();
            fmt::print("item {}\n", model.item_of_moment ? static_cast<int>(*model.item_of_moment) + 1 : 0);
        } else if (action == OperatorAction::hide_item || action == OperatorAction::show_item) {
            const bool hide = action == OperatorAction::hide_item;
            const auto which = window.item_wanted();
            for (std::size_t i = 0; i < model.rows.size(); ++i)
                if (!which || i == *which) model.rows[i].hidden = hide;
            if (!which || model.item_of_moment == which) model.item_of_moment.reset();
            fmt::print("{} {}\n", hide ? "hide" : "show", which ? static_cast<int>(*which) + 1 : 0);
        } else if (action != OperatorAction::none) {
            fmt::print("{}\n", names[static_cast<int>(action)]);
        }
        if (const bool now = window.place_of("view-R")[2] > 0; now != view_buttons) {
            view_buttons = now;
            if (now)
                write_places("view-buttons", {"view-A", "view-P", "view-R", "view-L", "view-S", "view-reset",
                                              "view-projector", "view-surgeon", "views-close"});
            fmt::print("view buttons {}\n", now ? "open" : "closed");
        }
        if (window.place_of("all-items")[2] > 0) write_places("whole", {"all-items"});
        if (window.view().azimuth != last_azimuth)
            fmt::print("turned {}\n", window.view().azimuth > last_azimuth ? "+" : "-");
        last_azimuth = window.view().azimuth;
        if (window.fit_view() != last_view) fmt::print("{}\n", views[static_cast<int>(window.fit_view())]);
        last_view = window.fit_view();
        if (window.answer() != answer && !window.answer().empty()) fmt::print("answer {}\n", window.answer());
        answer = window.answer();
        if (const bool now = window.place_of("close")[2] > 0 && window.place_of("undo")[2] == 0; now != page) {
            page = now;
            if (page) write_places("page", {"close", "item-1", "item-2", "hide-1", "hide-2"});
            fmt::print("page {}\n", page ? "open" : "closed");
        }
        if (std::remove((folder + "/close").c_str()) == 0) ask_to_close("Planlight buttons");
        if (const bool now = window.place_of("stay")[2] > 0; now != asked) {
            asked = now;
            if (asked) {
                write_places("question", {"close-window", "stay"});
                test::write_picture(folder + "/question.ppm", window.screenshot());
            }
            fmt::print("question {}\n", asked ? "open" : "closed");
        }
        if (const bool now = window.place_of("undo")[2] > 0; now != landmarks_open) {
            landmarks_open = now;
            fmt::print("landmarks {}\n", now ? "open" : "closed");
        }
        if (!opened && window.place_of("undo")[2] > 0) {
            opened = true;
            write_places("landmarks", {"undo", "turn", "use", "close", "skin-view", "scan-view"});
        }
        for (const auto pairs = window.landmarks(); clicked != pairs.size(); clicked = pairs.size())
            fmt::print("landmarks {} {}\n", pairs.size(),
                       pairs.empty() || on_the_head(pairs.back()) ? "on the head" : "off");
        std::fflush(stdout);
        if (action == OperatorAction::quit) return 0;
        window.rest(0.03);
    }
    return 1;
}
