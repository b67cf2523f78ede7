#include "app/commands/review_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/language_option.h"
#include "app/console.h"
#include "app/live/live_window.h"
#include "app/live/shown_review.h"
#include "app/report/moment_comparison.h"
#include "app/report/operation_report.h"
#include "app/report/recording_review.h"
#include "app/site_settings.h"
#include "app/windows/camera_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/keep_to_owner.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

void check_frames(const RecordingTimeLine& line, const fs::path& recording) {
    if (line.frames_s.empty())
        throw InputError(recording, "kept no frame", "Look at its page without --at and --clip.");
}

/// A PNG a frame, "clip/000000.png" on; a former clip goes as a whole.
int write_clip(const RecordingReviewOptions& options, RecordedMoments& moments, const fs::path& folder) {
    constexpr double kSame_s = 1e-6;
    int number = 0;
    write_folder_safely(folder, true, [&](const fs::path& into) {
        keep_to_owner(into);  // it shows the face
        std::string times = "file,seconds\n";
        const std::vector<double>& at_s = moments.line().frames_s;
        for (std::size_t i = 0; i < at_s.size(); ++i) {
            if (at_s[i] < options.clip_s[0] - kSame_s || at_s[i] > options.clip_s[1] + kSame_s) continue;
            const std::string name = fmt::format("{:06d}.png", number++);
            write_png(picture_of(moments.moment(i)), into / name);
            times += fmt::format("{},{:.6f}\n", name, at_s[i]);
        }
        if (number == 0)
            throw InputError(options.recording,
                             fmt::format("kept no frame from {:g} to {:g} s", options.clip_s[0], options.clip_s[1]),
                             "The times of its frames stand in review.json (\"frames_s\").");
        write_safely(into / "times.csv", times);
        keep_to_owner(into);
    });
    return number;
}

/// Whether a former review made it: then it may be written over.
bool is_review(const fs::path& folder) {
    std::error_code fault;
    if (!fs::is_regular_file(folder / "review.json", fault)) return false;
    try {
        const auto json = nlohmann::json::parse(read_whole(folder / "review.json"), nullptr, false);
        return json.is_object() && json.value("format", nlohmann::json()) == kReviewFormat;
    } catch (const Error&) {
        return false;
    }
}

/// A folder for its owner only, for it shows the face: new, empty, or one that a former review made.
void make_review_folder(const fs::path& folder) {
    std::error_code fault;
    if (fs::exists(folder, fault) && !fs::is_directory(folder, fault))
        throw InputError(folder, "is a file, and a review is a folder", "Name a new folder with --out.");
    if (fs::is_directory(folder, fault) && !fs::is_empty(folder, fault) && !is_review(folder))
        throw InputError(folder, "holds something that is no review of a recording",
                         "Name a new folder with --out, or an empty one.");
    fs::create_directories(folder, fault);
    if (!fault) fs::permissions(folder, fs::perms::owner_all, fault);
    if (fault)
        throw DiskError(folder, "cannot be made, or kept from others: " + fault.message(),
                        "Name a folder with --out where you may write.");
}

/// Plan and light of that frame, for the page: its pictures and its table are written beside it. Why not, where the
/// case is not there: the page has the rest.
std::string compared(const RecordingReviewOptions& options, RecordedMoments& moments, std::size_t frame,
                     const RecordedMoment& pictures, const fs::path& out) {
    const fs::path folder = options.case_folder.empty() ? moments.line().head.case_folder : options.case_folder;
    try {
        if (moments.line().head.anonymous) {  // it names no case, and whichever it was would not help
            MomentComparison none;
            none.why_not = kAnonymousKeepsNoPlan;
            if (!options.json) warn("plan and light cannot be compared at that moment. " + none.why_not);
            return comparison_section(none, pictures.frame, {}, {}, {});
        }
        const Case the_case = read_case(folder);
        const MomentComparison moment =
            MomentComparer(the_case, moments.line(), options.recording).compare(moments, frame, pictures);
        const auto name = [&](const char* what, const char* ends) {
            return fmt::format("{}-{:.3f}.{}", what, moment.at_s, ends);
        };
        if (moment.why_not.empty()) {
            write_png(rgb_of(brightened(pictures.frame.left)), out / name("left", "png"), ReadableBy::owner);
            write_png(rgb_of(brightened(pictures.frame.right)), out / name("right", "png"), ReadableBy::owner);
            write_png(render_scene(scene_of(moment, std::make_shared<TriangleMesh>(the_case.skin)), view_of(moment)),
                      out / name("head", "png"), ReadableBy::owner);
            write_safely(out / name("plan-and-light", "csv"), comparison_csv(moment), ReadableBy::owner);
        } else if (!options.json) {
            warn("plan and light cannot be compared at that moment. " + moment.why_not);
        }
        return comparison_section(moment, pictures.frame, name("left", "png"), name("right", "png"),
                                  name("head", "png"));
    } catch (const Error& fault) {
        if (!options.case_folder.empty()) throw;
        warn(std::string("plan and light cannot be compared: ") + fault.what() + ". Name the case with --case.");
        return {};
    }
}

/// Who waits for the file may open it: the rest may take long.
void say_written(const RecordingReviewOptions& options, const fs::path& file) {
    if (!options.json) fmt::print("{}\n", file.string());
    std::fflush(stdout);
}

/// The pictures of the frame nearest to the moment that was asked for, with plan and light in them.
void show_moment(const RecordingReviewOptions& options, RecordedMoments& moments, const fs::path& out,
                 ReviewedMoment& shown) {
    check_frames(moments.line(), options.recording);
    const std::size_t frame = frame_near(moments.line(), options.at_s);
    const RecordedMoment pictures = moments.moment(frame);
    const std::string name = fmt::format("frame-{:.3f}.png", pictures.at_s);
    write_png(picture_of(pictures), out / name, ReadableBy::owner);
    shown.pictures = {
        {name, fmt::format("At {:.3f} s: left camera, right camera, and what the projector was given, if it was kept.",
                           pictures.at_s)}};
    say_written(options, out / name);
    shown.more = compared(options, moments, frame, pictures, out);
}

/// As the report on it judges it; what cannot be read is judged by what can.
PageVerdict judged(RecordingTimeLine& line, const fs::path& recording) {
    look_at_pictures(line, recording);
    try {
        return page_verdict(facts_of_operation(recording));
    } catch (const DamagedFileError& fault) {
        return {PageVerdict::Kind::stop, fmt::format("The recording cannot be judged: {}.", fault.what()), {}};
    }
}

}  // namespace

fs::path review_folder_of(const fs::path& recording) {
    return fs::path(recording).replace_extension("") += "-review";
}

bool is_recording(const fs::path& path) {
    std::error_code fault;
    return path.extension() == ".plrec" && !fs::is_directory(path, fault);
}

int show_recording(const RecordingReviewOptions& options) {
    if (!options.out.empty() || !options.clip_s.empty() || options.json)
        throw Error(ExitCode::usage, "--out, --clip and --json are for the page of a recording, not for its window",
                    "Leave them out, or leave out --show.");
    if (!display_is_there())
        throw DeviceError("Display", "no window can be opened here",
                          "Start the program in a desktop session, or look at the page: leave out --show.");
    show_review(options.recording, {options.case_folder, std::max(0.0, options.at_s), options.picture,
                                    settings_of_window(options.language, options.theme, read_site_settings())});
    return 0;
}

int run_recording_review(const RecordingReviewOptions& options) {
    if (options.clip_s.size() == 2 && options.clip_s[1] < options.clip_s[0])
        throw Error(ExitCode::usage, "the clip ends before it begins", "Give --clip FROM TO, in seconds.");
    const fs::path out = options.out.empty() ? review_folder_of(options.recording) : options.out;
    RecordingTimeLine line = time_line_of(options.recording);
    make_review_folder(out);
    const auto show = [&](ReviewedMoment& shown) {
        say_written(options, out / "index.html");
        RecordedMoments moments(options.recording, line);
        if (options.at_s >= 0) show_moment(options, moments, out, shown);
        if (options.clip_s.size() == 2) {
            check_frames(line, options.recording);
            const int frames = write_clip(options, moments, out / "clip");
            if (!options.json) fmt::print("{} pictures in {}\n", frames, (out / "clip").string());
        }
    };
    write_review(line, out, show, [&](RecordingTimeLine& looked_at) { return judged(looked_at, options.recording); });
    if (options.json) std::cout << review_json(line);
    if (!line.ended.empty()) warn(line.ended);
    if (line.damaged_pictures)
        throw DamagedFileError(options.recording, "holds pictures that are damaged; what happened is shown to its end",
                               "Copy the file again from where it was written.");
    if (line.damaged)
        throw DamagedFileError(options.recording, "is shown up to where it is damaged",
                               "Copy the file again from where it was written.");
    return 0;
}

}  // namespace planlight
