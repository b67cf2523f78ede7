#pragma once

#include <string>

namespace planlight {

/// What people call a case by. Each may be empty; none is needed by the machine, which goes by hashes.
struct CaseNames {
    std::string title;         ///< as the site calls the case
    std::string patient;       ///< initials or a code, as the site sets them
    std::string plan;          ///< the plan's name: its file's, or as given
    std::string plan_version;  ///< as given
    std::string series;        ///< Volume::series_description
    std::string series_date;   ///< Volume::series_date
};

inline constexpr std::size_t kLongestCaseName = 80;  ///< characters, of each

/// Throws InputError by name when one of them is longer than that, no UTF-8, or holds control characters.
void check_case_names(const CaseNames& names);

/// Text that somebody else wrote (a file's name, a scanner's description), made fit to be such a name: no control
/// characters, UTF-8, not too long.
std::string fit_to_be_a_name(const std::string& text);

/// The same however long: fit to be printed on a terminal, whose cursor control characters (C0 and C1) would move.
std::string without_control_characters(const std::string& text);

}  // namespace planlight
