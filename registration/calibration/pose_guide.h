#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/time.h"
#include "registration/calibration/board_stance.h"
#include "registration/calibration/board_view.h"
#include "registration/calibration/rig_estimate.h"

namespace planlight {

/// What both cameras see of the board at one moment.
struct BoardSighting {
    BoardView left, right;
    Instant at{};  ///< mid-exposure
};

/// What is good enough for a pose, and for a calibration.
struct PoseGuideSettings {
    double still_px = 0.3;                               ///< corners of a board at rest move less (median),
    Instant still_for = std::chrono::milliseconds(500);  ///< for so long
    std::size_t still_frames = 4;                        ///< and in so many frames
    double least_corners = 0.35;                         ///< share of the board's corners that either camera must see
    double least_contrast_grey = 15;                     ///< of the print
    double max_saturated = 0.05;                         ///< share of the board
    double max_blur_px = 2.5;                            ///< sigma
    double least_tilt = 0.14;                            ///< radians (8 degrees): below it the board is flat on
    double steepest = 1.05;                              ///< radians (60 degrees): to either camera
    double alike_angle = 0.14, alike_mm = 25;            ///< nearer to a pose that is there: nothing new
    double max_depth_share = 0.25;  ///< of the distance; the working volume's half depth about the poses so far
    double least_in_light = 0.5;    ///< share of the board in the projector's picture, once the projector is known
    double useful_tilt = 0.2;       ///< radians (11 degrees): counts as tilted that way
    double depth_span = 0.08;       ///< of the distance: from the nearest pose to the farthest, at least
    std::size_t least_poses = 8, most_poses = 12;
    double good_enough_mm = 0.1;  ///< predicted: 95 % of the working volume, scanned points and light
};

/// Why the board is not captured where it is.
enum class PoseFault {
    none,
    not_seen,
    one_camera,
    in_part,
    too_dark,
    too_bright,
    blurred,
    flat_on,
    aslant,
    alike,
    too_near,
    too_far,
    beside_light
};
const char* text_of(PoseFault fault);  ///< in few words, for a list

/// Which edge is to be nearer to the cameras, as the left picture shows the board.
enum class BoardEdge { left, right, top, bottom };
inline constexpr std::array kBoardEdges{BoardEdge::left, BoardEdge::right, BoardEdge::top, BoardEdge::bottom};

/// What one look says: why not, what to do, and whether to capture now.
struct PoseAdvice {
    PoseFault fault = PoseFault::not_seen;
    std::string why;         ///< a sentence; empty without a fault
    std::string what;        ///< what to do, a sentence
    std::string in_light;    ///< the same in a word or three, for the light on the board
    bool still = false;      ///< what is seen of it has been at rest for long enough
    double still_share = 0;  ///< 0 to 1: how much of that time
    bool capture = false;    ///< good and still: now
    std::optional<BoardStance> stance;
};

/// Where the board has been. Cells of the devices' pictures: corners (projector: lit pixels) that fell there.
struct PoseCoverage {
    static constexpr int kAcross = 8, kDown = 6;
    using Cells = std::array<int, kAcross * kDown>;
    std::array<Cells, 3> cells{};  ///< by DeviceName
    std::vector<Eigen::Vector2d> tilts;
    std::vector<double> distances_mm;
    std::array<int, 4> by_edge{};  ///< poses tilted with that edge nearer, by BoardEdge
};

/// Leads a person with a board from pose to pose. Knows nothing of the cameras at first; `use_rig` tells it what the
/// poses so far have made known.
class PoseGuide {
public:
    explicit PoseGuide(const BoardSpec& board, const PoseGuideSettings& settings = {});

    /// One look at the live pictures, in the order of their times.
    PoseAdvice look(const BoardSighting& sighting);

    /// The board was captured in this pose.
    void add(const PoseObservation& pose, int projector_width, int projector_height);
    void use_rig(const RigEstimate& rig);

    std::size_t poses() const { return poses_.size(); }
    const PoseCoverage& coverage() const { return coverage_; }
    /// What is still wanted, a sentence each, the most wanted first; empty: poses enough, all over.
    std::vector<std::string> wanted() const;
    /// Nothing is wanted and the predicted error is good, or there are as many poses as anybody wants.
    bool done(std::optional<double> predicted_mm) const;
    const PoseGuideSettings& settings() const { return settings_; }

private:
    struct Kept {
        BoardCorners left, right;
        std::optional<BoardStance> stance;  ///< empty: not known yet
    };
    std::pair<CameraModel, CameraModel> lenses(const BoardSighting& sighting) const;
    PoseFault fault_of(const BoardSighting& sighting, PoseAdvice& advice) const;
    PoseFault fault_of_view(const BoardView& view, const char* camera, PoseAdvice& advice) const;
    PoseFault fault_of_stance(const BoardStance& stance, PoseAdvice& advice) const;
    double share_in_light(const BoardStance& stance) const;
    double usual_distance_mm() const;
    double still_share(const BoardSighting& sighting);
    BoardEdge wanted_edge() const;
    double wanted_nearer_mm() const;
    void advise(PoseAdvice& advice) const;
    void count();

    BoardSpec board_;
    PoseGuideSettings settings_;
    std::vector<Kept> poses_;
    PoseCoverage coverage_;
    std::optional<RigEstimate> rig_;
    int left_width_ = 0, left_height_ = 0, right_width_ = 0, right_height_ = 0;
    std::deque<BoardSighting> recent_;
};

}  // namespace planlight
