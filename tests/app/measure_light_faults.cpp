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
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "app/evaluation/distribution.h"
#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "projection/light_gate.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using namespace std::chrono_literals;
using Eigen::Vector2d;
using Eigen::Vector3d;
using simulation::SimulatedRig;

/// Shows the picture shifted, or something else instead.
class Spoilt final : public Projector {
public:
    explicit Spoilt(Projector& projector) : projector_(projector) {}
    int width() const override { return projector_.width(); }
    int height() const override { return projector_.height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        if (instead) return projector_.show(*instead, valid_until);
        if (shift_px.norm() == 0) return projector_.show(picture, valid_until);
        RgbImage shifted(picture.width, picture.height);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) shifted.at(x, y) = at(picture, Vector2d(x, y) - shift_px);
        return projector_.show(shifted, valid_until);
    }
    void go_dark() noexcept override { projector_.go_dark(); }

    Vector2d shift_px{0, 0};
    std::optional<RgbImage> instead;

private:
    static Rgb at(const RgbImage& picture, const Vector2d& p) {
        const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
        if (x < 0 || y < 0 || x + 1 >= picture.width || y + 1 >= picture.height) return {0, 0, 0};
        const double u = p.x() - x, v = p.y() - y;
        Rgb mixed{};
        for (std::size_t c = 0; c < 3; ++c)
            mixed[c] = static_cast<std::uint8_t>(
                (1 - v) * ((1 - u) * picture.at(x, y)[c] + u * picture.at(x + 1, y)[c]) +
                v * ((1 - u) * picture.at(x, y + 1)[c] + u * picture.at(x + 1, y + 1)[c]) + 0.5);
        return mixed;
    }
    Projector& projector_;
};

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
    Room(const Volume& volume, const Case& the_case, const CaseDrawing& drawing, simulation::Preset preset,
         unsigned seed, std::chrono::milliseconds computing)
        : computing_(computing),
          random_(seed * 7919 + 3),
          rig_(volume, points_of(the_case.plan), room(preset, seed)),
          spoilt_(rig_.projector()),
          session_(the_case, drawing, rig_.calibration(), spoilt_, rig_.cameras(), rig_.clock(), settings()) {
        session_.scan();
        if (session_.find_patient().verdict == Verdict::no) throw CheckFailedError("not found", "-");
        session_.confirm();
    }

    /// One draw; empty when the light was not good before the fault.
    std::optional<Outcome> draw(const std::string& fault, bool moving, std::string& right) {
        session_.go_dark();
        move(moving || fault == "late");
        if (!good_for(1s)) return std::nullopt;
        const auto undo = begin(fault, right);
        const Instant began = rig_.clock().now();
        Outcome outcome;
        std::string seen;
        const Instant found_before = session_.found_delay();
        LightGate gate;
        gate.verify(began);
        while (rig_.clock().now() - began < (fault == "good" ? 20s : 2500ms)) {
            const auto update = session_.update();
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
            const bool corrected = session_.found_delay() != found_before && outcome.named == "nothing";
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
        undo();
        return outcome;
    }

private:
    static simulation::RoomSettings room(simulation::Preset preset, unsigned seed) {
        simulation::RoomSettings room;
        room.preset = preset;
        room.seed = seed;
        return room;
    }
    SessionSettings settings() {
        SessionSettings settings;
        settings.while_computing = [this] { rig_.wait(computing_); };
        return settings;
    }
    void move(bool moving) {
        if (moving == moving_) return;
        rig_.set_motion({moving ? 20.0 : 0.0, rig_.clock().now()});
        moving_ = moving;
    }
    bool good_for(Instant duration) {
        const Instant from = rig_.clock().now();
        bool good = true;
        while (rig_.clock().now() - from < duration) {
            const auto update = session_.update();
            good = update.overlay.lit && update.causes.empty();
        }
        return good;
    }
    Vector3d any_axis() {
        const double angle = std::uniform_real_distribution<double>(0, 2 * std::numbers::pi)(random_);
        return {std::cos(angle), std::sin(angle), 0};
    }
    std::function<void()> begin(const std::string& fault, std::string& right) {
        constexpr double kTurn = 0.05 * std::numbers::pi / 180;
        right = fault == "offset" ? "projector" : fault;
        if (fault == "offset") {
            const double mm_per_px = 900 / rig_.calibration().projector.focal_x;
            spoilt_.shift_px = 0.5 / mm_per_px * any_axis().head<2>();
            return [this] { spoilt_.shift_px.setZero(); };
        }
        if (fault == "late") {
            rig_.delay_light(20ms);
            return [this] { rig_.delay_light({}); };
        }
        if (fault == "slip" || fault == "cap") {
            const int markers = static_cast<int>(rig_.true_markers_in_ct().size());
            const int marker = fault == "cap" ? -1 : std::uniform_int_distribution<int>(0, markers - 1)(random_);
            const Vector3d at = rig_.true_markers_in_ct()[static_cast<std::size_t>(std::max(marker, 0))];
            const Vector3d normal = skin_normal(at);
            std::normal_distribution<double> gauss;
            const Vector3d any(gauss(random_), gauss(random_), gauss(random_));
            const Vector3d shift = (fault == "cap" ? 2 : 1) * (any - any.dot(normal) * normal).normalized();
            rig_.slip_marker(marker, shift);
            return [this, marker, shift] { rig_.slip_marker(marker, -shift); };
        }
        if (fault == "projector" || fault == "camera") {
            auto device = SimulatedRig::Device::projector;
            if (fault == "camera") {
                const bool left = std::uniform_int_distribution<int>(0, 1)(random_) == 0;
                device = left ? SimulatedRig::Device::left_camera : SimulatedRig::Device::right_camera;
                right = left ? "left camera" : "right camera";
            }
            const Vector3d turn = kTurn * any_axis();
            rig_.bump(device, turn);
            return [this, device, turn] { rig_.bump(device, -turn); };
        }
        if (fault == "covered") {
            rig_.cover_projector(true);
            return [this] { rig_.cover_projector(false); };
        }
        if (fault == "window") {
            RgbImage desktop(spoilt_.width(), spoilt_.height(), {120, 130, 140});
            for (int y = 0; y < desktop.height / 20; ++y)
                for (int x = 0; x < desktop.width; ++x) desktop.at(x, y) = {230, 230, 230};
            spoilt_.instead = desktop;
            return [this] { spoilt_.instead.reset(); };
        }
        right = "nothing";
        if (fault == "landmark" && !session_.landmarks().empty()) {
            session_.light_landmark(landmark_++ % session_.landmarks().size());
            return [this] { session_.light_landmark({}); };
        }
        return [] {};
    }
    /// From the skin's own shape round the place.
    Vector3d skin_normal(const Vector3d& at) const {
        const RigidTransform to_rig = rig_.true_rig_from_ct(rig_.clock().now());
        const Vector3d towards = (to_rig.inverse() * rig_.calibration().projector.centre_in_rig() - at).normalized();
        const auto skin = rig_.true_skin_along(at + 20 * towards, -towards);
        return skin ? skin->normal_in_ct : towards;
    }

    std::chrono::milliseconds computing_;
    std::mt19937 random_;
    SimulatedRig rig_;
    Spoilt spoilt_;
    Session session_;
    bool moving_ = false;
    std::size_t landmark_ = 0;  ///< lit next
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
        Room room(volume, prepared.prepared, drawing,
                  preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern,
                  static_cast<unsigned>(first + k), computing);
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
