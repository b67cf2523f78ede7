#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "registration/calibration/find_board.h"
#include "registration/scan/decode/decode_stripes.h"

namespace planlight {

/// A camera pixel on the board and the projector pixel that lit it.
struct LightSample {
    Eigen::Vector2d pixel_in_camera;     ///< a whole pixel: its centre
    Eigen::Vector2d pixel_in_projector;  ///< sub-pixel (whole for a Gray code without fringes)
};

/// What one camera saw of the board in one pose, and how well.
struct CameraObservation {
    int width = 0, height = 0;       ///< 0: there is no such camera
    BoardCorners corners;            ///< empty: the board was not found
    std::vector<LightSample> light;  ///< evenly over the board; empty without coded light
    bool coded_light = false;        ///< there were coded pictures
    double white_grey = 0;           ///< median on the board under white light
    double contrast_grey = 0;        ///< median of (white - black) on the board; 0 without coded light
    double saturated_share = 0;      ///< of the board's pixels under white light
    double decoded_share = 0;        ///< of the pixels looked at on the board
    double moved_px = 0;             ///< of the board between the first picture and the last
    bool found_mirrored = false;     ///< the board was found only in the picture's mirror image
    bool colour_mosaic = false;      ///< a colour camera's raw pictures (`is_colour_mosaic`)
    std::string wrong_sequence;      ///< a frame that does not show its own picture (`check_sequence`); empty: none
    std::string sequence_remedy;     ///< of lamps that flicker; empty: the usual one
};

/// What both cameras saw of the board in one place.
struct PoseObservation {
    std::string name;
    CameraObservation left, right;
};

/// How a pose's pictures are looked at.
struct ObserveSettings {
    int light_samples = 400;      ///< a camera and pose: enough for their noise to vanish, few enough to be quick
    double edge_contrast = 0.10;  ///< light samples lie where the white picture varies less than this within 5x5 pixels
    double moved_px =
        0.2;  ///< a board that moved less is looked up again in the sum of all pictures, which has less noise
    bool check_sequence = true;  ///< look for late, doubled, missing and swapped frames
};

/// Coded light of a calibration: that of a scan, or (`phase_steps` 0) a Gray code without fringes.
DecodedView decode_calibration_light(std::span<const GrayImage> frames, const StripeSettings& stripes);

/// Frames in the order of the sequence, the first under white light; one frame alone is a picture without coded light.
/// Throws std::invalid_argument when their number or sizes do not fit.
CameraObservation observe_board(std::span<const GrayImage> frames, const std::optional<StripeSettings>& stripes,
                                const BoardSpec& board, const ObserveSettings& settings = {});

}  // namespace planlight
