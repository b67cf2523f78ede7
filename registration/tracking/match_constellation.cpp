#include "registration/tracking/match_constellation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace planlight {
namespace {

constexpr double kDistanceToleranceMm = 0.8;  // skin between two markers stretches
constexpr double kNearPx = 4;                 // of a disc to where a proposed pose puts its marker
constexpr double kSameAngle = 0.1;            // radians; and
constexpr double kSameShiftMm = 5;            // up to which two poses are the same one
constexpr std::size_t kMostPoints = 60;

struct Proposal {
    RigidTransform pose;
    std::vector<Sighting> sightings;
    int markers = 0;
    double squared_px = 0;

    bool better_than(const Proposal& other) const {
        if (markers != other.markers) return markers > other.markers;
        if (sightings.size() != other.sightings.size()) return sightings.size() > other.sightings.size();
        return squared_px < other.squared_px;
    }
};

class Search {
public:
    Search(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
           const std::vector<MarkerObservation>& left, const std::vector<MarkerObservation>& right,
           const TrackingSettings& settings)
        : rig_(rig), markers_(markers), left_(left), right_(right), settings_(settings) {}

    std::vector<Proposal> run(const std::vector<MarkerPair>& points) {
        const std::size_t n = markers_.size(), m = std::min(points.size(), kMostPoints);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 1; j < n; ++j)
                for (std::size_t k = j + 1; k < n; ++k)
                    for (std::size_t a = 0; a < m; ++a)
                        for (std::size_t b = 0; b < m; ++b)
                            if (b != a && same_distance(i, j, points[a], points[b]))
                                for (std::size_t c = 0; c < m; ++c)
                                    if (c != a && c != b && same_distance(i, k, points[a], points[c]) &&
                                        same_distance(j, k, points[b], points[c]))
                                        propose({i, j, k}, {points[a], points[b], points[c]});
        return proposals_;
    }

private:
    bool same_distance(std::size_t i, std::size_t j, const MarkerPair& a, const MarkerPair& b) const {
        const double wanted = (markers_[i].centre_in_patient - markers_[j].centre_in_patient).norm();
        const double noise =
            4 * std::hypot(a.sigma_mm, b.sigma_mm, std::hypot(markers_[i].sigma_mm, markers_[j].sigma_mm));
        return std::abs((a.centre_in_rig - b.centre_in_rig).norm() - wanted) < kDistanceToleranceMm + noise;
    }

    void propose(const std::array<std::size_t, 3>& marker, const std::array<MarkerPair, 3>& point) {
        Eigen::Matrix3Xd in_patient(3, 3), in_rig(3, 3);
        std::vector<Sighting> three;
        for (int c = 0; c < 3; ++c) {
            const auto k = static_cast<std::size_t>(c);
            in_patient.col(c) = markers_[marker[k]].centre_in_patient;
            in_rig.col(c) = point[k].centre_in_rig;
            three.push_back({static_cast<int>(marker[k]), true, left_[static_cast<std::size_t>(point[k].left)]});
            three.push_back({static_cast<int>(marker[k]), false, right_[static_cast<std::size_t>(point[k].right)]});
        }
        const auto fit = fit_pose(rig_, markers_, three, fit_rigid_transform(in_patient, in_rig));
        if (!fit || fit->residual_px > 2 * settings_.max_residual_px) return;
        Proposal proposal{fit->rig_from_patient,
                          sightings_near(rig_, markers_, fit->rig_from_patient, left_, right_, kNearPx)};
        proposal.markers = distinct_markers(proposal.sightings);
        if (proposal.markers < settings_.min_markers) return;
        if (const auto all = fit_pose(rig_, markers_, proposal.sightings, proposal.pose)) {
            proposal.pose = all->rig_from_patient;
            proposal.squared_px = all->residual_px * all->residual_px;
        }
        keep(proposal);
    }

    void keep(const Proposal& proposal) {
        for (Proposal& known : proposals_) {
            if (angle_between(known.pose, proposal.pose) > kSameAngle) continue;
            const Eigen::Vector3d p = markers_.front().centre_in_patient;
            if ((known.pose * p - proposal.pose * p).norm() > kSameShiftMm) continue;
            if (proposal.better_than(known)) known = proposal;
            return;
        }
        proposals_.push_back(proposal);
    }

    const RigCalibration& rig_;
    const std::vector<PatientMarker>& markers_;
    const std::vector<MarkerObservation>&left_, &right_;
    const TrackingSettings& settings_;
    std::vector<Proposal> proposals_;
};

}  // namespace

std::vector<Sighting> sightings_near(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                     const RigidTransform& rig_from_patient, const std::vector<MarkerObservation>& left,
                                     const std::vector<MarkerObservation>& right, double max_px) {
    struct Candidate {
        double distance;
        Sighting sighting;
        std::size_t disc;
    };
    std::vector<Sighting> sightings;
    for (const bool is_left : {true, false}) {
        const auto& discs = is_left ? left : right;
        std::vector<Candidate> candidates;
        for (std::size_t k = 0; k < markers.size(); ++k) {
            const auto pixel =
                project(is_left ? rig.left_camera : rig.right_camera, rig_from_patient * markers[k].centre_in_patient);
            for (std::size_t d = 0; pixel && d < discs.size(); ++d)
                if (const double distance = (discs[d].pixel - *pixel).norm(); distance < max_px)
                    candidates.push_back({distance, {static_cast<int>(k), is_left, discs[d]}, d});
        }
        std::sort(candidates.begin(), candidates.end(),
                  [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
        std::vector<bool> marker_taken(markers.size(), false), disc_taken(discs.size(), false);
        for (const Candidate& c : candidates) {
            const auto k = static_cast<std::size_t>(c.sighting.marker);
            if (marker_taken[k] || disc_taken[c.disc]) continue;
            marker_taken[k] = disc_taken[c.disc] = true;
            sightings.push_back(c.sighting);
        }
    }
    return sightings;
}

ConstellationMatch match_constellation(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                       const std::vector<MarkerObservation>& left,
                                       const std::vector<MarkerObservation>& right,
                                       const std::optional<RigidTransform>& guess, const TrackingSettings& settings) {
    ConstellationMatch result;
    auto points = possible_pairs(rig, left, right, settings.design, settings.max_epipolar_px);
    std::sort(points.begin(), points.end(), [](const MarkerPair& a, const MarkerPair& b) { return a.cost < b.cost; });
    auto proposals = Search(rig, markers, left, right, settings).run(points);
    const int seen = static_cast<int>(
        consistent_pairs(points, static_cast<int>(left.size()), static_cast<int>(right.size())).size());
    // Three markers out of many fit somewhere by chance, and in a mirrored arrangement always: a triangle has no
    // handedness.
    const int expected = std::min(seen, static_cast<int>(markers.size()));
    const int needed = std::max(settings.min_markers, expected >= 4 ? std::max(4, (2 * expected + 2) / 3) : 0);
    result.needed = needed;
    std::erase_if(proposals, [&](const Proposal& p) { return p.markers < needed; });
    if (proposals.empty()) {
        result.reason = seen < settings.min_markers
                            ? fmt::format("only {} of {} markers seen; {} are needed",
                                          std::min<int>(seen, static_cast<int>(markers.size())), markers.size(),
                                          settings.min_markers)
                            : fmt::format("{} discs seen, but not {} in the arrangement of the markers", seen, needed);
        return result;
    }
    std::sort(proposals.begin(), proposals.end(),
              [](const Proposal& a, const Proposal& b) { return a.better_than(b); });
    const double allowed = settings.max_residual_px * settings.max_residual_px;
    if (proposals.front().squared_px <= allowed)  // what fits well has no rival in what does not
        std::erase_if(proposals, [&](const Proposal& p) { return p.squared_px > allowed; });
    const int most = proposals.front().markers;
    const auto rivals_end =
        std::find_if(proposals.begin(), proposals.end(), [&](const Proposal& p) { return p.markers < most; });
    if (rivals_end - proposals.begin() > 1) {
        const auto far = [&](const Proposal& p) { return angle_between(*guess, p.pose); };
        if (guess)
            std::sort(proposals.begin(), rivals_end,
                      [&](const Proposal& a, const Proposal& b) { return far(a) < far(b); });
        constexpr double kClear = 0.35;  // radians nearer to the guess
        if (!guess || far(proposals[1]) - far(proposals[0]) < kClear) {
            result.reason = fmt::format("the {} markers seen fit their arrangement in more than one way", most);
            return result;
        }
    }
    result.rig_from_patient = proposals.front().pose;
    result.sightings = proposals.front().sightings;
    return result;
}

}  // namespace planlight
