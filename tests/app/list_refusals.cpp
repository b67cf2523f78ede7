// Writes the page of all refusals (app/guide/refusals.md): list_refusals SOURCE_FOLDER > app/guide/refusals.md
#include <cstdio>

#include "tests/app/refusals_page.h"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("list_refusals SOURCE_FOLDER\n", stderr);
        return 2;
    }
    std::fputs(planlight::test::refusals_page(argv[1]).c_str(), stdout);
    return 0;
}
