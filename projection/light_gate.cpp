#include "projection/light_gate.h"

#include <fmt/format.h>

namespace planlight {

void LightGate::verify(Instant at) {
    verified_ = true;
    lit_at_ = at;
}

void LightGate::new_match() {
    verified_ = stopped_ = false;
    good_ = bad_ = 0;
    last_.reset();
}

void LightGate::restart() {
    stopped_ = false;
    good_ = bad_ = 0;
    last_.reset();
}

void LightGate::take(Instant at, const LightCheck& check) {
    last_ = check;
    measured_at_ = at;
    const bool measured = check.seen >= settings_.least_seen && check.seen_share() >= settings_.least_seen_share;
    const bool far = measured && check.off_mm > settings_.stop_mm;
    bad_ = far ? bad_ + 1 : 0;
    good_ = measured && check.off_mm <= settings_.warn_mm ? good_ + 1 : 0;
    if (bad_ >= settings_.dark_after) stopped_ = true;
}

LightGate::Ruling LightGate::step(Instant at, bool lit, const std::optional<LightCheck>& check) {
    if (lit && verified_ && at - lit_at_ > settings_.verified_for) verified_ = false;
    if (lit) lit_at_ = at;
    if (check && lit) take(at, *check);
    if (!lit) {
        good_ = bad_ = 0;
        last_.reset();
    }
    Ruling ruling = rule(at);
    if (!lit && !stopped_) ruling = {};
    return ruling;
}

/// The table of the README, from the gravest down.
LightGate::Ruling LightGate::rule(Instant at) const {
    Ruling ruling;
    ruling.ask_to_verify = !verified_;
    if (last_ && last_->seen > 0) {
        ruling.off_mm = last_->off_mm;
        ruling.sigma_mm = last_->sigma_mm;
    }
    if (stopped_) {
        ruling.stop = true;
        ruling.headline = fmt::format("Dark: the light lay {:.1f} mm beside the plan.", ruling.off_mm.value_or(0));
        ruling.details = {
            "The cameras measured it twice: the projector, a camera or a marker has moved, or the picture is late.",
            "Scan again; if it comes back, run `planlight check`."};
        return ruling;
    }
    ruling.trust = LightTrust::look;
    if (!last_ || at - measured_at_ > settings_.fresh) {
        ruling.headline = "LOOK: the light is not measured.";
        ruling.details = {
            "The cameras have not measured the light for a second or more: look at it on landmarks before you use it."};
        return ruling;
    }
    if (last_->seen < settings_.least_seen || last_->seen_share() < settings_.least_seen_share) {
        ruling.headline = "LOOK: the cameras do not see the light.";
        ruling.details = {fmt::format("They see {} of {} stretches.", last_->seen, last_->expected),
                          "Is something before the projector or a camera, or another window over the projector's?"};
        return ruling;
    }
    if (last_->off_mm > settings_.warn_mm) {
        ruling.headline = fmt::format("LOOK: the light lies up to {:.1f} mm beside the plan.", last_->off_mm);
        ruling.details = {"Wait until the patient lies still; if it stays so, scan again."};
        return ruling;
    }
    if (!verified_) {
        ruling.headline = "LOOK at the light on two landmarks.";
        ruling.details = {fmt::format("The cameras measure it within {:.1f} mm of the plan.", last_->off_mm),
                          "If it lies where it belongs, press \"The light is right\"."};
        return ruling;
    }
    if (good_ < settings_.green_after) {
        ruling.headline = "LOOK: the light is being measured.";
        return ruling;
    }
    ruling.trust = LightTrust::aligned;
    ruling.headline = "The plan is on the skin.";
    ruling.details = {
        fmt::format("Measured by the cameras: 95 % of the light within {:.1f} mm of the plan.", last_->off_mm)};
    return ruling;
}

}  // namespace planlight
