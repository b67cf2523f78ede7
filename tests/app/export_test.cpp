// What is handed to other systems is read back by others: DICOM by DCMTK, GDCM and dciodvfy, the scene by plain XML and
// VTK's readers, whose frames are worked out here anew.
#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUtilities.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "app/export/export_study.h"
#include "app/export/match_that_stood.h"
#include "app/prepare_case.h"
#include "planning_io/dicom/dicom_objects.h"
#include "planning_io/recording/recording_chunk.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// The phantom's series as files, its case with an item of every kind, and a match of an invented scan.
class Export : public ::testing::Test {
protected:
    struct World {
        test::TemporaryFolder folder;
        fs::path series;
        Case prepared;
        ExportedOperation operation;
    };
    static World& world() {
        static World& made = *[] {
            auto* w = new World;
            w->series = w->folder.path() / "series";
            test::write_series(test::synthetic_series(test::Grid{}), w->series);
            const Volume volume = read_volume(w->series);
            w->prepared = prepare_case(volume, plan_there(), {}, {}, "2026-01-02").prepared;
            w->operation = invented(w->prepared);
            return w;
        }();
        return made;
    }
    /// A place on the head's front.
    static Vector3d place() {
        Vector3d at{20, -96, 0};
        while (at.y() < 0 && test::phantom_hu(at) < -300) at.y() += 0.5;
        return at;
    }
    static Plan plan_there() {
        const Vector3d at = place();
        Plan plan;
        plan.boreholes.push_back({"hole \"1\" <ä>", at, Vector3d(0, 1, 0), 7, 5, {}});
        plan.osteotomy_lines.push_back({"line", {at, at + Vector3d(5, 0, 5), at + Vector3d(10, 0, 0)}, true, {}});
        plan.trajectories.push_back({"way", at, at + Vector3d(0, 30, 0), 2, {}});
        plan.cut_planes.push_back({"cut", at, Vector3d(1, 0, 0), Vector3d(0, 0, 1), 20, 10, {}});
        return plan;
    }
    static ExportedOperation invented(const Case& the_case) {
        ExportedOperation operation;
        RegistrationResult& match = operation.match;
        match.verdict = Verdict::yes;
        match.patient_from_ct = Eigen::Translation3d(12.5, -340.25, 901.125) *
                                Eigen::AngleAxisd(1.1, Vector3d(0.3, -0.8, 0.5).normalized());
        match.of_case = name_of(the_case);
        match.covariance.of_turn_and_shift.setIdentity();
        match.covariance.of_turn_and_shift *= 0.01;
        operation.made = "2026-03-14T09:30:00Z";
        operation.cloud.emplace();
        for (std::size_t i = 0; i < the_case.skin.vertices_in_ct.size(); i += 7)
            operation.cloud->points_in_rig.push_back(match.patient_from_ct * the_case.skin.vertices_in_ct[i]);
        operation.facts.emplace();
        OperationFacts& facts = *operation.facts;
        facts.head.case_code = the_case.code, facts.head.case_title = "Ä. Ö., a title";
        facts.head.began_utc = operation.made;
        facts.recording_hash = "0123";
        facts.lasted_s = 100, facts.lit_s = 60, facts.aligned_s = 50, facts.updates = 1000;
        facts.items.push_back({"hole", {{1, 60}}, 59, 0.8, {0.1, 0.2, 0.3}});
        for (int i = 0; i < 100; ++i) facts.course.push_back({static_cast<double>(i), i > 20, 0.3 + 0.01 * i});
        OperationMoment moment{30, "aligned", GrayImage(64, 48), GrayImage(64, 48), RgbImage(80, 60, {0, 255, 0})};
        moment.left.pixels[5] = 200;
        facts.moment = moment;
        return operation;
    }
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
        write_secondary_capture(study, called, comment, RgbImage(4, 4, colour), true, folder / "picture.dcm");
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
    write_secondary_capture(read_dicom_study(world().series), name, "a", RgbImage(4, 4, {1, 2, 3}), true, file);
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

/// A recording by hand: matches, and what became of them.
class Matches : public ::testing::Test {
protected:
    void event(const nlohmann::ordered_json& json) { chunks_.push_back({chunk_types::kEvent, {}, json.dump()}); }
    void scan() { event({{"what", "asked"}, {"call", "scan"}}); }
    void offered(const std::string& made) {
        KeptMatch match;
        match.registration.verdict = Verdict::yes;
        match.registration.patient_from_ct = RigidTransform::Identity();
        match.made_utc = made;
        chunks_.push_back({chunk_types::kMatch, {}, text_of(match)});
    }
    void found(const char* verdict, const std::string& made = {}) {
        event({{"what", "asked"}, {"call", "find_patient"}});
        event({{"what", "matched"}, {"verdict", verdict}});
        if (!made.empty()) offered(made);
    }
    void resume(const char* what) {
        event({{"what", "asked"}, {"call", "resume"}});
        event({{"what", what}, {"call", "resume"}, {"why", "the skin lies 3 mm off"}});
    }
    /// The moment at which the one that stood was made, or why none did.
    std::string stood() {
        const fs::path file = folder_.path() / "made.plrec";
        std::ofstream out(file, std::ios::binary);
        out << recording_header();
        for (std::size_t i = 0; i < chunks_.size(); ++i) out << chunk_bytes(chunks_[i], i);
        out.close();
        try {
            const MatchThatStood found = match_that_stood(file);
            return found.match.made_utc + (found.scanned_later ? ", scanned later" : "");
        } catch (const InputError& refusal) {
            return refusal.what();
        }
    }
    bool refused(const std::string& why) {
        const std::string said = stood();
        return said.find("no match that stood") != std::string::npos && said.find(why) != std::string::npos;
    }
    test::TemporaryFolder folder_;
    std::vector<RecordingChunk> chunks_;
};

TEST_F(Matches, WhatWasNeverUsedIsNotExported) {
    EXPECT_TRUE(refused("nobody was found"));
    offered("earlier");
    resume("refused");
    EXPECT_TRUE(refused("the skin lies 3 mm off")) << stood();
    scan();
    found("ask", "doubtful");
    EXPECT_TRUE(refused("nobody confirmed it")) << stood();
    event({{"what", "asked"}, {"call", "confirm"}});
    EXPECT_EQ(stood(), "doubtful");
    found("no");
    EXPECT_TRUE(refused("the match was refused")) << "landmarks spoke against it: " << stood();
}

TEST_F(Matches, TheLastOneThatStoodIsExported) {
    scan();
    found("yes", "first");
    EXPECT_EQ(stood(), "first");
    scan();
    EXPECT_EQ(stood(), "first, scanned later");
    found("ask", "second");
    EXPECT_EQ(stood(), "first, scanned later") << "an unconfirmed one takes nothing's place";
    offered("earlier");
    resume("refused");
    EXPECT_EQ(stood(), "first, scanned later");
    offered("earlier");
    resume("resumed");
    EXPECT_EQ(stood(), "earlier");
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

/// The folder for 3D Slicer.
class SlicerFolder : public Export {
protected:
    static const fs::path& folder() {
        static const fs::path made = [] {
            const fs::path to = world().folder.path() / "slicer";
            export_for_slicer(world().prepared, world().operation, to);
            return to;
        }();
        return made;
    }
    static vtkSmartPointer<vtkXMLDataElement> scene() {
        auto root = vtkSmartPointer<vtkXMLDataElement>::Take(
            vtkXMLUtilities::ReadElementFromFile((folder() / "scene.mrml").c_str()));
        EXPECT_NE(root, nullptr);
        return root;
    }
    static vtkXMLDataElement* by_id(vtkXMLDataElement* root, const std::string& id) {
        for (int i = 0; i < root->GetNumberOfNestedElements(); ++i)
            if (id == root->GetNestedElement(i)->GetAttribute("id")) return root->GetNestedElement(i);
        return nullptr;
    }
    static vtkSmartPointer<vtkPolyData> model(const char* file) {
        vtkNew<vtkXMLPolyDataReader> reader;
        reader->SetFileName((folder() / file).c_str());
        reader->Update();
        EXPECT_EQ(
            vtkStringArray::SafeDownCast(reader->GetOutput()->GetFieldData()->GetAbstractArray("SPACE"))->GetValue(0),
            "LPS")
            << file;
        return reader->GetOutput();
    }
    static Vector3d ras(const Vector3d& lps) { return {-lps.x(), -lps.y(), lps.z()}; }
};

TEST_F(SlicerFolder, EveryReferenceIsThereAndEveryFile) {
    const auto root = scene();
    ASSERT_STREQ(root->GetName(), "MRML");
    int markups = 0, models = 0;
    for (int i = 0; i < root->GetNumberOfNestedElements(); ++i) {
        vtkXMLDataElement* node = root->GetNestedElement(i);
        for (const char* reference : {"displayNodeRef", "storageNodeRef", "transformNodeRef"})
            if (const char* id = node->GetAttribute(reference)) {
                EXPECT_NE(by_id(root, id), nullptr) << id;
            }
        if (const char* file = node->GetAttribute("fileName")) {
            EXPECT_TRUE(fs::exists(folder() / file)) << file;
        }
        if (const char* space = node->GetAttribute("coordinateSystem")) {
            EXPECT_STREQ(space, "LPS");
        }
        const std::string name = node->GetName();
        models += name == "Model";
        markups += name == "MarkupsFiducial" || name == "MarkupsLine" || name == "MarkupsClosedCurve" ||
                   name == "MarkupsPlane";
    }
    EXPECT_EQ(models, 3) << "skin, scan, light";
    EXPECT_EQ(markups, 4) << "one of every kind";
}

TEST_F(SlicerFolder, TheScanLiesOnTheSkinInSlicersOwnFrame) {
    const auto root = scene();
    std::istringstream numbers(by_id(root, "vtkMRMLLinearTransformNode1")->GetAttribute("matrixTransformToParent"));
    Eigen::Matrix4d to_parent_in_ras;
    for (Eigen::Index i = 0; i < 16; ++i) numbers >> to_parent_in_ras(i / 4, i % 4);
    std::ifstream tfm(folder() / "ct_from_rig.tfm");
    std::string word;
    while (tfm >> word && word != "Parameters:") {
    }
    std::array<double, 12> a{};
    for (double& number : a) tfm >> number;
    const auto cloud = model("cloud.vtp");
    const auto& rig_points = world().operation.cloud->points_in_rig;
    ASSERT_EQ(cloud->GetNumberOfPoints(), static_cast<vtkIdType>(rig_points.size()));
    ASSERT_EQ(cloud->GetNumberOfVerts(), cloud->GetNumberOfPoints()) << "points without cells are not drawn";
    const auto& skin = world().prepared.skin.vertices_in_ct;
    for (vtkIdType i = 0; i < cloud->GetNumberOfPoints(); i += 50) {
        const Vector3d in_rig(cloud->GetPoint(i)), in_ct = skin[static_cast<std::size_t>(7 * i)];
        const Eigen::Vector4d there = to_parent_in_ras * ras(in_rig).homogeneous();
        EXPECT_LT((there.head<3>() - ras(in_ct)).norm(), 1e-9);
        // ITK's file takes points the other way, in LPS: from the CT to the rig.
        const Vector3d back(a[0] * in_ct.x() + a[1] * in_ct.y() + a[2] * in_ct.z() + a[9],
                            a[3] * in_ct.x() + a[4] * in_ct.y() + a[5] * in_ct.z() + a[10],
                            a[6] * in_ct.x() + a[7] * in_ct.y() + a[8] * in_ct.z() + a[11]);
        EXPECT_LT((back - in_rig).norm(), 1e-9);
    }
    const char* transform = nullptr;
    for (int i = 0; i < root->GetNumberOfNestedElements(); ++i)
        if (const char* name = root->GetNestedElement(i)->GetAttribute("name"); name && std::string(name) == "scan")
            transform = root->GetNestedElement(i)->GetAttribute("transformNodeRef");
    ASSERT_NE(transform, nullptr);
    EXPECT_STREQ(transform, "vtkMRMLLinearTransformNode1");
}

TEST_F(SlicerFolder, SkinLightAndPlanAreInMillimetresOfTheCt) {
    const auto skin = model("skin.vtp"), light = model("light.vtp");
    const auto& mesh = world().prepared.skin;
    ASSERT_EQ(skin->GetNumberOfPoints(), static_cast<vtkIdType>(mesh.vertices_in_ct.size()));
    ASSERT_EQ(skin->GetNumberOfPolys(), static_cast<vtkIdType>(mesh.triangles.size()));
    EXPECT_EQ(Vector3d(skin->GetPoint(10)), mesh.vertices_in_ct[10]);
    ASSERT_GT(light->GetNumberOfLines(), 0);
    // The cut plane is broken at each tick but the first: no piece of its colour is longer than from gap to gap.
    int of_plane = 0;
    for (vtkIdType i = 0; i < light->GetNumberOfCells(); ++i) {
        const double* colour = light->GetCellData()->GetScalars()->GetTuple(i);
        if (!(colour[0] > 200 && colour[1] < 100 && colour[2] > 200)) continue;
        double length_mm = 0;
        vtkPoints* points = light->GetCell(i)->GetPoints();
        for (vtkIdType k = 0; k + 1 < points->GetNumberOfPoints(); ++k)
            length_mm += (Vector3d(points->GetPoint(k + 1)) - Vector3d(points->GetPoint(k))).norm();
        EXPECT_LT(length_mm, 10) << "a whole stroke, without its gaps";
        of_plane += length_mm > 4.5;  // no tick
    }
    EXPECT_GE(of_plane, 2);
    EXPECT_EQ(light->GetCellData()->GetScalars()->GetNumberOfComponents(), 3);
    std::ifstream in(folder() / "plan-2.mrk.json");
    const auto hole = nlohmann::json::parse(in);
    ASSERT_EQ(hole["markups"].size(), 1u);
    EXPECT_EQ(hole["markups"][0]["coordinateSystem"], "LPS");
    EXPECT_EQ(hole["markups"][0]["controlPoints"][0]["position"],
              nlohmann::json({place().x(), place().y(), place().z()}));
}

TEST_F(SlicerFolder, AFolderThatHoldsSomethingIsLeftAlone) {
    const fs::path full = world().folder.path() / "full";
    fs::create_directory(full);
    std::ofstream(full / "mine") << "mine";
    EXPECT_THROW(export_for_slicer(world().prepared, world().operation, full), InputError);
    EXPECT_TRUE(fs::exists(full / "mine"));
}

}  // namespace
}  // namespace planlight
