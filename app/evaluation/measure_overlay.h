#pragma once

#include <string>
#include <vector>

#include "planning_io/types/plan.h"
#include "projection/render_drawing.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight {

/// Where the light of one picture truly fell, against where the plan wants it. One entry a measured place; signs
/// dropped.
struct OverlayErrors {
    std::vector<double> position_mm;  ///< lines: sideways, per 2 mm of line; circles: of the centre, along the skin
    std::vector<double> diameter_percent;  ///< of borehole circles
    std::vector<double> tick_mm;           ///< of the 10 mm between neighbouring ticks, along the line
    std::vector<double> angle_deg;         ///< of the right angle of the crosses of holes and ways in
    std::vector<double> long_angle_deg;    ///< of those crosses that are 8 mm and more: long enough to be measured
    /// Of those: between ticks, and of crosses, that are lit whole and by light that meets the skin at 65 degrees or
    /// less.
    std::vector<double> promised_tick_mm, promised_angle_deg;
    /// The same by place, for whoever sorts them by how steeply the light falls.
    struct Place {
        StrokeKind kind = StrokeKind::osteotomy_line;
        double incidence_deg = 0;  ///< between the true skin's normal and the way back to the projector
        double position_mm = 0;
        double diameter_percent = 0;  ///< signed; 0 of lines, and of circles whose diameter is not planned
        /// False: a circle that the product itself draws as one lit in part, or of whose light more than a tenth falls
        /// on hair, cloth or nothing.
        bool whole = true;
        std::string item;  ///< of the plan
    };
    std::vector<Place> places;
    std::size_t unseen_strokes = 0;  ///< strokes of which no light fell on the patient (hidden, too steep)

    void append(const OverlayErrors& more);
};

/// A picture as it was drawn, and when it was light.
struct DrawnPicture {
    RigidTransform rig_from_ct = RigidTransform::Identity();       ///< T_global as the product believed it
    RigidTransform rig_from_patient = RigidTransform::Identity();  ///< T_cur as the product believed it
    Instant lit_at{};                                              ///< the moment at which the error is taken
};

/// Measures with the simulator's optics and the true skin alone: every stroke of the drawing is rendered by itself, and
/// the light of each of its pixels is followed to the true skin of the true head. Nothing of the product's geometry is
/// used on the way back. `shapes` also measures diameters, ticks and angles.
OverlayErrors measure_overlay(const simulation::SimulatedRig& rig, const Plan& plan, const PlanDrawing& drawing,
                              const DrawingRenderer& renderer, const RenderSettings& render,
                              const DrawnPicture& picture, bool shapes);

}  // namespace planlight
