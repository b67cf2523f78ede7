#include "planning_io/case/missing_pictures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <regex>

namespace planlight {
namespace {

constexpr int kNone = std::numeric_limits<int>::max();

/// What a name of the sequence says (the room's README).
struct Meaning {
    bool white_or_black = false, fringe = false;
    bool row = false;
    int bit = kNone;  ///< of the Gray code
};

Meaning meaning_of(const std::string& name) {
    static const std::regex gray("(column|row)-gray-([0-9]{1,3})(-inverse)?"),
        fringe("(column|row)-phase[0-9]*-[0-9]+");
    Meaning meaning;
    std::smatch parts;
    if (name == "white" || name == "black")
        meaning.white_or_black = true;
    else if (std::regex_match(name, parts, gray)) {
        meaning.row = parts[1] == "row";
        meaning.bit = std::stoi(parts[2]);
    } else if (std::regex_match(name, parts, fringe)) {
        meaning.row = parts[1] == "row";
        meaning.fringe = true;
    }
    return meaning;
}

}  // namespace

UsableNames usable_without(const CaptureFolder& settings, const std::vector<std::string>& missing) {
    constexpr int kLeastBits = 2;
    std::array<int, 2> bits{kNone, kNone};  // so many of the columns and of the rows can be read
    bool fringes = true, any = true;
    for (const std::string& name : missing) {
        const Meaning m = meaning_of(name);
        any = any && !m.white_or_black;
        if (m.bit != kNone) bits[m.row] = std::min(bits[m.row], m.bit);
        fringes = fringes && !m.fringe && m.bit == kNone;
    }
    UsableNames usable;
    usable.rows = settings.rows && bits[1] >= kLeastBits;
    any = any && bits[0] >= kLeastBits && (fringes || settings.order_periods_px.empty());
    for (const std::string& name : settings.names) {
        const Meaning m = meaning_of(name);
        const bool kept =
            any && (!m.fringe || fringes) && (!m.row || usable.rows) && (m.bit == kNone || m.bit < bits[m.row]);
        (kept ? usable.names : usable.left_out).push_back(name);
    }
    return usable;
}

std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 6;
    if (names.size() <= kMost) return fmt::format("{}", fmt::join(names, ", "));
    return fmt::format("{} and {} more", fmt::join(names.begin(), names.begin() + kMost, ", "), names.size() - kMost);
}

}  // namespace planlight
