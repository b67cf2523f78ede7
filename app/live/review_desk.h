#pragma once

#include <condition_variable>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "app/report/moment_comparison.h"
#include "app/windows/review_model.h"

namespace planlight {

/// Goes through a recording for a reviewer: reads beside the window what it shows, pictures first, then plan and light
/// of that moment as the cameras saw them.
class ReviewDesk {
public:
    /// `case_folder` empty: where it was when it was recorded. `at_s`: the moment that is shown first.
    explicit ReviewDesk(std::filesystem::path recording, std::filesystem::path case_folder = {}, double at_s = 0);
    ~ReviewDesk();

    /// What is to be shown now; the same pointer as long as nothing is new. Throws what reading the recording has
    /// thrown (InputError, DamagedFileError, DiskError).
    std::shared_ptr<const ReviewModel> model();

    /// Goes where the person wants. Before the time line is read nothing but `pick` means anything.
    void take(const ReviewWish& wish);

private:
    struct Beside;  // what the thread beside has of its own
    void run(const std::stop_token& stop);
    void show_first_frame();
    bool show_next(Beside& own);
    void show_pictures(Beside& own, std::size_t frame);
    void show_comparison(Beside& own);
    void put(const MomentComparison& compared, const RecordedMoment& pictures,
             const std::shared_ptr<const TriangleMesh>& skin);
    void go_to(double at_s);
    template <class Change>
    void change(const Change& make);

    const std::filesystem::path recording_, case_folder_;
    std::mutex mutex_;
    std::condition_variable_any wake_;
    ReviewModel next_;                            // from here on guarded
    std::shared_ptr<const ReviewModel> current_;  ///< `next_` as it was handed out; null: there is a newer one
    std::size_t wanted_ = 0;                      ///< frame
    std::optional<Eigen::Vector3d> picked_in_ct_;
    std::exception_ptr fault_;
    std::jthread thread_;  // last: it uses all of these
};

}  // namespace planlight
