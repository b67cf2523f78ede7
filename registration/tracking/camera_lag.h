#pragma once

#include <map>
#include <vector>

#include "registration/tracking/track_patient.h"

namespace planlight {

/// Whether the two pictures of a pair were taken at one moment, by the markers in them: what moves across the epipolar
/// lines while one picture is older than the other does not meet any more. What moves along those lines alone shows
/// nothing, and neither does a head at rest.
class CameraLag {
public:
    explicit CameraLag(const RigCalibration& rig) : rig_(rig) {}

    /// After `tracker.update` with a frame of this moment; frames in the order of their times.
    void add(const PatientTracker& tracker, Instant at);

    /// How much later than the left one the right camera's pictures were taken, s, one for all frames; negative: they
    /// are older. Not known without movement across the epipolar lines.
    struct Lag {
        double right_later_s = 0, sigma_s = 0;
        bool known = false;
    };
    Lag lag() const;

    /// Frames, by their number from 0, in which the markers meet so much worse than in the others (0.2 px and six times
    /// the usual scatter) that one of the pictures is of another moment. Empty with fewer than five frames.
    std::vector<std::size_t> odd_frames() const;

private:
    struct Sight {
        std::size_t frame = 0;
        double at_s = 0;
        double parallax_px = 0;                  ///< of the right picture's disc, off the epipolar line of the left's
        Eigen::Vector2d pixel_in_right, across;  ///< `across`: unit vector across that line
    };
    /// The sights of each marker with its parallax over all frames (median) taken off: what a calibration leaves.
    std::vector<std::vector<Sight>> sights_without_usual() const;

    RigCalibration rig_;
    std::map<int, std::vector<Sight>> of_marker_;
    std::size_t frames_ = 0;
};

}  // namespace planlight
