// Twenty short sessions, each in a room of its own and with another fault, are replayed to the last digit.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "app/recording/recording_head.h"
#include "app/recording/replay_session.h"
#include "app/recording/resume_offer.h"
#include "app/session_observers.h"
#include "planning_io/types/error.h"
#include "tests/app/recorded_kinds.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using test::PlayedSession;
using test::RecordedKind;

/// A disk that is full from the update after so many on.
class SmallDisk final : public RecordingSink {
public:
    SmallDisk(const fs::path& file, int updates) : file_(file), name_(file), updates_left_(updates) {}
    void append(std::string_view bytes) override {
        if (bytes.find(R"({"what":"updated")") != std::string_view::npos && updates_left_-- <= 0) full_ = true;
        if (full_) throw DiskError(name_, "no space left on device", "Make room.");
        file_.append(bytes);
    }
    void sync() override { file_.sync(); }

private:
    RecordingFile file_;
    const fs::path name_;
    int updates_left_;
    bool full_ = false;
};

/// Without the time of day, and without presses: they come from another thread, between any two others.
std::vector<std::string> events_of(const fs::path& recording) {
    std::vector<std::string> events;
    for (const RecordingChunk& chunk : test::chunks_of(recording)) {
        if (chunk.type != chunk_types::kEvent || chunk.payload.starts_with(R"({"what":"pressed")")) continue;
        events.push_back(chunk.payload);
        if (const std::size_t at = events.back().find(",\"utc\":\""); at != std::string::npos)
            events.back().erase(at, events.back().find('"', at + 8) + 1 - at);
    }
    return events;
}

class RecordedKinds : public ::testing::TestWithParam<RecordedKind> {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    static ReplayResult replay(const fs::path& file) { return replay_session(file, test::example_case().prepared); }
    void expect_alike() {
        const ReplayResult replayed = replay(file_);
        EXPECT_FALSE(replayed.difference) << "frame " << replayed.difference->frame << ", update "
                                          << replayed.difference->update << ": " << replayed.difference->what;
        EXPECT_EQ(replayed.ended, "");
        EXPECT_EQ(replayed.end, RecordingEnd::whole);
        EXPECT_FALSE(replayed.other_program);
        EXPECT_GE(replayed.compared(), 1);
        EXPECT_EQ(test::missing_of(test::chunks_of(file_), GetParam().must_hold), "");
    }
    const test::TemporaryFolder folder_;
    const fs::path file_ = folder_.path() / "session.plrec";
};

TEST_P(RecordedKinds, IsReplayedToTheLastDigit) {
    const PlayedSession& how = GetParam().how;
    const test::PlayedResult played = test::record_kind(GetParam(), test::example_case(), file_);
    expect_alike();
    EXPECT_GE(played.updates, how.updates / 2) << played.headline;
    if (!how.doubt.empty()) {
        EXPECT_GE(played.doubted, 5) << "what the cameras say of themselves reaches the person";
    }
    if (how.look == PlayedSession::Look::refused) {
        EXPECT_FALSE(last_match_of(file_).match) << "a match that nobody said yes to";
    }
}

std::vector<RecordedKind> kinds(bool long_ones) {
    std::vector<RecordedKind> those = test::recorded_kinds();
    std::erase_if(those, [&](const RecordedKind& kind) { return kind.is_long != long_ones; });
    return those;
}

std::string test_name_of(const ::testing::TestParamInfo<RecordedKind>& kind) {
    std::string name;
    for (const char letter : kind.param.name) name += std::isalnum(static_cast<unsigned char>(letter)) ? letter : '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Short, RecordedKinds, ::testing::ValuesIn(kinds(false)), test_name_of);
INSTANTIATE_TEST_SUITE_P(Long, RecordedKinds, ::testing::ValuesIn(kinds(true)), test_name_of);

TEST(RecordedKindsThere, AreTwentyOfOtherSeeds) {
    std::set<unsigned> seeds;
    for (const RecordedKind& kind : test::recorded_kinds()) seeds.insert(kind.how.seed);
    EXPECT_EQ(test::recorded_kinds().size(), 20u);
    EXPECT_EQ(seeds.size(), 20u);
}

class OneRecordedKind : public RecordedKinds {};

/// One session by which several recordings are made at once.
TEST_P(OneRecordedKind, IsToldAlikeByEventsWithoutNamesAndByAFullDisk) {
    constexpr int kUpdatesOnDisk = 5;
    const Case& the_case = test::example_case().prepared;
    const fs::path events = folder_.path() / "events.plrec", anonymous = folder_.path() / "anonymous.plrec",
                   full = folder_.path() / "full.plrec";
    {
        SessionRecorder some(std::make_unique<RecordingFile>(events),
                             recording_head(the_case, {}, RecordMode::events, {}));
        SessionRecorder nameless(std::make_unique<RecordingFile>(anonymous),
                                 without_names(recording_head(the_case, {}, RecordMode::events, {})), {}, {},
                                 NamesLeftOut(the_case));
        SessionRecorder cut(std::make_unique<SmallDisk>(full, kUpdatesOnDisk),
                            recording_head(the_case, {}, RecordMode::all, {}));
        SessionObservers beside;
        for (SessionRecorder* recorder : {&some, &nameless, &cut}) beside.add(recorder);
        test::record_kind(GetParam(), test::example_case(), file_, &beside);
        EXPECT_NE(cut.finish().find("no space left on device"), std::string::npos);
    }
    // What a recording of events tells is what was replayed, and it says why it cannot be replayed itself.
    const auto all = events_of(file_);
    EXPECT_EQ(events_of(events), all);
    EXPECT_EQ(events_of(anonymous).size(), all.size());
    EXPECT_THROW(replay(events), InputError);
    EXPECT_THROW(replay(anonymous), InputError);
    const ReplayResult replayed = replay(full);
    EXPECT_FALSE(replayed.difference) << replayed.difference->what;
    EXPECT_EQ(replayed.end, RecordingEnd::cut);
    EXPECT_NE(replayed.ended, "") << "that it ends before the session did is said";
    EXPECT_EQ(replayed.scans, 1);
    EXPECT_EQ(replayed.updates, kUpdatesOnDisk);
}

INSTANTIATE_TEST_SUITE_P(Beside, OneRecordedKind, ::testing::Values(test::recorded_kinds().front()),
                         [](const auto&) { return "AHeadThatMoves"; });

}  // namespace
}  // namespace planlight
