#include "registration/simulation/head_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace planlight::simulation {

using Eigen::Vector3d;

HeadMotion::HeadMotion(const Motion& motion, Instant not_before, const Vector3d& neck, const Vector3d& middle,
                       std::mt19937& random)
    : begins_(std::max(motion.begins, not_before)), neck_(neck) {
    std::uniform_real_distribution<double> phase(0, 2 * M_PI), share(0.6, 1.0);
    for (std::size_t way = 0; way < 6; ++way)
        for (std::size_t wave = 0; wave < kWaves; ++wave) {
            const double full = way < 3 ? 3.5 * M_PI / 180 : 4.0;  // radians; mm
            amplitude_[way][wave] = full * share(random) / static_cast<double>((wave + 1) * (wave + 1));
            start_[way][wave] = phase(random);
        }
    constexpr int kSteps = 2000;
    double greatest = 0;  // mm per radian of phase, over the whole period
    at_rest_ = offset(0).inverse();
    Vector3d before = middle;
    for (int i = 1; i <= kSteps; ++i) {
        const Vector3d here = offset(2 * M_PI * i / kSteps) * at_rest_ * middle;
        greatest = std::max(greatest, (here - before).norm() * kSteps / (2 * M_PI));
        before = here;
    }
    rate_ = greatest > 0 ? motion.speed_mm_s / greatest : 0;
}

Eigen::Matrix<double, 6, 1> HeadMotion::swing(double phase) const {
    Eigen::Matrix<double, 6, 1> value;
    for (std::size_t way = 0; way < 6; ++way) {
        double sum = 0;
        for (std::size_t wave = 0; wave < kWaves; ++wave)
            sum += amplitude_[way][wave] * std::sin(static_cast<double>(wave + 1) * phase + start_[way][wave]);
        value[static_cast<Eigen::Index>(way)] = sum;
    }
    return value;
}

RigidTransform HeadMotion::offset(double phase) const {
    const Eigen::Matrix<double, 6, 1> s = swing(phase);
    RigidTransform turn = RigidTransform::Identity();
    turn.rotate(Eigen::AngleAxisd(s[0], Vector3d::UnitX()));
    turn.rotate(Eigen::AngleAxisd(s[1], Vector3d::UnitY()));
    turn.rotate(Eigen::AngleAxisd(s[2], Vector3d::UnitZ()));
    return Eigen::Translation3d(neck_ + s.tail<3>()) * turn * Eigen::Translation3d(-neck_);
}

RigidTransform HeadMotion::moved(Instant at) const {
    constexpr double kRamp_s = 0.5;
    const double t = seconds(at - begins_);
    if (t <= 0 || rate_ == 0) return RigidTransform::Identity();
    const double run_s = t < kRamp_s ? t * t / (2 * kRamp_s) : t - kRamp_s / 2;
    return offset(rate_ * run_s) * at_rest_;
}

void HeadHistory::add(HeadMotion motion, Instant now) {
    parts_.push_back({now, room_from_ct(now), std::move(motion)});
}

RigidTransform HeadHistory::room_from_ct(Instant at) const {
    for (auto part = parts_.rbegin(); part != parts_.rend(); ++part)
        if (at >= part->from) return part->motion.moved(at) * part->room_from_ct;
    return first_;
}

}  // namespace planlight::simulation
