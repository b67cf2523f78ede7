#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/recording/recording_time_line.h"

namespace planlight {

/// The page: time line in the gate's colours, measured and predicted error, events. `pictures`: files beside it that it
/// shows, with their captions; `more`: what stands behind them, as HTML.
std::string review_page(const RecordingTimeLine& line, const std::vector<std::pair<std::string, std::string>>& pictures,
                        const std::string& more = {});

/// The same as figures (JSON, `format` says `kReviewFormat`).
inline constexpr const char* kReviewFormat = "planlight review";
std::string review_json(const RecordingTimeLine& line);

}  // namespace planlight
