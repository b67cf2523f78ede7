#include "planning_io/files/held_end_signals.h"

#include <array>
#include <csignal>
#include <mutex>

namespace planlight {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

std::mutex mutex;
int holders = 0;
std::array<bool, kSignals.size()> held{};  ///< of `kSignals`: their default action waits
volatile std::sig_atomic_t waiting = 0;    ///< the signal that does; 0: none

void let_through(int signal) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

void hold(int signal) {
    if (waiting == SIGINT && signal == SIGINT) let_through(signal);
    waiting = signal;
}

}  // namespace

HeldEndSignals::HeldEndSignals() {
    const std::lock_guard lock(mutex);
    if (holders++ > 0) return;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        struct sigaction ours {
        }, before{};
        ours.sa_handler = hold;
        ours.sa_flags = SA_RESTART;
        held[i] = ::sigaction(kSignals[i], &ours, &before) == 0 && before.sa_handler == SIG_DFL;
        if (!held[i]) ::sigaction(kSignals[i], &before, nullptr);
    }
}

HeldEndSignals::~HeldEndSignals() {
    const std::lock_guard lock(mutex);
    if (--holders > 0) return;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        struct sigaction now {};
        // Whoever has begun to handle the signal meanwhile goes on with that.
        if (held[i] && ::sigaction(kSignals[i], nullptr, &now) == 0 && now.sa_handler == hold)
            std::signal(kSignals[i], SIG_DFL);
    }
    if (const int signal = waiting; signal != 0) {
        waiting = 0;
        std::raise(signal);
    }
}

bool HeldEndSignals::one_waits() {
    return waiting != 0;
}

}  // namespace planlight
