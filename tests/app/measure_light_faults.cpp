// How soon a fault of the light is noticed, and whether it is named rightly: whole sessions in simulated rooms, with
// faults drawn at random while the plan is on the skin.
// measure_light_faults paper|modern FIRST_ROOM ROOMS DRAWS_A_FAULT [FAULT,FAULT...] [--list] [--moving]
// [--computing=MS]
//
// Faults: offset (the picture 0.5 mm aside), late (20 ms, the head moving), slip (1 mm of one marker), projector and
// camera (turned by 0.05 degrees about an axis square to its sight), covered (no light), window (another picture),
// cap (all markers 2 mm along the skin), landmark (none, but a landmark is lit as for Verify, for 2 s), good
// (none, for 20 s). What the gate would have ruled of the last two is counted: how many updates were not ALIGNED, and
// for which item, of how many stretches lit, asked and seen in the last look at it. Each begins
// after a second of good light, is looked at until 0.8 s after it was noticed, 2.5 s at most, and taken away again.
// Every fourth draw is with the head moving at up to 20 mm/s, all of them where the light is late or --moving is asked
// for. Times are the room's; from a frame to its picture it computes for 10 ms, or as long as told.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

#include "app/evaluation/distribution.h"
#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "projection/light_gate.h"
#include "tests/app/faulty_room.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using namespace std::chrono_literals;

struct Outcome {
    std::optional<double> noticed_s;
    std::string named = "nothing", said;
    bool dark = false;
    int updates = 0, not_green = 0;  ///< by a gate that was verified, from the second second on
    std::string not_green_for;       ///< the last headline of these, and what was seen of the items then
};

bool no_fault(const std::string& draw) {
    return draw == "good" || draw == "landmark";
}

/// Of each item of which not all is seen that is lit.
std::string seen_of(const LightCheck& check) {
    std::string words;
    for (const ItemLight& item : check.items)
        if (item.seen < item.lit_segments)
            words += fmt::format("; {}: of {} lit {} asked, {} seen", item.name, item.lit_segments, item.segments,
                                 item.seen);
    return words;
}

const char* name_of(LightFault fault) {
    switch (fault) {
        case LightFault::late_picture:
            return "late";
        case LightFault::projector_moved:
            return "projector";
        case LightFault::left_camera_moved:
            return "left camera";
        case LightFault::right_camera_moved:
            return "right camera";
        case LightFault::marker_slipped:
            return "slip";
        case LightFault::markers_moved:
            return "cap";
        case LightFault::no_picture:
            return "covered";
        case LightFault::other_picture:
            return "window";
        case LightFault::partly_covered:
            return "half";
        case LightFault::light_off:
            return "unknown";
    }
    return "";
}

class Room {
public:
    Room(const Volume& volume, const Case& the_case, const CaseDrawing& drawing, const simulation::RoomSettings& room,
         std::chrono::milliseconds computing)
        : room_(volume, the_case, drawing, room, computing) {
        if (!room_.find_patient()) throw CheckFailedError("not found", "-");
    }

    /// One draw; empty when the light was not good before the fault.
    std::optional<Outcome> draw(const std::string& fault, bool moving, std::string& right) {
        Session& session = room_.session();
        session.go_dark();
        room_.move(moving || fault == "late" ? 20 : 0);
        if (!good_for(1s)) return std::nullopt;
        const test::FaultyRoom::Begun begun = room_.begin(fault);
        right = begun.right;
        const Instant began = room_.rig().clock().now();
        Outcome outcome;
        std::string seen;
        const Instant found_before = session.found_delay();
        LightGate gate;
        gate.verify(began);
        while (room_.rig().clock().now() - began < (fault == "good" ? 20s : 2500ms)) {
            const auto update = session.update();
            const auto ruling = gate.step(update.frame.at, update.overlay.lit, update.light, update.causes,
                                          update.pose.external_reliability_mm);
            if (update.light) seen = seen_of(*update.light);
            if (update.frame.at - began > 1s) {
                ++outcome.updates;
                if (ruling.trust != LightTrust::aligned)
                    ++outcome.not_green,
                        outcome.not_green_for =
                            ruling.headline + " " + (ruling.details.empty() ? "" : ruling.details.front()) + seen;
            }
            const bool corrected = session.found_delay() != found_before && outcome.named == "nothing";
            outcome.dark = outcome.dark || !update.overlay.lit;
            if (update.causes.empty() && !corrected && update.overlay.lit) continue;
            const double after_s = seconds(update.frame.at - began);
            if (!outcome.noticed_s) outcome.noticed_s = after_s;
            if (after_s > *outcome.noticed_s + 0.8 && !no_fault(fault)) break;
            if (!update.causes.empty()) {
                outcome.named = name_of(update.causes.front().fault);
                outcome.said = update.causes.front().sentence();
            } else if (!update.overlay.lit && outcome.named == "nothing") {
                outcome.said = update.overlay.reason;
            }
            if (outcome.named == "late") break;
        }
        begun.undo();
        return outcome;
    }

private:
    bool good_for(Instant duration) {
        const Instant from = room_.rig().clock().now();
        bool good = true;
        while (room_.rig().clock().now() - from < duration) {
            const auto update = room_.session().update();
            good = update.overlay.lit && update.causes.empty();
        }
        return good;
    }

    test::FaultyRoom room_;
};

struct Sums {
    int draws = 0, right = 0, noticed = 0, not_good_before = 0, dark = 0, updates = 0, not_green = 0;
    std::vector<double> after_s;
    std::map<std::string, int> named;
};

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> words(argv + 1, argv + argc);
    const bool list = std::erase(words, "--list") > 0, always_moving = std::erase(words, "--moving") > 0;
    std::chrono::milliseconds computing = 10ms;
    std::erase_if(words, [&](const std::string& word) {
        constexpr std::string_view kName = "--computing=";
        if (!word.starts_with(kName)) return false;
        computing = std::chrono::milliseconds(std::stoi(word.substr(kName.size())));
        return true;
    });
    if (!words.empty() && words[0] != "paper" && words[0] != "modern") {
        fmt::print(stderr,
                   "measure_light_faults paper|modern FIRST_ROOM ROOMS DRAWS_A_FAULT [FAULT,FAULT...] [--list] "
                   "[--moving] [--computing=MS]\n");
        return 2;
    }
    const std::string preset = !words.empty() ? words[0] : "paper";
    const int first = words.size() > 1 ? std::stoi(words[1]) : 1, rooms = words.size() > 2 ? std::stoi(words[2]) : 1,
              draws = words.size() > 3 ? std::stoi(words[3]) : 2;
    if (!test::example_patient()) return 77;
    std::vector<std::string> faults{"offset",  "late",   "slip", "projector", "camera",
                                    "covered", "window", "cap",  "landmark",  "good"};
    if (words.size() > 4) {
        faults.clear();
        std::istringstream named(words[4]);
        for (std::string fault; std::getline(named, fault, ',');) faults.push_back(fault);
    }
    const Volume volume = read_volume(*test::example_patient());
    const Preparation prepared = prepare_case(
        volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {}, "2001-10-14");
    const CaseDrawing drawing(prepared.prepared);
    std::map<std::string, Sums> sums;
    for (int k = 0; k < rooms; ++k) {
        simulation::RoomSettings settings;
        settings.preset = preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
        settings.seed = static_cast<unsigned>(first + k);
        Room room(volume, prepared.prepared, drawing, settings, computing);
        for (const std::string& fault : faults)
            for (int i = 0; i < draws; ++i) {
                std::string right;
                const bool moving = always_moving || i % 4 == 3;
                const auto outcome = room.draw(fault, moving, right);
                Sums& sum = sums[fault];
                if (!outcome) {
                    ++sum.not_good_before;
                    continue;
                }
                ++sum.draws;
                sum.right += outcome->named == right;
                sum.dark += outcome->dark;
                sum.updates += outcome->updates;
                sum.not_green += outcome->not_green;
                if (no_fault(fault) && outcome->not_green > 0)
                    fmt::print("room {} {} {}: {} of {} updates not ALIGNED, the last for: {}\n", first + k, fault,
                               moving ? "moving" : "rest", outcome->not_green, outcome->updates,
                               outcome->not_green_for);
                ++sum.named[outcome->named];
                if (outcome->noticed_s) {
                    ++sum.noticed;
                    sum.after_s.push_back(*outcome->noticed_s);
                }
                if (list)
                    fmt::print("room {} {} {}: {} after {:.2f} s, {} {}\n", first + k, fault,
                               moving || fault == "late" ? "moving" : "rest", outcome->named,
                               outcome->noticed_s.value_or(-1), outcome->dark ? "(dark)" : "", outcome->said);
                std::fflush(stdout);
            }
        fmt::print(stderr, "room {} of {}\n", k + 1, rooms);
    }
    fmt::print(
        "{} rooms, seeds {} to {}\nfault | draws | noticed | after, s (median / 95 % / worst) | named rightly | dark | "
        "said\n",
        preset, first, first + rooms - 1);
    for (const std::string& fault : faults) {
        const Sums& s = sums[fault];
        const Distribution after = distribution_of(s.after_s);
        std::string said;
        for (const auto& [name, count] : s.named) said += fmt::format("{}{} {}", said.empty() ? "" : ", ", count, name);
        fmt::print("{} | {}{} | {} | {:.2f} / {:.2f} / {:.2f} | {} | {} | {}\n", fault, s.draws,
                   s.not_good_before > 0 ? fmt::format(" (and {} not begun)", s.not_good_before) : "", s.noticed,
                   after.median, after.p95, after.worst, s.right, s.dark, said);
        if (no_fault(fault)) fmt::print("{}: {} of {} updates were not ALIGNED\n", fault, s.not_green, s.updates);
    }
    return 0;
}
