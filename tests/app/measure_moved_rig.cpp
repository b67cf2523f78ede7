// Rigs that moved between calibration and scan: measure_moved_rig [paper|modern] [FIRST SEED] [ROOMS] [DRAWS A ROOM]
// [--before] [--set full|fast] [--only WORDS] [--list].
//
// Every room is rendered and scanned once. Then rig.json is changed as if one device had been bumped since (which is
// the same as the device bumped and the file kept): turned by 0.01 to 1 degree, shifted by 0.1 to 5 mm in any direction
// or along one of its own axes, its focus by 0.02 to 1 %, its zoom by 0.2 to 5 %; sizes log-uniform. With each the
// capture goes through scan, match and light as the commands do it. The light at every point of the plan on the skin
// that the projector lights is followed by the simulator's optics to the true skin, at the scan and after the head
// moved. Draw 0 of a room is the good rig. --before: as it was before the scan found the whole rig: only the projector
// is placed anew, for the cloud alone, and light is drawn with rig.json.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "app/belonging.h"
#include "app/prepare_case.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "registration/matching/register_patient.h"
#include "registration/simulation/simulated_rig.h"
#include "registration/tracking/track_patient.h"

using namespace planlight;
using Eigen::Vector3d;
using simulation::Preset;
using simulation::SimulatedRig;

namespace {

struct Options {
    Preset preset = Preset::paper;
    unsigned seed = 1, rooms = 2, draws = 10;
    bool before = false, list = false, fast = false;
    std::string only;
};

Options parse(int argc, char** argv) {
    Options o;
    int place = 0;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--before")
            o.before = true;
        else if (word == "--list")
            o.list = true;
        else if (word == "--set")
            o.fast = i + 1 < argc && argv[++i] == std::string("fast");
        else if (word == "--only")
            o.only = i + 1 < argc ? argv[++i] : "";
        else if (word == "paper" || word == "modern")
            o.preset = word == "paper" ? Preset::paper : Preset::modern;
        else {
            unsigned& number = place == 0 ? o.seed : place == 1 ? o.rooms : o.draws;
            number = static_cast<unsigned>(std::stoul(word));
            ++place;
        }
    }
    return o;
}

/// What was done to a rig.
struct Bump {
    std::string what = "nothing";
    double size = 0;
};

Bump bump(RigCalibration& rig, std::mt19937& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    const auto device = static_cast<RigDevice>(std::min(2, static_cast<int>(3 * uniform(random))));
    const int kind = static_cast<int>(10 * uniform(random));
    const Vector3d way = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const double share = uniform(random), sign = uniform(random) < 0.5 ? -1 : 1;
    const double degrees = 0.01 * std::pow(100, share), mm = 0.1 * std::pow(50, share);
    DeviceChange change = DeviceChange::Zero();
    Bump done;
    const auto set = [&](const char* what, double size) { done = {fmt::format("{} {}", text_of(device), what), size}; };
    if (kind < 3) {
        set("turned any way (deg)", degrees);
        change.head<3>() = way * degrees * std::numbers::pi / 180;
    } else if (kind < 5) {
        set(kind == 3 ? "turned sideways (deg)" : "turned up or down (deg)", sign * degrees);
        change[kind == 3 ? 1 : 0] = sign * degrees * std::numbers::pi / 180;
    } else if (kind < 7) {
        set("shifted any way (mm)", mm);
        change.segment<3>(3) = way * mm;
    } else if (kind == 7) {
        set("shifted sideways (mm)", sign * mm);
        change[3] = sign * mm;
    } else {
        const double percent = kind == 8 ? 0.02 * std::pow(50, share) : 0.2 * std::pow(25, share);
        set(kind == 8 ? "focus (%)" : "zoom (%)", sign * percent);
        change[6] = std::log(1 + sign * percent / 100);
    }
    CameraModel& model = device_of(rig, device);
    model = changed(model, change);
    return done;
}

struct Outcome {
    Bump bump;
    std::string refused;  ///< why no light; empty: there is
    RigState state;
    Verdict verdict = Verdict::no;
    std::vector<double> at_scan_mm, moved_mm;  ///< of the light, at the points of the plan
    double bound_mm = 0;                       ///< the greatest predicted
};

class Room {
public:
    Room(const Volume& volume, const Case& the_case, const Options& options, unsigned seed)
        : case_(the_case), options_(options), room_(volume, points_of(the_case.plan), settings(options, seed)) {
        StripeSettings stripes;
        stripes.width = room_.projector().width();
        stripes.height = room_.projector().height();
        if (options.fast) stripes = fast_stripes(stripes.width, stripes.height);
        capture_ = capture_scan(room_.projector(), room_.cameras(), room_.clock(), stripes);
        find_plan_points();
        RgbImage white(stripes.width, stripes.height, {255, 255, 255});
        room_.set_motion({20, room_.clock().now()});
        room_.wait(std::chrono::seconds(2));
        frame_ = room_.cameras().grab(room_.projector().show(white, room_.clock().now() + std::chrono::seconds(1)),
                                      std::chrono::seconds(1));
    }

    Outcome run(unsigned draw, std::mt19937& random) {
        Outcome out;
        RigCalibration rig = room_.calibration();
        if (draw > 0) out.bump = bump(rig, random);
        if (out.bump.what.find(options_.only) == std::string::npos) {
            out.refused = "left out";
            return out;
        }
        try {
            light(rig, out);
        } catch (const Error& error) {
            out.refused = error.what();
        }
        return out;
    }

private:
    static simulation::RoomSettings settings(const Options& options, unsigned seed) {
        simulation::RoomSettings room;
        room.preset = options.preset;
        room.seed = seed;
        return room;
    }

    void find_plan_points() {
        constexpr double kOnSkin_mm = 3, kLit_mm = 0.5;
        const RigidTransform rig_from_ct = room_.true_rig_from_ct(capture_.began);
        const CameraModel projector = room_.true_rig().projector;
        for (const Vector3d& planned : points_of(case_.plan)) {
            const Vector3d skin = room_.nearest_true_skin(planned);
            const auto pixel = project(projector, rig_from_ct * skin);
            if ((skin - planned).norm() > kOnSkin_mm || !pixel) continue;
            const auto lit = room_.true_light(*pixel, capture_.began);
            if (lit && (lit->p_in_ct - skin).norm() < kLit_mm) points_in_ct_.push_back(skin);
        }
    }

    /// Along the skin: from the point to where its light falls.
    std::vector<double> errors(const CameraModel& projector, const RigidTransform& rig_from_ct, Instant at) const {
        std::vector<double> errors_mm;
        for (const Vector3d& p_in_ct : points_in_ct_) {
            const auto pixel = project(projector, rig_from_ct * p_in_ct);
            const auto lit = pixel ? room_.true_light(*pixel, at) : std::nullopt;
            if (!lit) continue;
            const Vector3d off = lit->p_in_ct - p_in_ct;
            errors_mm.push_back((off - off.dot(lit->normal_in_ct) * lit->normal_in_ct).norm());
        }
        std::sort(errors_mm.begin(), errors_mm.end());
        return errors_mm;
    }

    void light(const RigCalibration& rig, Outcome& out) {
        ScanSettings settings;
        if (options_.before)
            settings.rig.moved_chi_square = settings.rig.max_unadjusted = std::numeric_limits<double>::infinity();
        const ScanResult scan = scan_from_capture(capture_, rig, settings);
        if (scan.clean.kept.empty()) throw CheckFailedError("no skin was found", "-");
        out.state = named_rig_state(scan, rig, capture_);
        RegistrationSettings matching;
        matching.viewpoint_in_rig = out.state.rig.projector.centre_in_rig();
        RegistrationResult match = register_patient(scan.clean.kept, case_.lut, matching);
        if (!options_.before) take_case_and_rig(case_, out.state, match);
        out.verdict = match.verdict;
        if (match.verdict == Verdict::no)
            throw CheckFailedError(match.reasons.empty() ? "" : match.reasons.front(), "-");
        if (match.verdict == Verdict::ask) out.refused = "ask: " + match.reasons.front();
        const RigCalibration used = options_.before ? rig : rig_of_light(match, rig, true);
        out.at_scan_mm = errors(used.projector, match.patient_from_ct, capture_.began);
        if (!options_.before)
            for (const Vector3d& p_in_ct : points_in_ct_)
                out.bound_mm = std::max(out.bound_mm, predicted_light_mm(match, p_in_ct));
        PatientTracker tracker(used);
        tracker.set_reference(StereoFrame{capture_.left.front(), capture_.right.front(), capture_.began, Instant{}, 0});
        const TrackedPose pose = tracker.update(frame_);
        if (pose.rig_from_patient)
            out.moved_mm = errors(used.projector, *pose.rig_from_patient * match.patient_from_ct, frame_.at);
    }

    const Case& case_;
    const Options& options_;
    SimulatedRig room_;
    ScanCapture capture_;
    StereoFrame frame_;
    std::vector<Vector3d> points_in_ct_;
};

double worst(const std::vector<double>& sorted) {
    return sorted.empty() ? 0 : sorted.back();
}

void print(unsigned seed, const Outcome& o) {
    fmt::print(
        "{:4} {:34}{:9.3f}  {:13} hidden {:.2f}  {:4} light {:.2f} / {:.2f}, moved {:.2f} / {:.2f}, bound {:.2f}  {}  "
        "{}\n",
        seed, o.bump.what, o.bump.size, text_of(o.state.verdict), o.state.hidden_light_mm,
        o.verdict == Verdict::yes   ? "yes"
        : o.verdict == Verdict::ask ? "ask"
                                    : "no",
        o.at_scan_mm.empty() ? 0 : o.at_scan_mm[o.at_scan_mm.size() / 2], worst(o.at_scan_mm),
        o.moved_mm.empty() ? 0 : o.moved_mm[o.moved_mm.size() / 2], worst(o.moved_mm), o.bound_mm, o.state.sentence,
        o.refused.empty() ? "" : "REFUSED: " + o.refused);
}

struct Sums {
    unsigned draws = 0, lit = 0, over_half = 0, over_one = 0, moved_over_half = 0, moved_over_one = 0, moved = 0;
    unsigned as_calibrated = 0, corrected = 0, not_trusted = 0, asked = 0, beyond_bound = 0, named = 0, misnamed = 0;
    double worst_mm = 0, worst_moved_mm = 0;
    std::vector<double> all_mm;

    void add(const Outcome& o) {
        ++draws;
        as_calibrated += o.state.verdict == RigState::Verdict::as_calibrated;
        corrected += o.state.verdict == RigState::Verdict::corrected;
        not_trusted += o.state.verdict == RigState::Verdict::not_trusted;
        asked += o.verdict == Verdict::ask;
        if (o.state.moved()) {
            const bool right = o.bump.size != 0 &&
                               std::any_of(o.state.devices.begin(), o.state.devices.end(), [&](const DeviceFinding& f) {
                                   const auto device = static_cast<RigDevice>(&f - o.state.devices.data());
                                   return (f.moved || f.maybe) && o.bump.what.starts_with(text_of(device));
                               });
            ++(right ? named : misnamed);
        }
        if (!o.refused.empty()) return;
        ++lit;
        const double at_scan = worst(o.at_scan_mm), later = worst(o.moved_mm);
        over_half += at_scan > 0.5;
        over_one += at_scan > 1;
        worst_mm = std::max(worst_mm, at_scan);
        all_mm.insert(all_mm.end(), o.at_scan_mm.begin(), o.at_scan_mm.end());
        beyond_bound += o.bound_mm > 0 && at_scan > o.bound_mm;
        if (o.moved_mm.empty()) return;
        ++moved;
        moved_over_half += later > 0.5;
        moved_over_one += later > 1;
        worst_moved_mm = std::max(worst_moved_mm, later);
    }
};

void print(const char* what, Sums s) {
    std::sort(s.all_mm.begin(), s.all_mm.end());
    const auto at = [&](double share) {
        return s.all_mm.empty() ? 0
                                : s.all_mm[static_cast<std::size_t>(share * static_cast<double>(s.all_mm.size() - 1))];
    };
    fmt::print("{}: {} draws; lit with `yes` {} (as calibrated {}, corrected {}; not trusted {}, ask {})\n", what,
               s.draws, s.lit, s.as_calibrated, s.corrected, s.not_trusted, s.asked);
    fmt::print(
        "  light at the scan: median {:.2f}, 95 % {:.2f}, worst {:.2f} mm; a point over 0.5 mm in {}, over 1 mm in {}; "
        "beyond "
        "the bound in {}\n",
        at(0.5), at(0.95), s.worst_mm, s.over_half, s.over_one, s.beyond_bound);
    fmt::print("  after the head moved ({} with a pose): worst {:.2f} mm; over 0.5 mm in {}, over 1 mm in {}\n",
               s.moved, s.worst_moved_mm, s.moved_over_half, s.moved_over_one);
    fmt::print("  said to have moved: the right device among those named in {}, not in {}\n", s.named, s.misnamed);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Options options = parse(argc, argv);
        const Volume volume = read_volume("/usr/share/doc/invesalius-examples/examples/Cranium.inv3");
        const Preparation prepared =
            prepare_case(volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {},
                         "2026-01-01");
        Sums good, bumped;
        for (unsigned k = 0; k < options.rooms; ++k) {
            Room room(volume, prepared.prepared, options, options.seed + k);
            std::mt19937 random((options.seed + k) * 977 + 5);
            for (unsigned draw = 0; draw <= options.draws; ++draw) {
                const Outcome outcome = room.run(draw, random);
                if (outcome.refused == "left out") continue;
                (draw == 0 ? good : bumped).add(outcome);
                if (options.list || !outcome.refused.empty() || worst(outcome.at_scan_mm) > 0.5)
                    print(options.seed + k, outcome);
            }
            fmt::print(stderr, "\r{} of {} rooms ", k + 1, options.rooms);
        }
        fmt::print(stderr, "\n");
        print("good rigs", good);
        print("one device bumped", bumped);
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "measure_moved_rig: {}\n", error.what());
        return 2;
    }
}
