#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/site_settings.h"
#include "app/windows/window_settings.h"
#include "app/words/words.h"

namespace planlight {

/// --language: of the operator's windows; overrides the site's.
inline void language_option(CLI::App* command, std::string& language) {
    command->add_option("--language", language,
                        "Language of the window: en, de, ru, or that of a file of the site (default: the site's, else "
                        "English). Files, recordings and what is printed stay in English");
}

/// --theme: of the operator's windows; overrides the site's.
inline void theme_option(CLI::App* command, std::string& theme) {
    command
        ->add_option("--theme", theme,
                     "Colours of the window: dark, or bright for a bright room (default: the site's, else dark)")
        ->check(CLI::IsMember({"dark", "bright"}));
}
ThemeKind theme_of_window(const std::string& option, const SiteSettings& site);

/// A window with the language and the theme that were asked for, else the site's.
WindowSettings settings_of_window(const std::string& language, const std::string& theme, const SiteSettings& site);
/// The same of a page of its own, on the monitor that the option names, else the site's, else the primary one.
WindowSettings settings_of_page(const std::string& title, const std::string& language, const std::string& theme,
                                const std::string& operator_monitor);

/// The words of a window: those of the option, refused when there are none; else those of the site, or English with a
/// warning, since a patient does not wait for a translation. What a file lacks is said, and shown in English.
std::shared_ptr<const Words> words_of_window(const std::string& option, const SiteSettings& site);

}  // namespace planlight
