#pragma once

#include <vtkDICOMMetaData.h>

#include <array>
#include <string>

// Values of a DICOM header as plain text and numbers. Heavy (vtk-dicom): for .cpp files that read DICOM alone.
namespace planlight {

/// Printable ASCII; what is not becomes "?", for a damaged file may say anything.
std::string plain(std::string text);

/// Empty when not said. `frame`: of a multi-frame file, whose functional groups are asked as well.
std::string text_at(vtkDICOMMetaData* meta, vtkDICOMTag tag, int frame = 0);

/// Of the Patient ID; empty when not said. It tells whether two files are of one patient, and nothing of who that is.
std::string patient_hash(vtkDICOMMetaData* meta);

/// As many of the value's numbers as `count`, six at most; NaN where there are fewer.
std::array<double, 6> numbers_at(vtkDICOMMetaData* meta, int frame, vtkDICOMTag tag, unsigned count);

}  // namespace planlight
