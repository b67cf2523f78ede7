#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/case/case_folder.h"
#include "planning_io/case/poses_file.h"
#include "planning_io/types/registration_result.h"
#include "projection/draw_plan.h"
#include "registration/scan/scan_surface.h"

// Files that belong together say so by hashes; joined wrongly they are refused (InputError, exit 3) with both names.
namespace planlight {

/// XXH3-128 over the light's settings and every pixel of a capture, hex.
std::string hash_of(const ScanCapture& capture);

/// The rig that this scan found, with the names of rig.json and of its capture.
RigState named_rig_state(const ScanResult& scan, const RigCalibration& calibrated, const ScanCapture& capture);

/// Puts case and rig into a match, and lowers its verdict by what the scan found of the rig: `no` where it is not to be
/// trusted, `ask` where it could not be checked or hides more than a millimetre of light at a point of the plan. `rig`
/// empty: the cloud of another scanner, of which nothing is known.
void take_case_and_rig(const Case& the_case, const std::optional<RigState>& rig, RegistrationResult& match);

/// How far off light may be at one point because the scan is larger or smaller than the CT by more than two of the
/// sigmas of that, mm: a rigid match lays it on its middle.
double light_by_scale_mm(const RegistrationResult& found, const Eigen::Vector3d& p_in_ct);

/// How far off light may be at one point, 95 %, mm: by the registration, by what the scan could not tell of the rig,
/// and by the scan's own size. Infinite where nothing is known of the registration's pose, or where it is asked about
/// because it may be another one, or the pictures of another pattern.
double predicted_light_mm(const RegistrationResult& found, const Eigen::Vector3d& p_in_ct);
/// The same where it is known how much the rig may hide there, mm.
double predicted_light_mm(const RegistrationResult& found, const Eigen::Vector3d& p_in_ct, double hidden_mm);

/// Warnings for what is not known are added to `unknown`.
void check_case(const RegistrationResult& match, const Case& the_case, const std::filesystem::path& file,
                std::vector<std::string>& unknown);

/// As `check_case`, for the rig file that the light is about to be drawn with.
void check_rig(const RegistrationResult& match, const RigCalibration& rig, const std::filesystem::path& file,
               const std::filesystem::path& rig_file, std::vector<std::string>& unknown);

/// As `check_case`, for poses: they must follow this match, on this rig. Where they do not say so, or begin at the
/// first of their frames instead of at a scan, CheckFailedError, or a warning where `confirmed` is said.
void check_poses(const std::optional<PosesOrigin>& origin, const RegistrationResult& match, const RigCalibration& rig,
                 const std::filesystem::path& file, bool confirmed, std::vector<std::string>& unknown);

/// Of a cloud that says which rig it was made with, and that this was checked: each point must lie where the
/// projector's pixel that lit it puts it. Throws DamagedFileError where they do not: moved, turned or scaled since, by
/// whatever program. Points that were deleted are no harm. Nothing is asked of other clouds.
void check_points(const PointCloud& cloud, const std::optional<RigState>& rig, const std::filesystem::path& file);

/// The cloud of a match, rig. Throws InputError where it says that it is of another scan than `match`, read from
/// `file`.
PointCloud read_cloud_of(const RegistrationResult& match, const std::filesystem::path& cloud,
                         const std::filesystem::path& file);

/// The rig that the light of a match is to be drawn with: as the scan found it. Throws CheckFailedError where it may
/// not be trusted, or where nothing is known of it and `confirmed` is not said.
RigCalibration rig_of_light(const RegistrationResult& match, const RigCalibration& rig, bool confirmed);

/// Looks at each item of the plan, as drawn on the CT's skin, by what the scan tells of it: those of which a tenth or
/// more is covered (`covered_in_words`), and the worst of those that may lie more than 1.5 mm off (95 %), are asked
/// about by name, and `found.verdict` is no `yes` any more. After `take_case_and_rig`.
void judge_items(const PlanDrawing& planned, RegistrationResult& found);

}  // namespace planlight
