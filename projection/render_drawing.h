#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "projection/draw_plan.h"

namespace planlight {

/// How lines become pixels of the projector.
struct RenderSettings {
    double steepest = 1.31;  ///< radians (75 degrees) between skin normal and light: beyond it nothing is drawn
    double brightness = 1;   ///< share of the light of the drawing's colours, 0 to 1
    double halo_mm = 1.2;    ///< darkness kept round the markers' stickers
    std::vector<Eigen::Vector3d> keep_dark_in_patient;  ///< marker centres that no light may touch
    double keep_dark_radius_mm = 9;
    double whole_ring = 0.85;  ///< circles of which less of the rim can be lit are drawn broken
    int only_item = -1;        ///< draw one item alone (for measuring); -1 draws all
    /// The item that is worked on: bright, with its whole label; no other label is drawn then. -1: none.
    int item_of_moment = -1;
    double others = 0.25;         ///< share of their light that the other items keep then; 0 hides them
    bool card = false;            ///< `PlanDrawing::card` is lit as well, while no item is that of the moment
    double steepest_text = 1.13;  ///< radians (65 degrees): a label of which a part is steeper is left out whole
};

/// A circle of which only a part can be lit: an arc of it looks like a circle elsewhere. It is drawn broken.
struct PartlyLitRing {
    int item = -1;         ///< index into PlanDrawing::items
    double lit_share = 0;  ///< of its rim
};

/// What became of the points of lines; each is lit, or one of the other three.
struct PointCounts {
    std::size_t points = 0;
    std::size_t lit = 0;
    std::size_t too_steep = 0;  ///< the light would graze the skin, or it faces away
    std::size_t hidden = 0;     ///< other skin stands in the light's way
    std::size_t outside = 0;    ///< out of the projector's picture
    std::size_t on_marker = 0;  ///< a marker is there, or so near that it is kept dark

    /// Of all its points; 0 where there are none.
    double lit_share() const;
    PointCounts& operator+=(const PointCounts& others);
};

/// What became of the drawing's points in one picture, without those of labels.
struct RenderCounts : PointCounts {
    /// One for each of PlanDrawing::items, without its check marks; of those that are not drawn no points.
    std::vector<PointCounts> items;
    std::vector<PartlyLitRing> partly_lit;
    std::vector<int> labels_lit, labels_left_out;  ///< items; a label is left out when not all of it can be lit
    bool card_lit = false;
};

/// One sentence for every circle of which only a part can be lit.
std::vector<std::string> sentences(const std::vector<PartlyLitRing>& rings, const PlanDrawing& drawing);

/// One sentence for every item of whose lines a twentieth or more has no light, and for what reason most of it: a line
/// that ends where the light does looks like one planned to end there; then what to do. Not for those of `partly_lit`.
std::vector<std::string> sentences_of_unlit(const RenderCounts& counts, const PlanDrawing& drawing);

/// One sentence that names the items whose labels cannot be lit whole; empty when all can.
std::string sentence_of_labels(const RenderCounts& counts, const PlanDrawing& drawing);

/// Renders drawings for the projector's view: true occlusion by the skin, lens distortion, anti-aliased strokes.
/// Holds the depth mesh, so that a picture a frame costs only the strokes. Keeps a reference to `skin`. May be called
/// from several threads (one waits for the other).
class DrawingRenderer {
public:
    DrawingRenderer(const SkinSurface& skin, const CameraModel& projector);
    ~DrawingRenderer();

    /// The projector picture for a head at `rig_from_ct` (T_global).
    RgbImage render(const PlanDrawing& drawing, const RigidTransform& rig_from_ct,
                    const RigidTransform& rig_from_patient = RigidTransform::Identity(),
                    const RenderSettings& settings = {}) const;

    /// As above, into a picture that is kept from frame to frame (resized and blackened first).
    RenderCounts render_into(RgbImage& picture, const PlanDrawing& drawing, const RigidTransform& rig_from_ct,
                             const RigidTransform& rig_from_patient = RigidTransform::Identity(),
                             const RenderSettings& settings = {}) const;

    int width() const;  ///< of the projector, pixels
    int height() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
