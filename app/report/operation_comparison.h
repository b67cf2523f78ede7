#pragma once

#include <filesystem>
#include <functional>

#include "app/report/moment_comparison.h"
#include "app/report/operation_report.h"

namespace planlight {

/// A camera's picture round the plan, in its own size: the plan in blue, and each place of its light as a circle, green
/// within 1 mm, amber within 2 mm, red beyond, grey where none was found.
RgbImage compared_picture(const MomentComparison& moment, const GrayImage& picture, std::size_t camera);

/// Plan and light at the moment of the page, measured anew from its pictures (`OperationMoment::compared`). Of an
/// anonymous recording, or where nothing was followed, it says why not. Throws InputError when the recording is of
/// another case, DamagedFileError.
void compare_moment(OperationFacts& facts, const std::filesystem::path& recording, const Case& the_case);
/// The same with the case that the recording names; where that is not there, or is another by now, the page says so.
/// `go_on`: as of `facts_of_operation`.
void compare_moment(OperationFacts& facts, const std::filesystem::path& recording,
                    const std::function<void()>& go_on = {});

}  // namespace planlight
