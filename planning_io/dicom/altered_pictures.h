#pragma once

#include <vtkDICOMMetaData.h>

#include <string>

// What a header says was done to its pictures, in its words; empty: nothing.
namespace planlight {

/// How the file says that what made the face recognisable was taken away (DICOM PS3.3 C.7.6.1.1.10, PS3.16 CID 7050).
std::string defaced(vtkDICOMMetaData* meta);

/// How the file says that its picture was made of several slices (DICOM PS3.3 C.7.6.1.1.2 and C.8.16.1): maximum and
/// minimum intensity projections, subtractions.
/// "MIP" as a word of the description counts as well.
std::string projected(vtkDICOMMetaData* meta);

}  // namespace planlight
