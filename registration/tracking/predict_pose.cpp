#include "registration/tracking/predict_pose.h"

#include <Eigen/Dense>
#include <cmath>

namespace planlight {
namespace {

constexpr double kLeverMm = 100;  // the head's radius: what turns a place's sigma into an angle's

/// Place and velocity along one axis share this covariance: all axes are measured alike.
struct AxisFilter {
    Eigen::Matrix2d P = Eigen::Matrix2d::Zero();

    void advance(double dt_s, double acceleration_sigma) {
        Eigen::Matrix2d F, Q;
        F << 1, dt_s, 0, 1;
        Q << dt_s * dt_s / 4, dt_s / 2, dt_s / 2, 1;
        P = F * P * F.transpose() + std::pow(acceleration_sigma * dt_s, 2) * Q;
    }

    /// The gains of place and velocity.
    Eigen::Vector2d correct(double measurement_sigma) {
        const Eigen::Vector2d gain = P.col(0) / (P(0, 0) + measurement_sigma * measurement_sigma);
        P = (P - gain * P.row(0)).eval();
        P = (0.5 * (P + P.transpose())).eval();
        return gain;
    }
};

Eigen::Matrix3d turned(const Eigen::Vector3d& rotation_vector_rad) {
    Eigen::Matrix<double, 6, 1> twist = Eigen::Matrix<double, 6, 1>::Zero();
    twist.head<3>() = rotation_vector_rad;
    return transform_from_twist(twist).linear();
}

}  // namespace

struct PosePredictor::Filter {
    PredictionSettings settings;
    bool started = false;
    Instant at{};
    Eigen::Vector3d centre_in_patient = Eigen::Vector3d::Zero();
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the head, in rig, mm
    Eigen::Vector3d velocity_mm_s = Eigen::Vector3d::Zero();
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // rig_from_patient
    Eigen::Vector3d turn_rad_s = Eigen::Vector3d::Zero();    // in rig axes
    AxisFilter place_axis, turn_axis;
    double liveliness = 1;  // of the process noise, (0, 1]

    void start(const TrackedPose& pose, const Eigen::Vector3d& about) {
        constexpr double kFirstSpeedMmS = 100;  // of a head about which nothing is known yet
        started = true;
        liveliness = 1;
        at = pose.at;
        centre_in_patient = about;
        centre = *pose.rig_from_patient * about;
        rotation = pose.rig_from_patient->linear();
        velocity_mm_s.setZero();
        turn_rad_s.setZero();
        const double sigma = settings.measurement_sigma_mm;
        place_axis.P = Eigen::Vector2d(sigma * sigma, kFirstSpeedMmS * kFirstSpeedMmS).asDiagonal();
        turn_axis.P = place_axis.P / (kLeverMm * kLeverMm);
    }

    void move_centre(const Eigen::Vector3d& about) {
        const Eigen::Vector3d shift = rotation * (about - centre_in_patient);
        centre += shift;
        velocity_mm_s += turn_rad_s.cross(shift);
        centre_in_patient = about;
    }

    /// The process noise follows the head: small while it lies still or moves evenly, `acceleration_sigma_mm_s2` at
    /// once when the measurements leave what a quiet head would do (mean normalised innovation of the six axes above
    /// `kSurprise`).
    void advance_axes(double dt_s, const Eigen::Vector3d& off, const Eigen::Vector3d& off_rad) {
        constexpr double kSurprise = 2, kQuietest = 0.06, kCalming = 0.96;
        const double variance = std::pow(settings.measurement_sigma_mm, 2);
        while (true) {
            AxisFilter place = place_axis, turn = turn_axis;
            place.advance(dt_s, liveliness * settings.acceleration_sigma_mm_s2);
            turn.advance(dt_s, liveliness * settings.acceleration_sigma_mm_s2 / kLeverMm);
            const double surprise = (off.squaredNorm() / (place.P(0, 0) + variance) +
                                     off_rad.squaredNorm() / (turn.P(0, 0) + variance / (kLeverMm * kLeverMm))) /
                                    6;
            if (surprise < kSurprise || liveliness >= 1) {
                place_axis = place, turn_axis = turn;
                liveliness = std::max(kQuietest, kCalming * liveliness);
                return;
            }
            liveliness = std::min(1.0, 1.5 * liveliness);
        }
    }

    void measure(const TrackedPose& pose) {
        const double dt_s = seconds(pose.at - at);
        at = pose.at;
        centre += dt_s * velocity_mm_s;
        rotation = turned(dt_s * turn_rad_s) * rotation;
        const Eigen::Vector3d off = *pose.rig_from_patient * centre_in_patient - centre;
        const Eigen::Vector3d off_rad = rotation_vector(pose.rig_from_patient->linear() * rotation.transpose());
        advance_axes(dt_s, off, off_rad);

        const Eigen::Vector2d place_gain = place_axis.correct(settings.measurement_sigma_mm);
        centre += place_gain[0] * off;
        velocity_mm_s += place_gain[1] * off;

        const Eigen::Vector2d turn_gain = turn_axis.correct(settings.measurement_sigma_mm / kLeverMm);
        rotation = turned(turn_gain[0] * off_rad) * rotation;
        turn_rad_s += turn_gain[1] * off_rad;
    }
};

PosePredictor::PosePredictor(const PredictionSettings& settings) : filter_(std::make_unique<Filter>()) {
    filter_->settings = settings;
}
PosePredictor::~PosePredictor() = default;
PosePredictor::PosePredictor(PosePredictor&&) noexcept = default;
PosePredictor& PosePredictor::operator=(PosePredictor&&) noexcept = default;

void PosePredictor::add(const TrackedPose& pose, const Eigen::Vector3d& centre_in_patient) {
    if (!pose.rig_from_patient) return;
    if (!filter_->started || pose.at - filter_->at > filter_->settings.max_gap) {
        filter_->start(pose, centre_in_patient);
        return;
    }
    if (pose.at <= filter_->at) return;  // late or repeated: the filter has moved on
    if (centre_in_patient != filter_->centre_in_patient) filter_->move_centre(centre_in_patient);
    filter_->measure(pose);
}

std::optional<RigidTransform> PosePredictor::rig_from_patient_at(Instant at) const {
    const Filter& f = *filter_;
    const Instant ahead = at - f.at;
    if (!f.started || ahead > f.settings.max_ahead || -ahead > f.settings.max_ahead) return std::nullopt;
    const double dt_s = seconds(ahead);
    RigidTransform pose = RigidTransform::Identity();
    pose.linear() = turned(dt_s * f.turn_rad_s) * f.rotation;
    pose.translation() = f.centre + dt_s * f.velocity_mm_s - pose.linear() * f.centre_in_patient;
    return pose;
}

void PosePredictor::reset() {
    filter_->started = false;
}

}  // namespace planlight
