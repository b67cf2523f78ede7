#pragma once

#include <fmt/format.h>

#include <Eigen/Core>

#include "tests/planning_io/dicom_bytes.h"

namespace planlight::test {

inline DicomBytes closed_contour(const std::vector<Eigen::Vector3d>& points) {
    std::string data;
    for (const auto& p : points)
        data += fmt::format("{}{:.4f}\\{:.4f}\\{:.4f}", data.empty() ? "" : "\\", p.x(), p.y(), p.z());
    return DicomBytes()
        .add(0x30060042, "CS", "CLOSED_PLANAR")
        .add(0x30060046, "IS", std::to_string(points.size()))
        .add(0x30060050, "DS", data);
}

/// An RTSTRUCT in the frame of reference 1.2.3: a solid of these contours, and the ROI "Line" of the eleventh alone.
/// `type`: of the solid (RT ROI Interpreted Type).
inline std::string rt_struct_of(const std::string& solid, const std::vector<DicomBytes>& contours,
                                const std::string& type = "ORGAN") {
    const auto roi = [](const char* number, const std::string& name) {
        return DicomBytes().add(0x30060022, "IS", number).add(0x30060024, "UI", "1.2.3").add(0x30060026, "LO", name);
    };
    return DicomBytes()
        .add(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.481.3")
        .add(0x00080060, "CS", "RTSTRUCT")
        .add(0x00200052, "UI", "1.2.3")
        .add_sequence(0x30060020, {roi("1", solid), roi("2", "Line")})
        .add_sequence(0x30060039, {DicomBytes().add_sequence(0x30060040, contours).add(0x30060084, "IS", "1"),
                                   DicomBytes().add_sequence(0x30060040, {contours[10]}).add(0x30060084, "IS", "2")})
        .add_sequence(0x30060080, {DicomBytes().add(0x30060084, "IS", "1").add(0x300600A4, "CS", type)})
        .file("1.2.840.10008.5.1.4.1.1.481.3");
}

}  // namespace planlight::test
