// Where does the light fall, by how steeply it meets the skin? Plans all over the head, scanned in simulated rooms
// whose skin is not the CT's (another threshold, waves, a swelling), drawn on the CT's skin ("before") and on the skin
// as the scan found it ("after"), followed to the true skin by the simulator's optics. measure_light [ROOMS [FIRST_SEED
// [paper|modern]]]   (default 16 rooms, seed 1, both); 10 to 30 s a room.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "app/evaluation/distribution.h"
#include "app/evaluation/measure_overlay.h"
#include "app/prepare_case.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/pose_covariance.h"
#include "planning_io/volume/read_volume.h"
#include "projection/skin_now.h"
#include "registration/matching/register_patient.h"
#include "registration/scan/scan_surface.h"
#include "tests/app/moved_volume.h"
#include "tests/app/plan_all_over.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;
using simulation::Preset;

std::string name_of(Preset preset) {
    return preset == Preset::paper ? "paper" : "modern";
}

struct Room {
    Preset preset;
    unsigned seed;
    std::string side;
    Vector3d towards;
    double threshold_hu;
    std::string moved;
    double moved_mm;
};

/// Every side of the head in turn. Skin that is still since the CT has the room's own threshold every second time, else
/// one farther from the CT's; skin that moved any of these.
Room room_of(Preset preset, unsigned seed, bool still) {
    static const std::array<std::pair<const char*, Vector3d>, 8> kSides{{{"face", {0, -1, 0}},
                                                                         {"left temple", {1, -0.6, 0.2}},
                                                                         {"brow", {0, -1, 0.8}},
                                                                         {"right temple", {-1, -0.6, 0.2}},
                                                                         {"left side", {1, 0.1, 0.1}},
                                                                         {"vertex", {0, -0.3, 1}},
                                                                         {"right side", {-1, 0.1, 0.1}},
                                                                         {"half left", {1, -1, 0}}}};
    static const std::array<double, 4> kThresholds{-300, -700, -300, -150};
    static const std::array<std::pair<const char*, double>, 3> kMoved{
        {{"waves", 0.6}, {"swelling", 2}, {"thinner", 0.5}}};
    const auto& [side, towards] = kSides[seed % kSides.size()];
    const double threshold_hu = kThresholds[(seed + seed / 4) % kThresholds.size()];
    if (still) return {preset, seed, side, towards, threshold_hu, "still", 0};
    const auto& [moved, mm] = kMoved[seed % kMoved.size()];
    return {preset, seed, side, towards, threshold_hu, moved, mm};
}

struct Measured {
    std::string verdict;
    SkinDisplacement skin;
    std::vector<OverlayErrors::Place> before, after, known;
    std::vector<double> target_mm, bound_mm;  ///< of the registration at the points of the plan, and as it was stated
    int unscanned = 0;
    std::vector<double> tick_mm, right_angle_deg, known_tick_mm, known_right_angle_deg;  ///< after, and known
    std::vector<double> promised_tick_mm, promised_angle_deg, known_promised_tick_mm, known_promised_angle_deg;
};

/// The mesh of the CT's skin with every vertex on the true skin, on the side that is looked at.
SkinSurface true_skin_of(const simulation::SimulatedRig& rig, TriangleMesh mesh, const Vector3d& towards) {
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& v : mesh.vertices_in_ct) middle += v / static_cast<double>(mesh.vertices_in_ct.size());
    for (Vector3d& v : mesh.vertices_in_ct)
        if ((v - middle).dot(towards.normalized()) > -25) v = rig.nearest_true_skin(v);
    mesh.normals_in_ct.clear();
    return SkinSurface(std::move(mesh));
}

Measured measure(const Room& of, const Volume& volume, const Case& the_case, const SkinSurface& skin) {
    Measured measured;
    const Plan plan = plan_all_over(skin, of.towards);
    const Volume now = with_moved_skin(volume, of.moved, of.moved_mm, plan.cut_planes.front().origin_in_ct, of.seed);
    simulation::RoomSettings settings;
    settings.preset = of.preset;
    settings.seed = of.seed;
    settings.skin_threshold_hu = of.threshold_hu;
    simulation::SimulatedRig rig(now, points_of(plan), settings);
    StripeSettings stripes;
    stripes.width = rig.projector().width();
    stripes.height = rig.projector().height();
    const ScanCapture capture = capture_scan(rig.projector(), rig.cameras(), rig.clock(), stripes);
    const ScanResult scan = scan_from_capture(capture, rig.calibration());
    RegistrationSettings matching;
    matching.viewpoint_in_rig = rig.calibration().projector.centre_in_rig();
    const RegistrationResult found = register_patient(scan.clean.kept, the_case.lut, matching);
    measured.verdict = found.verdict == Verdict::yes ? "yes" : found.verdict == Verdict::ask ? "ask" : "no";
    if (found.verdict == Verdict::no) return measured;
    measured.skin = found.skin;
    const RigidTransform truth = rig.true_rig_from_ct(capture.began);
    for (const Vector3d& p : points_of(plan)) {
        measured.target_mm.push_back((found.patient_from_ct * p - truth * p).norm());
        measured.bound_mm.push_back(predicted_error(found.covariance, p).bound_95_mm);
    }

    DrawingSettings drawing;
    drawing.labels = false;
    const DrawnPicture picture{found.patient_from_ct, RigidTransform::Identity(), capture.began};
    const auto light_on = [&](const SkinSurface& drawn_on, const PlanDrawing& drawn, const CameraModel& projector,
                              const DrawnPicture& at, bool shapes) {
        const DrawingRenderer renderer(drawn_on, projector);
        return measure_overlay(rig, plan, drawn, renderer, {}, at, shapes);
    };
    const CameraModel& projector = rig.calibration().projector;
    const PlanDrawing planned = draw_plan(plan, skin, drawing);
    measured.before = light_on(skin, planned, projector, picture, false).places;
    const SkinDisplacementField field(found.skin);
    const SkinSurface skin_now = skin_as_scanned(skin.mesh(), field);
    PlanDrawing drawn = draw_plan(plan, skin, skin_now, drawing);
    warn_of_unscanned(field, planned, drawn);
    for (const auto& item : drawn.items)
        for (const auto& warning : item.warnings) measured.unscanned += warning.find("no skin") != std::string::npos;
    const OverlayErrors after = light_on(skin_now, drawn, projector, picture, true);
    measured.after = after.places, measured.tick_mm = after.tick_mm, measured.right_angle_deg = after.long_angle_deg;
    measured.promised_tick_mm = after.promised_tick_mm, measured.promised_angle_deg = after.promised_angle_deg;
    const SkinSurface true_skin = true_skin_of(rig, skin.mesh(), of.towards);
    const OverlayErrors known = light_on(true_skin, draw_plan(plan, skin, true_skin, drawing), rig.true_rig().projector,
                                         {truth, RigidTransform::Identity(), capture.began}, true);
    measured.known = known.places, measured.known_tick_mm = known.tick_mm;
    measured.known_right_angle_deg = known.long_angle_deg;
    measured.known_promised_tick_mm = known.promised_tick_mm;
    measured.known_promised_angle_deg = known.promised_angle_deg;
    return measured;
}

struct Figures {
    /// `against_known_percent`: of the diameter, to the same circle with skin, pose and rig known.
    std::array<std::vector<double>, 5> line_mm, hole_mm, diameter_percent, against_known_percent;
    std::array<int, 5> partly_lit{};
};
constexpr std::array kBins_deg{0., 30., 45., 60., 70., 91.};

using Places = std::vector<OverlayErrors::Place>;

std::size_t bin_of(const OverlayErrors::Place& place) {
    std::size_t bin = 0;
    while (bin + 1 < 5 && place.incidence_deg >= kBins_deg[bin + 1]) ++bin;
    return bin;
}

void add_diameters_against(const Places& known, const Places& places, Figures& figures) {
    for (const auto& place : places)
        for (const auto& other : known)
            if (!place.item.empty() && place.item == other.item && place.kind == other.kind && place.whole &&
                other.whole && place.diameter_percent != 0 && other.diameter_percent != 0)
                figures.against_known_percent[bin_of(place)].push_back(
                    std::abs(place.diameter_percent - other.diameter_percent));
}

void add(const Places& places, Figures& figures) {
    for (const auto& place : places) {
        const std::size_t bin = bin_of(place);
        const bool ring = place.kind == StrokeKind::borehole || place.kind == StrokeKind::trajectory;
        if (!place.whole) {
            ++figures.partly_lit[bin];
            continue;
        }
        (ring ? figures.hole_mm : figures.line_mm)[bin].push_back(place.position_mm);
        if (ring && place.diameter_percent != 0)
            figures.diameter_percent[bin].push_back(std::abs(place.diameter_percent));
    }
}

double lines_to_60_deg(const std::vector<OverlayErrors::Place>& places) {
    std::vector<double> errors;
    for (const auto& place : places)
        if (place.incidence_deg < 60 &&
            (place.kind == StrokeKind::osteotomy_line || place.kind == StrokeKind::cut_plane))
            errors.push_back(place.position_mm);
    return distribution_of(errors).p95;
}

using Bins = std::array<std::vector<double>, 5>;

void print(const char* what, const std::array<const Bins*, 3>& ways) {
    for (std::size_t bin = 0; bin < 5; ++bin) {
        fmt::print("  {:<22} {:>2.0f} to {:>2.0f} deg", what, kBins_deg[bin], std::min(90., kBins_deg[bin + 1]));
        for (const Bins* way : ways) {
            const Distribution d = distribution_of((*way)[bin]);
            fmt::print(" |{:>5} {:>5.2f} {:>5.2f} {:>5.2f}", d.count, d.median, d.p95, d.worst);
        }
        fmt::print("\n");
    }
}

void print(const std::string& name, const Figures& before, const Figures& after, const Figures& known) {
    constexpr const char* kOf = "places, median, 95 %, worst";
    fmt::print("\n{}\n  {:<36} |{:^24}|{:^24}|{:^24}\n  {:<36} |{:^74}\n", name, "light meets the skin at", "before",
               "after", "known", "", kOf);
    print("line, beside it, mm", {&before.line_mm, &after.line_mm, &known.line_mm});
    print("circle, centre, mm", {&before.hole_mm, &after.hole_mm, &known.hole_mm});
    print("circle, diameter, %", {&before.diameter_percent, &after.diameter_percent, &known.diameter_percent});
    print("the same, to the known",
          {&before.against_known_percent, &after.against_known_percent, &known.against_known_percent});
    const auto& broken = after.partly_lit;
    fmt::print("  drawn broken (less than 85 % of the rim can be lit), after: {} below 60 deg, {} to 70, {} beyond\n",
               broken[0] + broken[1] + broken[2], broken[3], broken[4]);
    std::fflush(stdout);
}

/// One preset, skin still or moved: a line a room, then the table.
void measure_rooms(Preset preset, bool still, int rooms, unsigned first_seed, const Volume& volume,
                   const Case& the_case, const SkinSurface& skin) {
    Figures before, after, known;
    std::map<std::string, int> verdicts;
    std::vector<double> target_mm, bound_mm, tick_mm, angle_deg, known_tick_mm, known_angle_deg;
    std::vector<double> promised_tick_mm, promised_angle_deg, known_promised_tick_mm, known_promised_angle_deg;
    const auto append = [](std::vector<double>& to, const std::vector<double>& more) {
        to.insert(to.end(), more.begin(), more.end());
    };
    std::size_t within = 0;
    for (int i = 0; i < rooms; ++i) {
        const Room room = room_of(preset, first_seed + static_cast<unsigned>(i), still);
        const Measured m = measure(room, volume, the_case, skin);
        ++verdicts[m.verdict];
        add(m.before, before), add(m.after, after), add(m.known, known);
        add_diameters_against(m.known, m.before, before), add_diameters_against(m.known, m.after, after);
        append(tick_mm, m.tick_mm), append(angle_deg, m.right_angle_deg);
        append(known_tick_mm, m.known_tick_mm), append(known_angle_deg, m.known_right_angle_deg);
        append(promised_tick_mm, m.promised_tick_mm), append(promised_angle_deg, m.promised_angle_deg);
        append(known_promised_tick_mm, m.known_promised_tick_mm);
        append(known_promised_angle_deg, m.known_promised_angle_deg);
        for (std::size_t k = 0; k < m.target_mm.size(); ++k) {
            target_mm.push_back(m.target_mm[k]), bound_mm.push_back(m.bound_mm[k]);
            within += m.target_mm[k] <= m.bound_mm[k];
        }
        fmt::print(
            "{} {:>3} {:<12} {:>5.0f} HU {:<8} {}: offset {:+.2f}, spread {:.2f} mm, {} places, {} items not all "
            "scanned; plan points {:.2f} mm off; lines to 60 deg, 95 %: {:.2f}, {:.2f}, known {:.2f} mm\n",
            name_of(preset), room.seed, room.side, room.threshold_hu, room.moved, m.verdict, m.skin.offset_mm,
            m.skin.spread_mm, m.skin.places.size(), m.unscanned, distribution_of(m.target_mm).median,
            lines_to_60_deg(m.before), lines_to_60_deg(m.after), lines_to_60_deg(m.known));
        std::fflush(stdout);
    }
    print(fmt::format("{} room, skin {}, {} rooms: {} yes, {} ask, {} refused", name_of(preset),
                      still ? "still since the CT" : "moved since the CT", rooms, verdicts["yes"], verdicts["ask"],
                      verdicts["no"]),
          before, after, known);
    const auto said = [](const std::vector<double>& values) {
        const Distribution d = distribution_of(values);
        return fmt::format("{:.2f} / {:.2f} / {:.2f} ({})", d.median, d.p95, d.worst, d.count);
    };
    fmt::print(
        "  median / 95 % / worst (how many): 10 mm between ticks, after {}, known {} mm; right angles of crosses of 8 "
        "mm "
        "and more, after {}, known {} degrees\n",
        said(tick_mm), said(known_tick_mm), said(angle_deg), said(known_angle_deg));
    fmt::print(
        "  of these lit whole and at 65 degrees or less: between ticks, after {}, known {} mm; right angles, after {}, "
        "known {} degrees\n",
        said(promised_tick_mm), said(known_promised_tick_mm), said(promised_angle_deg), said(known_promised_angle_deg));
    const Distribution off = distribution_of(target_mm), stated = distribution_of(bound_mm);
    fmt::print(
        "  registration at the plan's points: median {:.2f}, 95 % {:.2f}, worst {:.2f} mm; stated bound: median "
        "{:.2f}, "
        "95 % {:.2f} mm, covers {} of {}\n",
        off.median, off.p95, off.worst, stated.median, stated.p95, within, target_mm.size());
    std::fflush(stdout);
}

int run(int rooms, unsigned first_seed, const std::string& preset, const std::string& skin_is) {
    if (!example_patient()) {
        fmt::print("the package invesalius-examples is not installed\n");
        return 1;
    }
    const Volume volume = read_volume(*example_patient());
    const Case the_case = prepare_case(volume, {}, {}, {}, "2001-10-14").prepared;
    const SkinSurface skin(the_case.skin);
    for (const bool still : {true, false})
        for (const Preset each : {Preset::paper, Preset::modern})
            if ((preset.empty() || preset == "both" || preset == name_of(each)) &&
                (skin_is.empty() || (skin_is == "still") == still))
                measure_rooms(each, still, rooms, first_seed, volume, the_case, skin);
    return 0;
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    const int rooms = argc > 1 ? std::atoi(argv[1]) : 16;
    const unsigned seed = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
    return planlight::test::run(rooms, seed, argc > 3 ? argv[3] : "", argc > 4 ? argv[4] : "");
}
