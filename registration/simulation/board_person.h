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
    Instant hold = std::chrono::milliseconds(3500);     ///< at rest without flickering light
    Instant reaction = std::chrono::milliseconds(500);  ///< after the flicker has ended
    /// The room's time goes on while a place is drawn (the board is shaken about meanwhile): for a room that is served.
    bool time_goes_on = false;
    int steps = 4;  ///< places on the way from one stop to the next, the stop included
};

/// A person who carries a board from stop to stop, lays it down there, and does not touch it while the light on it
/// flickers. After the last stop the first comes again. Room frame, mm; moments of the room's clock.
///
/// How long the way takes is the simulator's business: it draws a place when it can, and asks for the next then.
class BoardPerson {
public:
    BoardPerson(std::vector<BoardStop> stops, const PersonSettings& settings);

    /// The light on the board became another one.
    void see_light_change(Instant at);

    /// True once the person takes the board up again; called with ascending moments while it is at rest.
    bool leaves(Instant at);

    /// The next place on the way.
    RigidTransform next_place();
    /// The board is where `next_place` said; at the stop it is at rest from then on.
    void arrive(Instant at);

    bool time_goes_on() const { return settings_.time_goes_on; }
    bool at_rest() const { return step_ == 0; }
    /// True when the next place is the stop itself.
    bool at_last_step() const { return step_ + 1 == settings_.steps; }
    std::size_t stops_made() const { return made_; }
    const std::vector<BoardStop>& stops() const { return stops_; }
    /// How far the board is shaken aside on the way, picture pixels.
    static int shaken_px(Instant at);

private:
    bool flickers(Instant at) const;

    std::vector<BoardStop> stops_;
    PersonSettings settings_;
    std::deque<Instant> changes_;
    std::size_t stop_ = 0, from_ = 0, made_ = 1;
    int step_ = 0;  ///< 0: at rest; else places of the way that were reached, the stop left included
    Instant came_{};
};

}  // namespace planlight::simulation
