#pragma once

#include <filesystem>
#include <functional>
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

/// What the page shows of one moment: files beside it with their captions, and what stands behind them, as HTML.
struct ReviewedMoment {
    std::vector<std::pair<std::string, std::string>> pictures;
    std::string more;
};

/// Writes the page and review.json into the folder, for their owner alone, and again each time that more is known.
/// `show` adds what was asked for of one moment; last, `look` reads every byte of the recording, which takes long where
/// it holds an hour of pictures, and says whether it is damaged. What does not read for `show` is thrown after that.
void write_review(RecordingTimeLine& line, const std::filesystem::path& folder,
                  const std::function<void(ReviewedMoment&)>& show,
                  const std::function<void(RecordingTimeLine&)>& look);

}  // namespace planlight
