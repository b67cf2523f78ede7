#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "app/site_settings.h"

namespace planlight {

/// --surgeon: for whom the letters on the skin are upright; overrides the site's.
inline void surgeon_option(CLI::App* command, std::string& side) {
    command
        ->add_option("--surgeon", side,
                     "Where the surgeon stands: the letters on the skin are upright for somebody at the patient's "
                     "feet, head, left or right, or (view) as the operator's window shows them (default: the site's)")
        ->check(CLI::IsMember(surgeon_sides()));
}

/// The site's settings with what the command was told.
inline SiteSettings site_with(const std::string& surgeon_side) {
    SiteSettings site = read_site_settings();
    if (!surgeon_side.empty()) site.surgeon_side = surgeon_side;
    return site;
}

}  // namespace planlight
