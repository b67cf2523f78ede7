// What the pages say of each other and of the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/refusals_page.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = fs::path(PLANLIGHT_SOURCE_FOLDER);
/// Where what the program installs, and the system, lie.
constexpr const char* kInstalled[] = {"/usr/", "/etc/", "/dev/", "/sys/", "/proc/", "/var/"};

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

std::vector<fs::path> pages() {
    std::vector<fs::path> found{kRoot / "README.md"};
    for (const char* room : {"planning_io", "segmentation", "registration", "projection", "app", "tests"})
        for (const auto& entry : fs::recursive_directory_iterator(kRoot / room))
            if (entry.path().extension() == ".md") found.push_back(entry.path());
    return found;
}

/// Without what stands as code.
std::string prose_of(const fs::path& page) {
    const std::string text = std::regex_replace(text_of(page), std::regex("```[^`]*```"), "");
    return std::regex_replace(text, std::regex("`[^`\n]*`"), "`");
}

/// As a heading is named in a link.
std::string anchor_of(const std::string& heading) {
    std::string anchor;
    for (const char c : heading) {
        const auto letter = static_cast<unsigned char>(c);
        if (std::isalnum(letter) != 0 || c == '-' || c == '_' || letter >= 128)
            anchor += static_cast<char>(std::tolower(letter));
        else if (c == ' ')
            anchor += '-';
    }
    return anchor;
}

std::set<std::string> anchors_of(const fs::path& page) {
    std::set<std::string> anchors;
    std::istringstream lines(text_of(page));
    static const std::regex kHeading("^#+ (.*)$");
    std::smatch found;
    for (std::string line; std::getline(lines, line);)
        if (std::regex_match(line, found, kHeading)) anchors.insert(anchor_of(found[1]));
    return anchors;
}

// The package has the pages with their pictures, in the folders of the source, and nothing else of it.
TEST(Pages, LinksLeadToPagesAndPicturesThatAreThere) {
    static const std::regex kLink("\\]\\(([^)\\s]+)\\)");
    int links = 0;
    for (const fs::path& page : pages()) {
        const std::string prose = prose_of(page);
        for (std::sregex_iterator it(prose.begin(), prose.end(), kLink), end; it != end; ++it) {
            const std::string link = (*it)[1];
            if (link.starts_with("http")) continue;
            ++links;
            const std::string to = link.substr(0, link.find('#'));
            const fs::path file = to.empty() ? page : page.parent_path() / to;
            EXPECT_TRUE(fs::is_regular_file(file)) << page << " links to " << link;
            EXPECT_TRUE(file.extension() == ".md" || file.extension() == ".png")
                << page << " links to " << link << ", which is not installed";
            const std::string anchor = to.size() < link.size() ? link.substr(to.size() + 1) : std::string();
            EXPECT_TRUE(anchor.empty() || anchors_of(file).contains(anchor)) << page << " links to " << link;
        }
    }
    EXPECT_GT(links, 150);
}

TEST(Pages, TheGuideHasARowForEveryBannerOfTheLight) {
    const std::string page = text_of(kRoot / "app/guide/6-when-it-says-no.md");
    const std::string words = text_of(kRoot / "app/words/en.json");
    std::set<std::string> banners;
    static const std::regex kBanner("\\n\\s*\"LOOK: ([^\\n]*?)\\.\": \"");
    for (std::sregex_iterator it(words.begin(), words.end(), kBanner), end; it != end; ++it) banners.insert((*it)[1]);
    const std::string causes = text_of(kRoot / "projection/light_cause_words.cpp");
    static const std::regex kCause("\"((the|a|no) [^\"]*)\\.\"");  // headlines; sentences begin with a capital
    for (std::sregex_iterator it(causes.begin(), causes.end(), kCause), end; it != end; ++it) banners.insert((*it)[1]);
    EXPECT_GT(banners.size(), 15u);
    for (std::string banner : banners) {
        if (banner == "a marker has slipped") continue;  // it stands beside a green banner
        banner = std::regex_replace(banner, std::regex("\\\\\""), "\"");
        banner = std::regex_replace(banner, std::regex("\\{name\\}"), "Hole 2");
        banner = std::regex_replace(banner, std::regex("\\{[a-z]+\\}"), "…");
        EXPECT_NE(page.find("*" + banner + "*"), std::string::npos) << banner;
    }
}

TEST(Pages, AllRefusalsStandOnTheirPage) {
    EXPECT_TRUE(text_of(kRoot / "app/guide/refusals.md") == refusals_page(kRoot))
        << "write it anew: build/tests/app/list_refusals . > app/guide/refusals.md";
}

// A row without a remedy helps nobody.
TEST(Pages, EveryRefusalHasARemedy) {
    const std::string page = refusals_page(kRoot);
    EXPECT_EQ(page.find("| … |\n"), std::string::npos) << page.substr(page.find("| … |\n") - 80, 100);
    for (const char* row :
         {"| says \"…\" twice | Correct the file;",
          "| is a spreadsheet or another zip archive, not a plan | Save its table as CSV",
          "| is not a whole picture | Capture or copy the picture again",
          "each camera sees other discs, or the rig is not that of these pictures | See that at least"})
        EXPECT_NE(page.find(row), std::string::npos) << row;
}

// A reader has the checkout and what its packages install: nothing else of the disks that a page was written on, and
// nobody to ask whom a page does not name.
TEST(Pages, NameNoPlaceThatAReaderDoesNotHave) {
    const std::regex kAbsolute("(?:^|[\\s`(\"'])(/[A-Za-z][\\w.-]*/[^\\s`)\"']*)"), kUp("[^\"./\\w]((?:\\.\\./)+)"),
        kSomebody("\\b(?:an?|another|our) (?:test|review)er\\b");
    for (const fs::path& page : pages()) {
        const std::string text = text_of(page);
        for (std::sregex_iterator it(text.begin(), text.end(), kAbsolute), end; it != end; ++it) {
            const std::string place = (*it)[1];
            EXPECT_TRUE(std::ranges::any_of(kInstalled, [&](const char* root) { return place.starts_with(root); }))
                << page << " says " << place;
        }
        const fs::path within = page.lexically_relative(kRoot);
        const auto depth = std::distance(within.begin(), within.end());
        for (std::sregex_iterator it(text.begin(), text.end(), kUp), end; it != end; ++it)
            EXPECT_LT((*it)[1].length() / 3, depth) << page << " leads out of the checkout";
        std::smatch said;
        EXPECT_FALSE(std::regex_search(text, said, kSomebody)) << page << " says " << said.str();
    }
}

}  // namespace
}  // namespace planlight::test
