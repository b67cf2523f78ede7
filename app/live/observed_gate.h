#pragma once

#include "app/session_observer.h"

namespace planlight {

/// The light gate of a session; what it is asked and how it rules is told to an observer (null: to nobody).
class ObservedGate {
public:
    explicit ObservedGate(SessionObserver* observer) : observer_(observer) {}

    LightGate::Ruling step(Instant at, bool lit, const std::optional<LightCheck>& check,
                           const std::vector<LightCause>& causes, double unnoticed_mm) {
        LightGate::Ruling ruling = gate_.step(at, lit, check, causes, unnoticed_mm);
        if (observer_) observer_->gate(GateCall::step, at, 0, &ruling);
        return ruling;
    }
    void verify(Instant at) {
        gate_.verify(at);
        tell(GateCall::verify, at);
    }
    bool verified() const { return gate_.verified(); }
    std::optional<Instant> skin_known_at() const { return gate_.skin_known_at(); }
    void skin_checked(double off_mm) {
        gate_.skin_checked(off_mm);
        tell(GateCall::skin_checked, {}, off_mm);
    }
    void new_match() {
        gate_.new_match();
        tell(GateCall::new_match);
    }
    void restart() {
        gate_.restart();
        tell(GateCall::restart);
    }
    void other_light(Instant at) {
        gate_.other_light();
        tell(GateCall::other_light, at);
    }
    /// Told only where it does.
    /// What `forbids` would say, for nobody to record: nothing is to be lit.
    std::optional<LightGate::Ruling> stopped() const { return gate_.forbids(); }
    std::optional<LightGate::Ruling> forbids(Instant at) const {
        auto ruling = gate_.forbids();
        if (ruling && observer_) observer_->gate(GateCall::forbids, at, 0, &*ruling);
        return ruling;
    }

private:
    void tell(GateCall call, Instant at = {}, double off_mm = 0) const {
        if (observer_) observer_->gate(call, at, off_mm, nullptr);
    }
    LightGate gate_;
    SessionObserver* observer_;
};

}  // namespace planlight
