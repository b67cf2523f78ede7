#pragma once

#include <string>
#include <vector>

#include "app/prepare_case.h"
#include "app/report/html_page.h"
#include "projection/draw_plan.h"

namespace planlight {

/// The pictures of the preparation's report. Their number does not depend on how much the plan holds.
struct PreparationPictures {
    std::vector<ReportPicture>
        middle_slices;                       ///< axial, coronal, sagittal: through the skin's middle, its line on them
    std::vector<ReportPicture> plan_slices;  ///< the same through `point_of_interest`; empty without a plan
    std::vector<ReportPicture> views;        ///< the head with the plan from four sides, from above and from below
    std::string no_views;                    ///< why there are none: where there is no OpenGL
};

/// The point that the slices through the plan go through: of its points on the skin the one nearest to their middle;
/// without a plan the middle of the skin. ct, mm.
Eigen::Vector3d point_of_interest(const Case& the_case);

/// The slices; the volume is not needed afterwards.
void add_slices(const Volume& volume, const Case& the_case, PreparationPictures& pictures);

/// The views; what is drawn is only the case's.
void add_views(const Case& the_case, const PlanDrawing& drawing, PreparationPictures& pictures);

}  // namespace planlight
