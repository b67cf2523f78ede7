// measure_igtl [ROUNDS] [UPDATES] [SEED]: how much longer the updates of a session take while other systems listen. One
// session in the simulated paper's room; in turn, so many updates each, nobody listens, one does, and eight, one of
// which never reads. An update's time is the product's own (track, draw, check) and that of all observers in its
// thread.
#include <fmt/format.h>

#include <time.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <thread>

#include "app/evaluation/distribution.h"
#include "app/igtl/session_link.h"
#include "tests/app/igtl/tcp_client.h"
#include "tests/app/played_session.h"

namespace {

using namespace planlight;
using std::chrono::steady_clock;

constexpr std::array<int, 3> kListeners{0, 1, 8};

/// Of processor, by this thread.
double thread_cpu_ms() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// Systems that listen, all read by one thread, but for one of many that never reads; who was closed comes again.
class Listeners {
public:
    Listeners(int port, int count) : deaf_(count > 1) {
        for (int i = 0; i < count; ++i) clients_.push_back(std::make_unique<test::TcpClient>(port));
        thread_ = std::thread([this, port] {
            while (!ending_) {
                for (std::size_t i = deaf_ ? 1 : 0; i < clients_.size(); ++i) {
                    while (!clients_[i]->read_now().empty()) {
                    }
                    if (clients_[i]->gone()) clients_[i] = std::make_unique<test::TcpClient>(port);
                }
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            }
        });
    }
    ~Listeners() {
        ending_ = true;
        thread_.join();
    }

private:
    bool deaf_;
    std::vector<std::unique_ptr<test::TcpClient>> clients_;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

/// Passes all to the link, and times it.
class Timed final : public SessionObserver {
public:
    Timed(SessionLink& link, int updates_each) : link_(link), each_(updates_each) {}
    std::array<std::vector<double>, 3> ms, told_cpu_ms;

    void room_entered(const RoomFacts& room) noexcept override { link_.room_entered(room); }
    void asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept override {
        timed([&] { link_.asked(call, landmarks, which); });
    }
    void clock_read(Instant now) noexcept override {
        timed([&] { link_.clock_read(now); });
    }
    void matched(const Session& session) noexcept override { link_.matched(session); }
    void refused(SessionCall call, const std::exception& why) noexcept override { link_.refused(call, why); }
    void updated(const Session& session, const Session::Update& update) noexcept override {
        timed([&] { link_.updated(session, update); });
        own_ms_ = 1e3 * update.times.total_s();
        lit_ = update.overlay.lit;
    }
    /// The end of an update.
    void gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept override {
        timed([&] { link_.gate(call, at, off_mm, ruling); });
        if (call != GateCall::step) return;
        const std::size_t phase = static_cast<std::size_t>(count_ / each_) % kListeners.size();
        if (lit_ && count_ % each_ >= kSettle) {
            ms[phase].push_back(own_ms_ + told_);
            told_cpu_ms[phase].push_back(told_cpu_);
        }
        told_ = told_cpu_ = 0;
        if (++count_ % each_ == 0) {
            listeners_.reset();
            const int next = kListeners[static_cast<std::size_t>(count_ / each_) % kListeners.size()];
            if (next > 0) listeners_ = std::make_unique<Listeners>(link_.port(), next);
        }
    }

private:
    static constexpr int kSettle = 5;  ///< updates after the listeners changed, not counted
    template <class Tell>
    void timed(const Tell& tell) {
        const auto began = steady_clock::now();
        const double cpu_ms = thread_cpu_ms();
        tell();
        told_cpu_ += thread_cpu_ms() - cpu_ms;
        told_ += std::chrono::duration<double, std::milli>(steady_clock::now() - began).count();
    }
    SessionLink& link_;
    const int each_;
    int count_ = 0;
    double own_ms_ = 0, told_ = 0, told_cpu_ = 0;
    bool lit_ = false;
    std::unique_ptr<Listeners> listeners_;
};

double share(std::vector<double> values, double part) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::atoi(argv[1]) : 10, each = argc > 2 ? std::atoi(argv[2]) : 50;
    if (!test::example_case().there) return 77;
    SessionLinkSettings settings;
    settings.server.port = 0;
    SessionLink link(test::example_case().prepared, settings);
    Timed timed(link, each);
    test::PlayedSession how;
    how.seed = argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1;
    how.updates = 3 * rounds * each;
    const test::PlayedResult played = test::play_session(how, test::example_case(), &timed);
    fmt::print("seed {}: {} updates, banner \"{}\"; clients taken {}, dropped {}, turned away {}\n", how.seed,
               played.updates, played.headline, link.counts().taken, link.counts().dropped, link.counts().turned_away);
    for (std::size_t i = 0; i < kListeners.size(); ++i)
        fmt::print(
            "{} listen{}: {} updates, p50 {:.2f} ms, p99 {:.2f} ms; telling them costs the session {:.3f} ms (p50), "
            "{:.3f} ms (p99) of processor; against "
            "nobody: p50 {:+.1f} %, p99 {:+.1f} %\n",
            kListeners[i], kListeners[i] > 1 ? ", one never reads" : "", timed.ms[i].size(), share(timed.ms[i], 0.5),
            share(timed.ms[i], 0.99), share(timed.told_cpu_ms[i], 0.5), share(timed.told_cpu_ms[i], 0.99),
            100 * (share(timed.ms[i], 0.5) / share(timed.ms[0], 0.5) - 1),
            100 * (share(timed.ms[i], 0.99) / share(timed.ms[0], 0.99) - 1));
    return 0;
}
