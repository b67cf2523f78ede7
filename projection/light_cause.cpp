#include "projection/light_cause.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "projection/light_patterns.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Weighted mean square of what an explanation leaves; one huge sample counts no more than a large one.
template <class Explained>
double left_mm2(const std::vector<LightSample>& samples, Explained explained) {
    constexpr double kMost_mm = 3;
    double sum = 0, weight = 0;
    for (const LightSample& s : samples) {
        const double left = std::clamp(s.off_mm - explained(s), -kMost_mm, kMost_mm);
        sum += s.weight * left * left;
        weight += s.weight;
    }
    return weight > 0 ? sum / weight : 0;
}

struct TurnedProjector {
    double size_mm = 0;  ///< of the light, root mean square
    double left_mm2 = 0;
};

/// The projector turned so that it explains the samples best beside the pictures as told; a little held back, so that a
/// direction that nothing tells stays unturned.
TurnedProjector fit_projector(const std::vector<LightSample>& samples) {
    constexpr double kHeldBack_mm2 = 0.02;  // per radian of 900 mm
    Vector3d turn = Vector3d::Zero();
    for (int round = 0; round < 3; ++round) {
        Matrix3d A = Matrix3d::Zero();
        Vector3d b = Vector3d::Zero();
        double weight = 0;
        for (const LightSample& s : samples) {
            const double left = s.off_mm - s.told_mm - s.by_projector.dot(turn);
            const double w = s.weight * (round == 0 || std::abs(left) < 0.3 ? 1 : 0.3 / std::abs(left));
            A += w * s.by_projector * s.by_projector.transpose();
            b += w * (s.off_mm - s.told_mm) * s.by_projector;
            weight += w;
        }
        A.diagonal().array() += kHeldBack_mm2 * weight * std::max(1.0, A.trace() / std::max(weight, 1e-9) * 0.05);
        turn = A.ldlt().solve(b);
    }
    TurnedProjector fit;
    double sum = 0, weight = 0;
    for (const LightSample& s : samples) {
        sum += s.weight * std::pow(s.by_projector.dot(turn), 2);
        weight += s.weight;
    }
    fit.size_mm = std::sqrt(sum / std::max(weight, 1e-9));
    fit.left_mm2 = left_mm2(samples, [&](const LightSample& s) { return s.told_mm + s.by_projector.dot(turn); });
    return fit;
}

struct Lateness {
    double low_s = 0, high_s = 0, effect_mm = 0, left_mm2 = 0;
    int frames = 0;  ///< in which it makes a difference, and the time they cover: one jerk of the head is no delay
    Instant span{};
    double middle_s() const { return (low_s + high_s) / 2; }
};

/// The delay that explains the samples best. Frames and pictures keep step, so that a range of delays may do so alike.
Lateness fit_delay(const std::vector<LightSample>& samples, const std::vector<double>& delays_s) {
    std::vector<double> left;
    for (std::size_t d = 0; d < delays_s.size(); ++d)
        left.push_back(left_mm2(samples, [&](const LightSample& s) { return s.by_delay_mm[d]; }));
    const auto best = static_cast<std::size_t>(std::min_element(left.begin(), left.end()) - left.begin());
    const double alike = left[best] + std::max(1e-4, 0.05 * left[best]);
    std::size_t low = best, high = best;
    while (low > 0 && left[low - 1] <= alike) --low;
    while (high + 1 < left.size() && left[high + 1] <= alike) ++high;
    Lateness fit{delays_s[low], delays_s[high], 0, left[best], 0, {}};
    constexpr double kDifference_mm = 0.1;
    double sum = 0, weight = 0;
    Instant counted = Instant::min();
    for (const LightSample& s : samples) {
        if (s.at != counted && std::abs(s.by_delay_mm[best] - s.told_mm) > kDifference_mm) {
            if (fit.frames++ > 0) fit.span += s.at - counted;
            counted = s.at;
        }
        sum += s.weight * std::pow(s.by_delay_mm[best] - s.told_mm, 2);
        weight += s.weight;
    }
    fit.effect_mm = std::sqrt(sum / std::max(weight, 1e-9));
    return fit;
}

/// How a window of frames is judged.
class Judgement {
public:
    Judgement(const std::vector<LightFacts>& facts, const RigCalibration& rig, double usual_background,
              const LightCauseSettings& settings)
        : facts_(facts), rig_(rig), usual_background_(usual_background), settings_(settings) {}

    std::vector<LightCause> causes() {
        if (facts_.empty()) return {};
        look_at_markers();
        if (!look_for_light()) {
            look_at_depth();
            look_at_place();
        }
        look_at_lost_pose();
        std::stable_sort(causes_.begin(), causes_.end(), [](const LightCause& a, const LightCause& b) {
            return a.light_is_wrong != b.light_is_wrong ? a.light_is_wrong : a.share > b.share;
        });
        return causes_;
    }

private:
    Instant now() const { return facts_.back().at; }
    LightCause& add(LightFault fault, double size, double share) {
        LightCause cause;
        cause.fault = fault;
        cause.size = size;
        cause.share = share;
        causes_.push_back(cause);
        return causes_.back();
    }

    /// A marker that most of the last frames were followed without.
    void look_at_markers() {
        int frames = 0, without = 0, marker = -1;
        std::vector<double> sizes;
        for (const LightFacts& f : facts_) {
            if (f.at < now() - settings_.least) continue;
            ++frames;
            if (f.slipped_marker < 0 || f.slipped_mm < settings_.least_slip_mm) continue;
            ++without;
            marker = f.slipped_marker;
            sizes.push_back(f.slipped_mm);
        }
        if (without < settings_.least_checks || 2 * without < frames) return;
        LightCause& cause = add(LightFault::marker_slipped, median(sizes), 1);
        cause.marker = marker;
        cause.light_is_wrong = false;
    }

    /// True when light is not seen, or too little of it: then nothing is said of its place.
    bool look_for_light() {
        int checks = 0, expected = 0, seen = 0;
        std::vector<double> background, far_mm;
        for (const LightFacts& f : facts_) {
            if (f.at < now() - settings_.least || f.expected == 0) continue;
            if (f.far_mm) far_mm.push_back(*f.far_mm);
            ++checks;
            expected += f.expected;
            seen += f.seen;
            background.push_back(f.background);
        }
        if (checks < settings_.least_checks) return false;
        const double share = static_cast<double>(seen) / expected;
        if (2 * static_cast<int>(far_mm.size()) > checks) {
            add(LightFault::light_off, median(std::move(far_mm)), 1);
            return true;
        }
        if (share >= settings_.covered_share) return false;
        const double grey = median(background);
        const bool brighter = usual_background_ > 0 && grey > settings_.brighter * usual_background_ &&
                              grey > usual_background_ + settings_.brighter_grey;
        add(share >= settings_.unseen_share ? LightFault::partly_covered
            : brighter                      ? LightFault::other_picture
                                            : LightFault::no_picture,
            share, 1);
        return share < settings_.unseen_share;
    }

    /// Light at another depth than the skin is by the markers.
    void look_at_depth() {
        constexpr std::size_t kLeast = 20;
        std::vector<double> depths;
        for (const LightSample& s : light_samples(facts_, now() - settings_.window, rig_, {}))
            if (s.depth_mm) depths.push_back(*s.depth_mm);
        if (depths.size() < kLeast) return;
        const double depth = median(depths);
        std::vector<double> spread;
        for (const double d : depths) spread.push_back(std::abs(d - depth));
        if (std::abs(depth) < settings_.least_depth_mm || std::abs(depth) < median(std::move(spread))) return;
        add(LightFault::markers_moved, std::abs(depth), 0.9);
    }

    /// Light beside its place: the explanation that leaves least.
    void look_at_place() {
        std::vector<double> delays_s;
        constexpr double kAlike = 0.02;  // a delay is one figure, a turn is three: explained alike, it is the delay
        constexpr double kEarliest_s = -0.04;  // light may also come earlier than told, as after a delay that went by
        for (double d = kEarliest_s; d <= settings_.most_delay_s; d += settings_.delay_step_s) delays_s.push_back(d);
        const auto recent = light_samples(facts_, now() - settings_.window, rig_, delays_s);
        if (checks_since(now() - settings_.window) < settings_.least_checks || recent.empty()) return;
        const auto told = [](const LightSample& s) { return s.told_mm; };
        const double unexplained = left_mm2(recent, told);
        const TurnedProjector turned = fit_projector(recent);
        const double explained_by_turn = 1 - turned.left_mm2 / std::max(unexplained, 1e-9);
        const auto [late, explained_by_delay, window] = best_delay(delays_s);
        const bool is_late = std::abs(late.middle_s()) >= settings_.least_delay_s &&
                             late.effect_mm >= settings_.least_effect_mm && explained_by_delay > 0.5 &&
                             explained_by_delay > explained_by_turn_since(now() - window) - kAlike;
        const bool is_turned = turned.size_mm >= settings_.least_off_mm && explained_by_turn > 0.5;
        if (is_late) {
            LightCause& cause = add(LightFault::late_picture, 1e3 * late.middle_s(), explained_by_delay);
            cause.low = 1e3 * late.low_s;
            cause.high = 1e3 * late.high_s;
        } else if (is_turned) {
            add(device_that_moved(), turned.size_mm, explained_by_turn);
        } else if (std::sqrt(unexplained) >= settings_.least_off_mm && explained_by_turn > 0.2) {
            add(device_that_moved(), std::sqrt(unexplained), explained_by_turn);
        } else if (std::sqrt(unexplained) >= 2 * settings_.least_off_mm) {
            add(LightFault::light_off, std::sqrt(unexplained), 0.5);
        }
    }

    /// The delay of that part of the last seconds which a delay explains best: it may have begun just now, and takes
    /// movement to be told.
    struct BestDelay {
        Lateness late;
        double explained = 0;
        Instant window{};
    };
    BestDelay best_delay(const std::vector<double>& delays_s) const {
        constexpr Instant kLeastSpan = std::chrono::milliseconds(250);
        BestDelay best;
        for (const Instant window : {settings_.least, settings_.window, 2 * settings_.window, settings_.long_window}) {
            const auto samples = light_samples(facts_, now() - window, rig_, delays_s);
            if (checks_since(now() - window) < settings_.least_checks) continue;
            const double unexplained = left_mm2(samples, [](const LightSample& s) { return s.told_mm; });
            const Lateness late = fit_delay(samples, delays_s);
            const double explained = 1 - late.left_mm2 / std::max(unexplained, 1e-9);
            if (late.effect_mm >= settings_.least_effect_mm && late.frames > settings_.least_checks &&
                late.span >= kLeastSpan && explained > best.explained)
                best = {late, explained, window};
        }
        return best;
    }

    /// Of the frames that a delay is told by, lest one is judged by more of good light than the other.
    double explained_by_turn_since(Instant from) const {
        const auto samples = light_samples(facts_, from, rig_, {});
        const double unexplained = left_mm2(samples, [](const LightSample& s) { return s.told_mm; });
        return 1 - fit_projector(samples).left_mm2 / std::max(unexplained, 1e-9);
    }

    int checks_since(Instant from) const {
        return static_cast<int>(std::count_if(
            facts_.begin(), facts_.end(), [&](const LightFacts& f) { return f.at >= from && f.pose && f.seen > 0; }));
    }

    /// One camera's discs jumped and the other's did not: that camera; else the projector.
    LightFault device_that_moved() const { return jumped_camera().value_or(LightFault::projector_moved); }

    std::optional<LightFault> jumped_camera() const {
        double greatest_mm = 0;
        std::optional<LightFault> found;
        for (const LightFacts& f : facts_) {
            if (!f.jump_mm[0] || !f.jump_mm[1]) continue;
            const double left = *f.jump_mm[0], right = *f.jump_mm[1];
            const double more = std::max(left, right), less = std::min(left, right);
            if (more < settings_.least_jump_mm || less > settings_.other_jump * more || more <= greatest_mm) continue;
            greatest_mm = more;
            found = left > right ? LightFault::left_camera_moved : LightFault::right_camera_moved;
        }
        return found;
    }

    /// No pose since one camera's discs jumped: the two no longer agree on any.
    void look_at_lost_pose() {
        const auto lost = std::find_if(facts_.rbegin(), facts_.rend(), [](const LightFacts& f) { return f.pose; });
        const auto frames = lost - facts_.rbegin();
        if (frames < settings_.least_checks) return;
        if (const auto camera = jumped_camera()) add(*camera, 0, 1);
    }

    const std::vector<LightFacts>& facts_;
    const RigCalibration& rig_;
    double usual_background_;
    const LightCauseSettings& settings_;
    std::vector<LightCause> causes_;
};

}  // namespace

std::vector<LightCause> find_causes(const std::vector<LightFacts>& facts, const RigCalibration& rig,
                                    double usual_background, const LightCauseSettings& settings) {
    return Judgement(facts, rig, usual_background, settings).causes();
}

}  // namespace planlight
