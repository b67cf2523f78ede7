#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "app/recording/recording_head.h"
#include "app/report/operation_report.h"
#include "planning_io/recording/packed_pictures.h"
#include "tests/support/test_data.h"

namespace planlight {

namespace fs = std::filesystem;
using nlohmann::json;

inline constexpr Instant kOrigin = std::chrono::seconds(1000);
inline constexpr Instant kStep = std::chrono::milliseconds(100);

/// A recording by hand: two items, a match, updates a tenth of a second apart.
class RecordingByHand : public ::testing::Test {
protected:
    RecordingByHand() {
        RecordingHead head;
        head.program = "1", head.case_code = "1a2b", head.case_title = "A <b> title";
        head.began_utc = "2026-03-14T09:30:00Z", head.operator_name = "Ada";
        add(chunk_types::kHead, text_of(head));
        add(chunk_types::kRoom,
            R"({"name": "Theatre 2", "simulated": false, "rig_hash": "r", "rig": {"made_on": "2026-03-01"}, "utc": "2026-03-14T09:30:07Z"})");
    }
    void add(ChunkType type, const std::string& payload) {
        chunks_.push_back({type, kOrigin + kStep * step_, payload});
    }
    void event(const json& event) { add(chunk_types::kEvent, event.dump()); }
    void match(const std::string& verdict = "yes") {
        event({{"what", "asked"}, {"call", "find_patient"}, {"utc", "2026-03-14T09:31:00Z"}});
        event({{"what", "matched"},
               {"verdict", verdict},
               {"reasons", json::array()},
               {"residual_rms_mm", 0.3},
               {"points", 20000},
               {"items", {"Line", "Hole"}},
               {"predicted_mm", {0.5, nullptr}}});
    }
    /// A tenth of a second of light of both items (`line_mm` below 0: the line's light was not seen).
    void lit(double line_mm, double hole_mm, const std::string& trust, bool hole_lit = true) {
        ++step_;
        event({{"what", "asked"}, {"call", "update"}});
        event(
            {{"what", "updated"},
             {"at_ns", (kOrigin + kStep * step_).count()},
             {"light", {{"lit", true}}},
             {"check",
              {{"items", {{true, 4, line_mm < 0 ? 0 : 4, std::max(0.0, line_mm), 0.1}, {hole_lit, 2, 2, hole_mm, 0.1}}},
               {"seen", 6},
               {"off_mm", hole_mm}}}});
        event({{"what", "gate"}, {"call", "step"}, {"trust", trust}, {"headline", "x"}});
    }
    void dark(const std::string& reason) {
        ++step_;
        event({{"what", "asked"}, {"call", "update"}});
        event({{"what", "updated"},
               {"at_ns", (kOrigin + kStep * step_).count()},
               {"light", {{"lit", false}, {"dark", reason}}}});
    }
    /// Light that no camera looked at.
    void unchecked(const std::string& trust) {
        ++step_;
        event({{"what", "asked"}, {"call", "update"}});
        event({{"what", "updated"}, {"at_ns", (kOrigin + kStep * step_).count()}, {"light", {{"lit", true}}}});
        event({{"what", "gate"}, {"call", "step"}, {"trust", trust}, {"headline", "x"}});
    }
    void skin_check(const json& off_mm) {
        event({{"what", "skin_checked"}, {"known", true}, {"why_not", ""}, {"off_mm", off_mm}});
    }
    OperationFacts facts(bool done = true, const std::string& last_word = "{}") {
        if (done) add(chunk_types::kDone, last_word);
        std::ofstream out(file(), std::ios::binary);
        out << recording_header();
        for (std::size_t i = 0; i < chunks_.size(); ++i) out << chunk_bytes(chunks_[i], i);
        out.close();
        return facts_of_operation(file());
    }
    /// The report's page, as text; its figures stand beside it.
    std::string page_of(const OperationFacts& f, const std::string& name = "page.html") const {
        const fs::path page = folder_.path() / name;
        write_operation_report(f, operation_json(f), page);
        std::ifstream in(page);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    fs::path file() const { return folder_.path() / "session.plrec"; }

    std::vector<RecordingChunk> chunks_;
    int step_ = 0;
    test::TemporaryFolder folder_;
};

}  // namespace planlight
