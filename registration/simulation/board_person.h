#pragma once

#include <deque>
#include <string>
#include <vector>

#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/time.h"

namespace planlight::simulation {

/// A place to which a person brings the board.
struct BoardStop {
    RigidTransform room_from_board = RigidTransform::Identity();
    std::string name;             ///< for the truth: "useful", "too aslant"
    bool leaves_at_once = false;  ///< moves on while the light still flickers
};

/// How patient the person is.
struct PersonSettings {
    Instant move = std::chrono::milliseconds(1200);    ///< from one stop to the next
    Instant hold = std::chrono::milliseconds(3500);    ///< at rest without flickering light
    Instant reaction = std::chrono::milliseconds(500); ///< after the flicker has ended
};

/// A person who carries a board from stop to stop, lays it down there, and does not touch it while the light on it
/// flickers. After the last stop the first comes again. Room frame, mm; moments of the room's clock.
class BoardPerson {
public:
    BoardPerson(std::vector<BoardStop> stops, const PersonSettings& settings);

    /// The light on the board became another one.
    void see_light_change(Instant at);

    /// Where the board is; called with ascending moments.
    RigidTransform place(Instant at);

    bool at_rest() const { return at_rest_; }
    std::size_t stop() const { return stop_; }  ///< the one where the board is, or to which it is carried
    std::size_t stops_made() const { return made_; }
    const std::vector<BoardStop>& stops() const { return stops_; }

private:
    bool flickers(Instant at) const;

    std::vector<BoardStop> stops_;
    PersonSettings settings_;
    std::deque<Instant> changes_;
    std::size_t stop_ = 0, from_ = 0, made_ = 0;
    Instant came_{}, left_{};
    bool at_rest_ = true, begun_ = false;
};

}  // namespace planlight::simulation
