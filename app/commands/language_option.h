#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/site_settings.h"
#include "app/words/words.h"

namespace planlight {

/// --language: of the operator's windows; overrides the site's.
inline void language_option(CLI::App* command, std::string& language) {
    command->add_option("--language", language,
                        "Language of the window: en, de, ru, or that of a file of the site (default: the site's, else "
                        "English). Files, recordings and what is printed stay in English");
}

/// The words of a window: those of the option, refused when there are none; else those of the site, or English with a
/// warning, since a patient does not wait for a translation. What a file lacks is said, and shown in English.
std::shared_ptr<const Words> words_of_window(const std::string& option, const SiteSettings& site);

}  // namespace planlight
