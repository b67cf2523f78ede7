// How often light that lies wrong is green, and light that lies right is dark: whole sessions in simulated rooms of
// many kinds (plan, head's side, lamps, wet skin, drapes, hair), in which faults of any size are drawn at random, one
// or two at a time, while a verified gate judges the light. The light's true place is measured in every third update.
// measure_green_light paper|modern FIRST_ROOM ROOMS DRAWS [--list] [--each] [--strange]
//
// Faults are those of `FaultyRoom::begin`, 0.3 to 15 times their usual size: to 7 mm of light, 0.75 degrees, 15 mm of
// a marker, 30 mm of all of them, 300 ms; or none. Each begins after a second of light, lasts 2 s and is taken away
// again. Of a hundred draws 18 are with the head moving at up to 20 mm/s, 7 at up to 60. The whole first half
// second after a fault's beginning is counted apart: nobody can know sooner. "Wrong": 95 % of the light (or, counted
// apart, that of one item at least) truly lies more than 2 mm beside the plan; "right": within 0.5 mm and without a
// fault.
// --list: what became of each draw; --each: of each update that was measured.
// --strange: cameras that blur, sharpen, bend grey values, are noisy or compress their pictures; projectors of another
// gamma, with a bright black, or whose pictures become light at odd moments.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include "app/evaluation/measure_overlay.h"
#include "app/prepare_case.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "planning_io/volume/read_volume.h"
#include "projection/light_gate.h"
#include "tests/app/faulty_room.h"
#include "tests/app/plan_all_over.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using namespace std::chrono_literals;

double uniform(double low, double high, std::mt19937& random) {
    return std::uniform_real_distribution<double>(low, high)(random);
}
template <class List>
const auto& any_of(const List& list, std::mt19937& random) {
    return list[std::uniform_int_distribution<std::size_t>(0, std::size(list) - 1)(random)];
}

/// At most so many items, one at least, chosen at random.
Plan some_items(const Plan& all, std::size_t most, std::mt19937& random) {
    std::vector<std::size_t> order(all.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    order.resize(std::min(order.size(), std::uniform_int_distribution<std::size_t>(1, most)(random)));
    Plan plan;
    for (std::size_t i : order) {
        if (i < all.trajectories.size()) {
            plan.trajectories.push_back(all.trajectories[i]);
            continue;
        }
        i -= all.trajectories.size();
        if (i < all.boreholes.size()) {
            plan.boreholes.push_back(all.boreholes[i]);
            continue;
        }
        i -= all.boreholes.size();
        if (i < all.osteotomy_lines.size())
            plan.osteotomy_lines.push_back(all.osteotomy_lines[i]);
        else
            plan.cut_planes.push_back(all.cut_planes[i - all.osteotomy_lines.size()]);
    }
    return plan;
}

Plan drawn_plan(const Plan& example, const SkinSurface& skin, std::mt19937& random) {
    const double kind = uniform(0, 1, random);
    if (kind < 0.3) return example;
    if (kind < 0.5) return some_items(example, 2, random);
    const Eigen::Vector3d towards(uniform(-1, 1, random), -1, uniform(-0.2, 1, random));
    return some_items(test::plan_all_over(skin, towards), 6, random);
}

simulation::RoomSettings drawn_room(simulation::Preset preset, unsigned seed, std::mt19937& random) {
    simulation::RoomSettings room;
    room.preset = preset;
    room.seed = seed;
    room.skin_threshold_hu = uniform(-600, -200, random);
    room.ambient = uniform(0.1, 0.35, random);
    room.wet = uniform(0, 1, random) < 0.3 ? uniform(0.1, 0.8, random) : 0;
    const double things = uniform(0, 1, random);
    room.things.drape_behind = things < 0.4;
    room.things.drape_hole = things < 0.2;
    room.things.hole_mm = uniform(120, 180, random);
    room.things.hair = things > 0.4 && things < 0.6;
    return room;
}

/// As webcams and microscopes' cameras are; lamps that flicker and light that is seen over all of an exposure.
test::CameraHabits drawn_habits(simulation::RoomSettings& room, std::mt19937& random) {
    test::CameraHabits habits;
    const auto maybe = [&](double share) { return uniform(0, 1, random) < share; };
    if (maybe(0.5)) habits.blur_px = uniform(0.3, 1.2, random);
    if (maybe(0.4)) habits.sharpening = uniform(0.2, 1, random);
    if (maybe(0.5)) habits.gamma = uniform(1.2, 2.4, random);
    if (maybe(0.5)) habits.noise = uniform(0.5, 3, random);
    if (maybe(0.4)) habits.jpeg_quality = std::uniform_int_distribution<int>(60, 95)(random);
    room.light.whole_exposure = maybe(0.5);
    room.light.panel.black = maybe(0.3) ? uniform(0.002, 0.01, random) : room.light.panel.black;
    room.light.panel.gamma = uniform(1.8, 2.6, random);
    room.light.jitter = maybe(0.3) ? 4ms : 0ms;
    return habits;
}

std::string text_of(const test::CameraHabits& h) {
    return fmt::format("blur {:.1f} px, sharpened by {:.1f}, gamma {:.1f}, noise {:.1f}, JPEG {}", h.blur_px,
                       h.sharpening, h.gamma, h.noise, h.jpeg_quality);
}

/// Markers whose middle nothing hides from either camera: a room with fewer than five is not the product's fault.
int markers_in_sight(const simulation::SimulatedRig& rig) {
    using enum simulation::SimulatedRig::Camera;
    int seen = 0;
    for (const Eigen::Vector3d& at : rig.true_markers_in_ct()) {
        const Eigen::Vector3d eye =
            rig.true_rig_from_ct(rig.clock().now()).inverse() * rig.true_rig().left_camera.centre_in_rig();
        const Eigen::Vector3d towards = (eye - at).normalized();
        const auto skin = rig.true_skin_along(at + 20 * towards, -towards);
        if (!skin) continue;
        const simulation::SimulatedRig::Lit marker{at, skin->normal_in_ct};
        seen += rig.truly_seen(left, marker, rig.clock().now()) && rig.truly_seen(right, marker, rig.clock().now());
    }
    return seen;
}

struct Sum {
    int draws = 0, updates = 0;
    int wrong = 0, wrong_and_green = 0;                    ///< after the first half second
    int wrong_at_first = 0, wrong_and_green_at_first = 0;  ///< in it
    int item_wrong = 0, item_wrong_and_green = 0;          ///< one item at least, after the first half second
    int right = 0, right_and_dark = 0, right_and_green = 0;
};

struct Judged {
    double off_mm = 0;       ///< true, 95 % of the light
    double item_off_mm = 0;  ///< true, 95 % of the light of the item that is farthest off
    std::string item;        ///< that
    LightTrust trust = LightTrust::dark;
    double after_s = 0;
    std::string headline;
    std::optional<double> measured_mm;
};

/// A picture that nothing followed is no longer lit after this.
constexpr Instant kLongest = 100ms;

/// Sees, judges and measures one session.
class Watched {
public:
    Watched(test::FaultyRoom& room, const Plan& plan) : room_(room), plan_(plan) {}

    /// A gate that a person verified sees a second of light. False: it was dark at the end.
    bool begin_good() {
        gate_ = LightGate();
        gate_.verify(room_.rig().clock().now());
        later_ = {};
        const Instant from = room_.rig().clock().now();
        bool lit = false;
        while (room_.rig().clock().now() - from < 1s) lit = step(from, false).trust != LightTrust::dark;
        return lit;
    }
    void light_comes_later(Instant later) { later_ = later; }

    /// One update. `measure`: also where the light truly was; else 0.
    Judged step(Instant since, bool measure) {
        const Session::Update update = room_.session().update();
        const LightGate::Ruling ruling = gate_.step(update.frame.at, update.overlay.lit, update.light, update.causes,
                                                    update.pose.external_reliability_mm);
        Judged judged{0, 0, {}, ruling.trust, seconds(update.frame.at - since), ruling.headline, ruling.off_mm};
        if (ruling.stop) judged.trust = LightTrust::dark;
        const ShownPicture* seen = nullptr;
        for (const ShownPicture& picture : shown_)
            if (picture.lit_from + later_ <= update.frame.at) seen = &picture;
        if (seen && update.frame.at - seen->lit_from - later_ > kLongest) seen = nullptr;  // it has gone out since
        if (measure && seen) {
            const OverlayErrors truth =
                measure_overlay(room_.rig(), plan_, room_.session().drawing(), room_.session().renderer(),
                                room_.session().render_settings(),
                                {seen->rig_from_ct, RigidTransform::Identity(), update.frame.at}, false);
            if (!truth.position_mm.empty()) judged.off_mm = quantile(truth.position_mm, 0.95);
            std::map<std::string, std::vector<double>> items;
            for (const auto& place : truth.places)
                if (place.whole) items[place.item].push_back(place.position_mm);
            for (const auto& [item, off_mm] : items)
                if (const double most = quantile(off_mm, 0.95); most > judged.item_off_mm)
                    judged.item_off_mm = most, judged.item = item;
        }
        if (update.overlay.lit) shown_.push_back({update.overlay.lit_from, update.overlay.rig_from_ct});
        if (shown_.size() > 60) shown_.erase(shown_.begin());
        return judged;
    }

private:
    test::FaultyRoom& room_;
    const Plan& plan_;
    LightGate gate_;
    Instant later_{};
    std::vector<ShownPicture> shown_;
};

constexpr const char* kFaults[] = {"none", "none", "late", "slip", "cap", "projector", "projector", "camera", "half"};

struct Drawn {
    std::string name;
    std::vector<test::FaultyRoom::Begun> begun;
};

Drawn begin_faults(test::FaultyRoom& room, std::mt19937& random) {
    Drawn drawn;
    const int faults = uniform(0, 1, random) < 0.25 ? 2 : 1;
    for (int i = 0; i < faults; ++i) {
        const std::string fault = any_of(kFaults, random);
        const double size = std::exp(uniform(std::log(0.3), std::log(15), random));
        drawn.name += fmt::format("{}{}", i > 0 ? " and " : "", fault);
        if (fault == "none" || (!drawn.begun.empty() && drawn.name.starts_with(fault))) continue;
        drawn.begun.push_back(room.begin(fault, size));
        drawn.name += fault == "half" ? "" : fmt::format(" x{:.1f}", size);
    }
    return drawn;
}

/// Markers that slid back are not where they were; nor is a rig that was found while a device was turned.
bool found_anew(test::FaultyRoom& room) {
    room.move(0);
    try {
        return room.find_patient();
    } catch (const CheckFailedError&) {
        return false;
    }
}

void count(const Judged& judged, bool fault, Sum& sum) {
    ++sum.updates;
    const bool green = judged.trust == LightTrust::aligned;
    if (judged.item_off_mm > 2 && judged.after_s >= 0.5) {
        ++sum.item_wrong;
        sum.item_wrong_and_green += green;
    }
    if (judged.off_mm > 2) {
        const bool at_first = judged.after_s < 0.5;
        ++(at_first ? sum.wrong_at_first : sum.wrong);
        if (green) ++(at_first ? sum.wrong_and_green_at_first : sum.wrong_and_green);
    } else if (judged.off_mm <= 0.5 && !fault) {
        ++sum.right;
        sum.right_and_dark += judged.trust == LightTrust::dark;
        sum.right_and_green += green;
    }
}

Sum total(const std::map<std::string, Sum>& sums) {
    Sum all;
    for (const auto& [name, s] : sums) {
        all.draws += s.draws, all.updates += s.updates, all.wrong += s.wrong, all.wrong_and_green += s.wrong_and_green;
        all.wrong_at_first += s.wrong_at_first, all.wrong_and_green_at_first += s.wrong_and_green_at_first;
        all.item_wrong += s.item_wrong, all.item_wrong_and_green += s.item_wrong_and_green;
        all.right += s.right, all.right_and_dark += s.right_and_dark, all.right_and_green += s.right_and_green;
    }
    return all;
}

void print(const std::string& name, const Sum& s) {
    fmt::print("{} | {} | {} | {} of {} | {} of {} | {} of {} | {} dark, {} green of {}\n", name, s.draws, s.updates,
               s.wrong_and_green, s.wrong, s.item_wrong_and_green, s.item_wrong, s.wrong_and_green_at_first,
               s.wrong_at_first, s.right_and_dark, s.right_and_green, s.right);
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> words(argv + 1, argv + argc);
    const bool list = std::erase(words, "--list") > 0, strange = std::erase(words, "--strange") > 0,
               each = std::erase(words, "--each") > 0;
    if (words.size() != 4 || (words[0] != "paper" && words[0] != "modern")) {
        fmt::print(stderr, "measure_green_light paper|modern FIRST_ROOM ROOMS DRAWS [--list] [--each] [--strange]\n");
        return 2;
    }
    if (!test::example_patient()) return 77;
    const auto preset = words[0] == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
    const int first = std::stoi(words[1]), rooms = std::stoi(words[2]), draws = std::stoi(words[3]);
    const Volume volume = read_volume(*test::example_patient());
    const Preparation prepared = prepare_case(
        volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {}, "2001-10-14");
    const SkinSurface skin = CaseDrawing(prepared.prepared).skin;
    std::map<std::string, Sum> sums;
    int unfit = 0, refused = 0, not_begun = 0;
    for (int k = 0; k < rooms; ++k) {
        std::mt19937 random(static_cast<unsigned>(first + k) * 104729 + 7);
        Case the_case = prepared.prepared;
        the_case.plan = drawn_plan(prepared.prepared.plan, skin, random);
        const CaseDrawing drawing(the_case);
        simulation::RoomSettings settings = drawn_room(preset, static_cast<unsigned>(first + k), random);
        const test::CameraHabits habits = strange ? drawn_habits(settings, random) : test::CameraHabits();
        test::FaultyRoom room(volume, the_case, drawing, settings, 10ms, habits);
        if (list)
            fmt::print("room {}: {} items, {} markers ({} in sight), lamps {:.2f}, wet {:.1f}{}{}; {}{}{}\n", first + k,
                       the_case.plan.size(), room.rig().true_markers_in_ct().size(), markers_in_sight(room.rig()),
                       settings.ambient, settings.wet,
                       settings.things.drape_hole     ? ", under a drape with a hole"
                       : settings.things.drape_behind ? ", a drape behind"
                                                      : "",
                       settings.things.hair ? ", hair" : "", text_of(habits),
                       settings.light.jitter > Instant::zero() ? "; pictures at odd moments" : "",
                       settings.light.whole_exposure ? "; seen over all of an exposure" : "");
        if (markers_in_sight(room.rig()) < SessionSettings().min_reference_markers) {
            ++unfit;
            continue;
        }
        try {
            if (!room.find_patient()) throw CheckFailedError("the patient was not found", "-");
        } catch (const CheckFailedError& e) {
            fmt::print("room {}: refused, {}\n", first + k, e.what());
            ++refused;
            continue;
        }
        Watched watched(room, the_case.plan);
        for (int i = 0; i < draws; ++i) {
            room.session().go_dark();
            const double how = uniform(0, 1, random), speed_mm_s = how < 0.75 ? 0 : how < 0.93 ? 20 : 60;
            room.move(speed_mm_s);
            if (!watched.begin_good() && !(found_anew(room) && watched.begin_good())) {
                ++not_begun;
                continue;
            }
            const Drawn drawn = begin_faults(room, random);
            const Instant began = room.rig().clock().now();
            for (const auto& fault : drawn.begun) watched.light_comes_later(fault.light_later);
            double worst_green_mm = 0, most_mm = 0, worst_green_item_mm = 0;
            std::string worst_item;
            Judged last;
            int n = 0;
            Sum& sum = sums[drawn.begun.size() > 1 ? "two"
                            : drawn.begun.empty()  ? "none"
                                                   : drawn.name.substr(0, drawn.name.find(' '))];
            ++sum.draws;
            while (room.rig().clock().now() - began < 2s) {
                const bool measured = n++ % 3 == 0;
                last = watched.step(began, measured);
                if (!measured) continue;
                count(last, !drawn.begun.empty(), sum);
                if (each)
                    fmt::print("  {:.3f} s: {:.2f} mm ({}: {:.2f} mm), measured {}, {}\n", last.after_s, last.off_mm,
                               last.item, last.item_off_mm,
                               last.measured_mm ? fmt::format("{:.2f} mm", *last.measured_mm) : "nothing",
                               last.headline);
                most_mm = std::max(most_mm, last.off_mm);
                if (last.trust != LightTrust::aligned || last.after_s < 0.5) continue;
                worst_green_mm = std::max(worst_green_mm, last.off_mm);
                if (last.item_off_mm > worst_green_item_mm)
                    worst_green_item_mm = last.item_off_mm, worst_item = last.item;
            }
            for (const auto& fault : drawn.begun) fault.undo();
            if (list || worst_green_mm > 2 || worst_green_item_mm > 2)
                fmt::print(
                    "room {}, draw {}, {} mm/s, {}: {:.2f} mm at most, {:.2f} mm while green ({}{:.2f} mm); "
                    "at last {}\n",
                    first + k, i, speed_mm_s, drawn.name, most_mm, worst_green_mm,
                    worst_item.empty() ? "" : worst_item + ": ", worst_green_item_mm,
                    last.trust == LightTrust::aligned ? "ALIGNED"
                    : last.trust == LightTrust::look  ? "CHECK: " + last.headline
                                                      : "DARK: " + last.headline);
            std::fflush(stdout);
        }
        fmt::print(stderr, "room {} of {}; wrong and green so far: {} of {} updates\n", k + 1, rooms,
                   total(sums).wrong_and_green, total(sums).wrong);
    }
    fmt::print(
        "{} rooms {} to {}: {} not played, for hair or cloth is before their markers; {} refused; {} draws not "
        "begun, for it was dark before\n"
        "fault | draws | updates | wrong and green, of wrong | the same of one item at least | wrong "
        "and green in the first half second | right light\n",
        words[0], first, first + rooms - 1, unfit, refused, not_begun);
    for (const auto& [name, s] : sums) print(name, s);
    print("all", total(sums));
    return 0;
}
