#pragma once

#include <utility>

#include "app/live/projector_keeper.h"
#include "app/windows/operator_model.h"

namespace planlight {

/// What the operator's window knows of its projector, from one look to the next. One that was away and came back
/// between two looks is known by its having been started again.
class ProjectorWatch {
public:
    explicit ProjectorWatch(unsigned starts) : starts_(starts) {}

    /// True where it was lost since the last look: the session is to be made dark.
    bool look(const ProjectorProblem& problem, unsigned starts) {
        const bool was_lost = !problem_.empty();
        const bool started_again = std::exchange(starts_, starts) != starts;
        problem_ = problem;
        const bool lost = (!problem.empty() || started_again) && !was_lost;
        if (lost) was_away_ = true;
        return lost;
    }
    /// By a person: why it is dark has been read.
    void pressed() {
        if (problem_.empty()) was_away_ = false;
    }
    /// While it is away that is said in place of the status; once it is back, why it is dark, until the next press.
    void put_into(OperatorModel& model) const;

private:
    unsigned starts_;
    ProjectorProblem problem_;
    bool was_away_ = false;
};

}  // namespace planlight
