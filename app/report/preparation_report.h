#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/prepare_case.h"
#include "app/report/html_page.h"
#include "projection/draw_plan.h"

namespace planlight {

/// The point that the slices of the report go through: the first trajectory's target, else the middle of the plan, else
/// of the skin. ct, mm.
Eigen::Vector3d point_of_interest(const Case& the_case);

/// Axial, coronal and sagittal slice with the skin's line, and the head with the plan from four sides. The views of the
/// head are left out, and `warning` says why, where there is no OpenGL.
std::vector<ReportPicture> preparation_pictures(const Volume& volume, const Case& the_case, const PlanDrawing& drawing,
                                                std::string& warning);

/// The preparation in figures (JSON text): skin, table, plan items with their distance to the skin, times, warnings.
std::string preparation_json(const Preparation& prepared, const PlanDrawing& drawing);

/// Writes report.html (one page with the pictures of `preparation_pictures` inside) and report.json into `folder`.
void write_preparation_report(const std::filesystem::path& folder, const Preparation& prepared,
                              const PlanDrawing& drawing, const std::vector<ReportPicture>& pictures);

}  // namespace planlight
