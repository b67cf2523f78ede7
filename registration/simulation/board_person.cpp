#include "registration/simulation/board_person.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace planlight::simulation {
namespace {

constexpr std::size_t kChangesOfFlicker = 4;
constexpr Instant kFlickerWithin = std::chrono::seconds(4);

/// Smoothly from one place to another; `share` 0 to 1.
RigidTransform between(const RigidTransform& a, const RigidTransform& b, double share) {
    const double eased = (1 - std::cos(std::numbers::pi * share)) / 2;
    RigidTransform p = RigidTransform::Identity();
    p.linear() =
        Eigen::Quaterniond(a.linear()).slerp(eased, Eigen::Quaterniond(b.linear())).normalized().toRotationMatrix();
    p.translation() = (1 - eased) * a.translation() + eased * b.translation();
    return p;
}

}  // namespace

BoardPerson::BoardPerson(std::vector<BoardStop> stops, const PersonSettings& settings)
    : stops_(std::move(stops)), settings_(settings) {}

void BoardPerson::see_light_change(Instant at) {
    changes_.push_back(at);
    while (changes_.size() > kChangesOfFlicker) changes_.pop_front();
}

/// Stripes follow each other quickly; a word that changes does not flicker.
bool BoardPerson::flickers(Instant at) const {
    return changes_.size() == kChangesOfFlicker && at - changes_.front() < kFlickerWithin;
}

bool BoardPerson::leaves(Instant at) {
    if (stops_.size() < 2) return false;
    if (flickers(at) && !stops_[stop_].leaves_at_once)
        came_ = std::max(came_, at - settings_.hold + settings_.reaction);
    if (at - came_ < settings_.hold) return false;
    from_ = std::exchange(stop_, (stop_ + 1) % stops_.size());
    return true;
}

RigidTransform BoardPerson::next_place() {
    return between(stops_[from_].room_from_board, stops_[stop_].room_from_board,
                   static_cast<double>(step_ + 1) / settings_.steps);
}

void BoardPerson::arrive(Instant at) {
    if (++step_ < settings_.steps) return;
    step_ = 0;
    came_ = at;
    ++made_;
}

int BoardPerson::shaken_px(Instant at) {
    constexpr double kPixels = 4, kTurns_hz = 1.6;
    return static_cast<int>(std::lround(kPixels * std::sin(2 * std::numbers::pi * kTurns_hz * seconds(at))));
}

}  // namespace planlight::simulation
