// `report` and `forget` on recordings, as the program's user runs them: no recording is lost, and none is left unsaid.
#include <gtest/gtest.h>

#include <fstream>

#include "app/live/shown_review.h"
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

/// A frame a second, from the first on.
void write_recording_of_frames(const fs::path& file, std::uint64_t frames, bool anonymous = false) {
    RecordingHead head;
    head.case_code = "1a2b";
    head.anonymous = anonymous;
    std::ofstream out(file, std::ios::binary);
    out << recording_header() << chunk_bytes({chunk_types::kHead, Instant(0), text_of(head)}, 0)
        << chunk_bytes({chunk_types::kRoom, Instant(0), "{}"}, 1);
    const GrayImage picture(64, 48, 90);
    for (std::uint64_t i = 1; i <= frames; ++i) {
        const Instant at = std::chrono::seconds(i);
        out << chunk_bytes({chunk_types::kFrame, at, pack_frame({picture, picture, at, {}, i})}, i + 1);
    }
    out << chunk_bytes({chunk_types::kDone, std::chrono::seconds(frames), "{}"}, frames + 2);
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
    write_recording_of_frames(folder.path() / "a.plrec", 1, true);
    const CommandRun run = run_planlight("review a.plrec --at 1", folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.err.find("An anonymous recording does not keep where the plan lies."), std::string::npos) << run.err;
    EXPECT_EQ(run.err.find("--case"), std::string::npos) << run.err;
    EXPECT_NE(whole(folder.path() / "a-review" / "index.html").find("does not keep where the plan lies"),
              std::string::npos);
}

TEST(ReviewCommand, AClipIsAPictureForEachFrameThatWasKeptInBetweenWithItsTime) {
    const TemporaryFolder folder;
    write_recording_of_frames(folder.path() / "a.plrec", 4);
    const auto clip = folder.path() / "a-review" / "clip";
    for (int time = 0; time < 2; ++time) {
        const CommandRun run = run_planlight("review a.plrec --clip 2 3.5", folder.path());
        ASSERT_EQ(run.exit_code, 0) << run.err;
        EXPECT_NE(run.out.find("2 pictures in a-review/clip"), std::string::npos) << run.out;
        EXPECT_EQ(std::distance(fs::directory_iterator(clip), {}), 3) << "two pictures and their times";
        EXPECT_EQ(whole(clip / "times.csv"), "file,seconds\n000000.png,2.000000\n000001.png,3.000000\n");
        EXPECT_EQ(whole(clip / "000001.png").substr(1, 3), "PNG");
    }
    expect_refused(run_planlight("review a.plrec --clip 9 10", folder.path()), 3, "kept no frame from 9 to 10 s");
    expect_refused(run_planlight("review a.plrec --clip 3 2", folder.path()), 2, "ends before it begins");
}

/// Whoever looks at a recording over a network share has others beside him.
TEST(ReviewCommand, PageMomentAndClipAreForTheirOwnerAloneWhateverTheUmask) {
    for (const char* umask : {"umask 0022; ", "umask 0077; ", "umask 0; "}) {
        const TemporaryFolder folder;
        fs::permissions(folder.path(), fs::perms(0755));
        write_recording_of_frames(folder.path() / "a.plrec", 1);
        const CommandRun run =
            run_planlight("review a.plrec --at 1 --clip 0 2 --out deep/review", folder.path(), umask);
        ASSERT_EQ(run.exit_code, 0) << run.err;
        int files = 0;
        for (const auto& entry : fs::recursive_directory_iterator(folder.path() / "deep" / "review")) {
            files += entry.is_regular_file();
            EXPECT_EQ(entry.status().permissions(), fs::perms(entry.is_directory() ? 0700 : 0600)) << umask << entry;
        }
        EXPECT_EQ(files, 5) << "page, figures, the moment, and a clip of one picture with its time";
        EXPECT_EQ(fs::status(folder.path() / "deep" / "review").permissions(), fs::perms(0700));
        EXPECT_EQ(fs::status(folder.path()).permissions(), fs::perms(0755)) << "what was there before stays as it was";
    }
}

TEST(ReviewCommand, AnEventOfTheWrongKindIsADamagedFile) {
    const TemporaryFolder folder;
    RecordingHead head;
    head.case_code = "1a2b";
    std::ofstream(folder.path() / "a.plrec", std::ios::binary)
        << recording_header() << chunk_bytes({chunk_types::kHead, Instant(0), text_of(head)}, 0)
        << chunk_bytes({chunk_types::kRoom, Instant(0), R"({"utc": 7})"}, 1)
        << chunk_bytes({chunk_types::kDone, Instant(1), "{}"}, 2);
    expect_refused(run_planlight("review a.plrec", folder.path()), 4, "cannot be understood");
}

TEST(ForgetCommand, NamesAllThatShowsTheFace) {
    const TemporaryFolder folder;
    write_recording(folder.path() / "a.plrec");
    ASSERT_EQ(run_planlight("review a.plrec", folder.path()).exit_code, 0);
    ASSERT_EQ(run_planlight("report a.plrec --pdf a.pdf", folder.path()).exit_code, 0);
    std::ofstream(snapshot_of(folder.path() / "a.plrec", 95)) << "a picture of the window";
    const CommandRun run = run_planlight("forget a.plrec", folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    for (const char* left : {"a-review", "a.pdf", "a.html", "a.json", "a-at-95.000.png"}) {
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
