#pragma once

#include <filesystem>
#include <string>

#include "app/prepare_case.h"
#include "app/report/document.h"
#include "app/report/preparation_pictures.h"
#include "app/report/removed_pieces.h"
#include "projection/draw_plan.h"

namespace planlight {

/// All that the report of a preparation says and shows, for the one who signs it.
struct PreparationReport {
    Document document;  ///< two sheets of A4 or Letter where the plan is no longer than some twenty items
    std::string json;   ///< the same in figures
};

/// What the page says, from what was prepared; nothing is written yet. `operator_name`: who prepared it; empty where
/// nobody may be named, and then no operator is on the page.
PreparationReport preparation_report(const Preparation& prepared, const PlanDrawing& drawing,
                                     const RemovedPieces& removed, const PreparationPictures& pictures,
                                     const std::string& operator_name);

/// report.html and report.json in the folder.
void write_preparation_report(const PreparationReport& report, const std::filesystem::path& folder);

}  // namespace planlight
