#pragma once

namespace planlight {

/// While one lives, Ctrl-C (SIGINT), SIGTERM and SIGHUP wait where they would end the program at once: temporary files,
/// which may show a patient's face, are put in place or removed first. The last one to go lets the signal through. A
/// second Ctrl-C is not waited with; a closed terminal and a shutdown send several signals by themselves. Signals that
/// the program handles itself are left alone.
class HeldEndSignals {
public:
    HeldEndSignals();
    ~HeldEndSignals();
    HeldEndSignals(const HeldEndSignals&) = delete;
    HeldEndSignals& operator=(const HeldEndSignals&) = delete;

    /// Whether one waits: what is being written is not wanted any more.
    static bool one_waits();
};

}  // namespace planlight
