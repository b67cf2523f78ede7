#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/camera_model.h"
#include "planning_io/types/image.h"
#include "projection/draw_plan.h"

namespace planlight::test {

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

/// What is read in the label's lines, parted by '/': at three scales, the reading that comes most ("" of a line in
/// which nothing is read). No value where part of it is out of the picture. `keep`: where its pictures are kept,
/// without their ending; empty: nowhere.
std::optional<std::string> read_label(const Label& label, const Seen& seen, const CameraModel& camera,
                                      const RigidTransform& rig_from_ct, const std::filesystem::path& keep = {});

/// Of a grey picture, between its pixels (Catmull-Rom).
double between(const GrayImage& picture, const Eigen::Vector2d& at);

}  // namespace planlight::test
