// `report` and `forget` on recordings, as the program's user runs them: no recording is lost, and none is left unsaid.
#include <gtest/gtest.h>

#include <fstream>

#include "app/recording/recording_head.h"
#include "planning_io/recording/packed_pictures.h"
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
    expect_refused(run_planlight("report a.plrec --out a.plrec", folder.path()), 2, "would be written over");
    expect_refused(run_planlight("report a.plrec --out link.html", folder.path()), 2, "would be written over");
    expect_refused(run_planlight("report a.plrec --out b.plrec", folder.path()), 3, "name of a recording");
    expect_refused(run_planlight("report a.plrec --out page.json", folder.path()), 3, "figures");
    expect_refused(run_planlight("report odd.json", folder.path()), 3, "the recording itself");
    expect_refused(run_planlight("report a.plrec --pdf a.plrec", folder.path()), 2, "would be written over");
    expect_refused(run_planlight("report a.plrec --pdf link.html", folder.path()), 2, "would be written over");
    expect_refused(run_planlight("report a.plrec --pdf c.plrec", folder.path()), 3, "name of a recording");
    expect_refused(run_planlight("report a.plrec --out p.html --pdf p.html", folder.path()), 2, "name the same file");
    expect_refused(run_planlight("report a.plrec --out p.html --pdf ./p.json", folder.path()), 3, "not the PDF");
    EXPECT_EQ(whole(file), bytes);
    EXPECT_EQ(whole(odd), bytes);
    EXPECT_EQ(run_planlight("report a.plrec", folder.path()).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder.path() / "a.html"));
}

/// The page's figures go beside it: there the case's own file may stand.
TEST(ReportCommand, ItsFiguresTakeNothingElsesPlace) {
    const TemporaryFolder folder;
    write_recording(folder.path() / "a.plrec");
    const fs::path manifest = folder.path() / "case.json", other = folder.path() / "list.json";
    std::ofstream(manifest) << R"({"format": "planlight case"})";
    std::ofstream(other) << "[1, 2";
    for (const char* page : {"case.html", "list.html"})
        expect_refused(run_planlight(std::string("report a.plrec --out ") + page, folder.path()), 3, "no report's");
    EXPECT_EQ(whole(manifest), R"({"format": "planlight case"})");
    EXPECT_EQ(whole(other), "[1, 2");
    EXPECT_EQ(run_planlight("report a.plrec --out p.html", folder.path()).exit_code, 0);
    EXPECT_EQ(run_planlight("report a.plrec --out p.html", folder.path()).exit_code, 0) << "its own are made anew";
}

TEST(ReportCommand, ItsPdfIsReadableByItsOwnerAlone) {
    const TemporaryFolder folder;
    write_recording(folder.path() / "a.plrec");
    const CommandRun run = run_planlight("report a.plrec --pdf a.pdf", folder.path(), "umask 0022; ");
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(whole(folder.path() / "a.pdf").substr(0, 5), "%PDF-");
    EXPECT_EQ(fs::status(folder.path() / "a.pdf").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(ReviewCommand, WritesOnlyIntoANewFolderOrOneOfItsOwn) {
    const TemporaryFolder folder;
    write_recording(folder.path() / "a.plrec");
    fs::create_directory(folder.path() / "mine");
    fs::permissions(folder.path() / "mine", fs::perms::owner_all | fs::perms::group_read);
    std::ofstream(folder.path() / "mine" / "index.html") << "my own page";
    expect_refused(run_planlight("review a.plrec --out mine", folder.path()), 3, "no review of a recording");
    EXPECT_EQ(whole(folder.path() / "mine" / "index.html"), "my own page");
    EXPECT_EQ(fs::status(folder.path() / "mine").permissions(), fs::perms::owner_all | fs::perms::group_read);
    fs::create_directory(folder.path() / "empty");
    for (int time = 0; time < 2; ++time)
        EXPECT_EQ(run_planlight("review a.plrec --out empty", folder.path()).exit_code, 0) << "once more into its own";
    expect_refused(run_planlight("review a.plrec --out a.plrec", folder.path()), 2, "would be written over");
}

TEST(ReviewCommand, OfAMomentOfAnAnonymousRecordingSaysThatNoCaseWouldHelp) {
    const TemporaryFolder folder;
    RecordingHead head;
    head.case_code = "1a2b";
    head.anonymous = true;
    const StereoFrame frame{GrayImage(64, 48, 90), GrayImage(64, 48, 90), std::chrono::seconds(1), {}, 1};
    std::ofstream(folder.path() / "a.plrec", std::ios::binary)
        << recording_header() << chunk_bytes({chunk_types::kHead, Instant(0), text_of(head)}, 0)
        << chunk_bytes({chunk_types::kRoom, Instant(0), "{}"}, 1)
        << chunk_bytes({chunk_types::kFrame, frame.at, pack_frame(frame)}, 2)
        << chunk_bytes({chunk_types::kDone, frame.at, "{}"}, 3);
    const CommandRun run = run_planlight("review a.plrec --at 1", folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.err.find("An anonymous recording does not keep where the plan lies."), std::string::npos) << run.err;
    EXPECT_EQ(run.err.find("--case"), std::string::npos) << run.err;
    EXPECT_NE(whole(folder.path() / "a-review" / "index.html").find("does not keep where the plan lies"),
              std::string::npos);
}

TEST(ForgetCommand, NamesAllThatShowsTheFace) {
    const TemporaryFolder folder;
    write_recording(folder.path() / "a.plrec");
    ASSERT_EQ(run_planlight("review a.plrec", folder.path()).exit_code, 0);
    ASSERT_EQ(run_planlight("report a.plrec --pdf a.pdf", folder.path()).exit_code, 0);
    const CommandRun run = run_planlight("forget a.plrec", folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    for (const char* left : {"a-review", "a.pdf", "a.html", "a.json"}) {
        EXPECT_NE(run.out.find(std::string("Left: ") + left), std::string::npos) << run.out;
        EXPECT_TRUE(fs::exists(folder.path() / left)) << "named, not removed";
    }
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
