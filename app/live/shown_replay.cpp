#include "app/live/shown_replay.h"

#include <fmt/format.h>

#include <future>

#include "app/live/replay_view.h"
#include "app/live/step_pictures.h"
#include "app/windows/operator_window.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

/// Thrown out of a replay whose window was closed.
struct WindowClosed {};

/// True: the person has closed it.
bool show_once(OperatorWindow& window, const ReplayView& view, StepPictures& pictures) {
    constexpr double kRest_s = 0.03;
    const OperatorModel model = view.model();
    const OperatorAction action = window.frame(model);
    if (action != OperatorAction::none && action != OperatorAction::quit) window.say(ReplayView::kNothingIsProjected);
    pictures.take(window, model);
    window.rest(kRest_s);
    return action == OperatorAction::quit;
}

std::string words_of_end(const ReplayResult& result) {
    if (result.difference) return "The replay is over: it differs from the recording.";
    return result.ended.empty() ? "The replay is over: alike to the last digit."
                                : "The replay is over: alike as far as the recording goes.";
}

}  // namespace

std::optional<ReplayResult> show_replay(const std::filesystem::path& recording, const Case& the_case,
                                        const ShownReplaySettings& settings) {
    OperatorWindow window(settings.window);
    DrawingSettings how;
    how.up_in_ct = head_of_recording(recording).up_in_ct;
    const CaseDrawing drawing(the_case, how);
    ReplayView view(the_case, drawing, {settings.speed, settings.longest_pause_s});
    const auto go_on = [&](double) {
        if (view.closed()) throw WindowClosed{};
    };
    auto replayed = std::async(std::launch::async, [&] { return replay_session(recording, the_case, go_on, &view); });
    StepPictures pictures(settings.screenshots, "replay");
    while (replayed.wait_for(0s) != std::future_status::ready)
        if (show_once(window, view, pictures)) view.close();
    try {
        const ReplayResult result = replayed.get();
        view.over(words_of_end(result), result.difference ? StatusKind::check : StatusKind::ready);
        for (int looks = 0; !view.closed() && (!settings.close_at_end || looks < 12); ++looks)
            if (show_once(window, view, pictures)) break;
        return result;
    } catch (const WindowClosed&) {
        return std::nullopt;
    }
}

}  // namespace planlight
