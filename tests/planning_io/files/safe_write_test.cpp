#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <functional>

#include "planning_io/files/disk_refusal.h"
#include "planning_io/files/keep_to_owner.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(SafeWrite, AFailedWriteLeavesTheOldFileAndNothingElse) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "a.txt";
    write_safely(file, "old");
    EXPECT_THROW(write_safely(file, [](std::ostream& out) { out.setstate(std::ios::badbit); }), DiskError);
    EXPECT_THROW(write_safely(file, [](std::ostream&) { throw std::runtime_error("stop"); }), std::runtime_error);
    EXPECT_EQ(read_whole(file), "old");
    EXPECT_EQ(files_in(folder.path()), 1u);
    EXPECT_THROW(write_safely(folder.path() / "no" / "folder.txt", "x"), DiskError);
    if (fs::is_character_file("/dev/full")) {
        EXPECT_THROW(write_safely("/dev/full", "x"), DiskError) << "a full disk is told";
        EXPECT_TRUE(fs::is_character_file("/dev/full")) << "a device is never replaced by a file";
    }
    EXPECT_THROW(write_safely(folder.path(), "x"), DiskError);
    fs::create_symlink(file, folder.path() / "link");
    write_safely(folder.path() / "link", "new");
    EXPECT_EQ(read_whole(file), "new");
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
    EXPECT_THROW(read_whole(folder.path()), InputError);
    EXPECT_THROW(read_whole(folder.path() / "none"), InputError);
}

TEST(SafeWrite, TheRemedyIsThatOfTheFault) {
    const test::TemporaryFolder folder;
    const fs::path too_long = folder.path() / std::string(300, 'x');
    for (const auto& write : {std::function<void()>([&] { write_safely(too_long, "x"); }),
                              std::function<void()>([&] { make_folder(too_long); })}) {
        try {
            write();
            FAIL() << "a name of 300 characters";
        } catch (const DiskError& error) {
            EXPECT_EQ(error.remedy, "Choose a shorter name.");
        }
    }
    EXPECT_STREQ(remedy_of_unwritable(std::make_error_code(std::errc::read_only_file_system)),
                 "This disk can only be read: name a folder on another one.");
}

TEST(SafeWrite, AFileForItsOwnerIsSoFromItsFirstByteOnAlsoInPlaceOfOneForAll) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "face.html";
    write_safely(file, "old");
    fs::permissions(file, fs::perms(0644));
    const auto perms = [](const fs::path& of) { return fs::status(of).permissions(); };
    write_safely(
        file,
        [&](std::ostream& out) {
            out << "a face" << std::flush;
            for (const auto& entry : fs::directory_iterator(folder.path()))
                if (entry.path() != file) {
                    EXPECT_EQ(perms(entry.path()), fs::perms(0600)) << "while it is written";
                }
        },
        ReadableBy::owner);
    EXPECT_EQ(read_whole(file), "a face");
    EXPECT_EQ(perms(file), fs::perms(0600));
}

/// What a test was started with may be to ignore it (nohup, a script's background).
void as_by_default() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
}

// Ctrl-C, a shutdown, a closed terminal: what is half written may be a patient's face.
TEST(SafeWrite, ASignalThatEndsTheProgramLeavesNothingHalfWritten) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const test::TemporaryFolder folder;
        const auto write_a_folder = [&] {
            as_by_default();
            write_folder_safely(folder.path() / "case", false, [&](const fs::path& into) {
                write_safely(into / "skin", "a face");
                std::raise(signal);
                write_safely(into / "more", "of it");
                std::_Exit(9);  // is not come to
            });
        };
        EXPECT_EXIT(write_a_folder(), testing::KilledBySignal(signal), "");
        EXPECT_EQ(files_in(folder.path()), 0U) << signal;
        const auto write_a_file = [&] {
            as_by_default();
            write_safely(folder.path() / "page", [&](std::ostream& out) {
                out << "a face" << std::flush;
                std::raise(signal);
            });
        };
        EXPECT_EXIT(write_a_file(), testing::KilledBySignal(signal), "");
        EXPECT_EQ(files_in(folder.path()), 1U) << "whole: it was nearly done";
        EXPECT_EQ(read_whole(folder.path() / "page"), "a face");
    }
}

// A terminal that is closed sends SIGHUP twice, a session that is ended SIGTERM and SIGHUP; a person who presses
// Ctrl-C twice does not want to wait.
TEST(SafeWrite, OnlyASecondCtrlCIsNotWaitedWith) {
    for (const auto& [first, second] :
         {std::pair(SIGHUP, SIGHUP), {SIGTERM, SIGHUP}, {SIGINT, SIGTERM}, {SIGINT, SIGINT}}) {
        const test::TemporaryFolder folder;
        const auto write = [&, first = first, second = second] {
            as_by_default();
            write_folder_safely(folder.path() / "case", false, [&](const fs::path& into) {
                write_safely(into / "skin", "a face");
                std::raise(first);
                std::raise(second);
                write_safely(into / "more", "of it");
            });
        };
        EXPECT_EXIT(write(), testing::KilledBySignal(second), "");
        EXPECT_EQ(files_in(folder.path()), second == SIGINT ? 1U : 0U) << first << ", " << second;
    }
}

TEST(SafeWrite, ASignalThatTheProgramHandlesItselfIsItsOwn) {
    const test::TemporaryFolder folder;
    static volatile std::sig_atomic_t handled = 0;
    const auto before = std::signal(SIGTERM, [](int) { handled = handled + 1; });
    write_folder_safely(folder.path() / "case", false, [&](const fs::path& into) {
        std::raise(SIGTERM);
        EXPECT_EQ(handled, 1) << "at once";
        write_safely(into / "skin", "whole");
    });
    std::signal(SIGTERM, before);
    EXPECT_EQ(read_whole(folder.path() / "case" / "skin"), "whole");
}

TEST(KeepToOwner, AFolderAndAllInItAreTheirOwnersWhateverTheUmaskMadeOfThem) {
    const test::TemporaryFolder folder;
    const fs::path made = folder.path() / "face", file = made / "deeper" / "skin", elsewhere = folder.path() / "mine";
    fs::create_directories(made / "deeper");
    for (const fs::path& one : {file, elsewhere}) write_safely(one, "x");
    for (const fs::path& one : {made, made / "deeper"}) fs::permissions(one, fs::perms(0755));
    for (const fs::path& one : {file, elsewhere}) fs::permissions(one, fs::perms(0644));
    fs::create_symlink(elsewhere, made / "link");
    keep_to_owner(made);
    for (const fs::path& one : {made, made / "deeper"}) EXPECT_EQ(fs::status(one).permissions(), fs::perms(0700));
    EXPECT_EQ(fs::status(file).permissions(), fs::perms(0600));
    EXPECT_EQ(fs::status(elsewhere).permissions(), fs::perms(0644)) << "a link leads to what is somebody else's";
    EXPECT_THROW(keep_to_owner(folder.path() / "none"), DiskError);
}

}  // namespace
}  // namespace planlight
