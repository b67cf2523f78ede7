// Which match of a recording is handed to other systems.
#include "app/export/match_that_stood.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "planning_io/recording/recording_chunk.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// A recording by hand: matches, and what became of them.
class Matches : public ::testing::Test {
protected:
    void event(const nlohmann::ordered_json& json) { chunks_.push_back({chunk_types::kEvent, {}, json.dump()}); }
    void scan() { event({{"what", "asked"}, {"call", "scan"}}); }
    void offered(const std::string& made, Verdict verdict = Verdict::yes, bool confirmed = false) {
        KeptMatch match;
        match.registration.verdict = verdict;
        match.confirmed = confirmed;
        match.registration.patient_from_ct = RigidTransform::Identity();
        match.made_utc = made;
        chunks_.push_back({chunk_types::kMatch, {}, text_of(match)});
    }
    void found(const char* verdict, const std::string& made = {}) {
        event({{"what", "asked"}, {"call", "find_patient"}});
        event({{"what", "matched"}, {"verdict", verdict}});
        if (!made.empty()) offered(made);
    }
    void resume(const char* what) {
        event({{"what", "asked"}, {"call", "resume"}});
        event({{"what", what}, {"call", "resume"}, {"why", "the skin lies 3 mm off"}});
    }
    /// The moment at which the one that stood was made, or why none did.
    std::string stood() {
        const fs::path file = folder_.path() / "made.plrec";
        std::ofstream out(file, std::ios::binary);
        out << recording_header();
        for (std::size_t i = 0; i < chunks_.size(); ++i) out << chunk_bytes(chunks_[i], i);
        out.close();
        try {
            const MatchThatStood found = match_that_stood(file);
            return found.match.made_utc + (found.scanned_later ? ", scanned later" : "");
        } catch (const InputError& refusal) {
            return refusal.what();
        }
    }
    bool refused(const std::string& why) {
        const std::string said = stood();
        return said.find("no match that stood") != std::string::npos && said.find(why) != std::string::npos;
    }
    test::TemporaryFolder folder_;
    std::vector<RecordingChunk> chunks_;
};

TEST_F(Matches, WhatWasNeverUsedIsNotExported) {
    EXPECT_TRUE(refused("nobody was found"));
    offered("earlier");
    resume("refused");
    EXPECT_TRUE(refused("the skin lies 3 mm off")) << stood();
    scan();
    found("ask", "doubtful");
    EXPECT_TRUE(refused("nobody confirmed it")) << stood();
    event({{"what", "asked"}, {"call", "confirm"}});
    EXPECT_EQ(stood(), "doubtful");
    found("no");
    EXPECT_TRUE(refused("the match was refused")) << "landmarks spoke against it: " << stood();
}

TEST_F(Matches, TheLastOneThatStoodIsExported) {
    scan();
    found("yes", "first");
    EXPECT_EQ(stood(), "first");
    scan();
    EXPECT_EQ(stood(), "first, scanned later");
    found("ask", "second");
    EXPECT_EQ(stood(), "first, scanned later") << "an unconfirmed one takes nothing's place";
    offered("earlier");
    resume("refused");
    EXPECT_EQ(stood(), "first, scanned later");
    offered("earlier");
    resume("resumed");
    EXPECT_EQ(stood(), "earlier");
}

/// Markers and skin agree with a wrong match as well as with a right one, where both were laid by it.
TEST_F(Matches, ADoubtfulOneOfAnEarlierSessionStandsOnAPersonsWordOnly) {
    offered("earlier", Verdict::ask);
    resume("resumed");
    EXPECT_TRUE(refused("nobody confirmed it")) << stood();
    event({{"what", "asked"}, {"call", "confirm"}});
    EXPECT_EQ(stood(), "earlier");
    offered("confirmed then", Verdict::ask, true);
    resume("resumed");
    EXPECT_EQ(stood(), "confirmed then");
}

/// What cannot be read may have said that another match stood.
TEST_F(Matches, ADamagedRecordingIsNotExported) {
    scan();
    found("yes", "first");
    scan();
    found("yes", "second");
    EXPECT_EQ(stood(), "second");
    const fs::path file = folder_.path() / "made.plrec";
    std::string bytes = (std::ostringstream() << std::ifstream(file, std::ios::binary).rdbuf()).str();
    bytes[bytes.rfind("find_patient")] = 'F';
    const fs::path damaged = folder_.path() / "damaged.plrec";
    std::ofstream(damaged, std::ios::binary) << bytes;
    EXPECT_THROW(match_that_stood(damaged), DamagedFileError);
    event({{"what", 5}});
    EXPECT_THROW(stood(), DamagedFileError) << "an event of another kind";
}

}  // namespace
}  // namespace planlight
