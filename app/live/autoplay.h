#pragma once

#include <string>

#include "app/windows/operator_model.h"

namespace planlight {

/// Presses the buttons of a session in their order as soon as each is free, until darkness was asked for: what a person
/// made dark is lit again by a person alone.
class Autoplay {
public:
    /// That light or a match is right is a person's word: only in the simulated room is it said without one.
    /// `resumes`: the session goes on with a match by itself, and Track is what comes next.
    explicit Autoplay(bool says_it_is_right, bool resumes = false)
        : says_it_is_right_(says_it_is_right), step_(resumes ? 2 : 0) {}

    /// What is pressed now; none: nothing yet, or no more.
    OperatorAction next(const OperatorModel& model) {
        if (over_) return OperatorAction::none;
        if (step_ == 0 && model.scan.enabled) return advance(OperatorAction::scan);
        if (step_ == 1 && model.do_register.enabled) return advance(OperatorAction::do_register);
        if (step_ == 2 && model.track.enabled) return advance(OperatorAction::track);
        if (step_ < 3 || !says_it_is_right_ || !model.confirm || model.confirm_words == confirmed_)
            return OperatorAction::none;
        confirmed_ = model.confirm_words;
        return OperatorAction::confirm;
    }
    /// A person has pressed that: DARK and Stop end it.
    void pressed(OperatorAction action) {
        over_ = over_ || action == OperatorAction::dark || action == OperatorAction::stop;
    }
    /// The session was made dark because its projector was away.
    void projector_lost() { over_ = true; }

private:
    OperatorAction advance(OperatorAction action) {
        ++step_;
        return action;
    }
    bool says_it_is_right_, over_ = false;
    int step_;
    std::string confirmed_;  ///< the words on the button that was pressed last
};

}  // namespace planlight
