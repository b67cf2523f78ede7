#include "planning_io/case/slicer_transform.h"

#include <fmt/format.h>

#include "planning_io/files/safe_write.h"

namespace planlight {

void write_slicer_transform(const RigidTransform& patient_from_ct, const std::filesystem::path& file) {
    const Eigen::Matrix3d R = patient_from_ct.linear();
    const Eigen::Vector3d t = patient_from_ct.translation();
    std::string parameters;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) parameters += fmt::format("{:.17g} ", R(row, column));
    parameters += fmt::format("{:.17g} {:.17g} {:.17g}", t.x(), t.y(), t.z());
    write_safely(file, fmt::format("#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
                                   "Parameters: {}\nFixedParameters: 0 0 0\n",
                                   parameters));
}

}  // namespace planlight
