#include "planning_io/surface/risk_structure_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "planning_io/plan/plan_file.h"
#include "planning_io/surface/mesh_file.h"
#include "tests/planning_io/rt_struct_bytes.h"
#include "tests/planning_io/surface/surface_file_fixture.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::closed_contour;
using test::DicomBytes;
using test::rt_struct_of;

/// A tetrahedron with edges of `size` along the axes, as corners and faces.
const std::array<std::array<int, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
std::array<Vector3d, 4> corners(double size) {
    return {Vector3d(0, 0, 0), Vector3d(size, 0, 0), Vector3d(0, size, 0), Vector3d(0, 0, size)};
}

std::string obj(double size, const std::string& header = "# SPACE=LPS\n", std::size_t faces = 4) {
    std::string text = header;
    for (const auto& p : corners(size)) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    for (std::size_t f = 0; f < faces; ++f)
        text += fmt::format("f {} {} {}\n", kFaces[f][0] + 1, kFaces[f][1] + 1, kFaces[f][2] + 1);
    return text;
}

std::string stl(double size, const std::string& header = "SPACE=LPS") {
    std::string text = "solid " + header + "\n";
    for (const auto& face : kFaces) {
        text += "facet normal 0 0 1\nouter loop\n";
        for (const int c : face) {
            const Vector3d p = corners(size)[static_cast<std::size_t>(c)];
            text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
        }
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid\n";
}

std::string ply(double size) {
    std::string text =
        "ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 4\nproperty double x\nproperty double y\nproperty "
        "double z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
    for (const auto& p : corners(size)) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    for (const auto& f : kFaces) text += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
    return text;
}

std::string vtk(double size) {
    std::string text = "# vtk DataFile Version 3.0\nSPACE=LPS\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n";
    for (const auto& p : corners(size)) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    text += "POLYGONS 4 16\n";
    for (const auto& f : kFaces) text += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
    return text;
}

class RiskStructureFileTest : public test::SurfaceFileTest {
protected:
    std::vector<RiskStructure> read(const std::string& name, const std::string& content,
                                    const PlanImportSettings& settings = {}, const RiskLimits& limits = {}) {
        notes_.clear();
        return read_risk_structures(write(name, content), settings, notes_, limits);
    }
    std::string refused(const std::string& name, const std::string& content, const PlanImportSettings& settings = {},
                        const RiskLimits& limits = {}) {
        try {
            read(name, content, settings, limits);
        } catch (const Error& e) {
            EXPECT_FALSE(e.remedy.empty()) << e.what();
            return std::string(e.what()) + ". " + e.remedy;
        }
        return "not refused";
    }
    std::vector<std::string> notes_;
};

TEST_F(RiskStructureFileTest, EveryFormatGivesTheSameClosedSurfaceNamedAsItsFile) {
    for (const auto& [ending, content] : {std::pair{".obj", obj(20)}, std::pair{".stl", stl(20)},
                                          std::pair{".ply", ply(20)}, std::pair{".vtk", vtk(20)}}) {
        const auto structures = read(std::string("Facial nerve") + ending, content);
        ASSERT_EQ(structures.size(), 1U) << ending;
        EXPECT_EQ(structures[0].name, "Facial nerve");
        EXPECT_EQ(structures[0].surface.vertices_in_ct.size(), 4U) << ending << ": corners at one place are one";
        EXPECT_EQ(structures[0].surface.triangles.size(), 4U);
        Vector3d sum = Vector3d::Zero();
        for (const auto& p : structures[0].surface.vertices_in_ct) sum += p;
        EXPECT_EQ(sum, Vector3d(20, 20, 20)) << ending;
        EXPECT_TRUE(notes_.empty());
    }
}

TEST_F(RiskStructureFileTest, ItsNameIsOneLineWithoutOrdersOfDirection) {
    const auto structures = read(
        "ves\nsel\xE2\x80\xAE"
        "12.stl",
        stl(20));
    ASSERT_EQ(structures.size(), 1U);
    EXPECT_EQ(structures[0].name, "ves sel12");
}

TEST_F(RiskStructureFileTest, ItsSpaceIsSaidByTheFileOrByThePersonAndNeverGuessed) {
    EXPECT_SAYS(refused("n.obj", obj(20, "")), "does not say its coordinate system");
    PlanImportSettings ras;
    ras.space = Space::ras;
    const auto turned = read("n.obj", obj(20, ""), ras);
    Vector3d low = Vector3d::Zero();
    for (const auto& p : turned[0].surface.vertices_in_ct) low = low.cwiseMin(p);
    EXPECT_EQ(low, Vector3d(-20, -20, 0)) << "in RAS x and y run the other way";
    EXPECT_SAYS(refused("n.obj", obj(20), ras), "says that it is in LPS");
}

TEST_F(RiskStructureFileTest, WhatIsNoClosedSurfaceOfAStructureIsRefused) {
    EXPECT_SAYS(refused("Nerve.obj", obj(20, "# SPACE=LPS\n", 3)),
                "risk structure \"Nerve\" is an open surface (3 edges at its border)");
    EXPECT_SAYS(refused("n.obj", "# SPACE=LPS\nv 0 0 0\nv 9 0 0\nl 1 2\n"), "holds no triangles");
    EXPECT_SAYS(refused("n.obj", "# SPACE=LPS\nv 0 0 nan\nv 9 0 0\nv 9 9 0\nf 1 2 3\n"), "finite");
    EXPECT_SAYS(refused("n.obj", obj(0.02)), "is 0.02 mm across, not between 1 and 600 mm. Export it in mm (it seems");
    EXPECT_SAYS(refused("n.obj", obj(2000)), "is 2e+03 mm across");
    EXPECT_SAYS(refused("n.obj", obj(20), {}, {50, 3, 1, 600}), "has 4 triangles, more than 3");
    EXPECT_SAYS(refused(std::string(121, 'n') + ".obj", obj(20)), "121 characters (at most 120)");
    EXPECT_SAYS(refused("n.txt", obj(20)), "is of no kind");
    EXPECT_SAYS(refused("cut.stl", stl(20).substr(0, 200)), "cut");
    EXPECT_THROW(read_risk_structures(folder_.path(), {}, notes_), InputError);
    EXPECT_THROW(read_risk_structures(folder_.path() / "nowhere.stl", {}, notes_), InputError);
}

TEST_F(RiskStructureFileTest, AClosedSurfaceThatIsGivenAsAPlanIsToldWhereItBelongs) {
    try {
        import_plan(write("n.obj", obj(20)));
        FAIL();
    } catch (const InputError& e) {
        EXPECT_SAYS(e.remedy, "--risk");
    }
}

TEST_F(RiskStructureFileTest, MoreThanAPersonCanMindAreRefused) {
    const fs::path file = write("n.obj", obj(20));
    PlanImport plan;
    append_risk_structures(plan, {file, file}, {}, {2, 100, 1, 600});
    EXPECT_EQ(plan.plan.risk_structures.size(), 2U);
    EXPECT_TRUE(plan.plan.empty()) << "they are no items";
    EXPECT_THROW(append_risk_structures(plan, {file}, {}, {2, 100, 1, 600}), InputError);
}

/// An RT Structure Set of a rod of `radius_mm` along z round (10, 20), contours every `step_mm` from -20 to 20 mm,
/// leant by `lean` mm a mm, and of one line.
std::string rod_rt_struct(double radius_mm, double step_mm, double lean, const std::string& type = "ORGAN") {
    std::vector<DicomBytes> contours;
    for (double z = -20; z <= 20; z += step_mm) {
        std::vector<Eigen::Vector3d> circle;
        for (int i = 0; i < 90; ++i)
            circle.emplace_back(10 + lean * z + radius_mm * std::cos(2 * M_PI * i / 90),
                                20 + radius_mm * std::sin(2 * M_PI * i / 90), z);
        contours.push_back(closed_contour(circle));
    }
    return rt_struct_of("Nerve", contours, type);
}

// Every way into the head goes through the outline of the patient: it would hide the nerve beside it.
TEST_F(RiskStructureFileTest, TheOutlineOfThePatientAndWhatIsToBeTreatedAreNoRiskStructures) {
    PlanImportSettings same_ct;
    same_ct.frame_of_reference_uid = "1.2.3";
    EXPECT_EQ(read("set.dcm", rod_rt_struct(3, 1, 0, "AVOIDANCE"), same_ct).size(), 1U);
    for (const std::string type : {"EXTERNAL", "PTV", "BOLUS"})
        EXPECT_SAYS(refused("set.dcm", rod_rt_struct(3, 1, 0, type), same_ct),
                    "holds no solid that is a risk structure");
    EXPECT_SAYS(notes_.empty() ? "" : notes_[0], "is a bolus (BOLUS) and is left out of the risk structures");
}

// A nerve of a millimetre on slices of a millimetre would be lost in voxels of one.
TEST_F(RiskStructureFileTest, AThinNerveOfAStructureSetIsAsWideAsItWasDrawn) {
    PlanImportSettings same_ct;
    same_ct.frame_of_reference_uid = "1.2.3";
    for (const double lean : {0.0, 0.5}) {
        const auto structures = read("set.dcm", rod_rt_struct(0.6, 1, lean), same_ct);
        ASSERT_EQ(structures.size(), 1U);
        EXPECT_EQ(structures[0].name, "Nerve");
        ASSERT_EQ(notes_.size(), 1U);
        EXPECT_SAYS(notes_[0], "ROI \"Line\" is no solid");
        double widest_mm = 0, low = 0, high = 0;
        for (const auto& p : structures[0].surface.vertices_in_ct) {
            low = std::min(low, p.z()), high = std::max(high, p.z());
            const double slice = std::round(p.z());
            if (std::abs(p.z() - slice) > 0.3 || std::abs(slice) > 18) continue;  // between slices it has steps
            const double off = std::hypot(p.x() - 10 - lean * slice, p.y() - 20) - 0.6;
            EXPECT_GT(off, -0.1) << p.transpose();
            widest_mm = std::max(widest_mm, off);
        }
        EXPECT_LT(widest_mm, 0.3);
        EXPECT_NEAR(low, -20.5, 0.1) << "half a slice beyond the last contour";
        EXPECT_NEAR(high, 20.5, 0.1);
    }
    EXPECT_SAYS(refused("set.dcm", rod_rt_struct(3, 1, 0),
                        [] {
                            PlanImportSettings other;
                            other.frame_of_reference_uid = "9.9";
                            return other;
                        }()),
                "9.9");
}

}  // namespace
}  // namespace planlight
