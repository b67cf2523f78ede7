#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "app/doctor/examine_room.h"
#include "app/json_text.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

struct DoctorOptions {
    Path room, case_folder;
    bool json = false;
};

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

int run_doctor(const DoctorOptions& options) {
    const auto began = std::chrono::steady_clock::now();
    const RoomFile room = read_room(options.room);
    fmt::print(stderr, "Nobody may lie under the projector; lay anything light where the patient will be.\n");
    ExamineSettings settings;
    settings.case_folder = options.case_folder;
    settings.under_way = [](const std::string& step) { log_line("looking at " + step); };
    const std::vector<DoctorLine> lines = examine_room(room, settings);
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    if (options.json)
        std::cout << json_text(json_of(lines, took_s)) << '\n';
    else
        print_lines(lines);
    std::cout.flush();
    const auto count = [&](Health health) {
        return std::count_if(lines.begin(), lines.end(), [&](const DoctorLine& one) { return one.health == health; });
    };
    if (!options.json)
        fmt::print("{} good, {} to look at, {} that stop; {:.0f} s.\n", count(Health::good), count(Health::look),
                   count(Health::stop), took_s);
    std::fflush(stdout);
    for (const DoctorLine& one : lines)
        if (one.health == Health::stop)
            throw CheckFailedError(fmt::format("the room cannot be used like this: {}: {}", one.subject, one.said),
                                   one.remedy);
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
    json_flag(sub, o.json);
    return [options] { return run_doctor(*options); };
}

}  // namespace planlight
