#pragma once

#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

#include "registration/simulation/rig_layout.h"
#include "registration/tracking/fit_pose.h"

namespace planlight::test {

/// A marker in the room: its centre and outward normal, mm.
struct DrawnMarker {
    Eigen::Vector3d centre, normal;
};

/// One rig with a calibration as wrong as good ones are, one patient, one reference; frames of it are drawn one by one.
struct DrawnRoom {
    simulation::RigLayout rig;
    RigCalibration calibration;
    std::vector<DrawnMarker> in_room;      ///< those that both cameras saw
    std::vector<PatientMarker> reference;  ///< the same
    double contrast = 100;

    DrawnRoom(simulation::Preset preset, std::mt19937& random);
};

struct DrawnFrame {
    std::vector<Sighting> sightings;
    RigidTransform truth;  ///< rig_from_patient
    std::string kind;      ///< by which cameras, with how many markers, how far from the reference
};

/// A head that has moved, markers covered for one camera or both. `slipped`: a marker that has moved by so much on the
/// skin.
DrawnFrame frame_of(const DrawnRoom& room, std::mt19937& random, int slipped = -1,
                    const Eigen::Vector3d& slip_mm = Eigen::Vector3d::Zero());

/// An item of the plan on the skin, 30 mm wide, in patient.
std::vector<Eigen::Vector3d> plan_of(const DrawnRoom& room, std::mt19937& random);

/// The largest error of a pose over places in patient, mm.
double largest_off(const RigidTransform& found, const RigidTransform& truth,
                   const std::vector<Eigen::Vector3d>& places);

std::string name_of(simulation::Preset preset);

}  // namespace planlight::test
