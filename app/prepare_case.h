#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <functional>
#include <string>

#include "planning_io/case/case_folder.h"
#include "planning_io/surface/surface_file.h"
#include "planning_io/types/volume.h"
#include "projection/draw_plan.h"
#include "segmentation/build_skin_lut.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_judgement.h"

namespace planlight {

/// What the report says of the volume.
struct VolumeFacts {
    std::string modality;  ///< "CT", "MR"
    bool is_hu = false;
    std::array<int, 3> size{0, 0, 0};
    Eigen::Vector3d voxel_mm{0, 0, 0};
};

/// What the preparation did and how long each step took, for the report.
struct Preparation {
    Case prepared;
    VolumeFacts volume;
    bool on_given_surface = false;  ///< of somebody else: no threshold, no body, nothing taken away
    bool threshold_given = false;   ///< by a person, not found from the histogram
    double brightness_ratio = 1;    ///< of an MR, across the head, evened out before the threshold
    double threshold = 0, body_ml = 0, removed_ml = 0;
    int pieces_removed = 0;
    SkinMask mask;  ///< empty on a given surface
    SkinJudgement
        judgement;  ///< how the skin was checked, where the volume cuts it off; empty on a given surface or a phantom
    PlanDrawing drawing;  ///< of the plan on the skin
    double segment_s = 0, triangulate_s = 0, lut_s = 0;
};

/// What a preparation tells while it runs; each may be empty.
struct PreparationWatcher {
    std::function<void(const std::string& step, double share)> progress;  ///< the step's name and how far it is, 0..1
    std::function<void(const std::string& sentence)>
        warned;  ///< each warning when it is known, whatever comes after it
    /// Told when the skin moves much with its threshold, before it is doubted or refused: show others beside it.
    std::function<void(const Volume& volume, double threshold)> unsure = {};
};

/// PREPARE: volume -> outer skin -> mesh -> LUT, plan checked against the skin (its warnings go into the case). `names`
/// are for people; the series' are taken from the volume. `said_frame`: items whose frame only a person says. `created`
/// is an ISO 8601 date.
Preparation prepare_case(const Volume& volume, const Plan& plan, const SkinSettings& skin, const LutSettings& lut,
                         const std::string& created, const PreparationWatcher& watcher = {},
                         const CaseNames& names = {}, const SaidFrame& said_frame = {});

/// The same on a surface that somebody else segmented (`mesh` as `read_surface` gives it, its `notes` become warnings).
Preparation prepare_case_on(const Volume& volume, const SurfaceFile& surface, const Plan& plan, const LutSettings& lut,
                            const std::string& created, const PreparationWatcher& watcher = {},
                            const CaseNames& names = {}, const SaidFrame& said_frame = {});

/// Throws an Error (exit 7) with the need in MiB when the memory that there is cannot be enough to prepare this volume.
void check_memory_to_prepare(const Volume& volume, const LutSettings& lut);

/// Now, as ISO 8601 in UTC.
std::string iso_date_now();

}  // namespace planlight
