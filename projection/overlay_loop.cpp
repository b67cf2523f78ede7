#include "projection/overlay_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "projection/picture_validity.h"

namespace planlight {
namespace {

double ms(Instant t) {
    return 1e3 * seconds(t);
}

/// Why this registration must not be drawn; empty when it may.
std::string registration_refusal(const RegistrationResult& registration, bool confirmed) {
    const std::string first = registration.reasons.empty() ? "" : ": " + registration.reasons.front();
    if (registration.verdict == Verdict::no) return "the patient is not registered" + first;
    if (registration.verdict == Verdict::ask && !confirmed)
        return "the registration awaits a person's confirmation" + first;
    if (!is_rigid(registration.patient_from_ct.matrix())) return "the registration is not a rigid transform";
    return "";
}

/// Why this pose must not be drawn now; empty when it may.
std::string pose_refusal(const TrackedPose& pose, Instant now, const OverlaySettings& s) {
    if (!pose.rig_from_patient)
        return pose.reason.empty() ? "the patient is not tracked" : "the patient is not tracked: " + pose.reason;
    if (!is_rigid(pose.rig_from_patient->matrix())) return "the tracked pose is not a rigid transform";
    const Instant age = now - pose.at;
    if (age > s.max_pose_age)
        return fmt::format("the last pose is {:.0f} ms old (at most {:.0f} ms)", ms(age), ms(s.max_pose_age));
    if (age < -s.max_pose_age)
        return fmt::format("the pose is dated {:.0f} ms in the future: the clocks disagree", -ms(age));
    if (!(pose.predicted_error_mm <= s.max_predicted_error_mm))
        return fmt::format("the pose is uncertain by {:.2f} mm (at most {:.2f} mm)", pose.predicted_error_mm,
                           s.max_predicted_error_mm);
    return "";
}

/// How far a head gets between two poses, mm, on a ball of its own size about `centre_in_patient`.
double way_mm(const RigidTransform& from, const RigidTransform& to, const Eigen::Vector3d& centre_in_patient) {
    constexpr double kHeadRadius_mm = 90;
    const double turned = Eigen::AngleAxisd(Eigen::Matrix3d(to.linear() * from.linear().transpose())).angle();
    return (to * centre_in_patient - from * centre_in_patient).norm() + kHeadRadius_mm * turned;
}

/// The middle of what is drawn: the prediction turns the head about it.
Eigen::Vector3d middle_in_ct(const PlanDrawing& drawing) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (const Stroke& stroke : drawing.strokes)
        for (const auto& p : stroke.points_in_ct) {
            sum += p;
            ++count;
        }
    return count > 0 ? Eigen::Vector3d(sum / count) : sum;
}

}  // namespace

struct OverlayLoop::Parts {
    Projector& projector;
    const Clock& clock;
    const DrawingRenderer& renderer;
    const PlanDrawing& drawing;
    RegistrationResult registration;
    OverlaySettings settings;
    PosePredictor predictor;
    Eigen::Vector3d centre_in_patient;
    std::optional<Instant> shown_last{};  ///< the last picture; empty after darkness
    Instant usual_life{};                 ///< of a picture until the next; 0: not known
    std::optional<Instant> promised{};    ///< from the pose to light, as the projector promised of the last pictures
    Instant found_delay{};                ///< beyond its promises
    Instant spare_time{};                 ///< that the last light could have come later and still be predicted

    OverlayStep dark(std::string reason) {
        projector.go_dark();
        shown_last.reset();
        OverlayStep step;
        step.reason = std::move(reason);
        step.picture = RgbImage(renderer.width(), renderer.height());
        return step;
    }
    /// Light that comes later than a pose can be predicted is drawn for as late as it can where the head lies still
    /// enough; else `why_not` says so.
    std::optional<RigidTransform> pose_at_light(const TrackedPose& pose, Instant now, std::string& why_not) {
        if (!settings.predict) return pose.rig_from_patient;
        why_not = "where the patient will be when the light arrives is not known";
        predictor.add(pose, centre_in_patient);
        const Instant light = now + light_delay() + std::min(usual_life / 2, settings.most_ahead);
        const Instant last = pose.at + settings.prediction.max_ahead;
        spare_time = last - light;
        if (light <= last) return predictor.rig_from_patient_at(light);
        const auto at_last = predictor.rig_from_patient_at(last), measured = predictor.rig_from_patient_at(pose.at);
        if (!at_last || !measured) return std::nullopt;
        const double share = seconds(light - last) / seconds(settings.prediction.max_ahead);
        if (share * way_mm(*measured, *at_last, centre_in_patient) > settings.most_unpredicted_mm) {
            why_not = fmt::format(
                "the head moves, and light comes {:.0f} ms after it was seen (drawn ahead for {:.0f} ms at most)",
                ms(light - pose.at), ms(settings.prediction.max_ahead));
            return std::nullopt;
        }
        return at_last;
    }
    Instant light_delay() const { return promised.value_or(settings.light_delay) + found_delay; }
    static constexpr int kSlow = 8;  ///< means, so that one late picture does not move the light
    void note_promise(Instant delay) {
        constexpr Instant kMost = std::chrono::milliseconds(500);
        delay = std::clamp(delay, Instant{}, kMost);
        promised = promised ? *promised + (delay - *promised) / kSlow : delay;
    }
    void note_shown(Instant now) {
        if (shown_last) {
            const Instant life = std::min(now - *shown_last, 2 * settings.most_ahead);
            usual_life = usual_life == Instant{} ? life : usual_life + (life - usual_life) / kSlow;
        }
        shown_last = now;
    }
    OverlayStep draw(const TrackedPose& pose);
};

OverlayStep OverlayLoop::Parts::draw(const TrackedPose& pose) {
    if (auto reason = registration_refusal(registration, settings.operator_confirmed); !reason.empty())
        return dark(std::move(reason));
    const Instant now = clock.now();
    if (auto reason = pose_refusal(pose, now, settings); !reason.empty()) return dark(std::move(reason));
    std::string why_not;
    const auto rig_from_patient = pose_at_light(pose, now, why_not);
    if (!rig_from_patient) return dark(std::move(why_not));
    if (!is_rigid(rig_from_patient->matrix())) return dark("the predicted pose is not a rigid transform");
    OverlayStep step;
    step.rig_from_ct = *rig_from_patient * registration.patient_from_ct;  // T_global = T_cur T_ini
    step.counts = renderer.render_into(step.picture, drawing, step.rig_from_ct, *rig_from_patient, settings.render);
    if (step.counts.lit == 0) return dark(kNothingInTheLight);
    const Instant shown = clock.now();
    if (auto reason = pose_refusal(pose, shown, settings); !reason.empty())
        return dark(std::move(reason));  // rendering took too long
    step.lit_from = projector.show(step.picture, shown + picture_validity(settings.picture_validity, usual_life));
    step.lit = true;
    note_shown(shown);
    note_promise(step.lit_from - now);
    return step;
}

OverlayLoop::OverlayLoop(Projector& projector, const Clock& clock, const DrawingRenderer& renderer,
                         const PlanDrawing& drawing, const RegistrationResult& registration,
                         const OverlaySettings& settings)
    : parts_(new Parts{projector,
                       clock,
                       renderer,
                       drawing,
                       registration,
                       settings,
                       PosePredictor(settings.prediction),
                       registration.patient_from_ct * middle_in_ct(drawing),
                       {},
                       {}}) {
    projector.go_dark();
}

OverlayLoop::~OverlayLoop() {
    parts_->projector.go_dark();
}

void OverlayLoop::set_operator_confirmed(bool confirmed) {
    parts_->settings.operator_confirmed = confirmed;
}

void OverlayLoop::set_found_delay(Instant later) {
    parts_->found_delay = later;
}

void OverlayLoop::set_brightness(double share) {
    parts_->settings.render.brightness = share;
}

Instant OverlayLoop::light_delay() const {
    return parts_->light_delay();
}

Instant OverlayLoop::spare_time() const {
    return parts_->spare_time;
}

OverlayStep OverlayLoop::step(const TrackedPose& pose) {
    try {
        return parts_->draw(pose);
    } catch (...) {
        parts_->projector.go_dark();
        throw;
    }
}

}  // namespace planlight
