#pragma once

#include <string_view>

namespace planlight {

/// True when the file's elements, sequences and items nest exactly and end with the file: nothing is cut off, nothing
/// follows. For little and big endian, explicit and implicit; true also for deflated and encapsulated data, which are
/// not looked into. vtk-dicom reads a cut file up to the cut without an error.
bool dicom_nests_to_its_end(std::string_view content);

}  // namespace planlight
