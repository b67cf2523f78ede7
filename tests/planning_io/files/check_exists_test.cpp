#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

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
    std::string said;
    {
        const AsNobody nobody;
        if (!nobody.is_nobody()) GTEST_SKIP() << "this process may be nobody else";
        said = refusal(file);
    }
    fs::permissions(folder.path() / "closed", fs::perms::all);
    EXPECT_EQ(said.find("does not exist"), std::string::npos) << said;
    EXPECT_NE(said.find((folder.path() / "closed").string() + " may not be entered"), std::string::npos) << said;
}

TEST(CheckExists, NamesWhereALinkLeads) {
    const test::TemporaryFolder folder;
    fs::create_symlink("gone.nii", folder.path() / "link.nii");
    EXPECT_NE(refusal(folder.path() / "link.nii").find("is a link to gone.nii, which does not exist"),
              std::string::npos);
    EXPECT_NE(refusal(folder.path() / std::string(300, 'n')).find("cannot be reached"), std::string::npos);
}

}  // namespace
}  // namespace planlight
