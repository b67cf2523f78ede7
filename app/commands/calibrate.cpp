#include <fmt/format.h>

#include <iostream>

#include "app/commands/calibrate_options.h"
#include "app/commands/capture_conversion.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/device_check.h"
#include "app/commands/language_option.h"
#include "app/commands/pdf_option.h"
#include "app/console.h"
#include "app/report/calibration_report.h"
#include "planning_io/case/board_captures.h"
#include "planning_io/case/missing_pictures.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// Refused where a board cannot be calibrated by it.
StripeSettings calibration_light(const CaptureFolder& settings, const Path& pose) {
    const StripeSettings stripes = stripes_of(settings);
    if (!stripes.rows)
        throw InputError(pose, "codes the projector's columns only",
                         "Calibrate with a sequence that codes columns and rows.");
    if (stripes.phase_steps == 0 && !stripes.inverse)
        throw InputError(pose, "is a Gray code without fringes and without inverse pictures",
                         "Capture each Gray picture and its inverse.");
    return stripes;
}

std::vector<std::string> names_of(const std::optional<StripeSettings>& stripes, const Path& pose) {
    std::vector<std::string> names;
    if (stripes)
        for (const StripePattern& pattern : patterns_of(*stripes, pose)) names.push_back(pattern.name);
    return names;
}

struct Observed {
    std::vector<PoseObservation> poses;
    int projector_width = 0, projector_height = 0;
    DeviceSerials serials;
};

/// All pictures that are missing, of all poses, before the first is read.
void check_all_there(const std::vector<Path>& folders, const Path& captures) {
    std::vector<std::string> missing;
    for (const Path& pose : folders) {
        const auto settings = pose_settings(pose);
        if (!settings) continue;
        const auto here = missing_pictures(pose, names_of(calibration_light(*settings, pose), pose));
        missing.insert(missing.end(), here.begin(), here.end());
    }
    if (missing.empty()) return;
    throw InputError(captures,
                     fmt::format("{} missing: {}",
                                 missing.size() == 1 ? "a picture is" : fmt::format("{} pictures are", missing.size()),
                                 listed(missing)),
                     "Capture these poses again, the whole sequence, or take their folders away.");
}

/// One pose after the other, so that only one pose's pictures are in memory.
Observed observe_captures(const CalibrateOptions& options, const BoardSpec& board) {
    Observed observed;
    observed.serials = {options.serial_left, options.serial_right, options.serial_projector};
    ProgressBar bar;
    const auto folders = pose_folders(options.captures);
    check_all_there(folders, options.captures);
    for (std::size_t i = 0; i < folders.size(); ++i) {
        const auto settings = pose_settings(folders[i]);
        std::optional<StripeSettings> stripes;
        if (settings) {
            stripes = calibration_light(*settings, folders[i]);
            observed.serials = joined_serials(observed.serials, settings->serials, folders[i]);
        }
        if (i > 0 && (stripes ? stripes->width : 0) != observed.projector_width)
            throw InputError(folders[i], "was captured under other light than the first pose",
                             "Capture all poses with one sequence.");
        if (stripes) observed.projector_width = stripes->width, observed.projector_height = stripes->height;
        const PosePictures pictures = read_pose(folders[i], names_of(stripes, folders[i]));
        ObserveSettings observe;
        observe.check_sequence = !settings || settings->check_sequence;
        observed.poses.push_back({folders[i].filename().string(), observe_board(pictures.left, stripes, board, observe),
                                  observe_board(pictures.right, stripes, board, observe)});
        bar.show("poses", static_cast<double>(i + 1) / static_cast<double>(folders.size()));
    }
    const bool right = observed.poses.front().right.width > 0;
    for (const PoseObservation& pose : observed.poses)
        if ((pose.right.width > 0) != right)
            throw InputError(
                options.captures / pose.name,
                right ? "has no right pictures, the first pose has" : "has right pictures, the first pose has none",
                "Capture all poses with the same cameras.");
    return observed;
}

int run_calibrate(const CalibrateOptions& options) {
    const CalibrationFiles files = calibration_files(options.out);
    check_pdf(options.pdf);
    if (options.live) return run_calibrate_live(options);
    const BoardSpec board = parse_board(options.board);
    check_can_write(options.out);  // before minutes of work, not after
    const Observed observed = observe_captures(options, board);
    const Calibration calibration =
        calibrate_rig(observed.poses, board, observed.projector_width, observed.projector_height);
    if (calibration.refusal) throw CheckFailedError(calibration.refusal->reason, calibration.refusal->remedy);
    CalibrationReport report{calibration, observed.poses, board, today(), {}, {}, observed.serials};
    if (calibration.makes_a_rig()) {
        RigCalibration rig = rig_calibration_of(calibration, report.made_on);
        rig.serials = observed.serials;
        if (const auto before = previous_rig(options.out); before && before->whole() && rig.whole())
            report.changes = changes_since(*before, rig);
        keep_previous_rig(options.out);
        write_rig(rig, options.out);
        report.rig_file = options.out;
    }
    const std::string text = write_calibration(report, options.out, options.pdf);
    for (const std::string& warning : calibration.warnings) warn(warning);
    if (options.json)
        std::cout << text;
    else
        fmt::print("{}{} and {}.\n", calibration_summary(report), files.page.string(), files.figures.string());
    return 0;
}

}  // namespace

CalibrationFiles calibration_files(const Path& rig) {
    Path stem = rig;
    stem.replace_extension();
    return {Path(stem) += "-calibration.html", Path(stem) += "-calibration.json"};
}

std::string write_calibration(const CalibrationReport& report, const Path& rig, const Path& pdf) {
    const CalibrationFiles files = calibration_files(rig);
    const Document document = calibration_document(report);
    const std::string figures = calibration_json(report);
    write_safely(files.page, html_of(document));
    write_safely(files.figures, figures);
    write_pdf(document, pdf);
    return figures;
}

std::optional<RigCalibration> previous_rig(const std::filesystem::path& file) {
    if (!std::filesystem::exists(file)) return std::nullopt;
    try {
        return read_partial_rig(file);
    } catch (const Error& error) {
        warn(fmt::format("the rig file there cannot be read and will be replaced: {}", error.what()));
        return std::nullopt;
    }
}

Path unused(const Path& file, const std::string& end) {
    const auto with = [&](const std::string& name) {
        Path other = file;
        other.replace_extension();
        return other += name + file.extension().string();
    };
    Path other = with(end);
    for (int i = 2; std::filesystem::exists(other); ++i) other = with(fmt::format("{}-{}", end, i));
    return other;
}

void keep_previous_rig(const Path& file) {
    if (std::filesystem::exists(file)) write_safely(unused(file, "-before"), read_whole(file));
}

Run add_calibrate(CLI::App& app) {
    const auto options = std::make_shared<CalibrateOptions>();
    CalibrateOptions& o = *options;
    auto* sub = add_command(
        app, "calibrate", "A board under coded light, captured or in your hands -> rig.json, or a refusal (exit 6)",
        "calibrate captures --board \"charuco 10x7 25 mm\" --out rig.json --pdf rig-calibration.pdf");
    auto* captures = sub->add_option("captures", o.captures, "Folder with one folder a pose");
    sub->add_option("--board", o.board,
                    "The board, its square as measured: \"charuco 10x7 24.98 mm\" or \"chessboard 9x6 25 mm\"")
        ->required();
    auto* left = sub->add_option("--serial-left", o.serial_left,
                                 "Serial of the left camera, kept in rig.json (default: as capture.json says)");
    auto* right = sub->add_option("--serial-right", o.serial_right, "Of the right camera");
    sub->add_option("--serial-projector", o.serial_projector,
                    "Of the projector; `projector --identify` tells it where the monitor does");
    sub->add_option("--out", o.out, "rig.json to write; the report stands beside it")->capture_default_str();
    pdf_option(sub, o.pdf);
    json_flag(sub, o.json);
    auto* live = sub->add_flag(
        "--live", o.live,
        "Guided, with the board in your hands: watches both cameras, says how to hold it, captures by itself "
        "when it lies still, and ends when it is good enough");
    live->excludes(captures, left, right);  // it takes its captures, and asks the cameras
    live->needs(sub->add_option("--room", o.room, "Of --live: room.json (see `devices`)"));
    sub->add_option("--keep", o.keep,
                    "Of --live, the new rig: ask (in the window or at the terminal; where nobody can be asked it is "
                    "written beside, as RIG-new.json), yes, no. The former one stays as RIG-before.json")
        ->check(CLI::IsMember({"ask", "yes", "no"}))
        ->capture_default_str();
    sub->add_option("--keep-captures", o.keep_captures, "Of --live: new folder for the pictures of every pose");
    sub->add_option("--most-poses", o.most_poses, "Of --live")->check(CLI::Range(8, 40))->capture_default_str();
    sub->add_option("--good-enough-mm", o.good_enough_mm,
                    "Of --live: ends when 95 % of the working volume is predicted to be this good")
        ->check(CLI::Range(0.001, 10.0))
        ->capture_default_str();
    sub->add_flag("--headless", o.headless, "Of --live: in words on the terminal, without a window");
    sub->add_option("--operator", o.operator_monitor, "Of --live: monitor of the window (default: the primary one)");
    sub->add_option("--screenshots", o.screenshots, "Of --live: folder for pictures of the window");
    language_option(sub, o.language);
    theme_option(sub, o.theme);
    for (const char* name : {"--room", "--keep", "--keep-captures", "--most-poses", "--good-enough-mm", "--headless",
                             "--operator", "--screenshots", "--language", "--theme"})
        sub->get_option(name)->needs(live);
    sub->parse_complete_callback([live, captures] {
        if (live->count() == 0 && captures->count() == 0)
            throw CLI::RequiredError("captures (their folder), or --live with --room room.json,");
    });
    return [options] { return run_calibrate(*options); };
}

}  // namespace planlight
