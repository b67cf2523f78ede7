// The folder for 3D Slicer, read back by plain XML and VTK's readers, whose frames are worked out here anew.
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

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/export/export_study.h"
#include "planning_io/types/error.h"
#include "tests/app/exported_phantom.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// The folder for 3D Slicer.
class SlicerFolder : public ::testing::Test {
protected:
    static test::ExportedPhantom& world() { return test::exported_phantom(); }
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
    bool plan_named = false;  // all of it, not what was lit at some moment
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
        plan_named |= name == "Model" && std::string(node->GetAttribute("name")) == "plan on the skin";
        markups += name == "MarkupsFiducial" || name == "MarkupsLine" || name == "MarkupsClosedCurve" ||
                   name == "MarkupsPlane";
    }
    EXPECT_EQ(models, 3) << "skin, scan, light";
    EXPECT_TRUE(plan_named);
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

/// Plastimatch reads transforms by ITK, as 3D Slicer does: it moves places of the CT to where the rig has them, in LPS.
TEST_F(SlicerFolder, AnotherProgramReadsTheTransformAsItIsMeant) {
    if (std::system("command -v plastimatch >/dev/null 2>&1") != 0) GTEST_SKIP() << "plastimatch is not installed";
    const fs::path moved = world().folder.path() / "moved.mha";
    const std::string command = "plastimatch xf-convert --input '" + (folder() / "ct_from_rig.tfm").string() +
                                "' --output '" + moved.string() +
                                "' --output-type vf --origin '-80 -100 5' --spacing '160 150 90' --dim '2 2 2'";
    ASSERT_EQ(std::system((command + " >/dev/null 2>&1").c_str()), 0) << command;
    std::ifstream in(moved, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {}), last = "ElementDataFile = LOCAL\n";
    const std::size_t at = bytes.find(last);
    ASSERT_NE(at, std::string::npos);
    std::array<float, 24> by{};  // of each place the way to where it goes, x fastest
    ASSERT_EQ(bytes.size(), at + last.size() + sizeof by);
    std::memcpy(by.data(), bytes.data() + at + last.size(), sizeof by);
    for (std::size_t i = 0; i < 8; ++i) {
        const Vector3d in_ct(i % 2 == 0 ? -80 : 80, i / 2 % 2 == 0 ? -100 : 50, i / 4 == 0 ? 5 : 95);
        const Vector3d there = in_ct + Vector3d(by[3 * i], by[3 * i + 1], by[3 * i + 2]);
        EXPECT_LT((there - world().operation.match.patient_from_ct * in_ct).norm(), 1e-3) << "single precision";
    }
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
    EXPECT_EQ(
        hole["markups"][0]["controlPoints"][0]["position"],
        nlohmann::json({test::place_on_phantom().x(), test::place_on_phantom().y(), test::place_on_phantom().z()}));
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
