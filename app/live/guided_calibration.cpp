#include "app/live/guided_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "app/commands/capture_conversion.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/types/error.h"
#include "registration/calibration/judge_pictures.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

constexpr auto kFramePatience = 2000ms;
constexpr Instant kLightValid = 3s, kLightRenewed = 1s;  ///< of a guiding light: it is shown again before it ends
constexpr Instant kLightLeast = 300ms;                   ///< words that change faster cannot be read
constexpr Instant kLookEvery = 100ms;  ///< to find a board takes a processor its while; a person is slower
constexpr Instant kLaterStep = 60ms, kLatest = 300ms;  ///< of a light whose delay is not known
constexpr double kLitGrey = 8;

/// Why a capture was given up in its middle.
struct PoseLeft {
    PoseFault fault;
    std::string why, what;
};

/// Somebody ended it in the middle of a capture.
struct Ended {};

/// Share of the board's corners round which white light is brighter than black.
double lit_share(const GrayImage& white, const GrayImage& black, const BoardCorners& corners) {
    constexpr int kRound = 3;
    std::size_t lit = 0;
    for (const Eigen::Vector2d& p : corners.pixels) {
        double more = 0;
        int count = 0;
        for (int y = static_cast<int>(p.y()) - kRound; y <= static_cast<int>(p.y()) + kRound; ++y)
            for (int x = static_cast<int>(p.x()) - kRound; x <= static_cast<int>(p.x()) + kRound; ++x) {
                if (x < 0 || y < 0 || x >= white.width || y >= white.height) continue;
                more += white.at(x, y) - black.at(x, y);
                ++count;
            }
        lit += count > 0 && more > kLitGrey * count;
    }
    return corners.size() ? static_cast<double>(lit) / static_cast<double>(corners.size()) : 0;
}

/// Looks at the white and the black picture, which come first: a board beside the light is not captured to the end.
class LitBoardCameras final : public StereoCamera {
public:
    LitBoardCameras(StereoCamera& cameras, const BoardSighting& sighting, double least_lit, Instant later)
        : cameras_(cameras), sighting_(sighting), least_lit_(least_lit), later_(later) {}

    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override {
        StereoFrame frame = cameras_.grab(not_before + later_, patience);
        if (++frames_ == 1) white_ = frame;
        if (frames_ == 2 && lit_by(frame) < least_lit_) {
            // The light may have come late: black is still shown.
            constexpr Instant kLate = 200ms;
            frame = cameras_.grab(not_before + later_ + kLate, patience);
            const double lit = lit_by(frame);
            if (lit < least_lit_)
                throw PoseLeft{PoseFault::beside_light,
                               fmt::format("The projector lights only {:.0f} % of it.", 100 * lit),
                               "Bring it into the middle of the projector's light."};
        }
        return frame;
    }
    /// Of the first two pictures another frame may be wanted.
    bool wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) override {
        return frames_ >= 2 && cameras_.wait_until_exposed(not_before + later_, patience);
    }
    std::string doubt() const override { return cameras_.doubt(); }

private:
    /// The least share of the board that is brighter under white light than under black.
    double lit_by(const StereoFrame& black) const {
        return std::min(lit_share(white_.left, black.left, sighting_.left.corners),
                        lit_share(white_.right, black.right, sighting_.right.corners));
    }
    StereoCamera& cameras_;
    const BoardSighting& sighting_;
    double least_lit_;
    Instant later_;
    int frames_ = 0;
    StereoFrame white_;
};

std::optional<double> predicted(const Calibration& calibration) {
    if (calibration.refusal || !calibration.volume) return std::nullopt;
    return std::max(calibration.volume->p95_mm, calibration.volume->light_p95_mm);
}

}  // namespace

GuidedCalibration::GuidedCalibration(Projector& projector, StereoCamera& cameras, const Clock& clock,
                                     const BoardSpec& board, const GuidedSettings& settings,
                                     std::function<void(const GuideEvent&)> tell)
    : projector_(projector),
      cameras_(cameras),
      clock_(clock),
      board_(board),
      settings_(settings),
      tell_(std::move(tell)),
      stripes_(multi_frequency_stripes(projector.width(), projector.height())),
      guide_(board, settings.guide),
      later_(settings.light_later),
      began_(clock.now()) {
    state_.least_poses = settings.guide.least_poses;
    state_.most_poses = settings.guide.most_poses;
    state_.good_enough_mm = settings.guide.good_enough_mm;
    state_.useful_tilt = settings.guide.useful_tilt;
    state_.wanted = guide_.wanted();
}

void GuidedCalibration::tell(GuideEvent::Kind kind, PoseFault fault, const std::string& why, const std::string& what) {
    if (tell_) tell_({kind, clock_.now() - began_, fault, why, what, poses_.size(), predicted_mm_});
}

void GuidedCalibration::set_step(GuideState::Step step, double share) {
    const std::lock_guard lock(mutex_);
    state_.step = step;
    state_.step_share = share;
}

GuideState GuidedCalibration::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

void GuidedCalibration::run(const std::stop_token& stop) {
    const DarkOnExit dark(projector_);
    stop_ = stop;
    Instant good_at = clock_.now();
    seen_at_ = clock_.now();
    while (!stop.stop_requested() && !guide_.done(predicted_mm_)) {
        try {
            look();
            good_at = clock_.now();
            const std::lock_guard lock(mutex_);
            state_.trouble.clear();
        } catch (const DeviceError& error) {
            if (clock_.now() - good_at > settings_.camera_patience) throw;
            set_step(GuideState::Step::watching, 0);
            const std::string trouble = fmt::format("{}.", error.what());
            if (state().trouble != trouble) tell(GuideEvent::Kind::trouble, PoseFault::none, trouble, error.remedy);
            {
                const std::lock_guard lock(mutex_);
                state_.trouble = trouble;
                state_.trouble_remedy = error.remedy;
            }
            light_ = {};
            std::this_thread::sleep_for(500ms);
        }
    }
    if (guide_.done(predicted_mm_)) tell(GuideEvent::Kind::done, PoseFault::none, "", "");
}

/// One look at the newest pictures, and what follows from it.
void GuidedCalibration::look() {
    collect_estimate();
    StereoFrame frame = cameras_.newest(seen_at_ + kLookEvery, kFramePatience);
    seen_at_ = frame.at;
    const auto left = std::make_shared<const GrayImage>(std::move(frame.left)),
               right = std::make_shared<const GrayImage>(std::move(frame.right));
    auto right_view = std::async(std::launch::async, [&] { return look_at_board(*right, board_); });
    BoardSighting sighting{look_at_board(*left, board_), right_view.get(), frame.at};
    const PoseAdvice advice = guide_.look(sighting);
    {
        const std::lock_guard lock(mutex_);
        state_.left = left;
        state_.right = right;
        state_.left_corners = sighting.left.corners;
        state_.right_corners = sighting.right.corners;
        state_.advice = advice;
        state_.wanted = guide_.wanted();
        state_.coverage = guide_.coverage();
    }
    say(advice);
    if (advice.capture && clock_.now() >= not_before_) capture(sighting);
}

/// By light at once; by events when it is new, and once for every place where the board was laid in vain.
void GuidedCalibration::say(const PoseAdvice& advice) {
    if (!advice.still) refused_here_ = advice.still_share > 0.5 && refused_here_;
    if (!refused_here_) {
        const std::lock_guard lock(mutex_);
        state_.given_up_why.clear();
        state_.given_up_what.clear();
    }
    const bool good = advice.fault == PoseFault::none;
    if (advice.still && !good && !refused_here_ && advice.fault != PoseFault::not_seen) {
        refused_here_ = true;
        ++refused_;
        tell(GuideEvent::Kind::refused, advice.fault, advice.why, advice.what);
    } else if (advice.fault != told_ || advice.what != told_what_) {
        tell(GuideEvent::Kind::advice, advice.fault, advice.why, advice.what);
    }
    told_ = advice.fault;
    told_what_ = advice.what;
    GuideLight light{good ? GuideLight::Mood::hold : GuideLight::Mood::wrong, advice.in_light,
                     good && advice.still_share >= 0.5 ? 0.5 : 0};
    if (advice.fault == PoseFault::alike && light_.mood == GuideLight::Mood::taken && advice.still) light = light_;
    shine(light);
}

void GuidedCalibration::shine(const GuideLight& light) {
    const Instant now = clock_.now(), shone_for = now - shone_at_;
    const bool another = !(light == light_);
    if (another ? shone_for < kLightLeast && shone_at_ > Instant{} : shone_for < kLightRenewed) return;
    projector_.show(draw_guide_light(light, projector_.width(), projector_.height()), now + kLightValid);
    light_ = light;
    shone_at_ = now;
    const std::lock_guard lock(mutex_);
    state_.light = light;
}

/// Whether the board has left its place, by a fresh look at it; false where it is not seen, for the light may be late.
bool GuidedCalibration::moved_since(const BoardSighting& before) {
    const Instant until = clock_.now() + 1s;
    while (clock_.now() < until) {
        const StereoFrame frame = cameras_.newest(clock_.now(), kFramePatience);
        const BoardSighting now{look_at_board(frame.left, board_), look_at_board(frame.right, board_), frame.at};
        if (now.left.corners.size() == 0 || now.right.corners.size() == 0) continue;
        PoseGuide here(board_, settings_.guide);
        here.look(before);
        return here.look(now).still_share <= 0;
    }
    return false;
}

void GuidedCalibration::give_up(PoseFault fault, const std::string& why, const std::string& what) {
    ++refused_;
    refused_here_ = true;
    not_before_ = clock_.now() + 1s;
    set_step(GuideState::Step::watching, 0);
    {
        const std::lock_guard lock(mutex_);
        state_.given_up_why = why;
        state_.given_up_what = what;
    }
    tell(GuideEvent::Kind::refused, fault, why, what);
    light_ = {};
    shone_at_ = {};
    shine({GuideLight::Mood::wrong, "AGAIN", 0});
}

/// Throws PoseLeft, or Ended.
ScanCapture GuidedCalibration::take_pictures(const BoardSighting& sighting) {
    LitBoardCameras watched(cameras_, sighting, settings_.guide.least_in_light, later_);
    return capture_scan(projector_, watched, clock_, stripes_, [&](int done, int of) {
        set_step(GuideState::Step::capturing, static_cast<double>(done) / of);
        if (stop_.stop_requested()) throw Ended{};
    });
}

PoseObservation GuidedCalibration::observe(const ScanCapture& pictures) const {
    PoseObservation pose{fmt::format("pose-{:02}", poses_.size() + 1), {}, {}};
    auto right = std::async(std::launch::async, [&] { return observe_board(pictures.right, stripes_, board_); });
    pose.left = observe_board(pictures.left, stripes_, board_);
    pose.right = right.get();
    return pose;
}

/// Throws PoseLeft where its pictures are no good: by what the person did rather than by what the pictures show.
void GuidedCalibration::refuse_bad(const PoseObservation& pose, const BoardSighting& sighting) {
    if (pose.left.corners.size() == 0 || pose.right.corners.size() == 0)
        throw PoseLeft{PoseFault::in_part, "The board was not seen to the end.",
                       "Leave it where it is while the light flickers."};
    constexpr double kMoved_px = 0.25;
    const auto refusal = judge_pose_pictures(pose, board_);
    if (refusal && (std::max(pose.left.moved_px, pose.right.moved_px) > kMoved_px || moved_since(sighting)))
        throw PoseLeft{PoseFault::none, "It was moved while the light flickered.",
                       "Lay it down, or lean your hands on something, until the light says TAKEN."};
    if (!pose.left.wrong_sequence.empty() || !pose.right.wrong_sequence.empty()) {
        later_ = std::min(later_ + kLaterStep, kLatest);
        throw PoseLeft{PoseFault::none,
                       "The light came later than this projector is said to be, so that pictures were mixed up.",
                       "Leave the board there: it is captured again, more slowly. `planlight projector` measures the "
                       "delay."};
    }
    if (refusal) throw PoseLeft{PoseFault::none, refusal->reason + ".", refusal->remedy};
}

void GuidedCalibration::keep_pose(PoseObservation pose) {
    guide_.add(pose, stripes_.width, stripes_.height);
    poses_.push_back(std::move(pose));
    refused_here_ = true;
    set_step(GuideState::Step::watching, 0);
    estimate();
    {
        const std::lock_guard lock(mutex_);
        state_.poses = poses_.size();
        state_.coverage = guide_.coverage();
        state_.wanted = guide_.wanted();
        state_.given_up_why.clear();
        state_.given_up_what.clear();
    }
    tell(GuideEvent::Kind::captured, PoseFault::none, "", "");
}

/// The pose, if its pictures are good; the reason if not.
void GuidedCalibration::capture(const BoardSighting& sighting) {
    tell(GuideEvent::Kind::capturing, PoseFault::none, "", "Leave it as it is.");
    try {
        const ScanCapture pictures = take_pictures(sighting);
        shone_at_ = {};
        shine({GuideLight::Mood::taken, "TAKEN", 0});
        set_step(GuideState::Step::looking, 1);
        PoseObservation pose = observe(pictures);
        refuse_bad(pose, sighting);
        keep_pictures(pictures);
        keep_pose(std::move(pose));
    } catch (const Ended&) {
    } catch (const PoseLeft& left) {
        give_up(left.fault, left.why, left.what);
    }
}

void GuidedCalibration::keep_pictures(const ScanCapture& capture) const {
    if (settings_.captures.empty()) return;
    CaptureFolder folder = capture_folder_from(capture);
    folder.serials = settings_.serials;
    make_folder(settings_.captures);
    write_capture(folder, settings_.captures / fmt::format("pose-{:02}", poses_.size() + 1));
}

Calibration GuidedCalibration::calibrate() const {
    return calibrate_rig(poses_, board_, stripes_.width, stripes_.height);
}

/// In the background, without the judgement on held-out poses: what the person does next need not wait for it.
void GuidedCalibration::estimate() {
    constexpr std::size_t kLeast = 3;
    if (poses_.size() < kLeast || estimate_.valid()) return;
    estimated_poses_ = poses_.size();
    CalibrationSettings quick;
    quick.folds = 0;
    estimate_ = std::async(std::launch::async, [poses = poses_, board = board_, stripes = stripes_, quick] {
        return calibrate_rig(poses, board, stripes.width, stripes.height, quick);
    });
}

void GuidedCalibration::collect_estimate() {
    if (!estimate_.valid() || estimate_.wait_for(0s) != std::future_status::ready) return;
    const Calibration calibration = estimate_.get();
    predicted_mm_ = predicted(calibration);  // one that is refused now says that the last was too good
    if (predicted_mm_) guide_.use_rig(calibration.bundle.rig);
    {
        const std::lock_guard lock(mutex_);
        state_.predicted_mm = predicted_mm_;
        state_.coverage = guide_.coverage();
    }
    if (tell_)
        tell_({GuideEvent::Kind::predicted, clock_.now() - began_, PoseFault::none,
               calibration.refusal ? calibration.refusal->reason + "." : "", "", estimated_poses_, predicted_mm_});
    if (estimated_poses_ < poses_.size()) estimate();
}

}  // namespace planlight
