#pragma once

#include <functional>

namespace CLI {
class App;
}

// The commands of the program. Each adds itself with its options to the command line, and gives what runs it once the
// line has been parsed: the exit code of a run that was not refused.
namespace planlight {

using Run = std::function<int()>;

Run add_demo(CLI::App& app);
Run add_devices(CLI::App& app);
Run add_doctor(CLI::App& app);
Run add_prepare(CLI::App& app);
Run add_plan(CLI::App& app);
Run add_patterns(CLI::App& app);
Run add_board(CLI::App& app);
Run add_calibrate(CLI::App& app);
Run add_cameras(CLI::App& app);
Run add_capture(CLI::App& app);
Run add_check(CLI::App& app);
Run add_scan(CLI::App& app);
Run add_register(CLI::App& app);
Run add_track(CLI::App& app);
Run add_project(CLI::App& app);
Run add_projector(CLI::App& app);
Run add_projector_window(CLI::App& app);
Run add_session(CLI::App& app);
Run add_review(CLI::App& app);
Run add_replay(CLI::App& app);
Run add_report(CLI::App& app);
Run add_forget(CLI::App& app);
Run add_export(CLI::App& app);
Run add_fetch(CLI::App& app);
Run add_store(CLI::App& app);
Run add_simulate(CLI::App& app);
Run add_merge(CLI::App& app);

}  // namespace planlight
