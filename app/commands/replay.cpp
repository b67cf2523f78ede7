#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/language_option.h"
#include "app/console.h"
#include "app/json_text.h"
#include "app/live/live_window.h"
#include "app/live/shown_replay.h"
#include "app/recording/recording_head.h"
#include "app/recording/replay_session.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

struct ReplayOptions {
    Path recording, case_folder;
    bool json = false, show = false;
    std::string language, theme;  ///< of the window; empty: as the site says
    ShownReplaySettings window;   ///< with `show`
};

std::string counts_of(const ReplayResult& r) {
    return fmt::format("{} scan{}, {} match{}, {} updates with {} decisions of the gate, {} pictures, {} frames",
                       r.scans, r.scans == 1 ? "" : "s", r.matches, r.matches == 1 ? "" : "es", r.updates, r.rulings,
                       r.pictures, r.frames);
}

std::string sentence_of(const ReplayDifference& d, Instant began) {
    return fmt::format("the replay differs from frame {} on (update {}, {:.3f} s into the recording): {}", d.frame,
                       d.update, seconds(d.at - began), d.what);
}

void print_json(const ReplayResult& r) {
    nlohmann::ordered_json json = {{"alike", !r.difference.has_value()},
                                   {"whole", r.end == RecordingEnd::whole && r.ended.empty()},
                                   {"ended", r.ended},
                                   {"case", r.head.case_code},
                                   {"program", r.head.program},
                                   {"same_build", !r.other_program},
                                   {"scans", r.scans},
                                   {"matches", r.matches},
                                   {"updates", r.updates},
                                   {"decisions", r.rulings},
                                   {"skin_checks", r.skin_checks},
                                   {"resumptions", r.resumptions},
                                   {"refusals", r.refusals},
                                   {"pictures", r.pictures},
                                   {"frames", r.frames},
                                   {"recorded_s", r.recorded_s},
                                   {"difference", nullptr}};
    if (r.difference)
        json["difference"] = {{"frame", r.difference->frame},
                              {"at_ns", r.difference->at.count()},
                              {"update", r.difference->update},
                              {"what", r.difference->what}};
    std::cout << json_text(json) << '\n';
}

const char* heading_of(const ReplayResult& r) {
    if (r.difference) return "Alike before it differs";
    if (r.end == RecordingEnd::whole && r.ended.empty()) return "Alike to the last digit";
    return "Alike as far as it could be compared";
}

[[noreturn]] void tell_difference(const ReplayResult& result) {
    throw CheckFailedError(sentence_of(*result.difference, result.began),
                           result.other_program
                               ? "It was recorded by another build of the program: replay it with that."
                               : "The same build of the program should not differ: keep the recording, "
                                 "and report it with the processor's name.");
}

/// Throws unless all that the recording holds was compared. One that was cut holds no more.
void check_compared(const ReplayResult& result, const Path& recording) {
    if (result.difference) tell_difference(result);
    if (may_be_damaged(result.end))
        throw DamagedFileError(recording, "is alike up to where it is damaged",
                               "Copy the file again from where it was written.");
    if (result.compared() == 0)
        throw CheckFailedError("nothing of the recording could be compared: " +
                                   (result.ended.empty() ? "nothing was asked of the session." : result.ended),
                               "Record a session with a scan: `planlight session --record all`.");
    if (!result.ended.empty() && result.end == RecordingEnd::open)
        throw CheckFailedError(
            fmt::format("the replay is alike up to {:.1f} s, and cannot go on to the end of the recording: {}",
                        result.recorded_s, result.ended),
            "What comes after rests on what was not kept: record on a disk that is quick and has room.");
}

int run_replay(const ReplayOptions& options) {
    Path folder = options.case_folder;
    if (folder.empty()) folder = head_of_recording(options.recording).case_folder;
    const Case the_case = read_case(folder);
    ReplayResult result;
    if (options.show && !display_is_there())
        throw DeviceError("Display", "no window can be opened here",
                          "Start the program in a desktop session, or replay without --show.");
    if (options.show) {
        ShownReplaySettings window = options.window;
        window.window = settings_of_window(options.language, options.theme, read_site_settings());
        const auto shown = show_replay(options.recording, the_case, window);
        if (!shown) {
            fmt::print("The window was closed before the end of the replay.\n");
            return 0;
        }
        result = *shown;
    } else {
        ProgressBar bar;
        result = replay_session(options.recording, the_case, [&](double share) { bar.show("replay", share); });
        bar.show("replay", 1);
    }
    if (options.json)
        print_json(result);
    else
        fmt::print("{}: {} ({:.1f} s of the session).\n", heading_of(result), counts_of(result), result.recorded_s);
    check_compared(result, options.recording);
    if (!result.ended.empty()) warn(result.ended);
    return 0;
}

}  // namespace

Run add_replay(CLI::App& app) {
    const auto options = std::make_shared<ReplayOptions>();
    ReplayOptions& o = *options;
    auto* sub = add_command(app, "replay", "A recorded session through the same program again, compared bit for bit",
                            "replay case/recordings/2026-03-14T09-30-00Z.plrec");
    sub->add_option("recording", o.recording, "Recording of a session (`session --record all`)")->required();
    sub->add_option("--case", o.case_folder, "Case folder (default: where it was when it was recorded)");
    auto* show = sub->add_flag("--show", o.show,
                               "In the operator's window, at the pace at which it was recorded (default: as fast as "
                               "possible, without a window)");
    sub->add_option("--speed", o.window.speed, "Of the window: 2 is twice as fast")
        ->check(CLI::Range(0.05, 20.0))
        ->needs(show);
    sub->add_flag("--close", o.window.close_at_end, "The window is closed at the end")->needs(show);
    sub->add_option("--screenshots", o.window.screenshots, "Folder for pictures of the window")->needs(show);
    language_option(sub, o.language);
    theme_option(sub, o.theme);
    json_flag(sub, o.json);
    show->excludes(sub->get_option("--json"));  // whoever closes the window early leaves nothing to print
    return [options] { return run_replay(*options); };
}

}  // namespace planlight
