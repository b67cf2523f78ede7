#include "projection/monitor/realtime_priority.h"

#include <sched.h>

#include <thread>

namespace planlight {

bool request_realtime_priority() {
    sched_param lowest{};
    lowest.sched_priority = sched_get_priority_min(SCHED_RR);
    return sched_setscheduler(0, SCHED_RR, &lowest) == 0;
}

bool may_have_realtime_priority() {
    bool may = false;
    std::thread([&] { may = request_realtime_priority(); }).join();  // a thread has its own, and this one ends
    return may;
}

}  // namespace planlight
