// `export` of a recorded session, as the program's user runs it.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "app/kept_match.h"
#include "app/recording/recording_head.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/recording/recording_chunk.h"
#include "tests/app/exported_phantom.h"
#include "tests/app/run_command.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using test::run_planlight;

/// The phantom's case, and the recording of a session in which it was found; no frame of it was kept.
class ExportCommand : public ::testing::Test {
protected:
    ExportCommand() {
        write_case(phantom_.prepared, folder_.path() / "case", false);
        record(recording_head(phantom_.prepared, folder_.path() / "case", RecordMode::events, {}), "a.plrec");
    }
    void record(const RecordingHead& head, const char* name) const {
        KeptMatch match;
        match.registration = phantom_.operation.match;
        match.made_utc = "2026-03-14T09:31:00Z";
        const nlohmann::json matched{{"what", "matched"},
                                     {"verdict", "yes"},
                                     {"reasons", nlohmann::json::array()},
                                     {"residual_rms_mm", 0.3},
                                     {"points", 20000},
                                     {"items", nlohmann::json::array()},
                                     {"predicted_mm", nlohmann::json::array()}};
        const std::pair<ChunkType, std::string> chunks[] = {
            {chunk_types::kHead, text_of(head)},
            {chunk_types::kRoom, R"({"name": "Theatre", "rig": {}, "utc": "2026-03-14T09:30:00Z"})"},
            {chunk_types::kEvent, R"({"what": "asked", "call": "find_patient"})"},
            {chunk_types::kEvent, matched.dump()},
            {chunk_types::kMatch, text_of(match)},
            {chunk_types::kDone, "{}"}};
        std::ofstream out(folder_.path() / name, std::ios::binary);
        out << recording_header();
        std::uint64_t number = 0;
        for (const auto& [type, payload] : chunks) {
            out << chunk_bytes({type, Instant(number), payload}, number);
            ++number;
        }
    }
    const test::ExportedPhantom& phantom_ = test::exported_phantom();
    test::TemporaryFolder folder_;
};

TEST_F(ExportCommand, ARecordingBecomesObjectsOfItsStudyAndAFolderForSlicer) {
    const auto run = run_planlight("export case --recording a.plrec --slicer for-slicer --dicom for-pacs --volume '" +
                                       phantom_.series.string() + "' --json",
                                   folder_.path());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto told = nlohmann::json::parse(run.out);
    for (const char* file : {"registration.dcm", "report.dcm"})
        EXPECT_EQ(std::count(told["dicom"].begin(), told["dicom"].end(), file), 1) << run.out;
    for (const auto& file : told["dicom"]) EXPECT_TRUE(fs::exists(folder_.path() / "for-pacs" / file)) << file;
    EXPECT_EQ(told["slicer"], "for-slicer/scene.mrml");
    EXPECT_TRUE(fs::exists(folder_.path() / "for-slicer" / "scene.mrml"));
    EXPECT_NE(run.err.find("the scan of this match is not in"), std::string::npos) << run.err;
    expect_refused(run_planlight("export case --recording a.plrec --slicer for-slicer", folder_.path()), 3,
                   "is not empty");
}

// No picture is needed to know that the plan of today is not the one that was lit.
TEST_F(ExportCommand, OfASessionWithAnotherPlanItIsRefused) {
    RecordingHead head = recording_head(phantom_.prepared, folder_.path() / "case", RecordMode::events, {});
    head.plan_hash = "of another plan";
    record(head, "other.plrec");
    expect_refused(run_planlight("export case --recording other.plrec --slicer for-slicer", folder_.path()), 3,
                   "whose skin or plan is another");
    EXPECT_FALSE(fs::exists(folder_.path() / "for-slicer"));
}

}  // namespace
}  // namespace planlight
