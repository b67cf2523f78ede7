// measure_recording [SESSIONS] [UPDATES] [FIRST_SEED]: sessions in the simulated paper's room, without a fault and with
// each in turn, are recorded (--record all) and replayed; says how many are alike to the last digit, how many bytes a
// second the parts of a recording take, and how long the session was kept by its recorder. Exit code 0 when all are
// alike to their end.
#include <fmt/format.h>

#include <cstdlib>
#include <map>

#include "app/evaluation/distribution.h"
#include "app/live/simulated_fault.h"
#include "app/recording/replay_session.h"
#include "planning_io/types/error.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;

struct Sizes {
    std::map<std::string, std::pair<int, double>> by_type;  ///< chunks, bytes
    double followed_s = 0;                                  ///< of the room's clock
    void add(const std::filesystem::path& file) {
        RecordingReader reader(file);
        std::optional<Instant> first, last;
        while (const auto chunk = reader.next()) {
            auto& [count, bytes] = by_type[std::string(chunk->type.begin(), chunk->type.end())];
            ++count;
            bytes += static_cast<double>(chunk->payload.size() + kChunkHeaderBytes);
            if (!chunk->payload.starts_with(R"({"what":"updated")")) continue;
            if (!first) first = chunk->at;
            last = chunk->at;
        }
        if (first) followed_s += seconds(*last - *first);
    }
};

}  // namespace

int main(int argc, char** argv) {
    const int sessions = argc > 1 ? std::atoi(argv[1]) : 20, updates = argc > 2 ? std::atoi(argv[2]) : 60;
    const unsigned first_seed = argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1;
    if (!test::example_case().there) return 77;
    std::vector<std::string> faults{""};
    for (const std::string& fault : simulated_faults()) faults.push_back(fault);
    int alike = 0, whole = 0, compared_updates = 0, compared_scans = 0, compared_pictures = 0;
    Sizes sizes;
    std::vector<double> told_ms;
    for (int i = 0; i < sessions; ++i) {
        const test::TemporaryFolder folder;
        test::PlayedSession how;
        how.seed = first_seed + static_cast<unsigned>(i);
        how.fault = faults[static_cast<std::size_t>(i) % faults.size()];
        how.updates = updates;
        how.check_skin = i % 3 == 1;
        how.dark_in_scan = i % 5 == 4;
        const auto file = folder.path() / "session.plrec";
        const test::PlayedResult played = test::record_session(how, test::example_case(), RecordMode::all, file);
        told_ms.insert(told_ms.end(), played.told_ms.begin(), played.told_ms.end());
        sizes.add(file);
        const ReplayResult replayed = replay_session(file, test::example_case().prepared);
        alike += !replayed.difference;
        whole += !replayed.difference && replayed.ended.empty() && replayed.end == RecordingEnd::whole;
        compared_updates += replayed.updates;
        compared_scans += replayed.scans;
        compared_pictures += replayed.pictures;
        fmt::print("seed {}{}{}{}: {} updates, {} scans, {}; banner \"{}\"\n", how.seed,
                   how.fault.empty() ? "" : ", fault " + how.fault, how.check_skin ? ", skin checked" : "",
                   how.dark_in_scan ? ", DARK in the scan" : "", replayed.updates, replayed.scans,
                   replayed.difference      ? "DIFFERS: " + replayed.difference->what
                   : replayed.ended.empty() ? "alike"
                                            : "alike, ended: " + replayed.ended,
                   played.headline);
        std::fflush(stdout);
    }
    fmt::print("{} of {} alike to the last digit, {} of them to their end: {} updates, {} scans, {} pictures.\n", alike,
               sessions, whole, compared_updates, compared_scans, compared_pictures);
    for (const auto& [type, size] : sizes.by_type)
        fmt::print("  {}: {} chunks, {:.1f} kB each, {:.1f} kB a second of following\n", type, size.first,
                   size.second / size.first / 1e3, size.second / sizes.followed_s / 1e3);
    const Distribution told = distribution_of(told_ms);
    fmt::print(
        "The recorder kept the session's thread for {:.2f} ms an update (median), {:.2f} ms (95 %), {:.2f} ms "
        "(worst) of {}.\n",
        told.median, told.p95, told.worst, told.count);
    return whole == sessions ? 0 : 1;
}
