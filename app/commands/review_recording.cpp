#include "app/commands/review_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "app/console.h"
#include "app/report/recording_review.h"
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

/// A PNG a frame, "clip/000000.png" on.
int write_clip(const RecordingReviewOptions& options, const fs::path& folder) {
    fs::create_directories(folder);
    int number = 0;
    std::string times = "file,seconds\n";
    for_each_moment(options.recording, options.clip_s[0], options.clip_s[1], [&](const RecordedMoment& moment) {
        const std::string name = fmt::format("{:06d}.png", number++);
        write_png(picture_of(moment), folder / name);
        times += fmt::format("{},{:.6f}\n", name, moment.at_s);
    });
    if (number == 0)
        throw InputError(options.recording,
                         fmt::format("kept no frame from {:g} to {:g} s", options.clip_s[0], options.clip_s[1]),
                         "The times of its frames stand in review.json (\"frames_s\").");
    write_safely(folder / "times.csv", times);
    return number;
}

}  // namespace

bool is_recording(const fs::path& path) {
    std::error_code fault;
    return path.extension() == ".plrec" && !fs::is_directory(path, fault);
}

int run_recording_review(const RecordingReviewOptions& options) {
    if (options.clip_s.size() == 2 && options.clip_s[1] < options.clip_s[0])
        throw Error(ExitCode::usage, "the clip ends before it begins", "Give --clip FROM TO, in seconds.");
    const fs::path out =
        options.out.empty() ? fs::path(options.recording).replace_extension("") += "-review" : options.out;
    const RecordingTimeLine line = time_line_of(options.recording);
    const std::string figures = review_json(line);
    fs::create_directories(out);
    fs::permissions(out, fs::perms::owner_all);
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
                     review_page(line, {{name, fmt::format("At {:.3f} s: left camera, right camera{}", at_s,
                                                           ", and what the projector was given, if it was kept.")}}));
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
