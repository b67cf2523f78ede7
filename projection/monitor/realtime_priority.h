#pragma once

namespace planlight {

/// Lets the calling thread, and those that it starts, go before all that other programs compute (SCHED_RR, the lowest
/// of its priorities), so that light goes out in time on a busy computer; false where the system does not allow it:
/// that needs root's rights, or a limit `rtprio` of 1 or more.
bool request_realtime_priority();

/// Whether a process of this user's would get it. Nothing changes.
bool may_have_realtime_priority();

}  // namespace planlight
