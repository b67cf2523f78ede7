#pragma once

namespace planlight {

/// How many of the signals that `note_end_signals` (console.h) notes have come since: what is still done at the end may
/// be ended by one more.
int times_asked_to_end();

}  // namespace planlight
