// `report` and `forget` on recordings, as the program's user runs them: no recording is lost, and none is left unsaid.
#include <gtest/gtest.h>

#include <fstream>

#include "app/recording/recording_head.h"
#include "planning_io/recording/recording_chunk.h"
#include "tests/app/run_command.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

void write_recording(const fs::path& file) {
    RecordingHead head;
    head.case_code = "1a2b";
    std::ofstream out(file, std::ios::binary);
    out << recording_header() << chunk_bytes({chunk_types::kHead, Instant(0), text_of(head)}, 0)
        << chunk_bytes({chunk_types::kDone, Instant(1), "{}"}, 1);
}

TEST(ReportCommand, NeverTakesTheRecordingsPlace) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.plrec", odd = folder.path() / "odd.json";
    write_recording(file);
    const std::string bytes = whole(file);
    fs::create_symlink(file, folder.path() / "link.html");
    fs::copy_file(file, odd);
    expect_refused(run_planlight("report a.plrec --out a.plrec", folder.path()), 3, "the recording itself");
    expect_refused(run_planlight("report a.plrec --out link.html", folder.path()), 3, "the recording itself");
    expect_refused(run_planlight("report a.plrec --out b.plrec", folder.path()), 3, "name of a recording");
    expect_refused(run_planlight("report a.plrec --out page.json", folder.path()), 3, "figures");
    expect_refused(run_planlight("report odd.json", folder.path()), 3, "the recording itself");
    EXPECT_EQ(whole(file), bytes);
    EXPECT_EQ(whole(odd), bytes);
    EXPECT_EQ(run_planlight("report a.plrec", folder.path()).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder.path() / "a.html"));
}

TEST(ForgetCommand, OfALinkRemovesWhatItLeadsTo) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.plrec", link = folder.path() / "link.plrec";
    write_recording(file);
    fs::create_symlink(file, link);
    const CommandRun run = run_planlight("forget link.plrec", folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_FALSE(fs::exists(file)) << "there the faces are";
    EXPECT_FALSE(fs::is_symlink(link));
    EXPECT_NE(run.out.find("a.plrec is removed"), std::string::npos) << run.out;
}

TEST(ForgetCommand, SaysThatTheRecordingHasAnotherName) {
    const TemporaryFolder folder;
    write_recording(folder.path() / "a.plrec");
    fs::create_hard_link(folder.path() / "a.plrec", folder.path() / "b.plrec");
    const CommandRun run = run_planlight("forget a.plrec", folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.out.find("1 other name"), std::string::npos) << run.out;
}

}  // namespace
}  // namespace planlight::test
