#include "app/commands/capture_conversion.h"

#include <fmt/format.h>

#include <algorithm>

#include "planning_io/types/error.h"
#include "registration/scan/decode/gray_code.h"

namespace planlight {
namespace {

using Kind = StripePattern::Kind;

bool is_there(const CaptureFolder& folder, const std::string& name) {
    return std::find(folder.names.begin(), folder.names.end(), name) != folder.names.end();
}

/// What of the Gray code was captured: all but, maybe, the finest bits of a direction. Refused where a coarser one is
/// missing: nothing can be read without it.
std::vector<StripePattern> gray_code_there(const std::vector<StripePattern>& wanted, const CaptureFolder& folder,
                                           const std::filesystem::path& named) {
    std::vector<StripePattern> there;
    for (const StripePattern& pattern : wanted) {
        if (pattern.kind == Kind::phase) continue;
        if (is_there(folder, pattern.name)) there.push_back(pattern);
        const bool bit = pattern.kind == Kind::gray_bit || pattern.kind == Kind::gray_bit_inverse;
        const bool finer_is_there = std::any_of(wanted.begin(), wanted.end(), [&](const StripePattern& other) {
            const bool other_bit = other.kind == Kind::gray_bit || other.kind == Kind::gray_bit_inverse;
            return other_bit && other.along_rows == pattern.along_rows && other.index >= pattern.index &&
                   is_there(folder, other.name);
        });
        if (!is_there(folder, pattern.name) && (!bit || finer_is_there || pattern.index < 2))
            throw InputError(
                named, fmt::format("the picture of pattern \"{}\" is missing", pattern.name),
                "Capture the whole sequence that `planlight patterns` writes; only fringes and the finest bits of the "
                "Gray code may be missing.");
    }
    return there;
}

}  // namespace

StripeSettings stripes_of(const CaptureFolder& folder) {
    StripeSettings stripes;
    stripes.width = folder.projector_width;
    stripes.height = folder.projector_height;
    stripes.phase_steps = folder.phase_steps;
    stripes.phase_period_px = folder.phase_steps > 0 ? folder.phase_period_px : 2;
    stripes.order_periods_px = folder.order_periods_px;
    stripes.order_steps = folder.order_steps;
    stripes.rows = folder.rows;
    stripes.inverse = folder.inverse;
    return stripes;
}

std::vector<StripePattern> patterns_of(const StripeSettings& stripes, const std::filesystem::path& named) {
    if (stripes.phase_steps == 0 && !stripes.order_periods_px.empty())
        throw InputError(named, "has further fringes and no first one (\"phase_steps\": 0)", "Correct capture.json.");
    if (stripes.phase_steps == 0) return gray_code_patterns(stripes);
    try {
        return stripe_sequence(stripes);
    } catch (const std::invalid_argument& error) {
        throw InputError(named, error.what(), "Correct capture.json.");
    }
}

ScanCapture scan_capture_from(const CaptureFolder& folder, const std::filesystem::path& named) {
    ScanCapture capture;
    capture.stripes = stripes_of(folder);
    capture.check_sequence = folder.check_sequence;
    auto patterns = patterns_of(capture.stripes, named);
    const bool whole =
        capture.stripes.phase_steps > 0 &&
        std::all_of(patterns.begin(), patterns.end(), [&](const auto& p) { return is_there(folder, p.name); });
    if (!whole && !capture.stripes.order_periods_px.empty())
        throw InputError(named, "a picture of the fringes of several frequencies is missing",
                         "Capture the whole sequence that `planlight patterns --set multi-frequency` writes.");
    if (!whole) capture.partial = patterns = gray_code_there(patterns, folder, named);
    for (const auto& pattern : patterns) {
        const auto found = std::find(folder.names.begin(), folder.names.end(), pattern.name);
        const auto index = static_cast<std::size_t>(found - folder.names.begin());
        capture.left.push_back(folder.left.at(index));
        if (!folder.right.empty()) capture.right.push_back(folder.right.at(index));
    }
    capture.began = folder.began;
    capture.ended = folder.ended;
    return capture;
}

void check_sizes(const ScanCapture& capture, const RigCalibration& rig, const std::filesystem::path& folder) {
    const auto fits = [](const std::vector<GrayImage>& pictures, const CameraModel& camera) {
        return pictures.empty() || !present(camera) ||
               (pictures.front().width == camera.width && pictures.front().height == camera.height);
    };
    const bool light_fits = !present(rig.projector) || (capture.stripes.width == rig.projector.width &&
                                                        capture.stripes.height == rig.projector.height);
    if (!fits(capture.left, rig.left_camera) || !fits(capture.right, rig.right_camera) || !light_fits)
        throw InputError(folder, "the pictures or the projector have another size than the rig file says",
                         "Use the rig.json of the rig that this capture was made with.");
    if (!present(rig.projector) && capture.right.empty())
        throw InputError(folder, "has the left camera's pictures only, and the rig file has no projector",
                         "Capture with both cameras, or calibrate the projector with the camera.");
}

CaptureFolder capture_folder_from(const ScanCapture& capture) {
    CaptureFolder folder;
    folder.projector_width = capture.stripes.width;
    folder.projector_height = capture.stripes.height;
    folder.phase_steps = capture.stripes.phase_steps;
    folder.phase_period_px = capture.stripes.phase_period_px;
    folder.order_periods_px = capture.stripes.order_periods_px;
    folder.order_steps = capture.stripes.order_steps;
    folder.rows = capture.stripes.rows;
    folder.inverse = capture.stripes.inverse;
    folder.check_sequence = capture.check_sequence;
    for (const auto& pattern : stripe_sequence(capture.stripes)) folder.names.push_back(pattern.name);
    folder.left = capture.left;
    folder.right = capture.right;
    folder.began = capture.began;
    folder.ended = capture.ended;
    return folder;
}

}  // namespace planlight
