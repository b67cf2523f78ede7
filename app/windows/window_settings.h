#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace planlight {

class Words;

enum class ThemeKind { dark, bright };

struct WindowSettings {
    std::string title = "Planlight";
    /// Pixels; at most the monitor's, at least 1280 x 720. On a monitor that stands on end the longer one is the
    /// height.
    int width = 1920, height = 1080;
    std::optional<std::string> monitor;       ///< name or index as text; the primary one when not given
    bool fill_monitor = false;                ///< borderless over that whole monitor
    std::shared_ptr<const Words> words = {};  ///< the window's language; null: English
    ThemeKind theme = ThemeKind::dark;
    std::vector<std::string> large_words = {};  ///< in the largest letters, beside those of the banner
};

}  // namespace planlight
