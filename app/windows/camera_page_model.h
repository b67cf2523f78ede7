#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "projection/monitor/test_pictures.h"

namespace planlight {

/// All that the page shows on which cameras are aimed, focused and exposed, as values.
struct CameraPageModel {
    struct Marker {
        Eigen::Vector2d pixel;
        double radius_px = 0;
        bool operator==(const Marker&) const = default;
    };
    struct Camera {
        std::string title;  ///< "Left camera"
        std::shared_ptr<const GrayImage> picture;
        std::vector<Marker> markers;
        double sharpness = 0, best_sharpness = 0;
        double too_bright_percent = 0, too_dark_percent = 0;
        double exposure_ms = 0;
        double frames_hz = 0;
        std::optional<double> asked_hz;  ///< of room.json
        std::size_t lost = 0;
        std::vector<std::string> notes;                  ///< sentences without their full stop
        std::string trouble, trouble_remedy;             ///< why nothing comes; empty: it comes
        bool operator==(const Camera&) const = default;  ///< another picture is another pointer
    };
    std::string title, subtitle;
    Camera left, right;

    std::optional<double> apart_ms;  ///< right less left; empty: not known
    double allowed_ms = 0;
    bool together() const { return apart_ms && std::abs(*apart_ms) <= allowed_ms; }

    TestPicture shown = TestPicture::dark;            ///< by the projector
    std::string no_light;                             ///< why none of its buttons does anything; empty: they do
    std::string light_trouble, light_trouble_remedy;  ///< sentences; empty: all is well
    bool operator==(const CameraPageModel&) const = default;
};

enum class CameraPageAction { none, dark, frame, star, steps, name, forget_best, quit };

/// What a press of a button for a test picture asks for; empty: it asks for none.
std::optional<TestPicture> wanted_picture(CameraPageAction action);

}  // namespace planlight
