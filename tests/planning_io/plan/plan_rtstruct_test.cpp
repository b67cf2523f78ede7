#include <gtest/gtest.h>

#include <cstdlib>

#include "planning_io/files/content_hash.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_rtstruct.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/plan_facts.h"
#include "tests/planning_io/rt_struct_bytes.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

const fs::path kData = fs::path(PLANLIGHT_SOURCE_DIR) / "tests" / "data" / "plans";
const RtStructIdentity kIdentity{"a1b2c3d4", "1.2.826.0.1.3680043.8.498.7", "2026-11-21T14:30:00Z"};
const PlanImportSettings kSameCt{{}, kIdentity.frame_of_reference_uid};

std::string refusal(const fs::path& file, const PlanImportSettings& settings) {
    try {
        import_plan(file, settings);
    } catch (const Error& e) {
        return std::string(e.what()) + " " + e.remedy;
    }
    return {};
}

/// A plan whose names DICOM can hold: not empty, at most 64 characters, no backslash.
Plan dicom_plan(unsigned seed) {
    Plan plan = test::random_plan(seed);
    int number = 0;
    const auto rename = [&](auto& items) {
        for (auto& item : items) item.name = "item ä " + std::to_string(++number);
    };
    rename(plan.trajectories);
    rename(plan.boreholes);
    rename(plan.osteotomy_lines);
    rename(plan.cut_planes);
    return plan;
}

TEST(PlanRtStruct, RandomPlansComeBackToTheDigitsThatDicomHas) {
    const test::TemporaryFolder folder;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        const Plan plan = dicom_plan(seed);
        write_plan_rtstruct(plan, kIdentity, folder.path() / "plan.dcm");
        const PlanImport read = import_plan(folder.path() / "plan.dcm", kSameCt);
        EXPECT_TRUE(read.notes.empty());
        EXPECT_EQ(read.frame_of_reference_uid, kIdentity.frame_of_reference_uid);
        test::expect_same(plan, read.plan, 1e-9, 0.5 / 255 + 1e-6);  // 16 characters a number, a byte a colour
        if (testing::Test::HasFailure()) FAIL() << "seed " << seed;
    }
}

TEST(PlanRtStruct, AnotherFrameOfReferenceIsRefusedWithBothNames) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "plan.dcm";
    write_plan_rtstruct(dicom_plan(1), kIdentity, file);
    const std::string other = refusal(file, {{}, "1.2.3"});
    EXPECT_NE(other.find(kIdentity.frame_of_reference_uid), std::string::npos) << other;
    EXPECT_NE(other.find("1.2.3"), std::string::npos) << other;
    EXPECT_NE(refusal(file, {{}, ""}).find("--accept-frame " + kIdentity.frame_of_reference_uid), std::string::npos);
    EXPECT_NE(refusal(file, {Space::ras, kIdentity.frame_of_reference_uid}).find("always LPS"), std::string::npos);
    const PlanImport unchecked = import_plan(file);
    ASSERT_EQ(unchecked.notes.size(), 1U);
    EXPECT_NE(unchecked.notes[0].find("not checked"), std::string::npos);
    EXPECT_THROW(write_plan_rtstruct(dicom_plan(1), {"code", "", ""}, folder.path() / "none.dcm"), InputError);
    EXPECT_FALSE(fs::exists(folder.path() / "none.dcm"));
}

TEST(PlanRtStruct, AnAcceptedFrameOfReferenceStandsBesideTheVolumesAndIsSaid) {
    const test::TemporaryFolder folder;
    const fs::path of_ct = folder.path() / "a.dcm", accepted = folder.path() / "b.dcm";
    write_plan_rtstruct(dicom_plan(1), {"code", "1.2.3", "2026-11-21T14:30:00Z"}, of_ct);
    write_plan_rtstruct(dicom_plan(2), kIdentity, accepted);
    PlanImportSettings settings{{}, "1.2.3", kIdentity.frame_of_reference_uid};
    EXPECT_TRUE(import_plan(of_ct, settings).notes.empty()) << "what is the volume's needs nobody's word";
    const PlanImport read = import_plan(accepted, settings);
    ASSERT_EQ(read.notes.size(), 1U);
    EXPECT_NE(read.notes[0].find("nothing but --accept-frame says"), std::string::npos) << read.notes[0];
    EXPECT_NE(read.notes[0].find("names another"), std::string::npos) << read.notes[0];
    EXPECT_EQ(read.frame_of_reference_uid, "1.2.3");
    EXPECT_EQ(import_plan(folder.path(), settings).notes.size(), 1U) << "both are one plan";
    settings.accepted_frame_uid = "9.9";
    EXPECT_NE(refusal(accepted, settings).find("the volume in 1.2.3"), std::string::npos);
    settings = {{}, "", kIdentity.frame_of_reference_uid};
    ASSERT_EQ(import_plan(accepted, settings).notes.size(), 1U);
    EXPECT_NE(import_plan(accepted, settings).notes[0].find("names none"), std::string::npos);
    EXPECT_FALSE(refusal(of_ct, settings).empty());
    settings = {{}, std::nullopt, "9.9"};
    EXPECT_NE(refusal(accepted, settings).find("not in 9.9"), std::string::npos);
}

TEST(PlanRtStruct, ACutOrFlippedFileNeverCrashesTheProgramAndACutOneIsRefused) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "plan.dcm";
    write_plan_rtstruct(dicom_plan(5), kIdentity, file);
    const std::string whole = read_whole(file);
    for (std::size_t part = 1; part < 40; ++part) {
        write_safely(folder.path() / "cut.dcm", whole.substr(0, whole.size() * part / 40));
        EXPECT_FALSE(refusal(folder.path() / "cut.dcm", kSameCt).empty()) << part;
    }
    write_safely(folder.path() / "long.dcm", whole + whole.substr(400, 9));
    EXPECT_FALSE(refusal(folder.path() / "long.dcm", kSameCt).empty());
    for (std::size_t i = 140; i < whole.size(); i += whole.size() / 60) {
        std::string flipped = whole;
        flipped[i] = static_cast<char>(flipped[i] ^ 0x24);
        write_safely(folder.path() / "flipped.dcm", flipped);
        EXPECT_NO_FATAL_FAILURE(
            refusal(folder.path() / "flipped.dcm", kSameCt));  // anything but another exception, or the end
    }
}

TEST(PlanRtStruct, RealFilesAreReadOrRefusedWithTheReason) {
    // The patient's contour on three slices is a solid; two points are isocentres.
    const std::string none = refusal(kData / "pydicom_rtstruct.dcm", {});
    EXPECT_NE(none.find("holds nothing to draw"), std::string::npos) << none;
    EXPECT_NE(none.find("an isocentre by its type (ISOCENTER)"), std::string::npos) << none;
    EXPECT_NE(refusal(kData / "pydicom_rtplan_truncated.dcm", {}).find("damaged or cut short"), std::string::npos);
    const auto file = test::third_party_data("plans/dicompyler_rtstruct_ct/rtss.dcm");
    if (!file) GTEST_SKIP() << "third-party plans are not here";
    const PlanImport read = import_plan(*file, {{}, "2.16.840.1.113662.2.12.0.3057.1241703565.36"});
    EXPECT_EQ(read.plan.size() + read.notes.size(), 11U);  // ten ROIs, of which one has two points or contours
    std::string notes;
    for (const auto& note : read.notes) notes += note + "\n";
    EXPECT_NE(notes.find("ROI \"Areola\" has no contours"), std::string::npos) << notes;
    EXPECT_NE(notes.find("ROI \"BODY\" has contours at 98 heights: a solid"), std::string::npos) << notes;
}

/// What others write, in the frame of reference of the CT.
PlanImport imported(const std::vector<test::WrittenRoi>& rois, const std::vector<std::string>& frames = {}) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "set.dcm";
    write_safely(file, test::rt_struct_of(rois, frames));
    return import_plan(file, {{}, "1.2.3"});
}

const std::string kLine = "12.9\\-103.9\\55.5\\22.9\\-103.7\\56";
const test::WrittenRoi kCut{"Cut", {test::contour_saying("OPEN_NONPLANAR", 2, kLine)}};

test::DicomBytes square(double z, const std::string& type = "CLOSED_PLANAR") {
    return test::closed_contour({{0, -100, z}, {8, -100, z}, {8, -92, z}, {0, -92, z}}, type);
}

TEST(PlanRtStruct, AnotherPatientIsRefusedAndAnotherSeriesSaid) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "set.dcm";
    PlanImportSettings settings{{}, "1.2.3"};
    settings.volume = {content_hash("4711"), "1.5", "1.5.1"};
    const auto notes_of = [&](const test::WrittenOf& of) {
        write_safely(file, test::rt_struct_of({kCut}, {"1.2.3"}, of));
        std::string notes;
        for (const auto& note : import_plan(file, settings).notes) notes += note + "\n";
        return notes;
    };
    EXPECT_EQ(notes_of({"4711", "1.5", "1.5.1"}), "");
    EXPECT_EQ(notes_of({" 4711 ", "1.5", "1.5.1"}), "") << "blanks are padding";
    EXPECT_EQ(notes_of({}), "") << "what is not said is not compared";
    EXPECT_EQ(notes_of({"4711", "1.5", ""}), "");
    EXPECT_EQ(notes_of({"4711", "1.7", "1.5.1"}), "") << "systems that open a study of their own";
    EXPECT_NE(notes_of({"4711", "1.5", "1.5.9"}).find("another series than the volume, in the same"),
              std::string::npos);
    EXPECT_NE(notes_of({"4711", "1.6", "1.6.1"}).find("is of another study, in the same"), std::string::npos);
    EXPECT_NE(notes_of({"4711", "1.6", ""}).find("does not say on which series"), std::string::npos);
    write_safely(file, test::rt_struct_of({kCut}, {"1.2.3"}, {"99", "1.5", "1.5.1"}));
    const std::string said = refusal(file, settings);
    EXPECT_NE(said.find("is of another patient"), std::string::npos) << said;
    EXPECT_NE(said.find("--accept-frame 1.2.3"), std::string::npos) << said;
    EXPECT_EQ(said.find("4711"), std::string::npos) << said;
    settings.accepted_frame_uid = "1.2.3";
    EXPECT_NE(notes_of({"99", "1.5", "1.5.1"}).find("nothing but --accept-frame"), std::string::npos);
    settings = {{}, "1.2.3"};
    EXPECT_EQ(notes_of({"99", "1.6", "1.6.1"}), "") << "of the volume nothing is known";
    // Our own are given the case's code as Patient ID.
    settings = {{}, kIdentity.frame_of_reference_uid};
    settings.volume = {content_hash("4711"), "1.5", "1.5.1"};
    write_plan_rtstruct(dicom_plan(1), kIdentity, file);
    EXPECT_TRUE(import_plan(file, settings).notes.empty());
}

// A decimal comma would cut each number: light a millimetre towards the scanner's middle.
TEST(PlanRtStruct, ACoordinateThatIsNoNumberIsRefusedByItsRoiAndWord) {
    ASSERT_EQ(imported({kCut}).plan.osteotomy_lines.at(0).points_in_ct.at(0), Eigen::Vector3d(12.9, -103.9, 55.5));
    for (const std::string word : {"12,9", "", "abc", "1.2 mm", "1e"}) {
        const std::string numbers = word + kLine.substr(kLine.find('\\'));
        try {
            imported({{"Cut", {test::contour_saying("OPEN_NONPLANAR", 2, numbers)}}});
            ADD_FAILURE() << "taken: " << numbers;
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find("ROI \"Cut\" has \"" + word + "\" where a number should stand"),
                      std::string::npos)
                << e.what();
        }
    }
}

// Of a plan of a radiotherapy system: markers on the skin, the isocentre and lenses are nothing to be drilled or cut.
TEST(PlanRtStruct, WhatIsNoPlanByItsTypeIsLeftOutAndSaid) {
    const test::WrittenRoi marker{"BB1", {test::contour_saying("POINT", 1, "1\\-100\\5")}, "MARKER"},
        centre{"ISO", {test::contour_saying("POINT", 1, "1\\-30\\5")}, "ISOCENTER"},
        lens{"Lens_L", {square(10), square(13)}, "ORGAN"};
    const PlanImport read = imported({kCut, marker, centre, lens});
    EXPECT_EQ(read.plan.osteotomy_lines.size(), 1U);
    EXPECT_TRUE(read.plan.boreholes.empty());
    ASSERT_EQ(read.notes.size(), 3U);
    EXPECT_NE(read.notes[0].find("ROI \"BB1\" is a marker by its type (MARKER)"), std::string::npos) << read.notes[0];
    EXPECT_NE(read.notes[1].find("an isocentre"), std::string::npos) << read.notes[1];
    EXPECT_NE(read.notes[2].find("at 2 heights: a solid"), std::string::npos) << read.notes[2];
    // A person's word goes before the type; what has none of either is drawn.
    test::WrittenRoi said = marker;
    said.description = "kind=borehole diameter_mm=7";
    EXPECT_EQ(imported({said}).plan.boreholes.at(0).diameter_mm, 7);
    EXPECT_EQ(imported({{"Hole", marker.contours}}).plan.boreholes.size(), 1U);
    EXPECT_EQ(imported({{"Two cuts", lens.contours}}).plan.osteotomy_lines.size(), 2U);
}

TEST(PlanRtStruct, ASolidWithHolesIsASolid) {
    const std::string type = "CLOSEDPLANAR_XOR";
    const PlanImport read = imported({kCut, {"Mandible", {square(10, type), square(13, type), square(16, type)}}});
    EXPECT_EQ(read.plan.osteotomy_lines.size(), 1U);
    ASSERT_EQ(read.notes.size(), 1U);
    EXPECT_NE(read.notes[0].find("at 3 heights: a solid"), std::string::npos) << read.notes[0];
}

// An MR that was registered to the CT stands in the list as well, before or behind it.
TEST(PlanRtStruct, TheFrameOfItsRoisCountsWhateverElseIsListed) {
    for (const auto& frames : {std::vector<std::string>{"1.2.3", "9.9"}, {"9.9", "1.2.3"}})
        EXPECT_EQ(imported({kCut}, frames).plan.osteotomy_lines.size(), 1U) << frames[0];
}

TEST(PlanRtStruct, DcmtkReadsWhatIsWritten) {
    if (std::system("command -v dcmdump >/dev/null 2>&1") != 0) GTEST_SKIP() << "dcmtk is not installed";
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "plan.dcm", dump = folder.path() / "dump.txt";
    const Plan plan = dicom_plan(2);
    write_plan_rtstruct(plan, kIdentity, file);
    ASSERT_EQ(std::system(("dcmdump -q '" + file.string() + "' > '" + dump.string() + "' 2>&1").c_str()), 0);
    const std::string text = read_whole(dump);
    std::size_t names = 0;
    for (auto at = text.find("ROIName"); at != std::string::npos; at = text.find("ROIName", at + 1)) ++names;
    EXPECT_EQ(names, plan.size());
    EXPECT_EQ(text.find("E: "), std::string::npos) << text.substr(0, 500);
}

}  // namespace
}  // namespace planlight
