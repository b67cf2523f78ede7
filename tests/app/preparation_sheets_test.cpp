// The report of a preparation on paper: two sheets, also where much is to be looked at.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/report/preparation_report.h"
#include "tests/app/read_pdf.h"
#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr const char* kWarning =
    "Over {} square cm (most at left ear) what lies just under the surface is lighter than skin and fat: hair, a "
    "strap, a cloth or a cover lies on the skin there. Look at the skin in the report before you use it.";

/// Six holes on the analytic head, with pictures of the sizes that slices and views have.
class PreparationSheets : public testing::Test {
protected:
    static void SetUpTestSuite() {
        Plan plan;
        for (int i = 0; i < 6; ++i)
            plan.boreholes.push_back(
                {fmt::format("Hole {}", i), on_analytic_head(Vector3d(8 * i, -90, 40)), std::nullopt, 7, 6, {}});
        SurfaceFile surface;
        surface.mesh = analytic_head_mesh(6);
        LutSettings lut;
        lut.voxel_mm = 6;
        Volume volume;
        volume.size = {240, 300, 300};
        volume.ct_from_voxel = Eigen::Affine3d(Eigen::Translation3d(-120, -150, -150));
        done_ = prepare_case_on(volume, surface, plan, lut, "2026-01-01T00:00:00Z");
        done_.on_given_surface = false;
        done_.prepared.warnings.clear();
        const auto picture = [](const char* title, int wide, int high) {
            return ReportPicture{title, "", RgbImage(wide, high, {90, 90, 90})};
        };
        pictures_.middle_slices = {picture("axial", 300, 360), picture("coronal", 300, 300),
                                   picture("sagittal", 360, 300)};
        pictures_.plan_slices = pictures_.middle_slices;
        for (const char* view : {"front", "left", "right", "back", "above", "below"})
            pictures_.views.push_back(picture(view, 400, 440));
        removed_.pictures = {picture("from the front", 300, 300), picture("from the left", 300, 300)};
        for (int i = 0; i < 8; ++i)
            removed_.pieces.push_back({40.0 / (i + 1), Vector3d(0, 120, 0), Vector3d(-50, 100, -50), {50, 140, 50}});
    }
    static std::vector<std::string> sheets_with(int warnings, PaperSize paper) {
        Preparation done = done_;
        for (int i = 0; i < warnings; ++i)
            done.prepared.warnings.push_back(fmt::format(fmt::runtime(kWarning), 20 + i));
        return sheets_of(
            pdf_of(preparation_report(done, done.drawing, removed_, pictures_, "An Operator").document, paper));
    }
    inline static Preparation done_;
    inline static PreparationPictures pictures_;
    inline static RemovedPieces removed_;
};

TEST_F(PreparationSheets, AreTwoWithNineLongWarnings) {
    for (const PaperSize paper : {PaperSize::a4, PaperSize::letter})
        for (const int warnings : {0, 3, 6, 9}) {
            const auto sheets = sheets_with(warnings, paper);
            EXPECT_EQ(sheets.size(), 2U) << warnings;
            for (int i = 0; i < warnings; ++i)
                EXPECT_NE(sheets[0].find(fmt::format("Over {} square cm", 20 + i)), std::string::npos)
                    << "all of them on the first";
            EXPECT_NE(sheets.back().find("Signature"), std::string::npos);
        }
}

}  // namespace
}  // namespace planlight::test
