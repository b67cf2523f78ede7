#include "app/live/review_desk.h"

#include <fmt/format.h>

#include <future>
#include <utility>

#include "app/recording/recording_head.h"
#include "app/report/operation_report.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// The case with all that comparing takes.
struct ComparedCase {
    Case the_case;
    std::shared_ptr<const TriangleMesh> skin;
    MomentComparer comparer;
    ComparedCase(const fs::path& folder, const RecordingTimeLine& line, const fs::path& recording)
        : the_case(read_case(folder)),
          skin(std::make_shared<TriangleMesh>(the_case.skin)),
          comparer(the_case, line, recording) {}
};

std::shared_ptr<const GrayImage> shared(GrayImage picture) {
    return std::make_shared<const GrayImage>(std::move(picture));
}

/// The place nearest to that point, where one is near.
std::optional<std::size_t> place_at(const std::vector<ReviewModel::Place>& places, const Eigen::Vector3d& p_in_ct) {
    double least_mm = 4;
    std::optional<std::size_t> nearest;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double off_mm = (places[i].p_in_ct - p_in_ct).norm();
        if (off_mm > least_mm) continue;
        least_mm = off_mm;
        nearest = i;
    }
    return nearest;
}

ReviewModel::Place shown_place(const MomentComparison::Place& place) {
    return {place.pixel, place.seen.p_in_ct,
            place.seen.seen ? std::optional(std::abs(place.seen.off_mm)) : std::nullopt, words_of(place)};
}

}  // namespace

struct ReviewDesk::Beside {
    std::shared_ptr<const RecordingTimeLine> line;
    RecordedMoments moments;
    std::future<std::unique_ptr<ComparedCase>> coming;
    std::unique_ptr<ComparedCase> there;
    std::string why_not_there;  ///< a sentence
    std::optional<std::size_t> frame;
    RecordedMoment pictures;
    bool compared = false;

    Beside(const fs::path& recording, const fs::path& case_folder)
        : line(std::make_shared<RecordingTimeLine>(time_line_of(recording))),
          moments(recording, *line),
          coming(std::async(std::launch::async, [this, recording, case_folder] {
              return std::make_unique<ComparedCase>(case_folder.empty() ? line->head.case_folder : case_folder, *line,
                                                    recording);
          })) {}

    /// False while it is being read.
    bool case_is_known() {
        if (!coming.valid()) return true;
        if (coming.wait_for(0s) != std::future_status::ready) return false;
        try {
            there = coming.get();
        } catch (const Error& fault) {
            why_not_there = std::string("Plan and light are not compared: ") + fault.what() + ".";
        }
        return true;
    }
};

ReviewDesk::ReviewDesk(fs::path recording, fs::path case_folder, double at_s)
    : recording_(std::move(recording)), case_folder_(std::move(case_folder)) {
    next_.title = recording_.filename().string();
    next_.now_s = at_s;
    next_.warn_above_mm = kOperationLook_mm, next_.stop_above_mm = kOperationStop_mm;
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

ReviewDesk::~ReviewDesk() = default;

template <class Change>
void ReviewDesk::change(const Change& make) {
    const std::lock_guard lock(mutex_);
    make();
    current_.reset();
}

std::shared_ptr<const ReviewModel> ReviewDesk::model() {
    const std::lock_guard lock(mutex_);
    if (fault_) std::rethrow_exception(fault_);
    if (!current_) current_ = std::make_shared<const ReviewModel>(next_);
    return current_;
}

/// With the lock held.
void ReviewDesk::go_to(double at_s) {
    next_.now_s = std::clamp(at_s, 0.0, next_.line->lasted_s);
    current_.reset();
    const std::size_t frame = frame_near(*next_.line, next_.now_s);
    if (frame == wanted_) return;
    wanted_ = frame;
    next_.settled = false;
    wake_.notify_all();
}

void ReviewDesk::take(const ReviewWish& wish) {
    using Kind = ReviewWish::Kind;
    const std::lock_guard lock(mutex_);
    if (wish.kind == Kind::pick) {  // on what was drawn, which may have been another moment
        picked_in_ct_ = wish.picked_in_ct;
        next_.picked = place_at(next_.places, *picked_in_ct_);
        current_.reset();
    }
    if (!next_.line) return;
    const TimeLine& line = *next_.line;
    const auto frame_s = [&](std::size_t frame) { return line.frames_s.empty() ? next_.now_s : line.frames_s[frame]; };
    const std::size_t last = line.frames_s.empty() ? 0 : line.frames_s.size() - 1;
    switch (wish.kind) {
        case Kind::frame_before:
            return go_to(frame_s(wanted_ > 0 ? wanted_ - 1 : 0));
        case Kind::frame_after:
            return go_to(frame_s(std::min(wanted_ + 1, last)));
        case Kind::event_before:
            return go_to(event_before_s(line, next_.now_s).value_or(next_.now_s));
        case Kind::event_after:
            return go_to(next_event_s(line, next_.now_s).value_or(next_.now_s));
        case Kind::begin:
            return go_to(frame_s(0));
        case Kind::end:
            return go_to(frame_s(last));
        case Kind::to_time:
            return go_to(wish.at_s);
        default:
            return;
    }
}

/// Before the time line of hours is read.
void ReviewDesk::show_first_frame() {
    RecordingReader reader(recording_);
    Instant origin{};
    reader.want_only([&](const ChunkType& type, Instant at) {
        if (type == chunk_types::kRoom) origin = at;
        return type == chunk_types::kFrame;
    });
    const auto chunk = reader.next();
    if (!chunk) return;
    StereoFrame frame = unpack_frame(chunk->payload, recording_);
    change([&] {
        next_.frame_s = seconds(chunk->at - origin);
        next_.cameras[0].picture = shared(std::move(frame.left));
        next_.cameras[1].picture = shared(std::move(frame.right));
    });
}

void ReviewDesk::show_pictures(Beside& own, std::size_t frame) {
    own.frame = frame;
    own.compared = false;
    std::string note;
    try {
        own.pictures = own.moments.moment(frame);
    } catch (const Error& fault) {
        own.pictures = {own.line->frames_s[frame], {}, {}};
        own.compared = true;
        note = std::string("The pictures of this moment cannot be read: ") + fault.what() + ".";
    }
    change([&] {
        next_.frame_s = own.pictures.at_s;
        next_.cameras[0].picture = shared(own.pictures.frame.left);
        next_.cameras[1].picture = shared(own.pictures.frame.right);
        next_.light = own.pictures.light.empty() ? nullptr : std::make_shared<const RgbImage>(own.pictures.light);
        for (auto& camera : next_.cameras) camera.plan.clear(), camera.round_plan = {};
        next_.places.clear();
        next_.picked.reset();
        next_.sum.clear();
        if (next_.scene) next_.scene->light.reset();
        next_.note = note;
        next_.settled = own.compared;
    });
}

void ReviewDesk::show_comparison(Beside& own) {
    own.compared = true;
    MomentComparison compared;
    std::shared_ptr<const TriangleMesh> skin;
    if (!own.there) {
        compared.why_not = own.why_not_there;
    } else {
        skin = own.there->skin;
        try {
            compared = own.there->comparer.compare(own.moments, *own.frame, own.pictures);
        } catch (const Error& fault) {
            compared.why_not = std::string("Plan and light are not compared: ") + fault.what() + ".";
        }
    }
    put(compared, own.pictures, skin);
}

void ReviewDesk::put(const MomentComparison& compared, const RecordedMoment& pictures,
                     const std::shared_ptr<const TriangleMesh>& skin) {
    change([&] {
        next_.settled = true;
        next_.note = compared.why_not;
        if (!compared.why_not.empty()) return;
        const std::array views{&pictures.frame.left, &pictures.frame.right};
        for (std::size_t i = 0; i < views.size(); ++i) {
            next_.cameras[i].plan = compared.plan[i];
            next_.cameras[i].round_plan = round_the_plan(compared.plan[i], *views[i]);
        }
        for (const auto& place : compared.places) next_.places.push_back(shown_place(place));
        if (picked_in_ct_) next_.picked = place_at(next_.places, *picked_in_ct_);
        next_.sum = sum_of(compared);
        next_.scene = scene_of(compared, skin);
        next_.by_projector = view_of(compared);
    });
}

/// False: there is nothing to do.
bool ReviewDesk::show_next(Beside& own) {
    std::size_t wanted = 0;
    {
        const std::lock_guard lock(mutex_);
        wanted = wanted_;
    }
    if (own.frame != wanted) {
        show_pictures(own, wanted);
        return true;
    }
    if (own.compared || !own.case_is_known()) return false;
    show_comparison(own);
    return true;
}

void ReviewDesk::run(const std::stop_token& stop) {
    try {
        show_first_frame();
        Beside own(recording_, case_folder_);
        const bool any = !own.line->frames_s.empty();
        change([&] {
            next_.line = own.line;
            next_.title = "REVIEW \u00b7 " + own.line->head.case_title;
            next_.subtitle =
                fmt::format("{} \u00b7 {} frames were kept", own.line->head.began_utc, own.line->frames_s.size());
            next_.note = any ? own.line->ended : "No frame was kept.";
            next_.settled = !any;
            go_to(next_.now_s);
        });
        while (any && !stop.stop_requested()) {
            if (show_next(own)) continue;
            std::unique_lock lock(mutex_);
            const auto wants = [&] { return own.frame != wanted_; };
            if (own.compared)
                wake_.wait(lock, stop, wants);
            else
                wake_.wait_for(lock, stop, 20ms, wants);  // the case is being read
        }
    } catch (...) {
        const std::lock_guard lock(mutex_);
        fault_ = std::current_exception();
    }
}

}  // namespace planlight
