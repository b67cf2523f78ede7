#include "app/commands/review_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/console.h"
#include "app/report/moment_comparison.h"
#include "app/report/recording_review.h"
#include "app/windows/camera_picture.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// The frame nearest to the time asked for.
double nearest_frame(const RecordingTimeLine& line, double at_s, const fs::path& recording) {
    if (line.frames_s.empty())
        throw InputError(recording, "kept no frame", "Look at its page without --at and --clip.");
    return *std::min_element(line.frames_s.begin(), line.frames_s.end(),
                             [&](double a, double b) { return std::abs(a - at_s) < std::abs(b - at_s); });
}

/// A PNG a frame, "clip/000000.png" on; a former clip goes as a whole.
int write_clip(const RecordingReviewOptions& options, const fs::path& folder) {
    int number = 0;
    write_folder_safely(folder, true, [&](const fs::path& into) {
        std::string times = "file,seconds\n";
        for_each_moment(options.recording, options.clip_s[0], options.clip_s[1], [&](const RecordedMoment& moment) {
            const std::string name = fmt::format("{:06d}.png", number++);
            write_png(picture_of(moment), into / name);
            times += fmt::format("{},{:.6f}\n", name, moment.at_s);
        });
        if (number == 0)
            throw InputError(options.recording,
                             fmt::format("kept no frame from {:g} to {:g} s", options.clip_s[0], options.clip_s[1]),
                             "The times of its frames stand in review.json (\"frames_s\").");
        write_safely(into / "times.csv", times);
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
std::string compared(const RecordingReviewOptions& options, const RecordingTimeLine& line, double at_s,
                     const fs::path& out) {
    const fs::path folder = options.case_folder.empty() ? line.head.case_folder : options.case_folder;
    try {
        MomentComparison moment;
        if (line.head.anonymous)  // it names no case, and whichever it was would not help
            moment.why_not = kAnonymousKeepsNoPlan;
        else
            moment = compare_moment(options.recording, at_s, read_case(folder));
        const auto name = [&](const char* what, const char* ends) {
            return fmt::format("{}-{:.3f}.{}", what, at_s, ends);
        };
        if (moment.why_not.empty()) {
            write_png(rgb_of(brightened(moment.pictures[0])), out / name("left", "png"));
            write_png(rgb_of(brightened(moment.pictures[1])), out / name("right", "png"));
            write_png(moment.scene, out / name("head", "png"));
            write_safely(out / name("plan-and-light", "csv"), comparison_csv(moment));
        } else if (!options.json) {
            warn("plan and light cannot be compared at that moment. " + moment.why_not);
        }
        return comparison_section(moment, name("left", "png"), name("right", "png"), name("head", "png"));
    } catch (const Error& fault) {
        if (!options.case_folder.empty()) throw;
        warn(std::string("plan and light cannot be compared: ") + fault.what() + ". Name the case with --case.");
        return {};
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

int run_recording_review(const RecordingReviewOptions& options) {
    if (options.clip_s.size() == 2 && options.clip_s[1] < options.clip_s[0])
        throw Error(ExitCode::usage, "the clip ends before it begins", "Give --clip FROM TO, in seconds.");
    const fs::path out = options.out.empty() ? review_folder_of(options.recording) : options.out;
    const RecordingTimeLine line = time_line_of(options.recording);
    const std::string figures = review_json(line);
    make_review_folder(out);
    write_safely(out / "index.html", review_page(line, {}));
    write_safely(out / "review.json", figures);
    if (!options.json) fmt::print("{}\n", (out / "index.html").string());
    std::cout << std::flush;
    if (options.at_s >= 0) {
        const double at_s = nearest_frame(line, options.at_s, options.recording);
        const std::string name = fmt::format("frame-{:.3f}.png", at_s);
        for_each_moment(options.recording, at_s, at_s,
                        [&](const RecordedMoment& moment) { write_png(picture_of(moment), out / name); });
        write_safely(out / "index.html",
                     review_page(line,
                                 {{name, fmt::format("At {:.3f} s: left camera, right camera{}", at_s,
                                                     ", and what the projector was given, if it was kept.")}},
                                 compared(options, line, at_s, out)));
        if (!options.json) fmt::print("{}\n", (out / name).string());
    }
    if (options.clip_s.size() == 2) {
        const int frames = write_clip(options, out / "clip");
        if (!options.json) fmt::print("{} pictures in {}\n", frames, (out / "clip").string());
    }
    if (options.json) std::cout << figures;
    if (!line.ended.empty()) warn(line.ended);
    if (line.damaged)
        throw DamagedFileError(options.recording, "is shown up to where it is damaged",
                               "Copy the file again from where it was written.");
    return 0;
}

}  // namespace planlight
