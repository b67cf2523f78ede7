#pragma once

#include <cstddef>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rig_calibration.h"
#include "registration/scan/decode/decode_stripes.h"

namespace planlight {

/// What rays must agree to, and where points may lie.
struct TriangulationSettings {
    /// What the calibration leaves, one standard deviation of a pixel; the noise of the code is added to it. The
    /// projector is calibrated worse than the cameras: the cameras place the point, the projector checks it.
    double camera_sigma_px = 0.1, projector_sigma_px = 0.25;
    double max_residual_sigma = 3.5;      ///< three-view agreement: normalised residual above which a point is dropped
    double near_mm = 200, far_mm = 3000;  ///< from the projector: the working volume
    bool one_camera = true;               ///< also points that only one camera and the projector see
    int stride = 0;  ///< every how many camera pixels a point is made; 0: so that a view makes at most 75,000
};

/// Every how many camera pixels along a line, and every how many lines, a point is made.
struct Stride {
    int x = 1, y = 1;
};

/// Points from all rays that agree, with counts by reason for those that do not (Fig. 2 of the paper, middle).
struct Triangulation {
    enum class Seen : unsigned char { both, left_only, right_only };
    PointCloud cloud;  ///< in rig; one point per left-camera pixel (or right, where only that sees it); no normals yet
    std::vector<Eigen::Vector2i> grid;  ///< per point: the rounded projector pixel (column, row), for neighbourhoods
    std::vector<Seen> seen;             ///< per point: by whom
    std::size_t three_view = 0, two_view = 0;
    std::size_t no_partner = 0, disagree = 0, outside_volume = 0;
    std::size_t ragged =
        0;          ///< the code is not smooth around the pixel: an edge, hair, a glint; with one camera also its rim
    Stride stride;  ///< as used

    /// Evidence about the calibration, over the points that both cameras placed without the projector: the median of
    /// (decoded - expected) projector pixel (of the sample below), and the rms distance from the epipolar line in
    /// camera pixels. Points that the gate drops count as well, or a rig that is off would look fine.
    Eigen::Vector2d projector_offset_px = Eigen::Vector2d::Zero();
    double epipolar_rms_px = 0;

    /// A sample of those points (at most 20,000), for the resection of the projector. With columns only the row of
    /// the pixel is what the rig expects, not measured.
    struct ByCameras {
        Eigen::Vector3d p_in_rig;
        Eigen::Vector2d pixel_in_projector;
        double epipolar_px;
    };
    std::vector<ByCameras> by_cameras;
};

/// Triangulates the decoded views of both cameras. The views must code both directions, or the columns only when three
/// views meet along epipolar lines.
Triangulation triangulate(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                          const TriangulationSettings& settings = {});

/// What 68.3 % of the points that both cameras placed stay within of their epipolar line, left camera pixels: of normal
/// noise its rms. A handful of wrong partners, 50 px off, makes a rms (`Triangulation::epipolar_rms_px`) of 0.44 px in
/// a room where 68.3 % have 0.08, and this none. 0: not known, for no point was placed across these lines (columns
/// only, one camera).
double usual_epipolar_px(const Triangulation& raw);

}  // namespace planlight
