#include "app/live/shown_review.h"

#include <fmt/format.h>

#include "app/live/review_desk.h"
#include "app/windows/review_window.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Kind = ReviewWish::Kind;

/// Pictures of the window beside the recording, and what is said of the last one until something else is wanted.
class Snapshots {
public:
    explicit Snapshots(fs::path recording) : recording_(std::move(recording)) {}

    void take(ReviewWindow& window, const ReviewModel& model) {
        const fs::path file = snapshot_of(recording_, model.frame_s.value_or(model.now_s));
        try {
            write_safely(file, png_bytes(window.screenshot()), ReadableBy::owner);  // the patient's face is on it
            say(fmt::format("Saved as {}, beside the recording.", file.filename().string()));
        } catch (const Error& fault) {
            say(fmt::format("The picture could not be saved: {}.", fault.what()));
        }
    }
    void say(std::string words) {
        said_ = std::move(words);
        of_.reset();
    }
    /// The model with that in it; the same pointer as long as nothing is new.
    std::shared_ptr<const ReviewModel> in(const std::shared_ptr<const ReviewModel>& model) {
        if (said_.empty()) return model;
        if (of_ != model) {
            auto shown = std::make_shared<ReviewModel>(*model);
            shown->note = said_;
            of_ = model, shown_ = std::move(shown);
        }
        return shown_;
    }

private:
    fs::path recording_;
    std::string said_;
    std::shared_ptr<const ReviewModel> of_, shown_;
};

}  // namespace

fs::path snapshot_of(const fs::path& recording, double at_s) {
    return fs::path(recording).replace_extension("") += fmt::format("{}{:.3f}.png", kSnapshotAt, at_s);
}

void show_review(const fs::path& recording, const ShownReviewSettings& settings) {
    constexpr double kRest_s = 0.03;
    constexpr int kDrawn = 6;                                         // until the window has settled
    ReviewDesk desk(recording, settings.case_folder, settings.at_s);  // it reads while the window opens
    WindowSettings window_settings = settings.window;
    window_settings.title = "Planlight review";
    ReviewWindow window(window_settings);
    Snapshots snapshots(recording);
    for (int settled = 0;;) {
        const auto model = desk.model();
        const ReviewWish wish = window.frame(snapshots.in(model));
        if (wish.kind == Kind::quit) return;
        if (wish.kind == Kind::snapshot)
            snapshots.take(window, *model);
        else if (wish.kind != Kind::none)
            snapshots.say({});
        desk.take(wish);
        settled = model->settled ? settled + 1 : 0;
        if (!settings.picture.empty() && settled == kDrawn)  // the patient's face is on it
            return write_safely(settings.picture, png_bytes(window.screenshot()), ReadableBy::owner);
        window.rest(kRest_s);
    }
}

}  // namespace planlight
