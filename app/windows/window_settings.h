#pragma once

#include <memory>
#include <optional>
#include <string>

namespace planlight {

class Words;

struct WindowSettings {
    std::string title = "Planlight";
    int width = 1920, height = 1080;          ///< pixels; at most the monitor's, at least 1280 x 720
    std::optional<std::string> monitor;       ///< name or index as text; the primary one when not given
    bool fill_monitor = false;                ///< borderless over that whole monitor
    std::shared_ptr<const Words> words = {};  ///< the window's language; null: English
};

}  // namespace planlight
