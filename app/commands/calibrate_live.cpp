#include <fmt/format.h>
#include <unistd.h>

#include <future>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "app/commands/calibrate_options.h"
#include "app/commands/language_option.h"
#include "app/console.h"
#include "app/json_text.h"
#include "app/live/guide_screen.h"
#include "app/live/guided_calibration.h"
#include "app/live/room_cameras.h"
#include "app/report/calibration_report.h"
#include "app/windows/guide_window.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/case/room_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "registration/calibration/rig_on_poses.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;
using std::filesystem::path;

const char* name_of(GuideEvent::Kind kind) {
    constexpr std::array kNames{"advice", "refused", "capturing", "captured", "predicted", "trouble", "done"};
    return kNames[static_cast<std::size_t>(kind)];
}

Json json_of(const GuideEvent& event) {
    Json json{{"event", name_of(event.kind)}, {"at_s", seconds(event.at)}, {"poses", event.poses}};
    if (event.fault != PoseFault::none) json["fault"] = text_of(event.fault);
    if (!event.why.empty()) json["why"] = event.why;
    if (!event.what.empty()) json["what"] = event.what;
    json["predicted_mm"] = event.predicted_mm ? Json(*event.predicted_mm) : Json();
    return json;
}

void print(const GuideEvent& event) {
    const std::string at = fmt::format("{:6.1f} s  ", seconds(event.at));
    const std::string words = event.why + (event.why.empty() || event.what.empty() ? "" : " ") + event.what;
    switch (event.kind) {
        case GuideEvent::Kind::advice:
            fmt::print("{}{}\n", at, words);
            break;
        case GuideEvent::Kind::refused:
            fmt::print("{}Not this pose: {}\n", at, words);
            break;
        case GuideEvent::Kind::capturing:
            fmt::print("{}Capturing. {}\n", at, words);
            break;
        case GuideEvent::Kind::captured:
            fmt::print("{}Pose {} is taken.\n", at, event.poses);
            break;
        case GuideEvent::Kind::predicted:
            if (event.predicted_mm)
                fmt::print("{}Predicted error by {} poses: {:.3f} mm.\n", at, event.poses, *event.predicted_mm);
            else
                fmt::print("{}Not enough for a calibration yet. {}\n", at, words);
            break;
        case GuideEvent::Kind::trouble:
            fmt::print("{}{}\n", at, words);
            break;
        case GuideEvent::Kind::done:
            fmt::print("{}{} poses.\n", at, event.poses);
            break;
    }
    std::fflush(stdout);
}

/// What the person looks at while something runs in a thread of its own: the window, or nothing but the terminal.
class Screen {
public:
    Screen(const CalibrateOptions& options, const GuidedCalibration& calibration, std::string subtitle)
        : calibration_(calibration), subtitle_(std::move(subtitle)), screenshots_(options.screenshots) {
        note_end_signals();
        if (options.headless) return;
        window_ = std::make_unique<GuideWindow>(
            settings_of_page("Planlight calibration", options.language, options.theme, options.operator_monitor));
        if (!screenshots_.empty()) make_folder(screenshots_);
    }

    bool has_window() const { return window_ != nullptr; }

    /// Until `ready`, or somebody wants to end it: false then.
    template <typename Ready>
    bool wait(const Ready& ready, const std::string& computing = {}) {
        while (!ready()) {
            if (asked_to_end()) return false;
            if (frame(computing) == GuideAction::quit) return false;
        }
        return true;
    }
    /// Keep, discard, or quit.
    GuideAction ask(const std::vector<std::string>& result) {
        result_ = result;
        for (;;) {
            const GuideAction wanted = frame({});
            if (asked_to_end()) return GuideAction::quit;
            if (wanted != GuideAction::none) return wanted;
        }
    }

private:
    GuideAction frame(const std::string& computing) {
        if (!window_) {
            std::this_thread::sleep_for(50ms);
            return GuideAction::none;
        }
        GuideModel model = guide_model_of(calibration_.state(), "Guided calibration", subtitle_);
        if (!computing.empty() || !result_.empty()) {
            model.mood = GuideModel::Mood::done;
            model.word = result_.empty() ? "DONE" : "KEEP IT?";
            model.what = result_.empty() ? computing : "Keep the new rig, or go on with the former one?";
            model.why = result_.empty() ? "" : "Enter keeps it, Delete discards it.";
            model.share = 0;
            model.result = result_;
        }
        const GuideAction wanted = window_->frame(model);
        take_picture(model.word);
        window_->rest(0.08);
        return wanted;
    }
    /// One for every word, when it has stood for some frames.
    void take_picture(const std::string& word) {
        constexpr int kSettled = 4;
        stood_ = word == word_ ? stood_ + 1 : 0;
        word_ = word;
        if (screenshots_.empty() || stood_ != kSettled) return;
        write_png(window_->screenshot(), screenshots_ / fmt::format("guide-{:02}.png", ++pictures_), ReadableBy::owner);
    }

    const GuidedCalibration& calibration_;
    std::string subtitle_;
    path screenshots_;
    std::unique_ptr<GuideWindow> window_;
    std::vector<std::string> result_;
    std::string word_;
    int stood_ = 0, pictures_ = 0;
};

CheckFailedError ended_by_hand(const GuidedCalibration& calibration) {
    return {fmt::format("ended by hand after {} poses; no rig was made", calibration.poses().size()),
            "Begin again when there is time; ten poses take some minutes."};
}

/// Guides in a thread of its own, so that this one can see to signals and the window.
void guide(GuidedCalibration& calibration, Screen& screen) {
    std::stop_source stop;
    auto run = std::async(std::launch::async, [&] { calibration.run(stop.get_token()); });
    // Whatever is thrown here, the future waits for an end that somebody must have asked for.
    struct AskToStop {
        std::stop_source& stop;
        ~AskToStop() { stop.request_stop(); }
    } ask{stop};
    const auto ready = [&] { return run.wait_for(0ms) == std::future_status::ready; };
    const bool wanted = screen.wait(ready);
    stop.request_stop();
    run.get();
    if (!wanted) throw ended_by_hand(calibration);
}

/// The two rigs on the poses that were just captured.
std::vector<std::string> beside_former(const RigCalibration& former, const Calibration& now,
                                       const std::vector<PoseObservation>& poses, const BoardSpec& board) {
    std::vector<std::string> words;
    const RigOnPoses old = rig_on_poses(former, poses, board, now);
    for (const DeviceName device : kDevices) {
        const auto d = static_cast<std::size_t>(device);
        words.push_back(
            fmt::format("On these poses the {} is off by {:.3f} px by the rig of {}, by {:.3f} px by the new one.",
                        text_of(device), old.rms_px[d], former.made_on, now.held_out.rms_px[d]));
        if (old.left_out[d] > 0.2)
            words.push_back(
                fmt::format("By the former rig {:.0f} % of the {}'s points fit not at all, and are not in "
                            "that figure: it was moved or changed.",
                            100 * old.left_out[d], text_of(device)));
    }
    return words;
}

bool ask_at_terminal() {
    fmt::print("Keep the new rig? [y/n] ");
    std::fflush(stdout);
    std::string answer;
    std::getline(std::cin, answer);
    return !answer.empty() && (answer[0] == 'y' || answer[0] == 'Y');
}

enum class Keeping { keep, discard, beside };

Keeping decide(const CalibrateOptions& options, const std::vector<std::string>& result, Screen& screen) {
    if (options.keep == "yes") return Keeping::keep;
    if (options.keep == "no") return Keeping::discard;
    if (screen.has_window()) return screen.ask(result) == GuideAction::keep ? Keeping::keep : Keeping::discard;
    if (isatty(STDIN_FILENO) && !options.json) return ask_at_terminal() ? Keeping::keep : Keeping::discard;
    return std::filesystem::exists(options.out) ? Keeping::beside : Keeping::keep;
}

/// Where it was written; empty: nowhere.
path write_as_decided(const RigCalibration& rig, const CalibrateOptions& options, Keeping keeping) {
    if (keeping == Keeping::discard) return {};
    if (keeping == Keeping::beside) {
        const path file = unused(options.out, "-new");
        write_rig(rig, file);
        return file;
    }
    keep_previous_rig(options.out);
    write_rig(rig, options.out);
    return options.out;
}

/// The result in words, for the window.
std::vector<std::string> sentences_of(const CalibrationReport& report) {
    std::vector<std::string> sentences;
    std::istringstream text(calibration_summary(report));
    for (std::string line; std::getline(text, line);)
        if (line.find("; the report: ") == std::string::npos) sentences.push_back(line);
    return sentences;
}

int finish(const CalibrateOptions& options, const GuidedCalibration& guided, const BoardSpec& board,
           const DeviceSerials& serials, Screen& screen) {
    auto computed = std::async(std::launch::async, [&] { return guided.calibrate(); });
    if (!screen.wait([&] { return computed.wait_for(0ms) == std::future_status::ready; },
                     "The rig is computed, and judged on poses that it has not seen."))
        throw ended_by_hand(guided);
    const Calibration calibration = computed.get();
    if (calibration.refusal) throw CheckFailedError(calibration.refusal->reason, calibration.refusal->remedy);
    CalibrationReport report{calibration, guided.poses(), board, today(), options.out, {}, serials};
    RigCalibration rig = rig_calibration_of(calibration, report.made_on);
    rig.serials = serials;
    if (const auto former = previous_rig(options.out); former && former->whole()) {
        report.changes = changes_since(*former, rig);
        for (const std::string& words : beside_former(*former, calibration, guided.poses(), board))
            report.changes.push_back(words);
    }
    for (const std::string& warning : calibration.warnings) warn(warning);
    if (!options.json)
        for (const std::string& sentence : sentences_of(report)) fmt::print("{}\n", sentence);
    const path written = write_as_decided(rig, options, decide(options, sentences_of(report), screen));
    report.rig_file = written;
    if (!written.empty()) write_calibration(report, written, options.pdf);
    if (options.json)
        std::cout << json_line(Json{{"event", "result"},
                                    {"rig", written.string()},
                                    {"refused_poses", guided.refused_poses()},
                                    {"calibration", Json::parse(calibration_json(report))}})
                  << '\n';
    else if (written.empty())
        fmt::print("Discarded; {} is as it was.\n", options.out.string());
    else
        fmt::print("{} is written.\n", written.string());
    return 0;
}

}  // namespace

int run_calibrate_live(const CalibrateOptions& options) {
    const BoardSpec board = parse_board(options.board);
    if (!board.has_a_top())
        throw InputError(
            {}, fmt::format("a {} looks the same when turned by half a turn", text_of(board)),
            "Use a ChArUco board for a guided calibration, or a chessboard with an odd sum of inner corners.");
    check_can_write(options.out);
    if (!options.keep_captures.empty()) check_new_folder(options.keep_captures);
    const RoomFile room = read_room(options.room);
    const SteadyClock clock;
    RoomCameras cameras(room, clock);
    for (const std::string& note : cameras.notes()) warn(note + ".");
    CommandProjector projector(room, &cameras);
    GuidedSettings settings;
    settings.captures = options.keep_captures;
    settings.serials = {cameras.left().serial(), cameras.right().serial(), options.serial_projector};
    if (room.projector_file.empty()) settings.light_later = 100ms;  // nobody has measured it
    settings.guide.most_poses = static_cast<std::size_t>(options.most_poses);
    settings.guide.good_enough_mm = options.good_enough_mm;
    GuidedCalibration guided(projector.projector(), cameras.pair(), clock, board, settings,
                             [&](const GuideEvent& event) {
                                 if (options.json)
                                     std::cout << json_line(json_of(event)) << std::endl;
                                 else
                                     print(event);
                             });
    Screen screen(options, guided, room.name + ", " + text_of(board));
    guide(guided, screen);
    return finish(options, guided, board, settings.serials, screen);
}

}  // namespace planlight
