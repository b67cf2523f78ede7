#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "planning_io/case/case_folder.h"
#include "planning_io/surface/surface_file.h"
#include "planning_io/types/volume.h"
#include "segmentation/build_skin_lut.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_judgement.h"

namespace planlight {

/// What the preparation did and how long each step took, for the report.
struct Preparation {
    Case prepared;
    bool on_given_surface = false;  ///< of somebody else: no threshold, no body, nothing taken away
    double brightness_ratio = 1;    ///< of an MR, across the head, evened out before the threshold
    double threshold = 0, body_ml = 0, removed_ml = 0;
    int pieces_removed = 0;
    SkinJudgement judgement;  ///< how the skin was checked, where the volume cuts it off; empty on a given surface or a phantom
    double segment_s = 0, triangulate_s = 0, lut_s = 0;
};

/// PREPARE: volume -> outer skin -> mesh -> LUT, plan checked against the skin (its warnings go into the case).
/// `progress(step, share)` names the step and how far it is, 0..1; may be empty. `created` is an ISO 8601 date.
Preparation prepare_case(const Volume& volume, const Plan& plan, const SkinSettings& skin, const LutSettings& lut,
                         const std::string& created,
                         const std::function<void(const std::string&, double)>& progress = {});

/// The same on a surface that somebody else segmented (`mesh` as `read_surface` gives it, its `notes` become warnings).
Preparation prepare_case_on(const Volume& volume, const SurfaceFile& surface, const Plan& plan, const LutSettings& lut,
                            const std::string& created,
                            const std::function<void(const std::string&, double)>& progress = {});

/// Now, as ISO 8601 in UTC.
std::string iso_date_now();

}  // namespace planlight
