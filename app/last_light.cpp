// What a session lit last, and whether it is still on the skin though it was put out.
#include <algorithm>
#include <utility>

#include "app/session.h"
#include "projection/light_gate.h"

namespace planlight {

bool Session::LitLight::lights(std::size_t item) const {
    return (!bright_item || *bright_item == item) && std::ranges::any_of(drawing->strokes, [&](const Stroke& stroke) {
               return stroke.item == static_cast<int>(item);
           });
}

bool Session::LitLight::still_seen() const {
    return (check && check->lit()) || (check_of_seen && check_of_seen->lit());
}

bool Session::LitLight::gone() const {
    return check && check->gone() && (!check_of_seen || check_of_seen->gone());
}

void Session::LitLight::look_anew() {
    check.reset();
    check_of_seen.reset();
}

/// A projector that holds its picture shows none that was ordered later, wherever the head has gone since.
void Session::note_seen(const LightCheck& check, Instant at) {
    const LightGateSettings gate;
    if (!last_light_ || last_light_->drawing != looked_for_ || check.seen < gate.least_seen ||
        check.seen_share() < gate.least_seen_share || check.light_off_mm() > gate.warn_mm)
        return;
    for (const ShownPicture& picture : shown_)
        if (picture.lit_from <= at) last_light_->rig_from_ct_seen = picture.rig_from_ct;
}

/// Of other light than before, the former is kept until it was seen to go: an order that never reached the skin is no
/// light.
void Session::note_lit(const OverlayStep& overlay) {
    const Instant lit_from = overlay.lit_from + found_delay_;
    if (!last_light_ || last_light_->drawing != looked_for_) {
        if (last_light_ && !former_light_) former_light_ = std::move(last_light_);
        if (former_light_) former_light_->look_anew();
        last_light_.emplace();
        last_light_->drawing = looked_for_;
        last_light_->bright_item = bright_item_;
        last_light_->landmark = lit_landmark_.has_value();
        last_light_->on = now_;
        last_light_->rig = rig_;
        changed_at_ = lit_from;
        if (former_light_ && put_out_since(*former_light_).empty()) former_light_.reset();
    }
    last_light_->lit_from = lit_from;
    last_light_->rig_from_ct = overlay.rig_from_ct;
    last_light_->patient_from_ct = registration_->patient_from_ct;
    last_light_->reference = references_;
    last_light_->grey = lit_grey_;
    last_light_->look_anew();
}

void Session::forget_last_light() {
    last_light_.reset();
    former_light_.reset();
}

/// What was lit in full then and is out or dim by what was ordered last. Dim light of an item whose grey was never seen
/// cannot be told from full light.
std::vector<std::size_t> Session::put_out_since(const LitLight& former) const {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < former.drawing->items.size(); ++i) {
        if (!former.lights(i)) continue;
        const bool same = former.landmark == last_light_->landmark;
        if (same && last_light_->lights(i)) continue;
        const bool dim = same && std::ranges::any_of(last_light_->drawing->strokes, [&](const Stroke& stroke) {
                             return stroke.item == static_cast<int>(i);
                         });
        if (!dim || former.grey > 0) out.push_back(i);
    }
    return out;
}

/// For `DarknessCheck`: in darkness all of it, beside other light what that has not.
LightPutOut Session::put_out(const LitLight& former, bool dark, const RigidTransform& rig_from_ct) const {
    LightPutOut light{*former.drawing, rig_from_ct, former.grey, former.bright_item, {}};
    if (dark) return light;
    const std::vector<std::size_t> out = put_out_since(former);
    const auto is_out = [&](int item) {
        return item >= 0 && std::ranges::find(out, static_cast<std::size_t>(item)) != out.end();
    };
    light.bright_item.reset();
    std::erase_if(light.drawing.strokes, [&](const Stroke& stroke) { return !is_out(stroke.item); });
    light.drawing.labels.clear();
    light.lit_now = *last_light_->drawing;
    if (former.landmark != last_light_->landmark) return light;
    std::erase_if(light.lit_now.strokes, [&](const Stroke& stroke) { return is_out(stroke.item); });
    std::erase_if(light.lit_now.labels, [&](const Label& label) { return is_out(label.item); });
    return light;
}

bool Session::light_stays(const StereoFrame& frame) {
    return sees_last_light(frame, true, [&] {
        PatientTracker tracker = tracker_;  // as it will be when the patient is followed again
        return tracker.update(frame).rig_from_patient;
    });
}

/// A few looks a second, each of a millisecond and the more where the head has moved.
bool Session::sees_last_light(const StereoFrame& frame, bool dark,
                              const std::function<std::optional<RigidTransform>()>& find_patient) {
    constexpr Instant kEvery = std::chrono::milliseconds(250);
    const auto now_lit = [&] {
        return (former_light_ && former_light_->still_seen()) || (dark && last_light_->still_seen());
    };
    if (!last_light_ || (!dark && !former_light_)) return false;
    const Instant since = dark ? last_light_->lit_from : changed_at_;
    if (frame.at - frame.exposure / 2 < since + settings_.time_to_dark) return now_lit();
    if (frame.at < darkness_looked_at_ + kEvery) return now_lit();
    darkness_looked_at_ = frame.at;
    const auto rig_from_patient = find_patient();
    const auto look_for = [&](LitLight& light) {
        const auto check_at = [&](const RigidTransform& rig_from_ct) {
            return std::make_unique<DarknessCheck>(put_out(light, dark, rig_from_ct),
                                                   light.on ? light.on->skin : planned_.skin, light.rig,
                                                   settings_.check_light);
        };
        if (!light.check) light.check = check_at(light.rig_from_ct);
        if (!light.check_of_seen && light.rig_from_ct_seen) light.check_of_seen = check_at(*light.rig_from_ct_seen);
        std::optional<RigidTransform> rig_from_ct;  // of a patient whose frame is another by now it is not known
        if (rig_from_patient && light.reference == references_) rig_from_ct = *rig_from_patient * light.patient_from_ct;
        light.check->look(frame, rig_from_ct);
        if (light.check_of_seen) light.check_of_seen->look(frame, rig_from_ct);
    };
    if (dark) look_for(*last_light_);
    if (former_light_) {
        look_for(*former_light_);
        if (former_light_->gone()) former_light_.reset();
    }
    return now_lit();
}

}  // namespace planlight
