#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "planning_io/files/check_exists.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

std::string refusal(const fs::path& path) {
    try {
        check_exists(path, "Name another.");
        return {};
    } catch (const InputError& error) {
        return std::string(error.what()) + ". " + error.remedy;
    }
}

/// For as long as it lives this process may do no more than anyone: tests may run as root, who may enter every folder.
class AsNobody {
public:
    AsNobody() { is_nobody_ = ::geteuid() != 0 || ::seteuid(65534) == 0; }
    ~AsNobody() {
        if (::getuid() == 0 && ::seteuid(0) != 0) std::abort();
    }
    bool is_nobody() const { return is_nobody_; }

private:
    bool is_nobody_ = false;
};

/// What is said to somebody who has no rights; nothing where this process can be nobody else.
std::optional<std::string> refusal_to_nobody(const fs::path& path) {
    const AsNobody nobody;
    if (!nobody.is_nobody()) return std::nullopt;
    return refusal(path);
}

/// Nobody can enter it: the folder for temporary files may be its owner's alone, as may those above it.
bool nobody_enters(const fs::path& folder) {
    const AsNobody nobody;
    return nobody.is_nobody() && ::eaccess(folder.c_str(), X_OK) == 0;
}

TEST(CheckExists, TellsWhatIsMissingFromWhatMayNotBeEntered) {
    const test::TemporaryFolder folder;
    fs::permissions(folder.path(), fs::perms::all);
    const fs::path file = folder.path() / "closed" / "deep" / "head.nii";
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "x";
    EXPECT_EQ(refusal(file), "");
    EXPECT_NE(refusal(folder.path() / "other.nii").find("does not exist. Name another."), std::string::npos);
    EXPECT_NE(refusal(file / "below").find("does not exist"), std::string::npos) << "below a file there is nothing";
    fs::permissions(folder.path() / "closed", fs::perms::none);
    const auto said = refusal_to_nobody(file);
    const bool the_way_there_is_open = nobody_enters(folder.path());
    fs::permissions(folder.path() / "closed", fs::perms::all);
    if (!said) GTEST_SKIP() << "this process may be nobody else";
    EXPECT_EQ(said->find("does not exist"), std::string::npos) << *said;
    EXPECT_NE(said->find(" may not be entered"), std::string::npos) << *said;
    if (!the_way_there_is_open) return;  // a folder above is named
    EXPECT_NE(said->find((folder.path() / "closed").string() + " may not be entered"), std::string::npos) << *said;
}

TEST(CheckExists, NamesTheClosedFolderThatALinkLeadsInto) {
    const test::TemporaryFolder folder;
    fs::permissions(folder.path(), fs::perms::all);
    fs::create_directories(folder.path() / "closed" / "in");
    fs::create_directories(folder.path() / "open");
    std::ofstream(folder.path() / "closed" / "in" / "p") << "x";
    fs::create_symlink("../closed/in", folder.path() / "open" / "link");
    fs::create_symlink(folder.path() / "open" / "link" / "p", folder.path() / "open" / "p");
    fs::permissions(folder.path() / "closed", fs::perms::none);
    const bool the_way_there_is_open = nobody_enters(folder.path());
    const auto folders = refusal_to_nobody(folder.path() / "open" / "link" / "p"),
               files = refusal_to_nobody(folder.path() / "open" / "p");
    fs::permissions(folder.path() / "closed", fs::perms::all);
    if (!folders || !the_way_there_is_open) GTEST_SKIP() << "nobody may enter the folder for temporary files";
    for (const std::string& said : {*folders, *files})
        EXPECT_NE(said.find("the folder " + (folder.path() / "closed").string() + " may not be entered"),
                  std::string::npos)
            << said;
}

TEST(CheckExists, NamesWhereALinkLeads) {
    const test::TemporaryFolder folder;
    fs::create_symlink("gone.nii", folder.path() / "link.nii");
    EXPECT_NE(refusal(folder.path() / "link.nii").find("is a link to gone.nii, which does not exist"),
              std::string::npos);
    fs::create_symlink("link.nii", folder.path() / "first.nii");
    const std::string second = (folder.path() / "link.nii").string();
    EXPECT_NE(
        refusal(folder.path() / "first.nii").find("leads over the link " + second + " to gone.nii, which does not"),
        std::string::npos)
        << refusal(folder.path() / "first.nii") << ": the first link's own target is there";
    fs::create_directory_symlink(".", folder.path() / "here");
    EXPECT_NE(refusal(folder.path() / "here" / "gone.nii").find("here/gone.nii: does not exist. Name another."),
              std::string::npos)
        << refusal(folder.path() / "here" / "gone.nii") << ": the link is no reason";
    fs::create_symlink("round.nii", folder.path() / "round.nii");
    EXPECT_NE(refusal(folder.path() / "round.nii").find("cannot be reached"), std::string::npos);
    EXPECT_NE(refusal(folder.path() / std::string(300, 'n')).find("cannot be reached"), std::string::npos);
}

TEST(CheckExists, SaysThatANameIsEmpty) {
    EXPECT_EQ(refusal(""), "the name of a file or folder is empty. Name another.");
}

}  // namespace
}  // namespace planlight
