#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "app/report/document.h"
#include "app/session.h"

namespace planlight {

/// What a match is worth, in words and pictures: verdict and reasons, what it was judged by, how far off each item of
/// the plan may be (95 %), the scan on the skin before and after the fine match, and how far off the match may be over
/// the skin. `cloud` may be null (landmarks): then without the scan.
Document certificate_of(const Case& the_case, const CaseDrawing& drawing, const RegistrationResult& found,
                        const std::shared_ptr<const PointCloud>& cloud);

/// Keeps a match as a new folder 0001, 0002, ... in `folder`: registration.json, cloud.ply where there was a scan,
/// landmarks.csv where there were any. What is there is not touched. Its owner's alone, where the disk
/// knows permissions. Gives the new folder. Throws DiskError like every writer.
std::filesystem::path keep_match(const RegistrationResult& found, const PointCloud* cloud,
                                 const std::vector<PointPair>& landmarks, const std::filesystem::path& folder);

}  // namespace planlight
