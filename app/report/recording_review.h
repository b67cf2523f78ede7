#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/recording/recording_time_line.h"
#include "app/report/html_page.h"

namespace planlight {

/// The page: time line in the gate's colours, measured and predicted error, events. `judged`: the verdict of the report
/// on the same recording (`page_verdict`), empty until it is known; `pictures`: files beside it that it shows, with
/// their captions; `more`: what stands behind them, as HTML.
std::string review_page(const RecordingTimeLine& line, const std::optional<PageVerdict>& judged,
                        const std::vector<std::pair<std::string, std::string>>& pictures = {},
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
/// it holds an hour of pictures, says whether it is damaged, and judges it. An Error of `show` is thrown after that.
void write_review(RecordingTimeLine& line, const std::filesystem::path& folder,
                  const std::function<void(ReviewedMoment&)>& show,
                  const std::function<PageVerdict(RecordingTimeLine&)>& look);

}  // namespace planlight
