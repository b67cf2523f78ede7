#pragma once

#include <array>
#include <random>
#include <vector>

#include "planning_io/types/rigid_transform.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::simulation {

/// One way of moving: nod, turn and tilt about the neck with a little shift, each a periodic sum of sines, so that the
/// greatest speed of the head's middle is exactly known. Smooth in position; the speed grows from zero over half a
/// second.
class HeadMotion {
public:
    /// `neck` and `middle` in room, mm. Moves as told from max(`motion.begins`, `not_before`).
    HeadMotion(const Motion& motion, Instant not_before, const Eigen::Vector3d& neck, const Eigen::Vector3d& middle,
               std::mt19937& random);

    /// Where the head has moved to, from where it was before the motion: room from room.
    RigidTransform moved(Instant at) const;
    Instant begins() const { return begins_; }

private:
    static constexpr int kWaves = 3;
    Eigen::Matrix<double, 6, 1> swing(double phase) const;
    RigidTransform offset(double phase) const;

    Instant begins_{};
    double rate_ = 0;  ///< radians of phase per second at full speed
    Eigen::Vector3d neck_;
    RigidTransform at_rest_ = RigidTransform::Identity();
    std::array<std::array<double, kWaves>, 6> amplitude_{}, start_{};
};

/// The pose of the head over the whole session.
class HeadHistory {
public:
    explicit HeadHistory(const RigidTransform& room_from_ct) : first_(room_from_ct) {}
    /// From `now` on the head moves by a motion that takes the pose at `now` as its start.
    void add(HeadMotion motion, Instant now);
    RigidTransform room_from_ct(Instant at) const;

private:
    struct Part {
        Instant from{};
        RigidTransform room_from_ct;
        HeadMotion motion;
    };
    RigidTransform first_;
    std::vector<Part> parts_;
};

}  // namespace planlight::simulation
