#pragma once

#include <fmt/format.h>

#include <Eigen/Core>

#include "tests/planning_io/dicom_bytes.h"

namespace planlight::test {

/// A contour whose numbers are these letters.
inline DicomBytes contour_saying(const std::string& type, int points, const std::string& numbers) {
    return DicomBytes()
        .add(0x30060042, "CS", type)
        .add(0x30060046, "IS", std::to_string(points))
        .add(0x30060050, "DS", numbers);
}

inline DicomBytes closed_contour(const std::vector<Eigen::Vector3d>& points,
                                 const std::string& type = "CLOSED_PLANAR") {
    std::string data;
    for (const auto& p : points)
        data += fmt::format("{}{:.4f}\\{:.4f}\\{:.4f}", data.empty() ? "" : "\\", p.x(), p.y(), p.z());
    return contour_saying(type, static_cast<int>(points.size()), data);
}

struct WrittenRoi {
    std::string name;
    std::vector<DicomBytes> contours;
    std::string type = {};         ///< RT ROI Interpreted Type
    std::string description = {};  ///< ROI Description
};

/// Whose it is and on which series it was drawn; empty: it does not say.
struct WrittenOf {
    std::string patient_id = {}, study_uid = {}, series_uid = {};
};

/// An RTSTRUCT of these ROIs in the frame of reference 1.2.3; `frames`: what its list of frames says.
inline std::string rt_struct_of(const std::vector<WrittenRoi>& rois, const std::vector<std::string>& frames = {},
                                const WrittenOf& of = {}) {
    std::vector<DicomBytes> names, contours, types, listed;
    for (std::size_t i = 0; i < rois.size(); ++i) {
        const std::string number = std::to_string(i + 1);
        names.push_back(DicomBytes()
                            .add(0x30060022, "IS", number)
                            .add(0x30060024, "UI", "1.2.3")
                            .add(0x30060026, "LO", rois[i].name)
                            .add(0x30060028, "ST", rois[i].description));
        contours.push_back(DicomBytes().add_sequence(0x30060040, rois[i].contours).add(0x30060084, "IS", number));
        types.push_back(DicomBytes().add(0x30060084, "IS", number).add(0x300600A4, "CS", rois[i].type));
    }
    for (const std::string& frame : frames) {
        DicomBytes item;
        item.add(0x00200052, "UI", frame);
        if (!of.series_uid.empty()) {
            const DicomBytes series = DicomBytes().add(0x0020000E, "UI", of.series_uid);
            item.add_sequence(0x30060012, {DicomBytes().add_sequence(0x30060014, {series})});
        }
        listed.push_back(item);
    }
    DicomBytes all;
    all.add(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.481.3").add(0x00080060, "CS", "RTSTRUCT");
    if (!of.patient_id.empty()) all.add(0x00100020, "LO", of.patient_id);
    if (!of.study_uid.empty()) all.add(0x0020000D, "UI", of.study_uid);
    if (frames.empty()) all.add(0x00200052, "UI", "1.2.3");
    if (!frames.empty()) all.add_sequence(0x30060010, listed);
    return all.add_sequence(0x30060020, names)
        .add_sequence(0x30060039, contours)
        .add_sequence(0x30060080, types)
        .file("1.2.840.10008.5.1.4.1.1.481.3");
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
