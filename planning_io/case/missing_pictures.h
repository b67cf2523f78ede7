#pragma once

#include <string>
#include <vector>

#include "planning_io/case/capture_folder.h"

namespace planlight {

/// What of a sequence can still be used without some of its pictures.
struct UsableNames {
    std::vector<std::string> names;  ///< of what is left, in order; empty: nothing can be read without the missing ones
    std::vector<std::string> left_out;  ///< the missing ones, and what counts on them
    bool rows = true;                   ///< false: the columns' code alone is left
};

/// A picture takes with it what counts on it: a Gray bit or its inverse the finer bits of its direction and all fringes
/// (their order is the Gray code's), a fringe all fringes of its direction and the other; under two bits are no code.
/// Nothing is left without white, black or the columns, or where fringes of several frequencies tell the order.
UsableNames usable_without(const CaptureFolder& settings, const std::vector<std::string>& missing);

/// "column-gray-7, column-gray-7-inverse and 12 more", for a sentence: the first six.
std::string listed(const std::vector<std::string>& names);

}  // namespace planlight
