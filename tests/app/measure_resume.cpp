// Whether a session goes on with a match when it may, and only then: rooms of other seeds, each scanned and matched
// once and the match written and read back; then something happens while no program runs, and a new session is asked to
// go on. For what was gone on with, where light of the plan then truly falls. measure_resume paper|modern FIRST_ROOM
// ROOMS [DRAWS]
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

#include "app/evaluation/distribution.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/app/played_session.h"

namespace {

using namespace planlight;
using Eigen::Vector3d;
using simulation::SimulatedRig;

struct Sums {
    int draws = 0, resumed = 0;
    std::vector<double> light_mm, took_s, pictures_s;
    std::map<std::string, int> refused;
};

Vector3d any_way(std::mt19937& random) {
    std::normal_distribution<double> gauss;
    return Vector3d(gauss(random), gauss(random), gauss(random)).normalized();
}

/// The farthest that light of a point of the plan falls from the true skin nearest to it, mm.
std::vector<double> light_errors_mm(const Session& session, const SimulatedRig& rig, const RigidTransform& rig_from_ct,
                                    const Plan& plan) {
    std::vector<double> errors;
    const Instant now = rig.clock().now();
    for (const Vector3d& planned : points_of(plan)) {
        const Vector3d skin = rig.nearest_true_skin(planned);
        const auto pixel = project(session.rig().projector, rig_from_ct * skin);
        if ((skin - planned).norm() > 3 || !pixel) continue;
        if (const auto lit = rig.true_light(*pixel, now)) errors.push_back((lit->p_in_ct - skin).norm());
    }
    return errors;
}

class Rooms {
public:
    Rooms(const test::ExampleCase& patient, simulation::Preset preset, unsigned seed)
        : case_(patient.prepared), drawing_(case_), random_(seed * 7919) {
        simulation::RoomSettings room;
        room.preset = preset;
        room.seed = seed;
        rig_ = std::make_unique<SimulatedRig>(patient.volume, points_of(case_.plan), room);
        rig_->set_motion({0.0, rig_->clock().now()});
        Session session(case_, drawing_, rig_->calibration(), rig_->projector(), rig_->cameras(), rig_->clock());
        session.scan();
        session.find_patient();
        session.confirm();
        if (const auto match = session.kept_match()) text_ = text_of(*match);
    }
    bool matched() const { return !text_.empty(); }

    /// `cap` moves the markers against the head all together, stiff, before the match is read back.
    void draw(Sums& sums, const std::function<void(SimulatedRig&, double)>& happens,
              const RigidTransform& cap = RigidTransform::Identity()) {
        happens(*rig_, 1);
        Session session(case_, drawing_, rig_->calibration(), rig_->projector(), rig_->cameras(), rig_->clock());
        ++sums.draws;
        const auto began = std::chrono::steady_clock::now();
        const Instant room_began = rig_->clock().now();
        try {
            KeptMatch match = kept_match_of(text_, {});
            for (PatientMarker& marker : match.markers) marker.centre_in_patient = cap * marker.centre_in_patient;
            session.resume(match);
            sums.took_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
            sums.pictures_s.push_back(seconds(rig_->clock().now() - room_began));
            const Session::Update update = session.update();
            if (!update.pose.rig_from_patient) throw CheckFailedError("no pose", "");
            ++sums.resumed;
            const auto errors = light_errors_mm(
                session, *rig_, *update.pose.rig_from_patient * session.registration()->patient_from_ct, case_.plan);
            if (!errors.empty()) sums.light_mm.push_back(distribution_of(errors).worst);
        } catch (const Error& refusal) {
            std::string why = refusal.what();
            why.erase(std::remove_if(why.begin(), why.end(), [](char c) { return std::isdigit(c) || c == '.'; }),
                      why.end());
            ++sums.refused[why.substr(0, 90)];
        }
        session.go_dark();
        happens(*rig_, -1);
    }
    std::mt19937& random() { return random_; }
    const std::vector<Vector3d>& markers() const { return rig_->true_markers_in_ct(); }

private:
    const Case& case_;
    CaseDrawing drawing_;
    std::mt19937 random_;
    std::unique_ptr<SimulatedRig> rig_;
    std::string text_;
};

}  // namespace

int main(int argc, char** argv) {
    const std::string preset = argc > 1 ? argv[1] : "paper";
    const int first = argc > 2 ? std::stoi(argv[2]) : 1, rooms = argc > 3 ? std::stoi(argv[3]) : 1,
              draws = argc > 4 ? std::stoi(argv[4]) : 1;
    const test::ExampleCase& patient = test::example_case();
    if (!patient.there) return 77;
    std::map<std::string, Sums> sums;
    for (int k = 0; k < rooms; ++k) {
        Rooms room(patient, preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern,
                   static_cast<unsigned>(first + k));
        if (!room.matched()) continue;
        for (int i = 0; i < draws; ++i) {
            room.draw(sums["a nothing"], [](SimulatedRig&, double) {});
            room.draw(sums["b the head with its markers"], [](SimulatedRig& rig, double way) {
                if (way < 0) return;
                rig.set_motion({20, rig.clock().now()});
                rig.wait(std::chrono::seconds(2));
                rig.set_motion({0, rig.clock().now()});
            });
            for (const double mm : {0.5, 1.0, 1.5, 2.0, 4.0, 15.0, 40.0}) {
                RigidTransform cap = RigidTransform::Identity();
                cap.translation() = mm * any_way(room.random());
                room.draw(
                    sums[fmt::format("c the head under its stiff cap, {:4.1f} mm", mm)], [](SimulatedRig&, double) {},
                    cap);
            }
            for (const double degrees : {0.02, 0.05, 0.1, 0.3, 1.0})
                for (const auto device : {SimulatedRig::Device::left_camera, SimulatedRig::Device::right_camera,
                                          SimulatedRig::Device::projector}) {
                    const Vector3d turn = degrees * std::numbers::pi / 180 * any_way(room.random());
                    room.draw(sums[fmt::format("{} turned {:.2f} degrees",
                                               device == SimulatedRig::Device::projector     ? "g projector"
                                               : device == SimulatedRig::Device::left_camera ? "e left camera"
                                                                                             : "f right camera",
                                               degrees)],
                              [&](SimulatedRig& rig, double way) { rig.bump(device, way * turn); });
                }
        }
        // A sticker does not slip back to its place: a room of its own for each.
        for (const int marker : {-1, 0})
            for (const double mm : {0.5, 1.0, 2.0, 4.0, 12.0}) {
                Rooms own(patient, preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern,
                          static_cast<unsigned>(first + k));
                if (!own.matched()) continue;
                const Vector3d slide = mm * any_way(room.random());
                own.draw(sums[fmt::format("d {} {:4.1f} mm",
                                          marker < 0 ? "all stickers along the skin," : "one sticker,", mm)],
                         [&](SimulatedRig& rig, double way) {
                             if (way > 0) rig.slip_marker(marker, slide);
                         });
            }
        fmt::print(stderr, "room {} of {}\n", k + 1, rooms);
    }
    fmt::print(
        "{} rooms, seeds {} to {}\nwhat happened | draws | gone on | its light off, worst of the plan, mm (median / "
        "95 % / worst) | s, wall / in the room\n",
        preset, first, first + rooms - 1);
    for (const auto& [what, s] : sums) {
        const Distribution light = distribution_of(s.light_mm);
        fmt::print("{} | {} | {} | {:.2f} / {:.2f} / {:.2f} | {:.1f} / {:.1f}\n", what.substr(2), s.draws, s.resumed,
                   light.median, light.p95, light.worst, distribution_of(s.took_s).worst,
                   distribution_of(s.pictures_s).worst);
        for (const auto& [why, count] : s.refused) fmt::print("    {} x {}\n", count, why);
    }
    return 0;
}
