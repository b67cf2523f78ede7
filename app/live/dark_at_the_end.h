#pragma once

#include "app/live/live_session.h"

namespace planlight {

/// Ends a session's light, however its scope is left, before the session itself ends: that waits for its thread, and
/// the thread may hang on a camera for a second while a scan's stripes are on the patient.
class DarkAtTheEnd {
public:
    /// `projector`: what the session lights; null: it has none of its own.
    DarkAtTheEnd(LiveSession& session, Projector* projector) : session_(session), projector_(projector) {}
    ~DarkAtTheEnd() {
        session_.end();  // first: what it hands over from now on is no light any more
        if (projector_) projector_->go_dark();
    }
    DarkAtTheEnd(const DarkAtTheEnd&) = delete;
    DarkAtTheEnd& operator=(const DarkAtTheEnd&) = delete;

private:
    LiveSession& session_;
    Projector* projector_;
};

}  // namespace planlight
