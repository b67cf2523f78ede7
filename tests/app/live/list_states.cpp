// Writes the page of all states of a session: list_states > app/guide/states.md
#include <cstdio>

#include "tests/app/live/states_page.h"

int main() {
    std::fputs(planlight::test::states_page().c_str(), stdout);
}
