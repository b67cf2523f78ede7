#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/doctor_options.h"
#include "app/commands/language_option.h"
#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

void print_lines(const std::vector<DoctorLine>& lines) {
    std::size_t widest = 0;
    for (const DoctorLine& one : lines) widest = std::max(widest, one.subject.size());
    for (const DoctorLine& one : lines) {
        fmt::print("{:4}  {:{}}  {}\n", one.health == Health::stop ? "STOP" : text_of(one.health), one.subject, widest,
                   one.said);
        if (!one.remedy.empty()) fmt::print("{:4}  {:{}}  -> {}\n", "", "", widest, one.remedy);
    }
}

nlohmann::ordered_json json_of(const std::vector<DoctorLine>& lines, double took_s) {
    nlohmann::ordered_json json{
        {"verdict", text_of(worst_of(lines))}, {"took_s", took_s}, {"lines", nlohmann::ordered_json::array()}};
    for (const DoctorLine& one : lines)
        json["lines"].push_back(
            {{"subject", one.subject}, {"health", text_of(one.health)}, {"said", one.said}, {"remedy", one.remedy}});
    return json;
}

void print(const DoctorOptions& options, const std::vector<DoctorLine>& lines, double took_s) {
    const auto count = [&](Health health) {
        return std::count_if(lines.begin(), lines.end(), [&](const DoctorLine& one) { return one.health == health; });
    };
    if (options.json) {
        std::cout << json_text(json_of(lines, took_s)) << std::endl;
        return;
    }
    print_lines(lines);
    fmt::print("{} good, {} to look at, {} STOP; {:.0f} s.\n", count(Health::good), count(Health::look),
               count(Health::stop), took_s);
    std::fflush(stdout);
}

/// Without a window.
ExaminationState examine(const DoctorOptions& options, const RoomFile& room) {
    const SteadyClock clock;
    const Instant began = clock.now();
    ExamineSettings settings;
    settings.case_folder = options.case_folder;
    settings.under_way = [](const std::string& step) { log_line("looking at " + step); };
    ExaminationState state;
    state.lines = examine_room(room, settings);
    state.over = true;
    state.took_s = seconds(clock.now() - began);
    return state;
}

int run_doctor(const DoctorOptions& options) {
    const RoomFile room = read_room(options.room);
    print_to_user("Nobody may lie under the projector; lay anything light where the patient will be.\n");
    const ExaminationState found = options.window ? show_doctor_page(options, room) : examine(options, room);
    print(options, found.lines, found.took_s);
    for (const DoctorLine& one : found.lines)
        if (one.health == Health::stop)
            throw CheckFailedError(fmt::format("the room cannot be used like this: {}: {}", one.subject, one.said),
                                   one.remedy);
    if (!found.over || found.ended_by_hand)
        throw CheckFailedError("ended by hand: not all of the room was looked at",
                               "Look again before a patient comes.");
    return 0;
}

}  // namespace

Run add_doctor(CLI::App& app) {
    const auto options = std::make_shared<DoctorOptions>();
    DoctorOptions& o = *options;
    auto* sub = add_command(app, "doctor",
                            "Is everything in this room ready for a patient? Each thing good, look or stop (exit 6)",
                            "doctor --room room.json case");
    sub->add_option("--room", o.room, "room.json (see `devices`)")->required();
    sub->add_option("case", o.case_folder, "Case folder whose checksums are looked at as well");
    auto* window = sub->add_flag("--window", o.window,
                                 "On a page in a window: each line as it is found, the verdict in large letters; what "
                                 "was found last is printed when it is closed");
    sub->add_option("--operator", o.operator_monitor, "Monitor of the window (default: the primary one)")
        ->needs(window);
    language_option(sub, o.language);
    theme_option(sub, o.theme);
    sub->add_option("--screenshot", o.screenshot, "Write a picture of the window when all was looked at, and end")
        ->check(png_file())
        ->needs(window);
    json_flag(sub, o.json);
    return [options] { return run_doctor(*options); };
}

}  // namespace planlight
