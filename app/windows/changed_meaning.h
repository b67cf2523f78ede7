#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "app/windows/operator_model.h"

namespace planlight {

/// The key or pedal that leads on means another thing from one moment to the next: where the light is stopped while
/// the foot goes down, what was meant as "Light 2 is right" would be Scan, and throw the match away. For a moment after
/// such a change it means nothing. What leads on after nothing did may be pressed at once. Time is handed in.
class ChangedMeaning {
public:
    using Moment = std::chrono::steady_clock::time_point;

    /// At each look at the session.
    void look(const OperatorModel& model, Moment now) {
        const std::string means = model.next == OperatorAction::none ? std::string{} : meaning(model);
        if (means == means_) return;
        if (!means_.empty() && !means.empty()) changed_ = now;
        means_ = means;
    }
    bool just_changed(Moment now) const {
        constexpr auto kReaction = std::chrono::milliseconds(700);
        return changed_ && now - *changed_ < kReaction;
    }

private:
    static std::string meaning(const OperatorModel& model) {
        return std::to_string(static_cast<int>(model.next)) +
               (model.next == OperatorAction::confirm ? model.confirm_words : "");
    }
    std::string means_;
    std::optional<Moment> changed_;
};

}  // namespace planlight
