#pragma once

#include <string>

namespace planlight::test {

/// The page of all states of a session (app/guide/states.md), made from the table.
std::string states_page();

}  // namespace planlight::test
