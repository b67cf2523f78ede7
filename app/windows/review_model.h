#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/windows/operator_model.h"
#include "app/windows/time_line.h"

namespace planlight {

/// All that the window of a review shows, as values. Shared parts are unchanging: another pointer is another thing.
struct ReviewModel {
    std::string title, subtitle;
    std::shared_ptr<const TimeLine> line;  ///< null: it is still being read
    double now_s = 0;                      ///< the moment that is looked at, since the room was entered
    std::optional<double> frame_s;         ///< of the pictures; empty: none was kept
    std::string note;                      ///< what is missing, and why; a sentence

    /// A place of the plan where a camera should see its light.
    struct Place {
        std::array<std::optional<Eigen::Vector2d>, 2> pixel;  ///< in the left and the right picture
        Eigen::Vector3d p_in_ct = Eigen::Vector3d::Zero();
        std::optional<double> off_mm;  ///< of its light; empty: none was found there
        std::string words;             ///< item, and how far off: a sentence
    };
    struct Camera {
        std::shared_ptr<const GrayImage> picture;
        std::vector<std::vector<Eigen::Vector2d>> plan;  ///< where it belongs, pixels
        std::array<double, 4> round_plan{};              ///< x, y, width, height of the part that it is in
    };
    std::array<Camera, 2> cameras;          ///< left, right
    std::shared_ptr<const RgbImage> light;  ///< what the projector was given; null: not kept
    std::optional<SceneModel> scene;        ///< the head with plan and light; empty: nothing is known of them
    SceneView by_projector;                 ///< that shows the plan first
    std::vector<Place> places;              ///< of this frame
    std::optional<std::size_t> picked;      ///< of `places`
    std::string sum;                        ///< plan and light of this frame in a sentence
    double warn_above_mm = 1, stop_above_mm = 2;
    bool settled = false;  ///< all that there is of this moment is here
};

/// What the person wants of a review.
struct ReviewWish {
    enum class Kind {
        none,
        frame_before,
        frame_after,
        event_before,
        event_after,
        begin,
        end,
        to_time,
        pick,
        snapshot,
        quit
    };
    Kind kind = Kind::none;
    double at_s = 0;                        ///< of `to_time`
    Eigen::Vector3d picked_in_ct{0, 0, 0};  ///< of `pick`
};

/// The place whose light is meant by a press on a picture: the nearest, 20 pixels of it away at most. `camera`: 0 left,
/// 1 right.
std::optional<std::size_t> place_near(const ReviewModel& model, std::size_t camera, const Eigen::Vector2d& pixel);

/// "0:03:12.40"
std::string time_text(double s);

}  // namespace planlight
