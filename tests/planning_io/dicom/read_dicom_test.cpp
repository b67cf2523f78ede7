#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "planning_io/dicom/dicom_slices.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// 20 slices of 1.5 mm with a gantry tilted by `shear` mm in y for each slice.
std::vector<DicomSlice> a_stack(double shear_mm = 0) {
    std::vector<DicomSlice> slices;
    for (int k = 0; k < 20; ++k) {
        DicomSlice& slice = slices.emplace_back();
        slice.file = "slice" + std::to_string(k);
        slice.position_in_ct = {-100, -120 + shear_mm * k, 7 + 1.5 * k};
        slice.row_direction = Vector3d::UnitX();
        slice.column_direction = Vector3d::UnitY();
        slice.column_spacing_mm = 0.5;
        slice.row_spacing_mm = 0.6;
        slice.columns = 512;
        slice.rows = 400;
    }
    return slices;
}

std::string problem(const std::vector<DicomSlice>& slices) {
    const auto fault = fault_of(slices);
    return fault ? fault->problem : "";
}

TEST(DicomSlices, AnEvenStackInAnyOrderIsAVolumeAndATiltIsKept) {
    auto slices = a_stack();
    std::reverse(slices.begin() + 3, slices.end());
    EXPECT_EQ(problem(slices), "");
    EXPECT_EQ(problem(a_stack(0.4)), "");
    const Eigen::Affine3d ct_from_voxel = ct_from_voxel_of(a_stack(0.4));
    EXPECT_LT((ct_from_voxel * Vector3d(10, 20, 5) - Vector3d(-100 + 5, -120 + 12 + 2, 7 + 7.5)).norm(), 1e-9);
}

TEST(DicomSlices, CopiesInTwoFoldersAreCalledSo) {
    auto slices = a_stack();
    slices.push_back(slices[7]);
    EXPECT_EQ(problem(slices), "two files named slice7 lie at the same place (double slice)");
    slices.back().file = "another";
    EXPECT_NE(problem(slices).find("another and slice7 lie at the same place"), std::string::npos) << problem(slices);
}

// The gantry's angle stands in the header, and in the slices' places unless it was lost on the way.
TEST(DicomSeries, ATiltThatTheHeaderSaysAndTheSlicesDoNotIsSaid) {
    const test::TemporaryFolder folder;
    for (const auto& [tilt_deg, said] : {std::pair{"0", false}, {"0.5", false}, {"-8", true}, {"8", true}}) {
        const fs::path into = folder.path() / tilt_deg;
        fs::create_directories(into);
        auto objects = test::synthetic_series({});  // they stand straight
        for (auto& object : objects) object.text(0x00181120, "DS", tilt_deg);
        test::write_series(objects, into);
        std::string notes;
        for (const std::string& note : read_volume(into).notes) notes += note;
        EXPECT_EQ(
            notes.find("the gantry was tilted by 8.0 degrees, and the slices stand tilted by 0.0") != std::string::npos,
            said)
            << tilt_deg << ": " << notes;
    }
}

// As a viewer's "thick slab" makes them: each is a mean over what lies around it.
TEST(DicomSeries, SlicesThatOverlapByMoreThanHalfBlurTheSkin) {
    const test::TemporaryFolder folder;
    for (const auto& [thick_mm, said] : {std::pair{"4.0", false}, {"8.0", false}, {"10.0", true}}) {
        const fs::path into = folder.path() / thick_mm;
        fs::create_directories(into);
        auto objects = test::synthetic_series({});  // 4 mm apart
        for (auto& object : objects) object.text(0x00180050, "DS", thick_mm);
        test::write_series(objects, into);
        std::string notes;
        for (const std::string& note : read_volume(into).notes) notes += note;
        EXPECT_EQ(notes.find("the skin is blurred") != std::string::npos, said) << thick_mm << ": " << notes;
    }
}

// "0.999\0.042\0.000": of length 0.9999.
TEST(DicomSeries, DirectionsOfThreeDecimalsAreMadeWhole) {
    const test::TemporaryFolder folder;
    auto objects = test::synthetic_series({});
    for (auto& object : objects) object.text(0x00200037, "DS", "0.999\\0.042\\0.000\\-0.042\\0.999\\0.001");
    test::write_series(objects, folder.path());
    const Volume volume = read_volume(folder.path());
    const Eigen::Matrix3d axes = volume.ct_from_voxel.linear().colwise().normalized();
    EXPECT_NEAR(volume.spacing_mm().x(), 3, 1e-12);
    EXPECT_NEAR(volume.spacing_mm().y(), 3, 1e-12);
    EXPECT_NEAR(axes.col(0).dot(axes.col(1)), 0, 1e-12);
    EXPECT_NEAR(axes(1, 0), 0.042, 1e-3);
    EXPECT_TRUE(std::ranges::any_of(
        volume.notes, [](const std::string& note) { return note.find("in few digits (off by") != std::string::npos; }));
    auto slices = a_stack();
    for (auto& slice : slices) slice.row_direction = {1 - 9e-5, 0, 0};
    EXPECT_EQ(ct_from_voxel_of(slices).linear()(0, 0), 0.5 * (1 - 9e-5)) << "taken as it is written";
    for (auto& slice : slices) slice.row_direction = {1 - 1.1e-3, 0, 0};
    EXPECT_NE(problem(slices).find("not of length 1"), std::string::npos);
}

TEST(DicomSeries, ThinSlicesThatAreMeantForProjectionsAreNone) {
    const test::TemporaryFolder folder;
    for (const char* words : {"Head 0.6 for MIP", "HELMIP", "Head thin"}) {
        const fs::path into = folder.path() / words;
        fs::create_directories(into);
        test::write_series(test::synthetic_series({}, {.description = words}), into);
        EXPECT_NO_THROW(read_volume(into)) << words;
    }
}

TEST(DicomSeries, WhoseItIsIsToldAndNotKept) {
    const test::TemporaryFolder folder;
    test::write_series(test::synthetic_series({}), folder.path());
    SeriesIdentity identity;
    const Volume volume = read_volume(folder.path(), {}, SliceGaps::refused, &identity);
    EXPECT_EQ(identity.patient_hash, content_hash("PHANTOM-1"));
    EXPECT_EQ(identity.series_uid, "1.2.826.0.1.3680043.9.9999.7.1");
    EXPECT_EQ(volume.source, "DICOM series " + identity.series_uid);
}

/// A cylinder along z whose values rise by 5 HU a mm, cut at these heights: joined linearly its cuts give it back.
void write_ramp(const std::vector<double>& heights_mm, const fs::path& into) {
    auto objects = test::synthetic_series({});
    for (std::size_t k = 0; k < objects.size(); ++k) {
        objects[k].decimals(0x00200032, {-94.5, -97, heights_mm[k]});
        std::vector<std::int16_t> stored(64 * 64, 24);
        for (int at = 0; at < 64 * 64; ++at)
            if (std::hypot(at % 64 - 31.5, at / 64 - 31.5) < 20)
                stored[static_cast<std::size_t>(at)] = static_cast<std::int16_t>(std::lround(1024 + 5 * heights_mm[k]));
        objects[k].pixels(stored);
    }
    fs::create_directories(into);
    test::write_series(objects, into);
}

// A pixel is rounded to 1 HU; slices that are even enough without the option may lie 0.08 mm off, 0.4 HU.
TEST(DicomSeries, UnevenSlicesAreLaidWhereTheyLieHoweverLittleTheirStepsDiffer) {
    const test::TemporaryFolder folder;
    for (const double upper_step_mm : {4.01, 4.05, 4.1, 4.2, 5.0, 7.0}) {
        std::vector<double> heights_mm;
        for (int k = 0; k < 24; ++k)
            heights_mm.push_back(-46 + 4.0 * std::min(k, 12) + upper_step_mm * std::max(0, k - 12));
        const fs::path into = folder.path() / std::to_string(upper_step_mm);
        write_ramp(heights_mm, into);
        const Volume volume = read_volume(into, {}, SliceGaps::resampled);
        double worst_hu = 0;
        for (int k = 0; k < volume.size[2]; ++k) {
            const double z_mm = (volume.ct_from_voxel * Vector3d(32, 32, k)).z();
            worst_hu = std::max(worst_hu, std::abs(volume.at(32, 32, k) - 5 * z_mm));
        }
        EXPECT_LT(worst_hu, 1) << "steps of 4 and " << upper_step_mm << " mm, " << volume.size[2] << " slices";
        EXPECT_NEAR((volume.ct_from_voxel * Vector3d(0, 0, volume.size[2] - 1)).z(), heights_mm.back(), 1e-6);
        EXPECT_NEAR(volume.widest_gap_mm, upper_step_mm > 4.02 ? upper_step_mm : 0, 1e-6);
        if (upper_step_mm > 4.02) {
            EXPECT_THROW(read_volume(into), InputError) << upper_step_mm;
        }
    }
}

class DicomFolder : public ::testing::Test {
protected:
    /// A copy of a third-party series that may be spoilt; skips without it.
    bool copy(const char* name) {
        const auto series = test::third_party_data(name);
        if (!series) return false;
        for (const auto& entry : fs::directory_iterator(*series)) {
            if (!entry.is_regular_file()) continue;
            const fs::path copy = folder_.path() / entry.path().filename();
            fs::copy_file(entry.path(), copy);
            fs::permissions(copy, fs::perms::owner_all);
            if (fs::file_size(copy) > 100000) files_.push_back(copy);
        }
        std::sort(files_.begin(), files_.end());
        return true;
    }
    test::TemporaryFolder folder_;
    std::vector<fs::path> files_;
};

TEST_F(DicomFolder, PhantomWithoutTiltIsHuAndRightHanded) {
    if (!copy("ct/philips_skull_phantom/plain_5mm")) GTEST_SKIP() << "the phantom is not here";
    const Volume volume = read_volume(folder_.path());
    EXPECT_EQ(volume.modality, "CT");
    EXPECT_TRUE(volume.is_hu);
    EXPECT_GT(volume.ct_from_voxel.linear().determinant(), 0);
    EXPECT_NEAR(volume.spacing_mm().z(), 5, 0.01);
    EXPECT_LE(*std::min_element(volume.values.begin(), volume.values.end()), -900) << "air";
    EXPECT_FALSE(volume.frame_of_reference_uid.empty());
    EXPECT_EQ(hash_of(read_volume(files_.front())), hash_of(volume)) << "any file of the series stands for it";
}

TEST_F(DicomFolder, AMissingADoubleAndACutSliceAreRefused) {
    if (!copy("ct/philips_skull_phantom/plain_5mm")) GTEST_SKIP() << "the phantom is not here";
    ASSERT_GT(files_.size(), 18u);
    const fs::path middle = files_[files_.size() / 2];
    const std::string whole = read_whole(middle);
    EXPECT_NO_THROW(read_volume(folder_.path()));
    fs::remove(middle);
    EXPECT_THROW(read_volume(folder_.path()), InputError);
    write_safely(middle, whole);
    write_safely(folder_.path() / "again", whole);
    EXPECT_THROW(read_volume(folder_.path()), InputError);
    fs::remove(folder_.path() / "again");
    for (const double part : {0.004, 0.3, 0.95}) {
        write_safely(middle, whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
        EXPECT_THROW(read_volume(folder_.path()), Error) << "cut at " << part;
    }
}

TEST(DicomThirdParty, GantryTiltIsKeptAsShear) {
    const auto series = test::third_party_data("ct/philips_skull_phantom/tilt_minus18p5");
    if (!series) GTEST_SKIP() << "the phantom is not here";
    const Volume volume = read_volume(*series);
    const Eigen::Matrix3d axes = volume.ct_from_voxel.linear().colwise().normalized();
    const double tilt_deg = std::acos(axes.col(0).cross(axes.col(1)).dot(axes.col(2))) * 180 / 3.14159265358979;
    EXPECT_NEAR(tilt_deg, 18.5, 0.1);  // the gantry's angle as the scanner wrote it
    EXPECT_GT(volume.ct_from_voxel.linear().determinant(), 0);
}

TEST(DicomThirdParty, StoredValuesWithoutAnOffsetAreNotCalledHu) {
    const auto series = test::third_party_data("ct/slicer_cthead_dicom");
    if (!series) GTEST_SKIP() << "the series is not here";
    const Volume volume = read_volume(*series);
    EXPECT_EQ(volume.modality, "CT");
    EXPECT_FALSE(volume.is_hu);
    EXPECT_GT(volume.ct_from_voxel.linear().determinant(), 0);
}

TEST(DicomThirdParty, BadFilesAreRefusedInWordsAndNeverCrashUs) {
    const auto folder = test::third_party_data("dicom_bad/single_files");
    if (!folder) GTEST_SKIP() << "the bad files are not here";
    int read = 0, refused = 0;
    for (const auto& entry : fs::directory_iterator(*folder)) {
        if (!entry.is_regular_file() || refused > 25) continue;
        const test::TemporaryFolder alone;
        const fs::path file = alone.path() / entry.path().filename();
        fs::copy_file(entry.path(), file);
        try {
            read_volume(file);
            ++read;
        } catch (const Error& e) {
            ++refused;
            EXPECT_FALSE(e.remedy.empty()) << entry.path();
        }
    }
    EXPECT_EQ(read, 0) << "a single picture is no volume";
    EXPECT_GT(refused, 10);
}

/// Fat answers 3.4 ppm lower than water: at 127.7 MHz 434 Hz.
struct Readout {
    std::string phase_along = "ROW", options = {}, bandwidth_hz = "200";
    std::uint16_t readings = 32;  ///< half as many as pixels: what was measured is twice as large as a pixel
};

Vector3d fat_shift_with(const Readout& readout) {
    const test::TemporaryFolder folder;
    test::SeriesLook look;
    look.modality = "MR";
    const test::Grid grid = test::turned_grid(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()).toRotationMatrix());
    auto objects = test::synthetic_series(grid, look);
    for (auto& object : objects) {
        object.text(0x00180022, "CS", readout.options);
        object.decimals(0x00180084, {127.7});
        object.text(0x00180095, "DS", readout.bandwidth_hz);
        object.text(0x00181312, "CS", readout.phase_along);
        const char low = static_cast<char>(readout.readings & 0xFF), high = static_cast<char>(readout.readings >> 8);
        object.elements[0x00181310] = {"US", {low, high, 0, 0, 0, 0, low, high}, {}, {}};
    }
    test::write_series(objects, folder.path());
    return read_volume(folder.path()).fat_shift_in_ct;
}

TEST(MrDicom, SaysHowFarFatLiesAsideAlongTheReadout) {
    const Vector3d along_rows(std::cos(0.3), std::sin(0.3), 0), along_columns(-std::sin(0.3), std::cos(0.3), 0);
    constexpr double kShift_mm = 3.4 * 127.7 / 200 * 6;
    EXPECT_LT((fat_shift_with({}) - kShift_mm * along_columns).norm(), 1e-3)
        << "phase along rows: columns are read out";
    EXPECT_LT((fat_shift_with({.phase_along = "COL"}) - kShift_mm * along_rows).norm(), 1e-3);
    EXPECT_LT((fat_shift_with({.readings = 0}) - kShift_mm / 2 * along_columns).norm(), 1e-3) << "of a pixel as drawn";
}

TEST(MrDicom, SaysNothingOfFatWhereItIsSuppressedOrNotTold) {
    EXPECT_EQ(fat_shift_with({.options = "PFP\\FS"}), Vector3d::Zero());
    EXPECT_EQ(fat_shift_with({.bandwidth_hz = ""}), Vector3d::Zero());
    EXPECT_EQ(fat_shift_with({.bandwidth_hz = "0"}), Vector3d::Zero());
    EXPECT_EQ(fat_shift_with({.bandwidth_hz = "31.25"}), Vector3d::Zero()) << "kHz of the whole picture";
    EXPECT_EQ(fat_shift_with({.phase_along = "OTHER"}), Vector3d::Zero());
}

/// Frames are looked up one by one: the work must grow with their number, not with its square, or the child's limit is
/// met.
TEST(EnhancedDicom, SixHundredFramesAreWithinTheChildsLimits) {
    const test::TemporaryFolder folder;
    test::Grid grid;
    grid.size[2] = 600;
    grid.ct_from_voxel.linear().col(2) *= 24.0 / 600;
    test::write_series({test::enhanced_object(grid)}, folder.path());
    const Volume volume = read_volume(folder.path());
    EXPECT_EQ(volume.size[2], 600);
    EXPECT_NEAR(volume.spacing_mm().z(), 0.16, 1e-6);
}

TEST(DicomRefusals, AFolderWithoutDicomIsRefused) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(read_volume(folder.path()), InputError);
    write_safely(folder.path() / "notes.txt", "nothing");
    EXPECT_THROW(read_volume(folder.path()), InputError);
    EXPECT_THROW(read_volume(folder.path() / "notes.txt"), InputError);
}

}  // namespace
}  // namespace planlight
