#include <gtest/gtest.h>

#include <filesystem>

#include "planning_io/case/case_folder.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

Case a_case() {
    Case made;
    made.volume_hash = "0123456789abcdef0123456789abcdef";
    made.skin = test::analytic_head_mesh(10);
    made.lut = test::analytic_head_lut(10, 20);
    made.lut.volume_hash = made.volume_hash;
    made.lut.mesh_hash = hash_of(made.skin);
    made.plan.trajectories.push_back({"T", {1, 2, 3}, {4, 5, 6}, 0, std::nullopt});
    made.plan_hash = hash_of(made.plan);
    made.code = code_of(made.volume_hash, made.plan_hash);
    return made;
}

std::string refusal(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& e) {
        EXPECT_FALSE(e.remedy.empty());
        return std::string(e.what()) + ". " + e.remedy;
    }
    return "";
}

#define EXPECT_SAYS(sentence, words) EXPECT_NE((sentence).find(words), std::string::npos) << (sentence)

class CaseFolderTest : public ::testing::Test {
protected:
    fs::path in(const std::string& name) const { return folder_.path() / name; }
    std::size_t things_there() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
    }
    test::TemporaryFolder folder_;
};

TEST_F(CaseFolderTest, TheReportIsCommittedWithTheCaseAndUnderItsChecksums) {
    write_case(a_case(), in("case"), false, [](const fs::path& into) { write_safely(into / "report.html", "<p>"); });
    EXPECT_NE(read_whole(in("case") / "checksums.xxh128").find("  report.html\n"), std::string::npos);
    EXPECT_NO_THROW(read_case(in("case")));
    write_safely(in("case") / "report.html", "<p>another</p>");
    EXPECT_SAYS(refusal([&] { read_case(in("case")); }), "report.html: is not the file that was prepared");
    fs::remove(in("case") / "report.html");
    EXPECT_SAYS(refusal([&] { read_case(in("case")); }), "report.html: is missing");
}

TEST_F(CaseFolderTest, AReportThatFailsLeavesNoCase) {
    EXPECT_THROW(write_case(a_case(), in("case"), false, [](const fs::path&) { throw std::runtime_error("no"); }),
                 std::runtime_error);
    EXPECT_EQ(things_there(), 0U);
}

TEST_F(CaseFolderTest, AFolderWithFilesThatAreNotTheCasesIsNotReplaced) {
    write_case(a_case(), in("case"));
    write_safely(in("case") / "notes of the ward.txt", "mine");
    const std::string said = refusal([&] { write_case(a_case(), in("case"), true); });
    EXPECT_SAYS(said, "notes of the ward.txt");
    EXPECT_SAYS(said, "would be lost");
    EXPECT_EQ(said.find("--replace"), std::string::npos) << "it was given: " << said;
    EXPECT_EQ(read_whole(in("case") / "notes of the ward.txt"), "mine");
    fs::remove(in("case") / "notes of the ward.txt");
    EXPECT_NO_THROW(write_case(a_case(), in("case"), true));
}

TEST_F(CaseFolderTest, AReportAsPdfIsOfTheCaseThatItWasWrittenWith) {
    const auto with_pdf = [](const fs::path& into) { write_safely(into / "for the file.pdf", "%PDF"); };
    write_case(a_case(), in("case"), false, with_pdf);
    EXPECT_NO_THROW(write_case(a_case(), in("case"), true, with_pdf));
    write_safely(in("case") / "another.pdf", "%PDF");
    const std::string said = refusal([&] { write_case(a_case(), in("case"), true, with_pdf); });
    EXPECT_SAYS(said, "another.pdf");
    EXPECT_EQ(said.find("for the file.pdf"), std::string::npos) << said;
}

TEST_F(CaseFolderTest, RefusalsSpeakOfWhatIsThere) {
    write_case(a_case(), in("case"));
    EXPECT_SAYS(refusal([&] { check_case_place(in("case"), false); }), "holds a case already");
    fs::create_directories(in("photos"));
    write_safely(in("photos") / "case.json", "{\"format\": \"somebody else's\"}");
    EXPECT_SAYS(refusal([&] { check_case_place(in("photos"), true); }),
                "holds no case: --replace replaces nothing else");
    EXPECT_SAYS(refusal([&] { check_case_place(in("photos"), false); }), "is not empty");
    EXPECT_SAYS(refusal([&] { check_case_place(in("case") / "case.json", true); }), "is a file");
    fs::create_directory_symlink(in("gone"), in("link"));
    EXPECT_SAYS(refusal([&] { check_case_place(in("link"), false); }), "is a link to a folder that is not there");
    EXPECT_EQ(refusal([&] { check_case_place(in("new"), false); }), "");
    EXPECT_FALSE(fs::exists(in("new"))) << "asking makes nothing";
}

TEST_F(CaseFolderTest, ALinkToAnEmptyFolderOrToACaseIsFollowed) {
    fs::create_directories(in("disk") / "there");
    fs::create_directory_symlink(in("disk") / "there", in("link"));
    write_case(a_case(), in("link"));
    EXPECT_TRUE(fs::is_symlink(in("link")));
    EXPECT_TRUE(fs::exists(in("disk") / "there" / "case.json"));
    EXPECT_NO_THROW(read_case(in("link")));
    EXPECT_NO_THROW(write_case(a_case(), in("link"), true));
    EXPECT_TRUE(fs::is_symlink(in("link")));
}

TEST_F(CaseFolderTest, TwoPlansOfOnePatientHaveTwoCodesAndTitles) {
    Case one = a_case(), other = a_case();
    other.plan.trajectories[0].target_in_ct.x() += 0.001;
    other.plan_hash = hash_of(other.plan);
    other.code = code_of(other.volume_hash, other.plan_hash);
    EXPECT_NE(one.code, other.code);
    EXPECT_EQ(one.code.substr(0, 8), other.code.substr(0, 8)) << "of one volume";
    EXPECT_NE(title_of(one), title_of(other));
    one.names = {"", "E. M.", "frontal defect", "2", "Head thin", "2025-02-01"};
    EXPECT_EQ(title_of(one), "E. M., frontal defect, version 2");
    write_case(one, in("case"));
    const Case back = read_case(in("case"));
    EXPECT_EQ(title_of(back), title_of(one));
    EXPECT_EQ(back.names.series, "Head thin");
    EXPECT_EQ(back.names.series_date, "2025-02-01");
    EXPECT_EQ(back.plan_hash, one.plan_hash);
}

RiskStructure a_nerve(const std::string& name) {
    return {name,
            {{{0, 0, 0.1}, {10, 0, 0}, {0, 10, 0}, {0, 0, 1.0 / 3}},
             {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}},
             {},
             {},
             {}}};
}

TEST_F(CaseFolderTest, RiskStructuresComeBackAsTheyWereAndCountForThePlansCode) {
    const Case without = a_case();
    Case with = a_case();
    with.plan.risk_structures = {a_nerve("Facial nerve"), a_nerve("Dura")};
    with.plan.risk_structures[1].surface.vertices_in_ct[0].x() = 0.25;
    with.plan_hash = hash_of(with.plan);
    EXPECT_NE(with.plan_hash, without.plan_hash) << "what is lit beside the items differs";
    write_case(with, in("case"));
    const Case back = read_case(in("case"));
    ASSERT_EQ(back.plan.risk_structures.size(), 2U);
    EXPECT_EQ(back.plan.risk_structures[0].name, "Facial nerve");
    EXPECT_EQ(hash_of(back.plan.risk_structures[1].surface), hash_of(with.plan.risk_structures[1].surface));
    EXPECT_EQ(hash_of(back.plan), with.plan_hash);
    EXPECT_NO_THROW(write_case(without, in("case"), true)) << "they are the case's own files";
    EXPECT_FALSE(fs::exists(in("case") / "risk-1.ply"));
    EXPECT_TRUE(read_case(in("case")).plan.risk_structures.empty());
    write_safely(in("case") / "risk-notes.ply", "mine");
    EXPECT_SAYS(refusal([&] { write_case(without, in("case"), true); }), "risk-notes.ply");
}

TEST_F(CaseFolderTest, ARiskStructureThatWasChangedOrTakenAwayIsNoticed) {
    Case with = a_case();
    with.plan.risk_structures = {a_nerve("Facial nerve")};
    write_case(with, in("case"));
    const fs::path file = in("case") / "risk-1.ply";
    const std::string whole = read_whole(file);
    std::string flipped = whole;
    flipped[flipped.size() - 20] = static_cast<char>(flipped[flipped.size() - 20] ^ 1);
    write_safely(file, flipped);
    EXPECT_SAYS(refusal([&] { read_case(in("case")); }), "risk-1.ply: is not the file that was prepared");
    fs::remove(file);
    EXPECT_SAYS(refusal([&] { read_case(in("case")); }), "risk-1.ply: is missing");
}

TEST_F(CaseFolderTest, ACaseOfBeforeRiskStructuresIsRead) {
    write_case(a_case(), in("case"));
    std::string manifest = read_whole(in("case") / "case.json");
    const auto from = manifest.find("\"risk_structures\""), to = manifest.find(']', from);
    ASSERT_NE(from, std::string::npos);
    manifest.erase(from, manifest.find('"', to) - from);
    write_safely(in("case") / "case.json", manifest);
    std::string sums = read_whole(in("case") / "checksums.xxh128");
    const auto line = sums.find("  case.json");
    sums.replace(line - 32, 32, content_hash(manifest));
    write_safely(in("case") / "checksums.xxh128", sums);
    EXPECT_TRUE(read_case(in("case")).plan.risk_structures.empty());
}

TEST_F(CaseFolderTest, ANameThatCannotBeReadIsRefusedWithItsLimit) {
    CaseNames names;
    for (int i = 0; i < 80; ++i) names.patient += "Ø";
    EXPECT_NO_THROW(check_case_names(names)) << "eighty characters, of two bytes each";
    names.patient += "x";
    EXPECT_SAYS(refusal([&] { check_case_names(names); }), "81 characters, more than 80");
    names.patient = "a\nb";
    EXPECT_SAYS(refusal([&] { check_case_names(names); }), "control characters");
    for (const char* bad : {"\xff", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80", "end \xe2\x82"}) {
        names.patient = bad;
        EXPECT_SAYS(refusal([&] { check_case_names(names); }), "no UTF-8");
        EXPECT_NO_THROW(check_case_names({{}, fit_to_be_a_name(bad), {}, {}, {}, {}})) << bad;
    }
    EXPECT_NO_THROW(check_case_names({{}, fit_to_be_a_name(std::string(600, 'n')), {}, {}, {}, {}}));
    EXPECT_EQ(without_control_characters("M\xc3\xbcller\x1b[2J\xc2\x9b"
                                         "1A"),
              "M\xc3\xbcller?[2J?1A")
        << "C0 and C1";
}

}  // namespace
}  // namespace planlight
