#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// All that the window of a guided calibration shows, as values.
struct GuideModel {
    /// Cells of a device's picture, row by row: how many corners (lit pixels) fell there.
    struct Cells {
        int across = 0, down = 0;
        std::vector<int> hits;
    };
    struct Camera {
        std::string title;
        std::shared_ptr<const GrayImage> picture;
        std::vector<Eigen::Vector2d> corners;  ///< that are seen now, pixels
        Cells cells;
    };
    enum class Mood { wrong, hold, busy, done };

    std::string title, subtitle;
    Camera left, right;
    Cells projector;

    Mood mood = Mood::wrong;
    std::string word;       ///< "TILT IT", in capital letters without accents
    std::string why, what;  ///< sentences
    double share = 0;       ///< 0 to 1, of holding still or of capturing; 0: no bar

    /// Where faces were turned: right and down in the left picture, radians; and now. See `BoardStance::tilt`.
    std::vector<Eigen::Vector2d> tilts;
    std::optional<Eigen::Vector2d> tilt_now;
    std::array<int, 4> by_edge{};  ///< poses with that edge nearer: left, right, upper, lower
    double useful_tilt = 0;        ///< radians: from where on it counts
    std::vector<double> distances_mm;
    std::optional<double> distance_now_mm;

    std::size_t poses = 0, least_poses = 0, most_poses = 0;
    std::optional<double> predicted_mm;
    double good_enough_mm = 0;
    std::vector<std::string> wanted;  ///< what is still wanted
    std::vector<std::string> result;  ///< once it is there: sentences; then keep and discard may be pressed
};

/// Every word that `GuideModel::word` may be.
std::vector<std::string> guide_words();

enum class GuideAction { none, keep, discard, quit };

}  // namespace planlight
