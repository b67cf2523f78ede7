#pragma once

#include <memory>
#include <vector>

#include "app/session.h"
#include "app/windows/operator_model.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight {

/// The parts of the 3-D view that a session gives; all in ct.
/// The markers where the scan found them, lying on the skin as it is there and high enough that none of it sticks
/// through their stickers.
std::shared_ptr<const std::vector<SceneMarker>> markers_in_ct(const PatientTracker& tracker,
                                                              const RigidTransform& ct_from_patient,
                                                              const SkinSurface& skin);
SceneMarker marker_on_skin(const Eigen::Vector3d& p_in_ct, const SkinSurface& skin);

/// The light of a simulated room as it truly falls, without labels (the plan has them, and twice on one another nobody
/// reads them): every stroke through the product's projector model to its pixel,
/// and from there by the room's own optics to the true skin.
std::shared_ptr<const std::vector<LightLine>> true_light_lines(const PlanDrawing& drawing,
                                                               const RigCalibration& calibration,
                                                               const OverlayStep& overlay,
                                                               const simulation::SimulatedRig& rig);

/// The head as the light of this rig falls on it.
SceneView projector_view(const RigCalibration& rig, const RigidTransform& ct_from_rig);

/// The discs that the tracker found, for the camera pictures; `all`: also those that are none of the patient's markers.
std::vector<FoundMarker> found_markers(const std::vector<PatientTracker::Seen>& seen, bool all = false);

/// The last scan's even pictures with what was found in them, into the model: those of a refusal. Nothing without one.
void show_refused_scan(const Session& session, OperatorModel& model);

}  // namespace planlight
