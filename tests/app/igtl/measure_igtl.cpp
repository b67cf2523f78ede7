// measure_igtl [REPLAYS] [EACH] [SEED]: how much longer the updates of a session take while other systems listen. One
// session of the simulated paper's room is recorded with every frame and then replayed, REPLAYS times, as fast as it
// can be computed, with the link on. In turn, EACH updates long and in an order drawn anew each time, nobody listens,
// nobody once more (so that the noise of the machine is seen), one, eight, a slow one, a dead one and hostile ones. An
// update's time is the product's own (track, draw, check) and that of telling the link, in the session's thread.
#include <fmt/format.h>

#include <time.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "app/igtl/session_link.h"
#include "app/recording/recording_head.h"
#include "app/recording/replay_session.h"
#include "planning_io/plan/plan_file.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/app/igtl/other_systems.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using std::chrono::steady_clock;
using test::Listening;

/// Nobody twice, and then each of them.
constexpr std::array kPhases{Listening::nobody, Listening::nobody, Listening::one,    Listening::eight,
                             Listening::slow,   Listening::dead,   Listening::hostile};

double thread_cpu_ms() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// Of one phase in one turn of all: an update's time, and what telling took of processor, ms.
struct Block {
    std::vector<double> ms, told_cpu_ms;
};
using Turn = std::array<Block, kPhases.size()>;

/// Passes all to the link, and times it.
class Timed final : public SessionObserver {
public:
    Timed(SessionLink& link, const test::OtherSystems& others, int each, unsigned seed)
        : link_(link), others_(others), each_(each), random_(seed) {
        begin_turn();
    }
    /// Turns that came to their end.
    std::vector<Turn> turns;

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
        const LightGate::Ruling ruling = gate_.step(update.frame.at, update.overlay.lit, update.light, update.causes);
        timed([&] { link_.gate(GateCall::step, update.frame.at, 0, &ruling); });
        end_of_update(1e3 * update.times.total_s(), update.overlay.lit);
    }

private:
    static constexpr int kSettle = 5;  ///< updates after the listeners changed, not counted
    void end_of_update(double own_ms, bool lit) {
        Block& block = turn_[order_[phase_]];
        if (lit && ++count_ > kSettle) {
            block.ms.push_back(own_ms + told_ms_);
            block.told_cpu_ms.push_back(told_cpu_ms_);
        }
        told_ms_ = told_cpu_ms_ = 0;
        if (count_ < each_ + kSettle) return;
        count_ = 0;
        if (++phase_ == kPhases.size()) {
            turns.push_back(std::move(turn_));
            begin_turn();
        }
        others_.listen(kPhases[order_[phase_]], link_.port());
    }

    void begin_turn() {
        turn_ = {};
        phase_ = 0;
        for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
        std::shuffle(order_.begin(), order_.end(), random_);
    }
    template <class Tell>
    void timed(const Tell& tell) {
        const auto began = steady_clock::now();
        const double cpu_ms = thread_cpu_ms();
        tell();
        told_cpu_ms_ += thread_cpu_ms() - cpu_ms;
        told_ms_ += std::chrono::duration<double, std::milli>(steady_clock::now() - began).count();
    }
    SessionLink& link_;
    const test::OtherSystems& others_;
    const int each_;
    std::mt19937 random_;
    Turn turn_;
    std::array<std::size_t, kPhases.size()> order_{};
    std::size_t phase_ = 0;
    int count_ = 0;
    double told_ms_ = 0, told_cpu_ms_ = 0;
    LightGate gate_;  // the recorded session has none: nobody stops its light
};

double percentile(std::vector<double> values, double part) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Of all turns, or of those that are named, with repetitions.
std::vector<double> pooled(const std::vector<Turn>& turns, const std::vector<std::size_t>& which, std::size_t phase,
                           std::vector<double> Block::*figure) {
    std::vector<double> all;
    for (const std::size_t turn : which) {
        const auto& some = turns[turn][phase].*figure;
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

/// What is between 2.5 and 97.5 % of such shares when turns are drawn anew (bootstrap over turns), in percent.
std::pair<double, double> spread_percent(const std::vector<Turn>& turns, std::size_t phase, double part) {
    constexpr int kDraws = 1000;
    std::mt19937 random(1);
    std::uniform_int_distribution<std::size_t> one(0, turns.size() - 1);
    std::vector<double> shares;
    for (int i = 0; i < kDraws; ++i) {
        std::vector<std::size_t> which(turns.size());
        for (auto& turn : which) turn = one(random);
        shares.push_back(100 * (percentile(pooled(turns, which, phase, &Block::ms), part) /
                                    percentile(pooled(turns, which, 0, &Block::ms), part) -
                                1));
    }
    return {percentile(shares, 0.025), percentile(shares, 0.975)};
}

void print_table(const std::vector<Turn>& turns) {
    std::vector<std::size_t> all(turns.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    const double p50_of_none = percentile(pooled(turns, all, 0, &Block::ms), 0.5);
    fmt::print(
        "| who listens | updates | p50 ms | p95 ms | p99 ms | p50 against nobody | p99 against nobody (95 %) | telling "
        "p50, p99 ms of processor |\n|---|---|---|---|---|---|---|---|\n");
    for (std::size_t i = 0; i < kPhases.size(); ++i) {
        const auto ms = pooled(turns, all, i, &Block::ms), told = pooled(turns, all, i, &Block::told_cpu_ms);
        const double p99 = percentile(ms, 0.99), none = percentile(pooled(turns, all, 0, &Block::ms), 0.99);
        const auto [low, high] = spread_percent(turns, i, 0.99);
        fmt::print(
            "| {}{} | {} | {:.2f} | {:.2f} | {:.2f} | {:+.1f} % | {:+.1f} % ({:+.1f} to {:+.1f}) | {:.3f}, {:.3f} |\n",
            words_of(kPhases[i]), i == 1 ? ", once more" : "", ms.size(), percentile(ms, 0.5), percentile(ms, 0.95),
            p99, 100 * (percentile(ms, 0.5) / p50_of_none - 1), 100 * (p99 / none - 1), low, high,
            percentile(told, 0.5), percentile(told, 0.99));
        std::fflush(stdout);
    }
}

/// A session without a window and without a gate, so that it waits for nothing.
void record(const std::filesystem::path& file, unsigned seed) {
    constexpr int kUpdates = 80;
    const Case& the_case = test::example_case().prepared;
    simulation::RoomSettings papers;
    papers.preset = simulation::Preset::paper;
    papers.seed = seed;
    simulation::SimulatedRig room(test::example_case().volume, points_of(the_case.plan), papers);
    SessionRecorder recorder(std::make_unique<RecordingFile>(file),
                             recording_head(the_case, file.parent_path(), RecordMode::all, {}));
    recorder.room_entered({"A room", RoomKind::simulated, {}, room.calibration(), {}, room.clock().now()});
    const CaseDrawing drawing(the_case);
    SessionSettings settings;
    settings.observer = &recorder;
    Session session(the_case, drawing, room.calibration(), room.projector(), room.cameras(), room.clock(), settings);
    session.scan();
    session.find_patient();
    session.confirm();
    for (int i = 0; i < kUpdates; ++i) session.update();
}

}  // namespace

int main(int argc, char** argv) {
    const int replays = argc > 1 ? std::atoi(argv[1]) : 20, each = argc > 2 ? std::atoi(argv[2]) : 60;
    const unsigned seed = argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1;
    const test::OtherSystems others;
    if (!test::example_case().there) return 77;
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "session.plrec";
    record(file, seed);
    SessionLinkSettings settings;
    settings.server.port = 0;
    settings.server.patience = std::chrono::milliseconds(500);  // so that who takes nothing is closed in each block
    SessionLink link(test::example_case().prepared, settings);
    Timed timed(link, others, each, seed);
    for (int i = 0; i < replays; ++i) {
        const ReplayResult result = replay_session(file, test::example_case().prepared, {}, &timed);
        fmt::print(stderr, "replay {} of {}: {} updates, {} turns{}\n", i + 1, replays, result.updates,
                   timed.turns.size(), result.difference ? ": " + result.difference->what : "");
    }
    const MessageServerCounts counts = link.counts();
    fmt::print("seed {}: clients taken {}, closed by us {}, gone {}, turned away {}; {} turns of {} updates each\n\n",
               seed, counts.taken, counts.dropped, counts.closed_by_them, counts.turned_away, timed.turns.size(), each);
    if (timed.turns.empty()) return 1;
    print_table(timed.turns);
    return 0;
}
