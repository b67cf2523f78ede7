#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>

#include <algorithm>
#include <cmath>

#include "planning_io/invesalius_project.h"
#include "planning_io/read_volume.h"
#include "segmentation/segment_skin.h"
#include "tests/segmentation/mesh_facts.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// Distances of points from the nearest triangle of `mesh`, mm.
std::vector<double> distances(const std::vector<Vector3d>& from, const TriangleMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const auto& p : mesh.vertices_in_ct) points->InsertNextPoint(p.data());
    vtkNew<vtkCellArray> cells;
    for (const auto& t : mesh.triangles) {
        const vtkIdType ids[3] = {t[0], t[1], t[2]};
        cells->InsertNextCell(3, ids);
    }
    vtkNew<vtkPolyData> surface;
    surface->SetPoints(points);
    surface->SetPolys(cells);
    vtkNew<vtkStaticCellLocator> locator;
    locator->SetDataSet(surface);
    locator->BuildLocator();
    std::vector<double> result;
    for (const Vector3d& p : from) {
        double closest[3], squared = 0;
        vtkIdType cell = 0;
        int part = 0;
        locator->FindClosestPoint(p.data(), closest, cell, part, squared);
        result.push_back(std::sqrt(squared));
    }
    return result;
}

/// The volume at a ct point, trilinear; NaN outside.
double value_at(const Volume& volume, const Vector3d& p_in_ct) {
    const Vector3d v = volume.ct_from_voxel.inverse() * p_in_ct;
    const Eigen::Vector3i c = v.array().floor().cast<int>();
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        Eigen::Vector3i w = c;
        for (int a = 0; a < 3; ++a) {
            const int up = (corner >> a) & 1;
            w[a] += up;
            if (w[a] < 0 || w[a] >= volume.size[static_cast<std::size_t>(a)]) return NAN;
            weight *= up ? v[a] - c[a] : 1 - (v[a] - c[a]);
        }
        sum += weight * static_cast<double>(volume.at(w.x(), w.y(), w.z()));
    }
    return sum;
}

class ExamplePatient : public testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!example_patient()) return;
        volume = read_volume(*example_patient());
        mask = segment_skin(volume);
        skin = triangulate_skin(volume, mask);
    }
    void SetUp() override {
        if (!example_patient()) GTEST_SKIP() << "Debian's invesalius-examples is not installed";
    }
    static inline Volume volume;
    static inline SkinMask mask;
    static inline TriangleMesh skin;
};

TEST_F(ExamplePatient, SkinIsOneClosedOutwardSurfaceWithoutHandles) {
    const MeshFacts facts = facts_of(skin);
    EXPECT_EQ(facts.bad_edges, 0U);
    EXPECT_EQ(facts.pieces, 1U);
    EXPECT_EQ(facts.euler, 2);
    EXPECT_GT(skin.triangles.size(), 60000U);
    EXPECT_LT(skin.triangles.size(), 190000U);
    EXPECT_NEAR(facts.volume_ml, 3250, 150);  // an adult head from the upper lip up
}

TEST_F(ExamplePatient, HeadHolderIsGoneAndEarsAreThere) {
    // Ears stand out furthest; the cup of the holder is wider and behind. Measured on the slices: ear tips 168 mm apart at
    // the most 185; back of the head to tip of the nose 200 mm.
    Vector3d low = skin.vertices_in_ct.front(), high = low;
    for (const auto& p : skin.vertices_in_ct) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const Vector3d extent = high - low;
    RecordProperty("width_mm", static_cast<int>(extent.x()));
    RecordProperty("depth_mm", static_cast<int>(extent.y()));
    EXPECT_GT(extent.x(), 170);
    EXPECT_LT(extent.x(), 205);
    EXPECT_GT(extent.y(), 200);
    EXPECT_LT(extent.y(), 230);
    EXPECT_GE(mask.pieces_removed, 1);
    EXPECT_GT(mask.removed_ml, 80);
}

TEST_F(ExamplePatient, SkinVerticesLieOnTheCrossingOfTheThreshold) {
    // Along the normal the volume must cross the threshold within 0.2 of the smallest voxel (0.957 mm).
    std::size_t off = 0, count = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        if (skin.flags[v] != kSkin) continue;
        const double inside = value_at(volume, skin.vertices_in_ct[v] - 0.19 * skin.normals_in_ct[v]);
        const double outside = value_at(volume, skin.vertices_in_ct[v] + 0.19 * skin.normals_in_ct[v]);
        if (std::isnan(inside) || std::isnan(outside)) continue;
        ++count;
        off += !(inside > mask.threshold && outside < mask.threshold);
    }
    EXPECT_GT(count, 50000U);
    EXPECT_LT(off, count / 200);
}

TEST_F(ExamplePatient, AgreesWithTheSurfaceOfInVesalius) {
    const auto surfaces = read_invesalius_surfaces(*example_patient());
    ASSERT_FALSE(surfaces.empty());
    SkinSettings settings;
    settings.threshold = -142;  // of the project's skin surface
    const SkinMask same = segment_skin(volume, settings);
    const TriangleMesh mesh = triangulate_skin(volume, same, settings);
    // InVesalius keeps cavities and head holder in its surface: only its vertices within 3 mm of our skin are compared, and
    // they must be most of what one skin has. The other surface of the project is bone.
    double best = 1e9;
    std::size_t most = 0;
    for (const auto& surface : surfaces) {
        std::vector<Vector3d> some;
        for (std::size_t v = 0; v < surface.vertices_in_ct.size(); v += 5) some.push_back(surface.vertices_in_ct[v]);
        std::vector<double> mm = distances(some, mesh);
        std::erase_if(mm, [](double d) { return d > 3; });
        if (mm.size() < most) continue;
        most = mm.size();
        std::nth_element(mm.begin(), mm.begin() + static_cast<std::ptrdiff_t>(most / 2), mm.end());
        best = mm[most / 2];
    }
    RecordProperty("median_um", static_cast<int>(1000 * best));
    EXPECT_GT(most, 10000U);
    EXPECT_LT(best, 0.957 / 3);
}

TEST_F(ExamplePatient, ThresholdMovesTheSkinByLessThanAMillimetre) {
    // Air to skin is a ramp of about two voxels: the choice of threshold matters little, and in the right direction.
    SkinSettings settings;
    settings.threshold = -200;
    const SkinMask higher = segment_skin(volume, settings);
    EXPECT_LT(higher.volume_ml, mask.volume_ml);
    EXPECT_GT(higher.volume_ml, mask.volume_ml - 0.1 * 1000);  // 0.1 litre over about 1000 square cm: 1 mm
}

TEST(SlicerHead, ClosedSkinFromStoredValues) {
    const auto folder = third_party_data("ct/slicer_cthead_dicom");
    if (!folder) GTEST_SKIP() << "the CT head of 3D Slicer is not beside the checkout";
    const Volume volume = read_volume(*folder);
    const SkinMask mask = segment_skin(volume);
    const MeshFacts facts = facts_of(triangulate_skin(volume, mask));
    EXPECT_EQ(facts.bad_edges, 0U);
    EXPECT_EQ(facts.pieces, 1U);
    EXPECT_GT(facts.volume_ml, 2000);
    EXPECT_LT(facts.volume_ml, 8000);
}

}  // namespace
}  // namespace planlight::test
