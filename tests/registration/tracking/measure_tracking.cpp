// How true is the uncertainty that a tracked pose states? Random rigs of both rooms with calibrations as wrong as good
// ones are; markers on a head that has moved; discs measured with the noise that the product states; markers covered
// for one camera or both. The largest error over the plan's places (an item on the skin, up to 100 mm from the markers)
// against the stated 95 % bound, once with the places told, once without. measure_tracking [FRAMES [FIRST_SEED]]
// (default 10000 a room, seed 1; about 10 s). measure_tracking slipped [FRAMES [FIRST_SEED]]: the same, but one marker
// has moved on the skin. On rendered pictures of the example patient through the tracker itself: measure_tracking
// rendered [FRAMES [FIRST_SEED]] (300; minutes).
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "planning_io/types/statistics.h"
#include "planning_io/volume/read_volume.h"
#include "registration/tracking/fit_pose.h"
#include "registration/tracking/track_patient.h"
#include "tests/registration/tracking/drawn_frames.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;
using simulation::Preset;

/// Errors of one kind of frame, with their stated sigma and bound.
struct Figures {
    std::vector<double> error_mm, bound_mm, of_sigma;
    int within = 0, refused = 0;
    std::map<std::string, int> why;  ///< refused
    void refuse(const std::string& reason) {
        ++refused;
        std::string words;  // without its numbers
        for (const char c : reason)
            if (!std::isdigit(static_cast<unsigned char>(c)) && c != '.') words += c;
        ++why[words];
    }
    void add(double error, double sigma, double bound) {
        error_mm.push_back(error);
        bound_mm.push_back(bound);
        of_sigma.push_back(error / sigma);
        within += error <= bound;
    }
};

void print(const std::string& title, const std::map<std::string, Figures>& kinds) {
    fmt::print("\n{}\n{:<52} {:>6} {:>7} {:>7} {:>24} {:>16} {:>9}\n", title, "", "frames", "refused", "within",
               "error mm: median, 95 %, worst", "bound: median", "rms/sigma");
    Figures all;
    const auto line = [](const std::string& name, const Figures& f) {
        double squares = 0;
        for (const double r : f.of_sigma) squares += r * r / static_cast<double>(f.of_sigma.size());
        const auto n = f.error_mm.size();
        fmt::print("{:<52} {:>6} {:>7} {:>5.1f} % {:>12.3f} {:>7.3f} {:>7.3f} {:>16.3f} {:>9.2f}\n", name, n, f.refused,
                   n ? 100. * f.within / static_cast<double>(n) : 0., median(f.error_mm), quantile(f.error_mm, 0.95),
                   quantile(f.error_mm, 1), median(f.bound_mm), std::sqrt(squares));
    };
    for (const auto& [name, f] : kinds) {
        line(name, f);
        all.refused += f.refused, all.within += f.within;
        all.error_mm.insert(all.error_mm.end(), f.error_mm.begin(), f.error_mm.end());
        all.bound_mm.insert(all.bound_mm.end(), f.bound_mm.begin(), f.bound_mm.end());
        all.of_sigma.insert(all.of_sigma.end(), f.of_sigma.begin(), f.of_sigma.end());
    }
    line("all", all);
    std::map<std::string, int> why;
    for (const auto& [name, f] : kinds)
        for (const auto& [words, count] : f.why) why[words] += count;
    for (const auto& [words, count] : why) fmt::print("  {:>6} refused: {}\n", count, words);
}

void measure_geometry(Preset preset, int frames, unsigned seed) {
    constexpr int kFramesOfARoom = 10;
    std::mt19937 random(seed), random_plan(seed);
    std::map<std::string, Figures> told, untold;
    for (int drawn = 0; drawn < frames;) {
        const DrawnRoom room(preset, random);
        if (room.reference.size() < 3) continue;
        for (int i = 0; i < kFramesOfARoom; ++i) {
            const DrawnFrame frame = frame_of(room, random);
            if (distinct_markers(frame.sightings) < 3) continue;
            ++drawn;
            const auto plan = plan_of(room, random_plan);
            for (const bool tell : {true, false}) {
                const CheckedPose pose =
                    fit_pose_checked(room.calibration, room.reference, frame.sightings, frame.truth, TrackingSettings{},
                                     tell ? plan : std::vector<Vector3d>{});
                Figures& of = (tell ? told : untold)[frame.kind];
                if (pose.fit)
                    of.add(largest_off(pose.fit->rig_from_patient, frame.truth, plan), pose.fit->error_mm,
                           pose.fit->bound_95_mm);
                else
                    of.refuse(pose.reason);
            }
        }
    }
    print(fmt::format("{} room, discs by their geometry, the plan's places told", name_of(preset)), told);
    print(fmt::format("{} room, the same, 100 mm all round", name_of(preset)), untold);
}

/// What becomes of a marker that moved.
struct Slips {
    int frames = 0, refused = 0, right = 0, wrong = 0, none = 0, within = 0, green = 0;
    double worst_wrong_mm = 0, worst_none_mm = 0, worst_right_mm = 0, worst_green_mm = 0;
};

void measure_slips(Preset preset, int frames, unsigned seed) {
    std::mt19937 random(seed);
    std::map<std::string, Slips> kinds;
    for (int drawn = 0; drawn < frames;) {
        const DrawnRoom room(preset, random);
        if (room.reference.size() < 3) continue;
        for (const double slip_mm : {0.3, 0.5, 0.7, 1., 2.}) {
            const int slipped = static_cast<int>(random() % room.in_room.size());
            const Vector3d n = room.in_room[static_cast<std::size_t>(slipped)].normal, a = n.unitOrthogonal();
            const double angle = std::uniform_real_distribution<double>(0, 2 * std::numbers::pi)(random);
            const DrawnFrame frame =
                frame_of(room, random, slipped, slip_mm * (std::cos(angle) * a + std::sin(angle) * n.cross(a)));
            const auto plan = plan_of(room, random);
            const int seen = distinct_markers(frame.sightings);
            const bool in_sight = std::any_of(frame.sightings.begin(), frame.sightings.end(),
                                              [&](const Sighting& s) { return s.marker == slipped; });
            if (seen < 3 || !in_sight) continue;
            ++drawn;
            const CheckedPose pose = fit_pose_checked(room.calibration, room.reference, frame.sightings, frame.truth,
                                                      TrackingSettings{}, plan);
            Slips& of = kinds[fmt::format("{:>3} mm, {}", slip_mm,
                                          seen == 3   ? "3 markers"
                                          : seen == 4 ? "4 markers"
                                          : seen == 5 ? "5 markers"
                                                      : "6 markers and more")];
            ++of.frames;
            if (!pose.fit) {
                ++of.refused;
                continue;
            }
            const double off_mm = largest_off(pose.fit->rig_from_patient, frame.truth, plan);
            of.within += off_mm <= pose.fit->bound_95_mm;
            const bool right = std::any_of(pose.doubts.begin(), pose.doubts.end(),
                                           [&](const MarkerDoubt& d) { return d.marker == slipped; });
            ++(right ? of.right : pose.doubts.empty() ? of.none : of.wrong);
            double& worst = right ? of.worst_right_mm : pose.doubts.empty() ? of.worst_none_mm : of.worst_wrong_mm;
            worst = std::max(worst, off_mm);
            constexpr double kGreen_mm = 3;  // LightGateSettings::warn_unnoticed_mm
            if (pose.doubts.empty() && pose.fit->external_reliability_mm <= kGreen_mm) {
                ++of.green;
                of.worst_green_mm = std::max(of.worst_green_mm, off_mm);
            }
        }
    }
    fmt::print(
        "\n{} room, one marker slipped: what is done about it, and the worst error at the plan, mm\n{:<28} {:>6} "
        "{:>7} {:>18} {:>18} {:>18} {:>18} {:>8}\n",
        name_of(preset), "", "frames", "refused", "it is left out", "another left out", "none left out",
        "of these green", "within");
    for (const auto& [name, of] : kinds) {
        const int posed = of.right + of.wrong + of.none;
        fmt::print("{:<28} {:>6} {:>7} {:>9} {:>8.2f} {:>9} {:>8.2f} {:>9} {:>8.2f} {:>9} {:>8.2f} {:>6.1f} %\n", name,
                   of.frames, of.refused, of.right, of.worst_right_mm, of.wrong, of.worst_wrong_mm, of.none,
                   of.worst_none_mm, of.green, of.worst_green_mm, posed ? 100. * of.within / posed : 0.);
    }
}

/// One frame of the tracker in the simulated room of the example patient.
void measure_rendered(Preset preset, int frames, unsigned seed, const Volume& volume) {
    constexpr int kFramesOfARoom = 25;
    std::map<std::string, Figures> kinds;
    for (int done = 0; done < frames; ++seed) {
        simulation::RoomSettings settings;
        settings.preset = preset;
        settings.seed = seed;
        simulation::SimulatedRig rig(volume, {}, settings);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> share(0, 1);
        const auto grab = [&] { return rig.cameras().grab(rig.clock().now(), std::chrono::seconds(1)); };
        PatientTracker tracker(rig.calibration());
        const StereoFrame first = grab();
        if (tracker.set_reference(first).size() < 4) continue;
        const RigidTransform ct_from_rig = rig.true_rig_from_ct(first.at).inverse();
        // Without the plan's places: 90 mm from the markers' middle to the patient's left, right, head and feet.
        Vector3d middle = Vector3d::Zero();
        for (const auto& m : tracker.markers())
            middle += m.centre_in_patient / static_cast<double>(tracker.markers().size());
        std::vector<Vector3d> places;
        for (const int axis : {0, 2})
            for (const double sign : {-1., 1.})
                places.push_back(middle + 90 * sign * ct_from_rig.linear().row(axis).transpose());
        const double speed = std::array{0., 20., 100.}[seed % 3];
        rig.set_motion({speed, rig.clock().now()});
        for (int i = 0; i < kFramesOfARoom && done < frames; ++i, ++done) {
            if (share(random) < 0.3)
                rig.wait(std::chrono::milliseconds(static_cast<int>(700 * share(random))));  // a jump
            std::vector<int> covered;
            for (int k = 0; k < static_cast<int>(rig.true_markers_in_ct().size()); ++k)
                if (share(random) < 0.2) covered.push_back(k);
            rig.cover_markers(covered);
            StereoFrame frame = grab();
            const bool one = share(random) < 0.25;
            if (one) std::fill(frame.right.pixels.begin(), frame.right.pixels.end(), std::uint8_t{12});
            const TrackedPose pose = tracker.update(frame);
            const int least = std::min(pose.markers_left, pose.markers_right),
                      most = std::max(pose.markers_left, pose.markers_right);
            const std::string kind = fmt::format("{:>3.0f} mm/s, {}", speed,
                                                 !pose.rig_from_patient ? "no pose"
                                                 : least == 0           ? "one camera"
                                                 : most < 5             ? "both, 3 and 4 markers"
                                                                        : "both, 5 markers and more");
            Figures& of = kinds[kind];
            if (!pose.rig_from_patient) {
                of.refuse(pose.reason);
                continue;
            }
            const RigidTransform truth = rig.true_rig_from_ct(frame.at) * ct_from_rig;
            of.add(largest_off(*pose.rig_from_patient, truth, places), pose.predicted_error_mm, pose.bound_95_mm);
        }
    }
    print(fmt::format("{} room, rendered pictures of the example patient", name_of(preset)), kinds);
}

int run(int argc, char** argv) {
    const std::string what = argc > 1 ? argv[1] : "";
    const bool rendered = what == "rendered", slipped = what == "slipped";
    const int at = rendered || slipped ? 2 : 1, frames = argc > at ? std::atoi(argv[at]) : rendered ? 300 : 10000;
    const unsigned seed = argc > at + 1 ? static_cast<unsigned>(std::atoi(argv[at + 1])) : 1;
    if (rendered && !example_patient()) {
        fmt::print("the package invesalius-examples is not installed\n");
        return 1;
    }
    std::optional<Volume> volume;
    if (rendered) volume = read_volume(*example_patient());
    for (const Preset preset : {Preset::paper, Preset::modern}) {
        if (rendered)
            measure_rendered(preset, frames, seed, *volume);
        else if (slipped)
            measure_slips(preset, frames, seed);
        else
            measure_geometry(preset, frames, seed);
    }
    return 0;
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    return planlight::test::run(argc, argv);
}
