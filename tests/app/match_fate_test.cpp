// What became of a match is told alike by all that ask: a session that would go on with it, what is exported, what is
// reported.
#include "app/recording/match_fate.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "app/export/match_that_stood.h"
#include "app/recording/recording_head.h"
#include "app/recording/resume_offer.h"
#include "app/report/operation_report.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A recording by hand. A match is known by the moment at which it was made, and by the error that was predicted of it.
class FateOfAMatch : public ::testing::Test {
protected:
    FateOfAMatch() {
        chunks_.push_back({chunk_types::kHead, {}, text_of(RecordingHead{})});
        chunks_.push_back({chunk_types::kRoom, {}, R"({"rig":{}})"});
    }
    void event(const Json& json) { chunks_.push_back({chunk_types::kEvent, {}, json.dump()}); }
    void ask(const char* call) { event({{"what", "asked"}, {"call", call}}); }
    void gate(const Json& more) {
        Json json{{"what", "gate"}};
        json.update(more);
        event(json);
    }
    void keep(const std::string& made, Verdict verdict, bool confirmed = false) {
        KeptMatch match;
        match.registration.verdict = verdict;
        match.registration.patient_from_ct = RigidTransform::Identity();
        match.confirmed = confirmed;
        match.made_utc = made;
        chunks_.push_back({chunk_types::kMatch, {}, text_of(match)});
    }
    void find(Verdict verdict, const std::string& made, double predicted_mm) {
        constexpr const char* kVerdicts[] = {"yes", "ask", "no"};
        ask("find_patient");
        event({{"what", "matched"},
               {"verdict", kVerdicts[static_cast<std::size_t>(verdict)]},
               {"reasons", Json::array()},
               {"residual_rms_mm", 0.2},
               {"points", 9000},
               {"items", {"B1"}},
               {"predicted_mm", {predicted_mm}}});
        if (verdict != Verdict::no) keep(made, verdict);
    }
    void resume(bool fits, double predicted_mm) {
        ask("resume");
        if (fits)
            event({{"what", "resumed"},
                   {"verdict", "yes"},
                   {"markers", 5},
                   {"skin_off_mm", 0.2},
                   {"items", {"B1"}},
                   {"predicted_mm", {predicted_mm}}});
        else
            event({{"what", "refused"}, {"call", "resume"}, {"why", "the skin lies 3 mm off"}});
    }

    /// What each of those who ask makes of it; "-": none.
    struct Told {
        MatchFate fate;
        std::string resumed, exported;
        double reported_mm;  ///< predicted; -1: none
        bool operator==(const Told&) const = default;
        friend std::ostream& operator<<(std::ostream& out, const Told& told) {
            return out << "fate " << static_cast<int>(told.fate) << ", resumed " << told.resumed << ", exported "
                       << told.exported << ", reported " << told.reported_mm;
        }
    };
    Told told() {
        const fs::path file = folder_.path() / "made.plrec";
        std::ofstream out(file, std::ios::binary);
        out << recording_header();
        FateOfMatches matches(file);
        for (std::size_t i = 0; i < chunks_.size(); ++i) {
            out << chunk_bytes(chunks_[i], i);
            matches.take(chunks_[i]);
        }
        out.close();
        Told told{matches.fate(), "-", "-", -1};
        const LastMatch last = last_match_of(file);
        EXPECT_NE(last.match.has_value(), !last.why_none.empty()) << "one or the other";
        if (last.match) told.resumed = last.match->made_utc;
        try {
            told.exported = match_that_stood(file).match.made_utc;
        } catch (const InputError&) {
        }
        const OperationFacts facts = facts_of_operation(file);
        if (!facts.items.empty()) told.reported_mm = facts.items[0].predicted_mm.value_or(-1);
        return told;
    }
    test::TemporaryFolder folder_;
    std::vector<RecordingChunk> chunks_;
};

TEST_F(FateOfAMatch, NobodyWasFound) {
    EXPECT_EQ(told(), (Told{MatchFate::none, "-", "-", -1}));
    ask("scan");
    EXPECT_EQ(told(), (Told{MatchFate::superseded, "-", "-", -1}));
}

TEST_F(FateOfAMatch, FoundForSureItStands) {
    ask("scan");
    find(Verdict::yes, "first", 0.3);
    EXPECT_EQ(told(), (Told{MatchFate::stands, "first", "first", 0.3}));
    ask("confirm");  // of nothing that needs it
    EXPECT_EQ(told(), (Told{MatchFate::stands, "first", "first", 0.3}));
}

TEST_F(FateOfAMatch, ADoubtfulOneStandsOnAPersonsWordOnly) {
    ask("scan");
    find(Verdict::ask, "doubtful", 0.8);
    EXPECT_EQ(told(), (Told{MatchFate::unconfirmed, "-", "-", -1}));
    ask("confirm");
    EXPECT_EQ(told(), (Told{MatchFate::stands, "doubtful", "doubtful", 0.8}));
}

TEST_F(FateOfAMatch, OneThatLandmarksSpeakAgainstIsUsedNoMore) {
    ask("scan");
    find(Verdict::yes, "first", 0.3);
    ask("find_patient");
    EXPECT_EQ(told(), (Told{MatchFate::looked_anew, "-", "first", 0.3})) << "cut while it was looked for anew";
    find(Verdict::no, {}, 5);
    EXPECT_EQ(told(), (Told{MatchFate::refused, "-", "-", 0.3})) << "light was drawn by it, as the report says";
}

TEST_F(FateOfAMatch, OneThatANewScanCameAfterIsExportedAndNotGoneOnWith) {
    ask("scan");
    find(Verdict::yes, "first", 0.3);
    ask("scan");
    EXPECT_EQ(told(), (Told{MatchFate::superseded, "-", "first", 0.3}));
    find(Verdict::ask, "second", 0.9);
    EXPECT_EQ(told(), (Told{MatchFate::unconfirmed, "-", "first", 0.3})) << "a doubtful one takes nothing's place";
    ask("confirm");
    EXPECT_EQ(told(), (Told{MatchFate::stands, "second", "second", 0.9}));
}

TEST_F(FateOfAMatch, OneOfAnEarlierSessionThatDidNotFitMayBeTriedAgainAndIsNotExported) {
    keep("earlier", Verdict::yes);
    EXPECT_EQ(told(), (Told{MatchFate::offered, "earlier", "-", -1}));
    resume(false, 0);
    EXPECT_EQ(told(), (Told{MatchFate::not_resumed, "earlier", "-", -1}));
    resume(true, 0.4);
    EXPECT_EQ(told(), (Told{MatchFate::stands, "earlier", "earlier", 0.4}));
}

TEST_F(FateOfAMatch, ADoubtfulOneOfAnEarlierSessionIsNotReportedEither) {
    keep("earlier", Verdict::ask);
    resume(false, 0);
    EXPECT_EQ(told(), (Told{MatchFate::unconfirmed, "-", "-", -1})) << "that it did not fit makes it no surer";
    resume(true, 0.4);
    EXPECT_EQ(told(), (Told{MatchFate::unconfirmed, "-", "-", -1}));
    ask("confirm");
    EXPECT_EQ(told(), (Told{MatchFate::stands, "earlier", "earlier", 0.4}));
}

// A session that is killed right after the check of the skin must not be gone on with as if nothing had been found.
TEST_F(FateOfAMatch, WhoseLightWasStoppedIsNotGoneOnWithUntilThatIsMended) {
    ask("scan");
    find(Verdict::yes, "first", 0.3);
    const Told stands{MatchFate::stands, "first", "first", 0.3}, stopped{MatchFate::stands, "-", "first", 0.3};
    gate({{"call", "skin_checked"}, {"off_mm", 1.5}});
    EXPECT_EQ(told(), stands) << "amber, not stopped";
    gate({{"call", "step"}, {"trust", "dark"}, {"headline", "x"}, {"stop", true}});
    EXPECT_EQ(told(), stopped);
    gate({{"call", "restart"}});
    EXPECT_EQ(told(), stands) << "light that lay beside the plan may be asked for again";
    gate({{"call", "skin_checked"}, {"off_mm", 3.0}});
    EXPECT_EQ(told(), stopped);
    gate({{"call", "restart"}});
    EXPECT_EQ(told(), stopped) << "Track does not mend it";
    keep("first", Verdict::yes);  // its own, offered after the projector was away
    EXPECT_EQ(told().resumed, "-");
    gate({{"call", "new_match"}});
    ask("scan");
    find(Verdict::yes, "second", 0.2);
    EXPECT_EQ(told(), (Told{MatchFate::stands, "second", "second", 0.2}));
}

TEST_F(FateOfAMatch, OfAnAnonymousRecordingIsReportedThoughItWasNotKept) {
    ask("scan");
    find(Verdict::yes, "first", 0.3);
    chunks_.pop_back();
    EXPECT_EQ(told(), (Told{MatchFate::stands, "-", "-", 0.3}));
}

// A full disk refuses the large piece first, and a session may be killed between the two.
TEST_F(FateOfAMatch, WhoseOwnPieceIsLostIsNotExportedAsTheOneBefore) {
    ask("scan");
    find(Verdict::yes, "first", 0.3);
    ask("scan");
    find(Verdict::yes, "second", 0.2);
    chunks_.pop_back();
    EXPECT_EQ(told(), (Told{MatchFate::stands, "-", "-", 0.2}));
    ask("scan");
    find(Verdict::ask, "third", 0.8);
    chunks_.pop_back();
    ask("confirm");
    EXPECT_EQ(told(), (Told{MatchFate::stands, "-", "-", 0.8}));
}

}  // namespace
}  // namespace planlight
