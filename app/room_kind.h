#pragma once

namespace planlight {

/// What stands before the cameras of a session.
enum class RoomKind {
    real,       ///< a patient, or whatever lies in the room
    simulated,  ///< nothing: all of it is computed
    recorded    ///< nothing: the cameras give pictures of another day
};

}  // namespace planlight
