#include "registration/scan/triangulate/find_rig_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "planning_io/types/between_rays.h"
#include "planning_io/types/statistics.h"
#include "registration/scan/triangulate/rig_doubts.h"
#include "registration/scan/triangulate/rig_explanations.h"

namespace planlight {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::size_t kPlacesOfDoubt = 50;

bool contains(const std::vector<RigDevice>& devices, RigDevice device) {
    return std::find(devices.begin(), devices.end(), device) != devices.end();
}

/// Places spread evenly over the matches, with a start for their points by the two cameras.
std::vector<SeenPlace> places_of(const ViewMatches& matches, const RigCalibration& rig, std::size_t wanted) {
    std::vector<SeenPlace> places;
    const std::size_t every = 1 + matches.both.size() / wanted;
    for (std::size_t i = every / 2; i < matches.both.size(); i += every) {
        const ViewMatch& m = matches.both[i];
        if (!m.whole) continue;
        const auto a = ray_through(rig.left_camera, m.pixel), b = ray_through(rig.right_camera, m.right);
        if (!a || !b) continue;
        const auto p = between_rays(*a, *b);
        if (!p) continue;
        places.push_back({{m.pixel, m.right, m.code}, *p});
    }
    return places;
}

std::vector<RigDevice> devices_of(const Explanation& e) {
    return e.moved.empty() ? e.lens : e.moved;
}

std::string names_of(const std::vector<RigDevice>& devices) {
    std::string text;
    for (const RigDevice device : devices)
        text += fmt::format("{}the {}", text.empty() ? "" : " and ", text_of(device));
    return text;
}

/// "the projector moved", "the left camera moved or its lens was changed (focus, zoom or shift)".
std::string words_of(const std::vector<RigDevice>& devices, bool moved, bool lens) {
    constexpr const char* kLens = "lens was changed (focus, zoom or shift)";
    if (!moved && devices.size() > 1) return "both cameras' lenses were changed (focus, zoom or warmth)";
    if (!moved) return fmt::format("{}'s {}", names_of(devices), kLens);
    return names_of(devices) + (lens ? fmt::format(" moved or its {}", kLens) : std::string(" moved"));
}

/// Explanations that blame the same device are one: "the projector moved, or the left camera moved".
std::string words_of(const std::vector<const Explanation*>& possible) {
    std::vector<std::vector<RigDevice>> blamed;
    std::string text;
    for (const Explanation* e : possible) {
        const auto devices = devices_of(*e);
        bool moved = !e->moved.empty(), lens = !e->lens.empty();
        if (devices.size() == 1) {
            if (std::find(blamed.begin(), blamed.end(), devices) != blamed.end()) continue;
            blamed.push_back(devices);
            for (const Explanation* other : possible)
                if (devices_of(*other) == devices) moved |= !other->moved.empty(), lens |= !other->lens.empty();
        }
        text += (text.empty() ? "" : ", or ") + words_of(devices, moved, lens);
    }
    return text;
}

void find_devices(const RigCalibration& before, const std::vector<const Explanation*>& possible, RigState& state) {
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto device = static_cast<RigDevice>(d);
        DeviceFinding& finding = state.devices[d];
        const CameraModel &a = device_of(before, device), &b = device_of(state.rig, device);
        finding.moved_mm = (a.centre_in_rig() - b.centre_in_rig()).norm();
        finding.turned = angle_between(a.device_from_rig, b.device_from_rig);
        finding.focal_change = b.focal_x / a.focal_x - 1;
        std::size_t blamed = 0;
        for (const Explanation* e : possible) blamed += contains(e->moved, device) || contains(e->lens, device);
        finding.moved = blamed == possible.size() && blamed > 0;
        finding.maybe = blamed > 0 && !finding.moved;
        if (possible.empty()) continue;
        finding.best = contains(possible.front()->moved, device) || contains(possible.front()->lens, device);
        finding.lens = contains(possible.front()->lens, device);
    }
}

std::string of_lens(const DeviceFinding& finding) {
    constexpr double kNone = 5e-4;
    return std::abs(finding.focal_change) < kNone
               ? "a shift of its picture"
               : fmt::format("{:+.2f} % of its focal length", 100 * finding.focal_change);
}

std::string size_of(const Explanation& best, const RigState& state) {
    std::string text;
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto device = static_cast<RigDevice>(d);
        const DeviceFinding& f = state.devices[d];
        if (contains(best.moved, device))
            text += fmt::format("{}{:.2f} mm and {:.3f} degrees", text.empty() ? "" : "; ", f.moved_mm,
                                f.turned * kDegrees);
        if (contains(best.lens, device)) text += (text.empty() ? "" : "; ") + of_lens(f);
    }
    return text;
}

constexpr const char* kGoOn =
    "The cloud is made, the patient followed and the light drawn with the rig as it stands now; calibrate it again as "
    "soon as there is time.";
constexpr const char* kStop = "No light is drawn with it: calibrate the rig again.";
/// What a lens and a picture that is drawn larger do to the light is the same.
constexpr const char* kSeeFirst = " See first that no keystone correction and no scaling of the picture is on.";

void judge(const Explanation& best, const std::vector<const Explanation*>& possible, const RigStateSettings& settings,
           RigState& state) {
    const bool fits = best.usual <= settings.max_usual_residual;
    const std::string since =
        state.rig.made_on.empty() ? "since the calibration" : "since the calibration of " + state.rig.made_on;
    state.verdict = fits && state.hidden_light_mm <= settings.max_hidden_mm ? RigState::Verdict::corrected
                                                                            : RigState::Verdict::not_trusted;
    state.sentence = fmt::format("{} {} (by {})", words_of(possible), since, size_of(best, state));
    const auto others = [&](const Explanation* e) {
        return devices_of(*e) != devices_of(best) ||
               (devices_of(best).size() > 1 && e->moved.empty() != best.moved.empty());
    };
    if (std::any_of(possible.begin(), possible.end(), others)) state.sentence += "; one scan cannot tell which";
    state.sentence +=
        fits ? fmt::format("; light may be off by up to {:.2f} mm without a sign of it", state.hidden_light_mm)
             : "; the devices fit each other from no place";
    state.remedy = state.verdict == RigState::Verdict::corrected ? kGoOn : kStop;
    // A keystone correction that was switched on after the calibration is no device's place or lens: nothing fits it.
    if (contains(best.lens, RigDevice::projector) || state.verdict == RigState::Verdict::not_trusted)
        state.remedy += kSeeFirst;
}

/// Whether no device stands or sees so differently that it cannot have been moved by accident.
bool is_a_bump(const RigCalibration& before, const RigState& state) {
    constexpr double kTurned = 0.05, kMoved_mm = 50, kFocal = 0.15, kCentreByWidth = 0.05;
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto device = static_cast<RigDevice>(d);
        const DeviceFinding& f = state.devices[d];
        const CameraModel &a = device_of(before, device), &b = device_of(state.rig, device);
        const double centre_px = std::hypot(b.centre_x - a.centre_x, b.centre_y - a.centre_y);
        if (f.turned > kTurned || f.moved_mm > kMoved_mm || std::abs(f.focal_change) > kFocal ||
            centre_px > kCentreByWidth * a.width)
            return false;
    }
    return true;
}

/// The rig by the explanation that costs least, and what the others that cost little more would do to the light.
void take_moved(const RigCalibration& rig, const RigFits& fits, const std::vector<SeenPlace>& some,
                const RigStateSettings& settings, RigState& state) {
    const Explanation& best = fits.others.front();
    std::vector<const Explanation*> possible;
    state.rig = changed(rig, best.numbers);
    state.doubts = own_doubts(best, state.rig, some);
    for (const Explanation& other : fits.others) {
        if (other.chi_square > best.chi_square + fits.noise * settings.doubt_chi_square) break;
        possible.push_back(&other);
        if (&other == &best) continue;
        RigDoubt doubt = doubt_between(state.rig, changed(rig, other.numbers), some);
        doubt.what = words_of({&other});
        doubt.chi_square = other.chi_square - best.chi_square;
        state.doubts.push_back(doubt);
    }
    find_devices(rig, possible, state);
    state.hidden_light_mm = hidden_over(state, some);
    judge(best, possible, settings, state);
    if (state.verdict != RigState::Verdict::corrected || is_a_bump(rig, state)) return;
    state.verdict = RigState::Verdict::not_trusted;
    state.sentence +=
        "; that is more than a bump: another rig, a picture under keystone correction, or a code that begins elsewhere";
    state.remedy =
        "Use the rig.json of this rig, switch keystone correction and scaling off, say in capture.json where its code "
        "begins, or calibrate it again.";
}

/// How far the cameras' rays miss each other, sigmas of their pixels: the usual place.
double usual_miss(const std::vector<SeenPlace>& places, const RigCalibration& rig) {
    constexpr double kSigma_px = 0.1, kMedianOfNormal = 0.6745;
    std::vector<double> sigmas;
    for (const SeenPlace& place : places) {
        const auto left = ray_through(rig.left_camera, place.pixels[0]),
                   right = ray_through(rig.right_camera, place.pixels[1]);
        const auto p = left && right ? between_rays(*left, *right) : std::nullopt;
        const auto in_left = p ? project(rig.left_camera, *p) : std::nullopt,
                   in_right = p ? project(rig.right_camera, *p) : std::nullopt;
        if (in_left && in_right)
            sigmas.push_back(std::hypot((*in_left - place.pixels[0]).norm(), (*in_right - place.pixels[1]).norm()) /
                             kSigma_px);
    }
    return median(std::move(sigmas)) / kMedianOfNormal;
}

/// The rig within what its calibration leaves open, where rig.json itself would lose the points of usual places.
void adjust_within_calibration(const RigFits& fits, const std::vector<SeenPlace>& places,
                               const RigStateSettings& settings, RigState& state) {
    const double before = usual_miss(places, state.rig);
    if (!(before > settings.max_unadjusted)) return;
    const RigCalibration adjusted = changed(state.rig, fits.as_calibrated.numbers);
    const double after = usual_miss(places, adjusted);
    if (!(after < before)) return;
    state.rig = adjusted;
    state.sentence += fmt::format(
        ", within what its calibration leaves open: the cameras' rays missed each other by {:.1f} sigmas, now by "
        "{:.1f}",
        before, after);
}

void take_as_calibrated(const RigFits& fits, const std::vector<SeenPlace>& places, const std::vector<SeenPlace>& some,
                        const RigStateSettings& settings, RigState& state) {
    const bool fits_together = fits.as_calibrated.usual <= settings.max_usual_residual;
    if (fits_together) {
        state.verdict = RigState::Verdict::as_calibrated;
        state.sentence = "the rig is as it was calibrated";
        adjust_within_calibration(fits, places, settings, state);
    }
    state.doubts = own_doubts(fits.as_calibrated, state.rig, some);
    state.hidden_light_mm = hidden_over(state, some);
    if (fits_together) return;
    state.verdict = RigState::Verdict::not_trusted;
    state.sentence = "the devices fit each other from no place: another rig, or a lens or a distortion that is wrong";
    state.remedy = "Use the rig.json of this rig, or calibrate it again.";
}

}  // namespace

RigState find_rig_state(const ViewMatches& matches, const RigCalibration& rig, const RigStateSettings& settings) {
    RigState state;
    state.rig = rig;
    const std::vector<SeenPlace> places = places_of(matches, rig, settings.places);
    if (places.size() < settings.min_places) {
        state.sentence = "whether the rig moved is not known: too little is seen by both cameras under the light";
        return state;
    }
    std::vector<SeenPlace> some;
    for (std::size_t i = 0; i < places.size(); i += 1 + places.size() / kPlacesOfDoubt) some.push_back(places[i]);
    const RigFits fits = fit_explanations(places, rig, settings);
    if (!fits.others.empty() &&
        fits.as_calibrated.chi_square - fits.others.front().chi_square > fits.noise * settings.moved_chi_square)
        take_moved(rig, fits, some, settings, state);
    else
        take_as_calibrated(fits, places, some, settings, state);
    return state;
}

}  // namespace planlight
