#include "app/windows/landmark_clicks.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/rigid_transform.h"

namespace planlight {

void LandmarkClicks::click(std::vector<Eigen::Vector3d>& here, const std::vector<Eigen::Vector3d>& there,
                           const Eigen::Vector3d& p, bool on_skin) {
    if (here.size() > there.size()) {
        here.back() = p;
        return;
    }
    here.push_back(p);
    order_.push_back(on_skin);
}

void LandmarkClicks::undo() {
    if (order_.empty()) return;
    (order_.back() ? in_ct_ : in_rig_).pop_back();
    order_.pop_back();
}

void LandmarkClicks::clear() {
    *this = {};
}

std::vector<PointPair> LandmarkClicks::pairs() const {
    std::vector<PointPair> pairs;
    const auto name_taken = [&](const std::string& name) {
        return std::any_of(pairs.begin(), pairs.end(), [&](const PointPair& pair) { return pair.name == name; });
    };
    for (std::size_t i = 0; i < std::min(in_ct_.size(), in_rig_.size()); ++i) {
        std::string name = i < names_.size() ? names_[i] : std::string();
        for (std::size_t number = i + 1; name.empty() || name_taken(name); ++number) name = std::to_string(number);
        pairs.push_back({name, in_ct_[i], in_rig_[i]});
    }
    return pairs;
}

void LandmarkClicks::set_pairs(const std::vector<PointPair>& pairs) {
    clear();
    for (const PointPair& pair : pairs) {
        names_.push_back(pair.name);
        click_skin(pair.in_ct);
        click_scan(pair.in_rig);
    }
}

double LandmarkClicks::misfit_mm() const {
    const auto count = static_cast<Eigen::Index>(std::min(in_ct_.size(), in_rig_.size()));
    if (count < 3) return 0;
    Eigen::Matrix3Xd a(3, count), b(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        a.col(i) = in_ct_[static_cast<std::size_t>(i)];
        b.col(i) = in_rig_[static_cast<std::size_t>(i)];
    }
    const RigidTransform fit = fit_rigid_transform(a, b);
    return std::sqrt(((fit * a) - b).squaredNorm() / static_cast<double>(count));
}

}  // namespace planlight
