#include "planning_io/dicom/fat_shift.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "planning_io/dicom/header_values.h"

namespace planlight {
namespace {

/// The first of these that is said as a number within the limits; else not a number.
double first_number_at(vtkDICOMMetaData* meta, int frame, std::initializer_list<vtkDICOMTag> tags, double least,
                       double most) {
    for (const vtkDICOMTag& tag : tags)
        if (const double number = numbers_at(meta, frame, tag, 1)[0]; number >= least && number <= most) return number;
    return DicomSlice::kUnsaid;
}

bool fat_is_suppressed(vtkDICOMMetaData* meta, int frame) {
    const std::string how = text_at(meta, vtkDICOMTag(0x0018, 0x9025), frame),  // Spectrally Selected Suppression
        options = "\\" + text_at(meta, vtkDICOMTag(0x0018, 0x0022), frame) + "\\";
    return how == "FAT" || how == "FAT_AND_WATER" || options.find("\\FS\\") != std::string::npos;
}

}  // namespace

Eigen::Vector3d fat_shift_of(vtkDICOMMetaData* meta, int frame, const DicomSlice& slice) {
    constexpr double kFat_ppm = 3.4, kProton_MHz_per_T = 42.577, kMost_mm = 20,
                     kLeast_Hz = 40;  // less is a bandwidth of all pixels in kHz, as some scanners wrote it
    const std::string phase_along = text_at(meta, vtkDICOMTag(0x0018, 0x1312), frame);
    const bool along_columns = phase_along == "ROW", along_rows = phase_along == "COL" || phase_along == "COLUMN";
    if (along_columns == along_rows || fat_is_suppressed(meta, frame)) return Eigen::Vector3d::Zero();
    double frequency_MHz =
        first_number_at(meta, frame, {vtkDICOMTag(0x0018, 0x0084), vtkDICOMTag(0x0018, 0x9098)}, 1, 600);
    if (std::isnan(frequency_MHz))
        frequency_MHz = kProton_MHz_per_T * first_number_at(meta, frame, {vtkDICOMTag(0x0018, 0x0087)}, 0.01, 15);
    const auto matrix = numbers_at(meta, frame, vtkDICOMTag(0x0018, 0x1310), 2);  // rows, columns; one of them is zero
    double readings = std::max(matrix[0], matrix[1]);
    if (!(readings > 0)) readings = first_number_at(meta, frame, {vtkDICOMTag(0x0018, 0x9058)}, 1, 65535);
    const double pixels = meta->Get(0, along_columns ? DC::Rows : DC::Columns).AsDouble(),
                 pixel_mm = (along_columns ? slice.row_spacing_mm : slice.column_spacing_mm) *
                            (readings > 0 ? pixels / readings : 1.0),
                 shift_mm = kFat_ppm * frequency_MHz * pixel_mm /
                            first_number_at(meta, frame, {vtkDICOMTag(0x0018, 0x0095)}, kLeast_Hz, 1e5);
    if (!(shift_mm > 0 && shift_mm < kMost_mm)) return Eigen::Vector3d::Zero();
    return shift_mm * (along_columns ? slice.column_direction : slice.row_direction);
}

}  // namespace planlight
