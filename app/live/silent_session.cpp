#include "app/live/silent_session.h"

#include "app/live/session_states.h"

namespace planlight {

void say_silence(OperatorModel& model, bool projecting, Instant silent, Instant patience) {
    const bool of_light = model.status.kind == StatusKind::aligned || model.status.kind == StatusKind::check;
    if (!projecting || !of_light || silent <= patience) return;
    model.status = {StatusKind::dark,
                    "Dark: the session does not answer.",
                    {"The light comes back by itself as soon as it does.",
                     "If it does not, close this window, and start Planlight again."},
                    {}};
    show_no_light(model);
}

}  // namespace planlight
