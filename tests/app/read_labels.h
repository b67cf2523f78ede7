#pragma once

#include <filesystem>
#include <functional>
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

/// What tesseract reads in a picture of one line of dark letters on bright ground. Empty: nothing.
std::string read_text(const GrayImage& picture);

enum class Reading { right, other, other_number };
/// Is what was read what was written? Blanks and capitals do not count. Another number: a line of which
/// other digits were read; one of which none were read is only not read.
Reading compare(const std::string& written, const std::string& read);

/// How bright a camera, or an eye in its place, sees what is at a pixel (sub-pixel): 0 to 255.
using Seen = std::function<double(const Eigen::Vector2d& pixel)>;

/// The label's lines as a camera saw them, each turned upright, dark on bright, pixels of that size. Empty
/// when part of them lies outside the picture.
std::vector<GrayImage> upright(const Label& label, const Seen& seen, const CameraModel& camera,
                               const RigidTransform& rig_from_ct, double pixel_mm);

/// What is read in the label's lines, parted by '/': at three scales, the reading that comes most. Empty when part of
/// it is out of the picture. `keep`: where its pictures are kept, without their ending; empty: nowhere.
std::string read_label(const Label& label, const Seen& seen, const CameraModel& camera,
                       const RigidTransform& rig_from_ct, const std::filesystem::path& keep = {});

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
