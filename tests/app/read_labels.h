#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "projection/draw_plan.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::test {

/// What was made of the labels of one picture, or of several.
struct LabelsRead {
    int items = 0, lit = 0;                 ///< of the plan; with a label that was lit whole
    int left_out = 0;                       ///< labels that could not be lit whole from there
    int name_alone = 0;                     ///< of those lit: without their figures
    int unseen = 0;                         ///< lit, and in the shadow of both cameras: not read
    int right = 0;                          ///< read as they are written
    std::vector<std::string> wrong;         ///< "written | read", lines parted by '/'
    std::vector<std::string> other_number;  ///< of those: read as another number
    double share_of_text = 0;               ///< of the light's area; of the last picture
    void append(const LabelsRead& more);
};

/// True where `tesseract` can be run.
bool can_read_labels();

/// What tesseract reads in a picture of dark letters on bright ground, lines parted by '/'. Empty: nothing.
std::string read_text(const GrayImage& picture);

enum class Reading { right, other, other_number };
/// Is what was read what was written? Blanks do not count; the diameter sign may be read as any sign that looks like
/// it, since the reader does not know it. Another number: other digits in the same places, or more or fewer of them.
Reading compare(const std::string& written, const std::string& read);

/// The label as a camera saw it, turned upright, dark on bright, a capital some 40 pixels high. Empty when part of it
/// lies outside the picture.
GrayImage upright(const Label& label, const GrayImage& seen, const CameraModel& camera,
                  const RigidTransform& rig_from_ct);

/// The example patient with plans of names and figures of several kinds on one side of the head.
class LabelledHead {
public:
    LabelledHead();
    ~LabelledHead();
    /// A plan, a room and a pose of that seed: the plan drawn, lit and read.
    LabelsRead read(simulation::Preset preset, unsigned seed) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight::test
