#pragma once

#include <memory>
#include <string>
#include <vector>

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
    double share_of_text = 0;               ///< of the light's area; of the last picture
    void append(const LabelsRead& more);
};

/// The example patient with plans of names and figures of several kinds on one side of the head.
class LabelledHead {
public:
    LabelledHead();
    ~LabelledHead();
    /// A plan, a room and a pose of that seed: the plan drawn, lit and read.
    /// `eye`: by an eye in the camera's place, without its blur, pixels and noise; else in the camera's picture.
    LabelsRead read(simulation::Preset preset, unsigned seed, bool eye) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight::test
