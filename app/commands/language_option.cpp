#include "app/commands/language_option.h"

#include <fmt/format.h>

#include <set>

#include "app/console.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// How many entries of the source that language lacks.
std::size_t lacking(const std::string& code) {
    std::set<std::string> there;
    for (const auto& entry : language_of(code).words) there.insert(entry.first);
    std::size_t count = 0;
    for (const auto& entry : language_of("en").words) count += there.contains(entry.first) ? 0 : 1;
    return count;
}

}  // namespace

std::shared_ptr<const Words> words_of_window(const std::string& option, const SiteSettings& site) {
    const std::string& code = option.empty() ? site.language : option;
    try {
        const auto words = words_of(code);
        if (const std::size_t count = code == "en" ? 0 : lacking(code); count > 0)
            warn(fmt::format("The language \"{}\" lacks {} texts; these are shown in English.", code, count));
        return words;
    } catch (const Error& fault) {
        if (!option.empty()) throw;
        warn(fmt::format("The window is in English: {}. {}", fault.what(), fault.remedy));
        return std::make_shared<const Words>();
    }
}

ThemeKind theme_of_window(const std::string& option, const SiteSettings& site) {
    return (option.empty() ? site.theme : option) == "bright" ? ThemeKind::bright : ThemeKind::dark;
}

WindowSettings settings_of_window(const std::string& language, const std::string& theme, const SiteSettings& site) {
    WindowSettings settings;
    settings.words = words_of_window(language, site);
    settings.theme = theme_of_window(theme, site);
    return settings;
}

WindowSettings settings_of_page(const std::string& title, const std::string& language, const std::string& theme,
                                const std::string& operator_monitor) {
    const SiteSettings site = read_site_settings();
    WindowSettings settings = settings_of_window(language, theme, site);
    settings.title = title;
    const std::string& monitor = operator_monitor.empty() ? site.operator_monitor : operator_monitor;
    if (!monitor.empty()) settings.monitor = monitor;
    return settings;
}

}  // namespace planlight
