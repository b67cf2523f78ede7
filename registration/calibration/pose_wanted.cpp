#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "registration/calibration/pose_guide.h"

// What the poses so far cover, and what is wanted next.
namespace planlight {
namespace {

using Eigen::Vector2d;

const char* text_of(BoardEdge edge) {
    constexpr std::array kNames{"left", "right", "upper", "lower"};
    return kNames[static_cast<std::size_t>(edge)];
}

const char* shout_of(BoardEdge edge) {
    constexpr std::array kNames{"LEFT", "RIGHT", "UPPER", "LOWER"};
    return kNames[static_cast<std::size_t>(edge)];
}

/// A face that is turned to the right has its left edge nearer.
BoardEdge nearer_edge(const Vector2d& tilt) {
    if (std::abs(tilt.x()) > std::abs(tilt.y())) return tilt.x() > 0 ? BoardEdge::left : BoardEdge::right;
    return tilt.y() > 0 ? BoardEdge::top : BoardEdge::bottom;
}

void hit(PoseCoverage::Cells& cells, const Vector2d& pixel, int width, int height) {
    if (width <= 0 || height <= 0) return;
    const int x = std::clamp(static_cast<int>((pixel.x() + 0.5) / width * PoseCoverage::kAcross), 0,
                             PoseCoverage::kAcross - 1),
              y = std::clamp(static_cast<int>((pixel.y() + 0.5) / height * PoseCoverage::kDown), 0,
                             PoseCoverage::kDown - 1);
    ++cells[static_cast<std::size_t>(y * PoseCoverage::kAcross + x)];
}

}  // namespace

const char* text_of(PoseFault fault) {
    constexpr std::array kWords{"good",
                                "not seen",
                                "seen by one camera",
                                "seen in part only",
                                "too dark",
                                "too bright",
                                "blurred",
                                "flat on",
                                "too far aslant",
                                "as a pose that is there",
                                "too near",
                                "too far",
                                "outside the projector's light"};
    return kWords[static_cast<std::size_t>(fault)];
}

void PoseGuide::add(const PoseObservation& pose, int projector_width, int projector_height) {
    BoardSighting sighting;
    sighting.left = {pose.left.width, pose.left.height, pose.left.corners};
    sighting.right = {pose.right.width, pose.right.height, pose.right.corners};
    const auto [left, right] = lenses(sighting);
    left_width_ = pose.left.width, left_height_ = pose.left.height;
    right_width_ = pose.right.width, right_height_ = pose.right.height;
    const auto stance = stance_of(pose.left.corners, pose.right.corners, left, right, board_);
    poses_.push_back({pose.left.corners, pose.right.corners, stance});
    for (const Vector2d& p : pose.left.corners.pixels) hit(coverage_.cells[0], p, left_width_, left_height_);
    for (const Vector2d& p : pose.right.corners.pixels) hit(coverage_.cells[1], p, right_width_, right_height_);
    for (const LightSample& sample : pose.left.light)
        hit(coverage_.cells[2], sample.pixel_in_projector, projector_width, projector_height);
    count();
}

void PoseGuide::use_rig(const RigEstimate& rig) {
    if (!rig.device(DeviceName::left_camera) || !rig.device(DeviceName::right_camera)) return;
    rig_ = rig;
    for (Kept& kept : poses_)
        if (const auto stance = stance_of(kept.left, kept.right, *rig.device(DeviceName::left_camera),
                                          *rig.device(DeviceName::right_camera), board_))
            kept.stance = stance;
    count();
}

void PoseGuide::count() {
    coverage_.tilts.clear();
    coverage_.distances_mm.clear();
    coverage_.by_edge = {};
    for (const Kept& kept : poses_) {
        if (!kept.stance) continue;
        coverage_.tilts.push_back(kept.stance->tilt);
        coverage_.distances_mm.push_back(kept.stance->distance_mm);
        if (kept.stance->tilt.norm() >= settings_.useful_tilt)
            ++coverage_.by_edge[static_cast<std::size_t>(nearer_edge(kept.stance->tilt))];
    }
}

BoardEdge PoseGuide::wanted_edge() const {
    const auto& by = coverage_.by_edge;
    return kBoardEdges[static_cast<std::size_t>(std::min_element(by.begin(), by.end()) - by.begin())];
}

/// How much nearer than usual a pose is wanted, mm (negative: farther); 0: depths enough.
double PoseGuide::wanted_nearer_mm() const {
    if (coverage_.distances_mm.size() < 2) return 0;
    const double usual = usual_distance_mm();
    const auto [nearest, farthest] = std::minmax_element(coverage_.distances_mm.begin(), coverage_.distances_mm.end());
    if (*farthest - *nearest >= settings_.depth_span * usual) return 0;
    const double half = 0.6 * settings_.depth_span * usual;
    return usual - *nearest <= *farthest - usual ? half : -half;
}

void PoseGuide::advise(PoseAdvice& advice) const {
    const BoardEdge edge = wanted_edge();
    const double nearer_mm = wanted_nearer_mm();
    advice.what = fmt::format("Tilt it: its {} edge (in the left picture) towards the cameras, by 20 to 35 degrees",
                              text_of(edge));
    advice.in_light = fmt::format("{} EDGE NEARER", shout_of(edge));
    if (nearer_mm != 0)
        advice.what += fmt::format("; and {}, by about {:.0f} cm", nearer_mm > 0 ? "nearer" : "farther away",
                                   std::abs(nearer_mm) / 10);
    advice.what += ".";
}

std::vector<std::string> PoseGuide::wanted() const {
    std::vector<std::string> wanted;
    if (const std::size_t there = poses_.size(); there < settings_.least_poses)
        wanted.push_back(settings_.least_poses - there == 1
                             ? "one more pose"
                             : fmt::format("{} more poses", settings_.least_poses - there));
    for (const BoardEdge edge : kBoardEdges)
        if (coverage_.by_edge[static_cast<std::size_t>(edge)] == 0)
            wanted.push_back(fmt::format("tilted with the {} edge nearer", text_of(edge)));
    if (poses_.size() >= 2 && wanted_nearer_mm() != 0)
        wanted.push_back(wanted_nearer_mm() > 0 ? "nearer to the cameras" : "farther from the cameras");
    return wanted;
}

bool PoseGuide::done(std::optional<double> predicted_mm) const {
    if (poses_.size() >= settings_.most_poses) return true;
    return wanted().empty() && predicted_mm && *predicted_mm <= settings_.good_enough_mm;
}

}  // namespace planlight
