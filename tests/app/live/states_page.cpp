#include "tests/app/live/states_page.h"

#include <fmt/format.h>

#include "app/live/session_states.h"
#include "app/windows/status_word.h"

namespace planlight::test {
namespace {

struct Press {
    OperatorAction action;
    const char* label;
};
constexpr Press kPresses[] = {{OperatorAction::scan, "Scan"},   {OperatorAction::do_register, "Register"},
                              {OperatorAction::track, "Track"}, {OperatorAction::stop, "Stop, DARK"},
                              {OperatorAction::confirm, "Yes"}, {OperatorAction::check_skin, "Check skin"}};

}  // namespace

std::string states_page() {
    std::string page =
        "# Every state of a session, and what each press does in it\n\n"
        "Made from the program's own table by `build/tests/app/list_states > app/guide/states.md`. \"Yes\" is the "
        "button "
        "over the 3-D view: *It fits: use it*, *Show landmarks*, *Light 1 is right*. A press that does nothing is "
        "answered with its reason. After going on with the match of an earlier session there is no scan of this one: "
        "Register, and landmarks, wait for one (\"scan first\").\n\n"
        "## What it says\n\n| state | word | sentence | and |\n|---|---|---|---|\n";
    for (const SessionState state : kSessionStates) {
        const SessionView& view = view_of(state);
        page +=
            fmt::format("| {} | {} | {} | {} |\n", view.name, status_word(view.kind), view.headline, view.what_next);
    }
    page += "\n## Where a press leads\n\n| state |";
    for (const Press& press : kPresses) page += fmt::format(" {} |", press.label);
    page += "\n|---|---|---|---|---|---|---|\n";
    for (const SessionState state : kSessionStates) {
        page += fmt::format("| **{}** |", view_of(state).name);
        for (const Press& press : kPresses) {
            const auto next = after_press(state, press.action);
            if (next)
                page += fmt::format(" {} |", *next == state ? "stays, dark" : view_of(*next).name);
            else
                page += " – |";
        }
        page += "\n";
    }
    page += "\n## Why a button does nothing\n\n| state | Scan | Register | Track | Stop |\n|---|---|---|---|---|\n";
    for (const SessionState state : kSessionStates) {
        const SessionView& view = view_of(state);
        const auto words = [](const char* no) { return no == nullptr ? "" : no; };
        page += fmt::format("| **{}** | {} | {} | {} | {} |\n", view.name, words(view.no_scan), words(view.no_register),
                            words(view.no_track), words(view.no_stop));
    }
    return page;
}

}  // namespace planlight::test
