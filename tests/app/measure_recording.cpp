// measure_recording [SESSIONS] [OTHER_SEEDS]: sessions in simulated rooms, of the twenty kinds of `recorded_kinds` in
// turn (with OTHER_SEEDS added to the seed of each; 100 more for each time round), are recorded (--record all) and
// replayed, and replayed once more with the last bit of one number of the recording changed. A table says of each what
// was compared, whether it was alike to the last digit, and where the changed one was found; then how many bytes a
// second the parts of a recording take in the paper's room, and how long the session was kept by its recorder. Exit
// code 0 when all are alike to their end and every changed one is named where it was changed.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <map>

#include "app/evaluation/distribution.h"
#include "app/recording/replay_session.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"
#include "tests/app/recorded_kinds.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using std::chrono::steady_clock;

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

struct Sums {
    int sessions = 0, alike = 0, whole = 0, found = 0, lacking = 0, updates = 0, scans = 0, pictures = 0, compared = 0;
};

/// One number of the recording is another by its last bit: where the replay finds it, in words.
std::string found_when_changed(const std::filesystem::path& recording, Sums& sums) {
    auto chunks = test::chunks_of(recording);
    const auto changed = test::tamper(chunks);
    if (!changed) return "NOTHING TO CHANGE";
    const auto file = std::filesystem::path(recording).replace_extension(".changed.plrec");
    test::write_recording(chunks, file);
    const ReplayResult replayed = replay_session(file, test::example_case().prepared);
    std::filesystem::remove(file);
    if (!replayed.difference) return "NOT FOUND";
    const ReplayDifference& difference = *replayed.difference;
    const std::string where = changed->frame ? fmt::format("frame {}, update {}", difference.frame, difference.update)
                                             : fmt::format("{}", difference.what.substr(0, difference.what.find(':')));
    const bool right =
        difference.what.find(changed->what) != std::string::npos &&
        (!changed->frame || (difference.frame == *changed->frame && difference.update == changed->update));
    sums.found += right;
    return right ? where : "ELSEWHERE: " + where + ", " + difference.what;
}

void record_and_replay(const test::RecordedKind& kind, Sums& sums, Sizes& sizes, std::vector<double>& told_ms) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "session.plrec";
    const auto began = steady_clock::now();
    const test::PlayedResult played = test::record_kind(kind, test::example_case(), file);
    const bool papers = kind.how.preset == simulation::Preset::paper;
    if (papers) {
        told_ms.insert(told_ms.end(), played.told_ms.begin(), played.told_ms.end());
        sizes.add(file);
    }
    const auto recorded = steady_clock::now();
    const ReplayResult replayed = replay_session(file, test::example_case().prepared);
    const auto done = steady_clock::now();
    const std::string missing = test::missing_of(test::chunks_of(file), kind.must_hold);
    ++sums.sessions;
    sums.lacking += !missing.empty();
    sums.alike += !replayed.difference;
    sums.whole += !replayed.difference && replayed.ended.empty() && replayed.end == RecordingEnd::whole;
    sums.updates += replayed.updates, sums.scans += replayed.scans + replayed.resumptions;
    sums.pictures += replayed.pictures, sums.compared += replayed.compared();
    const std::string result = replayed.difference      ? "DIFFERS: " + replayed.difference->what
                               : replayed.ended.empty() ? "alike"
                                                        : "alike, ended: " + replayed.ended;
    using Seconds = std::chrono::duration<double>;
    fmt::print("| {}{} | {} {} | {} | {} | {} | {} | {} | {:.1f} / {:.1f} |\n", kind.name,
               missing.empty() ? "" : " (THE RECORDING LACKS " + missing + ")", papers ? "paper" : "modern",
               kind.how.seed, replayed.frames, replayed.pictures, replayed.compared(), result,
               found_when_changed(file, sums), Seconds(recorded - began).count(), Seconds(done - recorded).count());
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const auto& kinds = test::recorded_kinds();
    const auto sessions = argc > 1 ? static_cast<std::size_t>(std::atoi(argv[1])) : kinds.size();
    const unsigned other_seeds = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 0;
    if (!test::example_case().there) return 77;
    Sums sums;
    Sizes sizes;
    std::vector<double> told_ms;
    fmt::print(
        "| what happens | room, seed | frames | pictures | compared | replayed | one bit changed: found at | played / "
        "replayed, s |\n|---|---|---|---|---|---|---|---|\n");
    for (std::size_t i = 0; i < sessions; ++i) {
        test::RecordedKind kind = kinds[i % kinds.size()];
        kind.how.seed += other_seeds + 100 * static_cast<unsigned>(i / kinds.size());
        record_and_replay(kind, sums, sizes, told_ms);
    }
    fmt::print(
        "{} of {} alike to the last digit, {} of them to their end; {} of {} found where one bit was changed. "
        "Compared: "
        "{} words in all, {} updates, {} scans, {} pictures.\n",
        sums.alike, sums.sessions, sums.whole, sums.found, sums.sessions, sums.compared, sums.updates, sums.scans,
        sums.pictures);
    for (const auto& [type, size] : sizes.by_type)
        fmt::print("  {}: {} chunks, {:.1f} kB each, {:.1f} kB a second of following\n", type, size.first,
                   size.second / size.first / 1e3, size.second / sizes.followed_s / 1e3);
    const Distribution told = distribution_of(told_ms);
    fmt::print(
        "The recorder kept the session's thread for {:.2f} ms an update (median), {:.2f} ms (95 %), {:.2f} ms "
        "(worst) of {}.\n",
        told.median, told.p95, told.worst, told.count);
    return sums.whole == sums.sessions && sums.found == sums.sessions && sums.lacking == 0 ? 0 : 1;
}
