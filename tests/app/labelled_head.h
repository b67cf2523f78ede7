#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "projection/draw_plan.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::test {

/// What was made of the labels of one picture, or of several.
struct LabelsRead {
    int items = 0, lit = 0;                 ///< of the plan; with a label that was lit whole
    int left_out = 0;                       ///< labels that could not be lit whole from there
    int name_alone = 0;                     ///< of those lit: without their figures
    int unseen = 0;                         ///< lit, and in the shadow of both cameras or out of their pictures
    int right = 0;                          ///< read as they are written
    std::vector<std::string> wrong;         ///< "written | read", lines parted by '/'
    std::vector<std::string> other_number;  ///< of those: read as another number
    int cards_lit = 0, cards_seen = 0, cards_right = 0;  ///< the card with name and side; by a camera; read as written
    std::vector<std::string> cards_wrong;
    double share_of_text = 0;  ///< of the light's area; of the last picture
    /// Of each kind of line in the left camera's picture: how much brighter it is than the skin 3.5 mm beside it, as a
    /// share of that.
    std::map<StrokeKind, std::vector<double>> contrast;
    int check_expected = 0, check_seen = 0;  ///< stretches that CHECK should see in both pictures, and sees
    std::vector<double> check_brighter;      ///< `LightCheck::brighter`, one a picture
    void append(const LabelsRead& more);
};

/// The example patient with plans of names and figures of several kinds on one side of the head.
class LabelledHead {
public:
    LabelledHead();
    ~LabelledHead();
    /// A plan, a room and a pose of that seed: the plan drawn, lit and read.
    /// `eye`: by an eye in the camera's place, without its blur, pixels and noise; else in the camera's picture.
    /// `room_light`: `simulation::RoomSettings::ambient`.
    LabelsRead read(simulation::Preset preset, unsigned seed, bool eye, double room_light = 0.2) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight::test
