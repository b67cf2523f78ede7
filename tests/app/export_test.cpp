// What is handed to an archive is read back by others: DCMTK, GDCM and dciodvfy.
#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <set>
#include <sstream>

#include "app/export/export_study.h"
#include "app/report/registration_certificate.h"
#include "planning_io/dicom/dicom_objects.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/app/exported_phantom.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// What is handed to an archive of the phantom's operation.
class Export : public ::testing::Test {
protected:
    static test::ExportedPhantom& world() { return test::exported_phantom(); }
    static std::string said(const std::string& command) {
        const fs::path out = world().folder.path() / "said";
        EXPECT_NE(std::system((command + " > '" + out.string() + "' 2>&1").c_str()), -1);
        std::ifstream in(out);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    static std::string uid_of(const fs::path& file) {
        gdcm::Reader reader;
        reader.SetFileName(file.c_str());
        if (!reader.Read()) return {};
        gdcm::Attribute<0x0008, 0x0018> uid;
        uid.SetFromDataSet(reader.GetFile().GetDataSet());
        return uid.GetValue();
    }
    static bool is_there(const char* program) {
        return std::system(("command -v " + std::string(program) + " >/dev/null 2>&1").c_str()) == 0;
    }
    static const fs::path& exported() {
        static const fs::path folder = [] {
            const fs::path made = world().folder.path() / "dicom";
            export_into_study(world().prepared, world().operation, world().series, {}, made);
            return made;
        }();
        return folder;
    }
};

TEST_F(Export, EveryObjectHoldsWhatTheStandardAsksOfItsKind) {
    if (!is_there("dciodvfy")) GTEST_SKIP() << "dicom3tools is not installed";
    for (const auto& file : fs::directory_iterator(exported())) {
        const std::string found = said("dciodvfy '" + file.path().string() + "'");
        EXPECT_EQ(found.find("Error"), std::string::npos) << file.path() << "\n" << found;
    }
}

TEST_F(Export, TheObjectsAreOfThePatientAndTheStudyOfThePlanningSeries) {
    if (!is_there("dcmdump")) GTEST_SKIP() << "dcmtk is not installed";
    const auto dump = [](const fs::path& file, const char* tag) {
        return said(std::string("dcmdump -q +L +P ") + tag + " '" + file.string() + "'");
    };
    const auto value = [](const std::string& line) {
        // The last: what stands in a sequence that comes before is of another object.
        const auto from = line.rfind('['), to = line.rfind(']');
        return from == std::string::npos ? std::string() : line.substr(from + 1, to - from - 1);
    };
    const fs::path slice = fs::directory_iterator(world().series)->path();
    int objects = 0;
    for (const auto& file : fs::directory_iterator(exported())) {
        ++objects;
        for (const char* tag : {"0010,0010", "0010,0020", "0020,000d"})
            EXPECT_EQ(value(dump(file.path(), tag)), value(dump(slice, tag))) << file.path() << " " << tag;
        EXPECT_NE(value(dump(file.path(), "0020,000e")), value(dump(slice, "0020,000e"))) << "a series of its own";
    }
    EXPECT_EQ(objects, 7);
    const fs::path registration = exported() / "registration.dcm";
    const std::string frames = dump(registration, "0020,0052");
    EXPECT_EQ(value(frames.substr(0, frames.find('\n'))), world().prepared.frame_of_reference_uid) << "the registered";
    // The second matrix takes the rig's points to those of the planning series.
    std::istringstream matrices(dump(registration, "3006,00c6"));
    std::string line;
    std::getline(matrices, line);
    std::getline(matrices, line);
    std::istringstream numbers(value(line));
    Eigen::Matrix4d ct_from_rig;
    for (Eigen::Index i = 0; i < 16; ++i) {
        std::string number;
        std::getline(numbers, number, '\\');
        ct_from_rig(i / 4, i % 4) = std::stod(number);
    }
    const Eigen::Matrix4d wanted = world().operation.match.patient_from_ct.inverse().matrix();
    EXPECT_LT((ct_from_rig - wanted).cwiseAbs().maxCoeff(), 1e-9) << "16 characters a number";
}

TEST_F(Export, AMatchThatNobodyConfirmedIsCalledSoInTheArchiveAndInSlicer) {
    if (!is_there("dcmdump")) GTEST_SKIP() << "dcmtk is not installed";
    ExportedOperation unsure = world().operation;
    unsure.confirmed = false;
    const fs::path root = world().folder.path();
    export_into_study(world().prepared, unsure, world().series, {}, root / "unsure");
    export_for_slicer(world().prepared, unsure, root / "unsure-slicer");
    export_for_slicer(world().prepared, world().operation, root / "sure-slicer");
    const auto series = [](const fs::path& folder) {
        return said("dcmdump -q +P 0008,103e '" + (folder / "registration.dcm").string() + "'");
    };
    EXPECT_NE(series(root / "unsure").find("NOT CONFIRMED"), std::string::npos) << series(root / "unsure");
    EXPECT_EQ(series(exported()).find("NOT CONFIRMED"), std::string::npos);
    const auto scene_says = [](const fs::path& folder) {
        std::ifstream in(folder / "scene.mrml");
        return std::string(std::istreambuf_iterator<char>(in), {}).find("NOT CONFIRMED") != std::string::npos;
    };
    EXPECT_TRUE(scene_says(root / "unsure-slicer"));
    EXPECT_FALSE(scene_says(root / "sure-slicer"));
}

TEST_F(Export, ThePdfIsOneAndThePictureHasItsPixels) {
    std::ifstream in(exported() / "report.dcm", std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    EXPECT_NE(bytes.find("%PDF-1."), std::string::npos);
    EXPECT_NE(bytes.find("%%EOF"), std::string::npos);
    gdcm::ImageReader reader;
    reader.SetFileName((exported() / "picture-5.dcm").c_str());
    ASSERT_TRUE(reader.Read());
    const gdcm::Image& image = reader.GetImage();
    ASSERT_EQ(image.GetDimension(0), 80u);
    ASSERT_EQ(image.GetDimension(1), 60u);
    std::string pixels(image.GetBufferLength(), '\0');
    ASSERT_TRUE(image.GetBuffer(pixels.data()));
    ASSERT_EQ(pixels.size(), 3u * 80 * 60);
    EXPECT_EQ(pixels.substr(0, 3), std::string("\0\xff\0", 3));
}

TEST_F(Export, WhatShowsTheLightMayShowANameInIt) {
    // Items are called by their names in the drawn ones, and in the light that cameras and projector hold.
    for (int i = 1; i <= 5; ++i) {
        gdcm::Reader reader;
        reader.SetFileName((exported() / ("picture-" + std::to_string(i) + ".dcm")).c_str());
        ASSERT_TRUE(reader.Read());
        gdcm::Attribute<0x0028, 0x0301> burned_in;
        burned_in.SetFromDataSet(reader.GetFile().GetDataSet());
        const std::string said = burned_in.GetValue();
        EXPECT_EQ(said.substr(0, said.find(' ')), "YES") << "picture " << i;
        gdcm::Attribute<0x0028, 0x0302> features;
        features.SetFromDataSet(reader.GetFile().GetDataSet());
        EXPECT_EQ(std::string(features.GetValue()).substr(0, 3), "YES") << "a face, picture " << i;
    }
}

/// Name and face are in all of it. What lay there before is as its owner wants it.
TEST_F(Export, IsItsOwnersAloneWhateverTheUmaskAndTheFolderItLiesInStaysAsItWas) {
    const auto perms = [](const fs::path& of) { return fs::status(of).permissions(); };
    for (const mode_t umask : {022, 077, 0}) {
        SCOPED_TRACE(umask);
        const fs::path parent = world().folder.path() / ("umask-" + std::to_string(umask));
        fs::create_directory(parent);
        fs::permissions(parent, fs::perms(0755));
        const mode_t was = ::umask(umask);
        export_into_study(world().prepared, world().operation, world().series, {}, parent / "dicom");
        export_for_slicer(world().prepared, world().operation, parent / "slicer");
        fs::create_directory(parent / "registrations");
        const fs::perms of_matches = perms(parent / "registrations");
        const fs::path kept =
            keep_match(world().operation.match, &*world().operation.cloud, {}, parent / "registrations");
        ::umask(was);
        for (const fs::path& folder : {parent / "dicom", parent / "slicer", kept}) {
            EXPECT_EQ(perms(folder), fs::perms(0700)) << folder;
            for (const auto& file : fs::directory_iterator(folder))
                EXPECT_EQ(perms(file.path()), fs::perms(0600)) << file;
        }
        EXPECT_EQ(perms(parent), fs::perms(0755));
        EXPECT_EQ(perms(parent / "registrations"), of_matches);
    }
}

TEST_F(Export, TheSameIsTheSameObject) {
    const fs::path again = world().folder.path() / "again";
    export_into_study(world().prepared, world().operation, world().series, {}, again);
    for (const auto& file : fs::directory_iterator(exported()))
        EXPECT_EQ(uid_of(file.path()), uid_of(again / file.path().filename())) << file.path();
    std::ifstream a(exported() / "registration.dcm", std::ios::binary), b(again / "registration.dcm", std::ios::binary);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(a), {}), std::string(std::istreambuf_iterator<char>(b), {}));
}

TEST_F(Export, OtherBytesTitleOrProgramAreAnotherObject) {
    const DicomStudy study = read_dicom_study(world().series);
    const fs::path folder = world().folder.path() / "objects";
    fs::create_directory(folder);
    DicomObjectName name{"2026-03-14T09:30:00Z", "1.0", "pictures", "Pictures", 1, 1, "the same hashes"};
    const auto picture = [&](const DicomObjectName& called, const std::string& comment, Rgb colour) {
        write_secondary_capture(study, called, comment, RgbImage(4, 4, colour), {}, folder / "picture.dcm");
        return uid_of(folder / "picture.dcm");
    };
    const auto pdf = [&](const std::string& title, const std::string& bytes) {
        write_encapsulated_pdf(study, name, title, bytes, folder / "report.dcm");
        return uid_of(folder / "report.dcm");
    };
    DicomObjectName newer = name, later = name;
    newer.program = "1.1", later.made = "2026-03-14T10:30:00Z";
    const std::vector<std::string> uids{picture(name, "a", {0, 255, 0}),
                                        picture(name, "a", {0, 254, 0}),
                                        picture(name, "b", {0, 255, 0}),
                                        picture(newer, "a", {0, 255, 0}),
                                        picture(later, "a", {0, 255, 0}),
                                        pdf("t", "%PDF-1"),
                                        pdf("t", "%PDF-2"),
                                        pdf("u", "%PDF-1")};
    EXPECT_EQ(std::set<std::string>(uids.begin(), uids.end()).size(), uids.size());
    EXPECT_EQ(picture(name, "a", {0, 255, 0}), uids[0]);
    EXPECT_EQ(pdf("t", "%PDF-1"), uids[5]);
}

TEST_F(Export, ItsTimesAreThoseOfTheClockOnTheWallAsTheScannersAre) {
    const char* was = std::getenv("TZ");
    const std::string zone = was ? was : "";
    ASSERT_EQ(setenv("TZ", "UTC-5:30", 1), 0);  // India: 5.5 h ahead
    tzset();
    const DicomObjectName name{"2026-03-14T20:30:05Z", "1.0", "pictures", "Pictures", 1, 1, "x"};
    const fs::path file = world().folder.path() / "time.dcm";
    write_secondary_capture(read_dicom_study(world().series), name, "a", RgbImage(4, 4, {1, 2, 3}), {}, file);
    was ? setenv("TZ", zone.c_str(), 1) : unsetenv("TZ");
    tzset();
    gdcm::Reader reader;
    reader.SetFileName(file.c_str());
    ASSERT_TRUE(reader.Read());
    gdcm::Attribute<0x0008, 0x0023> date;
    gdcm::Attribute<0x0008, 0x0033> time;
    date.SetFromDataSet(reader.GetFile().GetDataSet()), time.SetFromDataSet(reader.GetFile().GetDataSet());
    EXPECT_EQ(date.GetValue(), "20260315");
    EXPECT_EQ(time.GetValue(), "020005");
    EXPECT_FALSE(reader.GetFile().GetDataSet().FindDataElement(gdcm::Tag(0x0008, 0x0201)))
        << "a zone would move the study's own times, which have none";
}

// Scanners put the localizer into the series, often as its first file.
TEST_F(Export, ALocalizerThatIsTheFirstFileIsPassedOver) {
    auto slices = test::synthetic_series(test::Grid{});
    auto scout = slices[3];
    scout.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER");
    scout.decimals(0x00200037, {0, 1, 0, 0, 0, -1});
    const auto with = [&](int scouts, const char* name, bool alone) {
        std::vector<test::DicomObject> all;
        for (int i = 0; i < scouts; ++i) {
            scout.text(0x00080018, "UI", "1.2.826.0.1.3680043.9.9999.9." + std::to_string(i));
            all.push_back(scout);
        }
        if (!alone) all.insert(all.end(), slices.begin(), slices.end());
        const auto files = test::write_series(all, world().folder.path() / name);
        for (int i = 0; i < scouts; ++i)  // files are taken in the order of their names
            fs::rename(files[static_cast<std::size_t>(i)], world().folder.path() / name / ("!" + std::to_string(i)));
        return world().folder.path() / name;
    };
    const DicomStudy plain = read_dicom_study(world().series);
    for (const int scouts : {1, 20}) {
        const DicomStudy study = read_dicom_study(with(scouts, scouts == 1 ? "scout" : "scouts", false));
        EXPECT_EQ(study.image_uids, plain.image_uids);
        EXPECT_EQ(study.image_class, plain.image_class);
        EXPECT_EQ(study.series_uid, plain.series_uid);
    }
    EXPECT_THROW(read_dicom_study(with(3, "scouts-alone", true)), InputError);
}

TEST_F(Export, WithoutItsDicomSeriesItIsRefusedByName) {
    const auto refused = [](const Case& the_case, const fs::path& series, const std::string& words) {
        const fs::path out = world().folder.path() / "refused";
        try {
            export_into_study(the_case, world().operation, series, {}, out);
            ADD_FAILURE() << "it was taken; expected: " << words;
        } catch (const InputError& refusal) {
            EXPECT_NE(std::string(refusal.what()).find(words), std::string::npos) << refusal.what();
        }
        EXPECT_FALSE(fs::exists(out));
    };
    Case nifti;
    nifti.code = "1234", nifti.source = "NIfTI head.nii";
    refused(nifti, world().series, "names no DICOM frame of reference");
    refused(world().prepared, world().folder.path() / "nothing", "does not exist");
    const fs::path other = world().folder.path() / "other";
    auto slices = test::synthetic_series(test::Grid{});
    for (auto& slice : slices) slice.text(0x00200052, "UI", "1.2.3.4");
    test::write_series(slices, other);
    refused(world().prepared, other, "its frame of reference is another");
    const fs::path shifted = world().folder.path() / "shifted";
    test::Grid moved;
    moved.ct_from_voxel.pretranslate(Vector3d(0, 0, 4));
    test::write_series(test::synthetic_series(moved), shifted);
    refused(world().prepared, shifted, "its voxels are others");
}

TEST_F(Export, ASeriesWithoutAFrameOfReferenceGetsReportAndPicturesAlone) {
    const fs::path series = world().folder.path() / "frameless";
    auto slices = test::synthetic_series(test::Grid{});
    for (auto& slice : slices) slice.erase(0x00200052);
    test::write_series(slices, series);
    Case frameless = world().prepared;
    frameless.frame_of_reference_uid.clear();
    frameless.source = read_volume(series).source;
    const auto files =
        export_into_study(frameless, world().operation, series, {}, world().folder.path() / "without-a-frame");
    EXPECT_EQ(std::count(files.begin(), files.end(), "registration.dcm"), 0);
    EXPECT_EQ(std::count(files.begin(), files.end(), "report.dcm"), 1);
}

}  // namespace
}  // namespace planlight
