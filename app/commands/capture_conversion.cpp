#include "app/commands/capture_conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "planning_io/case/missing_pictures.h"
#include "planning_io/types/error.h"
#include "registration/scan/decode/gray_code.h"

namespace planlight {
namespace {

using Kind = StripePattern::Kind;

bool is_in(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_there(const CaptureFolder& folder, const std::string& name) {
    return is_in(folder.names, name);
}

/// What of the sequence was captured and can be used: all but, maybe, the fringes, the finest bits of a direction, all
/// rows. Refused where named bits count on one that is not there: all of them at once.
std::vector<StripePattern> gray_code_there(const std::vector<StripePattern>& wanted, const CaptureFolder& folder,
                                           const std::filesystem::path& named) {
    CaptureFolder whole = folder;
    whole.names.clear();
    std::vector<std::string> missing;
    for (const StripePattern& pattern : wanted) {
        whole.names.push_back(pattern.name);
        if (!is_there(folder, pattern.name)) missing.push_back(pattern.name);
    }
    const UsableNames usable = usable_without(whole, missing);
    std::vector<std::string> useless;  // named, and no more to be read than what is missing
    for (const StripePattern& pattern : wanted)
        if (pattern.kind != Kind::phase && is_there(folder, pattern.name) && !is_in(usable.names, pattern.name))
            useless.push_back(pattern.name);
    if (usable.names.empty())
        throw InputError(
            named,
            fmt::format("{} missing: {}",
                        missing.size() == 1 ? "the picture of a pattern is" : "the pictures of patterns are",
                        listed(missing)),
            "Capture the whole sequence that `planlight patterns` writes; only fringes, the finest bits of the Gray "
            "code "
            "and all rows may be missing.");
    if (!useless.empty())
        throw InputError(
            named, fmt::format("{} missing, and these cannot be used without: {}", listed(missing), listed(useless)),
            "Capture the whole sequence, or leave these out of \"names\" in capture.json as well: the cloud is then "
            "coarser.");
    std::vector<StripePattern> there;
    for (const StripePattern& pattern : wanted)
        if (pattern.kind != Kind::phase && is_in(usable.names, pattern.name)) there.push_back(pattern);
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
    stripes.begins_at_column = folder.begins_at_column;
    stripes.begins_at_row = folder.begins_at_row;
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

ScanCapture scan_capture_from(CaptureFolder folder, const std::filesystem::path& named) {
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
    if (!whole) {
        capture.partial = patterns = gray_code_there(patterns, folder, named);
        capture.stripes.rows =
            std::any_of(patterns.begin(), patterns.end(), [](const auto& p) { return p.along_rows; });
    }
    for (const auto& pattern : patterns) {
        const auto found = std::find(folder.names.begin(), folder.names.end(), pattern.name);
        const auto index = static_cast<std::size_t>(found - folder.names.begin());
        capture.left.push_back(std::move(folder.left.at(index)));
        if (!folder.right.empty()) capture.right.push_back(std::move(folder.right.at(index)));
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
    folder.begins_at_column = capture.stripes.begins_at_column;
    folder.begins_at_row = capture.stripes.begins_at_row;
    folder.check_sequence = capture.check_sequence;
    for (const auto& pattern : stripe_sequence(capture.stripes)) folder.names.push_back(pattern.name);
    folder.left = capture.left;
    folder.right = capture.right;
    folder.began = capture.began;
    folder.ended = capture.ended;
    return folder;
}

}  // namespace planlight
