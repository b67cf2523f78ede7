#include "app/belonging.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "planning_io/case/cloud_rig.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "projection/skin_now.h"
#include "registration/matching/register_patient.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxHidden_mm = 1;  // at a point of the plan, without a person's look
/// Of the projector's focal length, without a person's look: a code that was read with another period looks like a
/// zoom.
constexpr double kMaxZoomed = 0.004;

std::string begin_of(const std::string& hash) {
    return hash.substr(0, 8);
}

std::string words_of(const CaseName& name) {
    return fmt::format("case {} (volume {}, skin {})", name.code, begin_of(name.volume_hash), begin_of(name.mesh_hash));
}

std::string words_of(const RigName& name) {
    std::string text = fmt::format("rig {} (calibrated {}", begin_of(name.hash),
                                   name.made_on.empty() ? "on a day not said" : name.made_on);
    for (const auto& [what, serial] :
         {std::pair{"left camera", &name.serials.left_camera}, std::pair{"right camera", &name.serials.right_camera},
          std::pair{"projector", &name.serials.projector}})
        if (!serial->empty()) text += fmt::format(", {} {}", what, *serial);
    return text + ")";
}

/// Two findings of the same capture may differ by their last digits.
bool same(const CameraModel& a, const CameraModel& b) {
    constexpr double kAngle = 5e-5, kShift_mm = 0.1, kFocal = 2e-4;
    return angle_between(a.device_from_rig, b.device_from_rig) < kAngle &&
           (a.centre_in_rig() - b.centre_in_rig()).norm() < kShift_mm && std::abs(a.focal_x / b.focal_x - 1) < kFocal;
}

double projector_zoom(const RigState& rig) {
    return rig.devices[static_cast<std::size_t>(RigDevice::projector)].focal_change;
}

bool was_zoomed(const RigState& rig) {
    return rig.verdict == RigState::Verdict::corrected && std::abs(projector_zoom(rig)) > kMaxZoomed;
}

/// Another pose, or the mirrored head, fits nearly as well, or a pattern of another size: how uncertain this pose is
/// tells nothing of how far off it may be.
bool may_be_elsewhere(const RegistrationResult& found) {
    static const RegistrationSettings limits;
    if (found.verdict == Verdict::yes) return false;
    const auto near = [](double ratio, double least) { return ratio > 0 && ratio < least; };
    return near(found.runner_up_ratio, limits.min_runner_up_ratio) ||
           near(found.mirror_ratio, limits.min_mirror_ratio) || (found.rig && was_zoomed(*found.rig));
}

}  // namespace

std::string hash_of(const ScanCapture& capture) {
    ContentHash hash;
    hash.add("planlight capture 1");
    const std::array<std::int32_t, 3> light{capture.stripes.width, capture.stripes.height, capture.stripes.phase_steps};
    hash.add_values(light.data(), light.size());
    for (const auto* frames : {&capture.left, &capture.right})
        for (const GrayImage& frame : *frames) {
            const std::array<std::int32_t, 2> size{frame.width, frame.height};
            hash.add_values(size.data(), size.size());
            hash.add_bytes(frame.pixels.data(), frame.pixels.size());
        }
    return hash.hex();
}

RigState named_rig_state(const ScanResult& scan, const RigCalibration& calibrated, const ScanCapture& capture) {
    RigState state = scan.rig;
    state.calibrated = name_of(calibrated);
    state.capture_hash = hash_of(capture);
    return state;
}

void take_case_and_rig(const Case& the_case, const std::optional<RigState>& rig, RegistrationResult& match) {
    match.of_case = name_of(the_case);
    match.rig = rig;
    if (!rig || match.verdict == Verdict::no) return;
    if (rig->verdict == RigState::Verdict::not_trusted) {
        match.verdict = Verdict::no;
        if (!rig->remedy.empty()) match.reasons.insert(match.reasons.begin(), rig->remedy);
        match.reasons.insert(match.reasons.begin(), "The rig cannot be trusted: " + rig->sentence);
        return;
    }
    const auto ask = [&](const std::string& reason) {
        match.verdict = Verdict::ask;
        match.reasons.push_back(reason);
    };
    if (rig->accepted_movement_mm > 0)
        ask(
            fmt::format("The patient moved by {:.1f} mm during the scan, and it was taken all the same "
                        "(--accept-movement).",
                        rig->accepted_movement_mm));
    if (rig->verdict == RigState::Verdict::unknown) {
        std::string reason = rig->sentence.empty() ? "whether the rig moved is not known" : rig->sentence;
        reason.front() = 'W';
        ask(reason + ".");
        return;
    }
    double hidden_mm = 0;
    for (const auto& p_in_ct : points_of(the_case.plan))
        hidden_mm = std::max(hidden_mm, hidden_light_mm(*rig, match.patient_from_ct * p_in_ct));
    if (was_zoomed(*rig))
        ask(fmt::format(
            "The projector's focal length changed by {:.1f} % since the calibration, or the pictures are not "
            "of the pattern that capture.json says.",
            100 * projector_zoom(*rig)));
    if (hidden_mm > kMaxHidden_mm)
        ask(fmt::format(
            "The rig moved in a way that one scan cannot tell ({}): at a point of the plan it may hide {:.1f} mm.",
            rig->sentence, hidden_mm));
}

double light_by_scale_mm(const RegistrationResult& found, const Eigen::Vector3d& p_in_ct) {
    if (!found.covariance.known()) return 0;
    const double surely = std::max(0.0, std::abs(found.scale - 1) - 2 * found.scale_sigma);
    return surely * (p_in_ct - found.covariance.centre_in_ct).norm();
}

double predicted_light_mm(const RegistrationResult& found, const Eigen::Vector3d& p_in_ct, double hidden_mm) {
    if (may_be_elsewhere(found)) return std::numeric_limits<double>::infinity();
    // (std::hypot of three numbers makes "not a number" of an infinite one, and no maximum holds that.)
    const double pose_mm = found.covariance.known() ? predicted_error(found.covariance, p_in_ct).bound_95_mm
                                                    : std::numeric_limits<double>::infinity();
    if (!std::isfinite(pose_mm)) return std::numeric_limits<double>::infinity();
    return std::hypot(pose_mm, hidden_mm, light_by_scale_mm(found, p_in_ct));
}

double predicted_light_mm(const RegistrationResult& found, const Eigen::Vector3d& p_in_ct) {
    const double hidden_mm = found.rig ? hidden_light_mm(*found.rig, found.patient_from_ct * p_in_ct) : 0;
    return predicted_light_mm(found, p_in_ct, hidden_mm);
}

void check_case(const RegistrationResult& match, const Case& the_case, const fs::path& file,
                std::vector<std::string>& unknown) {
    const CaseName here = name_of(the_case);
    if (!match.of_case.known()) {
        unknown.push_back(fmt::format("{} does not say of which case it is; it is taken for one of {}", file.string(),
                                      words_of(here)));
    } else if (match.of_case.volume_hash != here.volume_hash || match.of_case.mesh_hash != here.mesh_hash ||
               match.of_case.code != here.code) {  // of another plan: its verdict is on the points of that one
        throw InputError(file, fmt::format("is a match of {}, and this is {}", words_of(match.of_case), words_of(here)),
                         "Name the case that was matched, or register the patient on this one.");
    }
}

void check_rig(const RegistrationResult& match, const RigCalibration& rig, const fs::path& file,
               const fs::path& rig_file, std::vector<std::string>& unknown) {
    const RigName here = name_of(rig);
    if (!match.rig || !match.rig->calibrated.known()) {
        unknown.push_back(fmt::format("{} does not say with which rig its cloud was made", file.string()));
    } else if (match.rig->calibrated.hash != here.hash) {
        throw InputError(file,
                         fmt::format("is of a scan with {}, and {} is {}", words_of(match.rig->calibrated),
                                     rig_file.string(), words_of(here)),
                         "Name the rig.json that the scan was made with, or scan and register again with this one.");
    }
}

void check_poses(const std::optional<PosesOrigin>& origin, const RegistrationResult& match, const RigCalibration& rig,
                 const fs::path& file, bool confirmed, std::vector<std::string>& unknown) {
    const auto on_a_persons_word = [&](const std::string& sentence) {
        if (!confirmed)
            throw CheckFailedError(sentence,
                                   "Track the frames with `planlight track --capture` of the scan that was matched, or "
                                   "look at the light on landmarks and give --confirmed.");
        unknown.push_back(sentence);
    };
    if (!origin) {
        on_a_persons_word(
            fmt::format("{} does not say with which rig and from which scan its poses are", file.string()));
        return;
    }
    const RigName here = name_of(rig);
    if (origin->calibrated.hash != here.hash)
        throw InputError(file,
                         fmt::format("holds poses of {}, and this is {}", words_of(origin->calibrated), words_of(here)),
                         "Track the frames with this rig.json.");
    if (origin->capture_hash.empty())
        on_a_persons_word(
            fmt::format("the poses of {} begin at its first frame, not at a scan: they are right only if the patient "
                        "had not moved since the scan",
                        file.string()));
    if (!match.rig) return;
    if (!origin->capture_hash.empty() && !match.rig->capture_hash.empty() &&
        origin->capture_hash != match.rig->capture_hash)
        throw InputError(
            file,
            fmt::format("holds poses from the scan of capture {}, and the match is of the scan of capture {}",
                        begin_of(origin->capture_hash), begin_of(match.rig->capture_hash)),
            "Track the frames with `planlight track --capture` of the scan that was matched.");
    if (!same(origin->rig.left_camera, match.rig->rig.left_camera) ||
        !same(origin->rig.right_camera, match.rig->rig.right_camera))
        throw InputError(file, "was tracked with cameras that stand elsewhere than the scan found them",
                         "Track the frames with `planlight track --capture` or `track --registration` of the scan that "
                         "was matched.");
}

void check_points(const PointCloud& cloud, const std::optional<RigState>& rig, const fs::path& file) {
    constexpr double kUsual_px = 1.5, kMost_px = 6;  // the projector's; of half of the points, and of 95 %
    if (!rig || !rig->checked() || !rig->rig.whole() || cloud.points_in_rig.empty()) return;
    constexpr const char* kRemedy =
        "Scan again, or copy the file again. A cloud that was moved, turned or scaled on purpose is no scan of this "
        "rig "
        "any more: take its lines PLANLIGHT-RIG out.";
    if (cloud.pixels_in_projector.size() != cloud.points_in_rig.size())
        throw DamagedFileError(file, "says which rig it was made with, and its points lack projector_x and projector_y",
                               kRemedy);
    std::vector<double> off_px;
    for (std::size_t i = 0; i < cloud.points_in_rig.size(); ++i) {
        const auto pixel = project(rig->rig.projector, cloud.points_in_rig[i]);
        off_px.push_back(pixel ? (*pixel - cloud.pixels_in_projector[i]).norm()
                               : std::numeric_limits<double>::infinity());
    }
    const double usual_px = median(off_px), most_px = quantile(off_px, 0.95);
    if (usual_px <= kUsual_px && most_px <= kMost_px) return;
    throw DamagedFileError(
        file,
        fmt::format("has points that do not lie where its rig saw them (half of them more than {:.1f} "
                    "pixels of the projector off, a twentieth more than {:.1f})",
                    usual_px, most_px),
        kRemedy);
}

PointCloud read_cloud_of(const RegistrationResult& match, const fs::path& cloud, const fs::path& file) {
    std::vector<std::string> comments;
    PointCloud points = read_cloud(cloud, {1, true}, &comments);
    const auto rig = rig_state_in(comments, cloud);
    check_points(points, rig, cloud);
    if (rig && match.rig && !match.rig->capture_hash.empty() && rig->capture_hash != match.rig->capture_hash)
        throw InputError(cloud,
                         fmt::format("is the scan of capture {}, and {} is the match of capture {}",
                                     begin_of(rig->capture_hash), file.string(), begin_of(match.rig->capture_hash)),
                         "Name the cloud that was matched.");
    return points;
}

RigCalibration rig_of_light(const RegistrationResult& match, const RigCalibration& rig, bool confirmed) {
    if (match.rig && match.rig->verdict == RigState::Verdict::not_trusted)
        throw CheckFailedError("the rig cannot be trusted: " + match.rig->sentence, match.rig->remedy);
    if ((!match.rig || !match.rig->checked()) && !confirmed)
        throw CheckFailedError(
            "nothing says whether the rig is as it was calibrated: the match is not of a scan that could check it",
            "Look at the light on landmarks and give --confirmed, or match a cloud of `planlight scan` (columns "
            "and rows, both cameras).");
    return match.rig && match.rig->rig.whole() ? match.rig->rig : rig;
}

namespace {

/// The worst bound of an item on the skin, of some of its points; 0 where none is known.
double worst_on_skin_mm(const PlanDrawing& planned, std::size_t item, const RegistrationResult& found) {
    constexpr std::size_t kSome = 8;  // of a stroke: the bound changes over centimetres
    double worst_mm = 0;
    for (const Stroke& stroke : planned.strokes) {
        if (stroke.item != static_cast<int>(item) || stroke.kind == StrokeKind::label) continue;
        for (std::size_t i = 0; i < stroke.points_in_ct.size(); i += 1 + stroke.points_in_ct.size() / kSome)
            if (const double mm = predicted_light_mm(found, stroke.points_in_ct[i]); std::isfinite(mm))
                worst_mm = std::max(worst_mm, mm);
    }
    return worst_mm;
}

}  // namespace

void judge_items(const PlanDrawing& planned, RegistrationResult& found) {
    constexpr double kMost_mm = 1.5;
    if (found.verdict == Verdict::no || !found.covariance.known()) return;
    std::vector<std::string> reasons;
    double worst_mm = kMost_mm;
    std::optional<std::size_t> worst;
    for (std::size_t i = 0; i < planned.items.size(); ++i)
        if (auto covered = covered_in_words(planned, i, found.skin))
            reasons.push_back(std::move(*covered));
        else if (const double mm = worst_on_skin_mm(planned, i, found); mm > worst_mm)
            worst_mm = mm, worst = i;
    if (worst)
        reasons.push_back(
            fmt::format("{}: it may lie up to {:.1f} mm off (95 %)", planned.items[*worst].name, worst_mm));
    if (reasons.empty()) return;
    found.verdict = Verdict::ask;
    found.reasons.insert(found.reasons.end(), reasons.begin(), reasons.end());
}

}  // namespace planlight
