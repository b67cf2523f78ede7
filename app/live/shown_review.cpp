#include "app/live/shown_review.h"

#include "app/live/review_desk.h"
#include "app/windows/review_window.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/safe_write.h"

namespace planlight {

void show_review(const std::filesystem::path& recording, const ShownReviewSettings& settings) {
    constexpr double kRest_s = 0.03;
    constexpr int kDrawn = 6;                                         // until the window has settled
    ReviewDesk desk(recording, settings.case_folder, settings.at_s);  // it reads while the window opens
    WindowSettings window_settings;
    window_settings.title = "Planlight review";
    window_settings.words = settings.words;
    ReviewWindow window(window_settings);
    for (int settled = 0;;) {
        const auto model = desk.model();
        const ReviewWish wish = window.frame(model);
        if (wish.kind == ReviewWish::Kind::quit) return;
        desk.take(wish);
        settled = model->settled ? settled + 1 : 0;
        if (!settings.picture.empty() && settled == kDrawn)  // the patient's face is on it
            return write_safely(settings.picture, png_bytes(window.screenshot()), ReadableBy::owner);
        window.rest(kRest_s);
    }
}

}  // namespace planlight
