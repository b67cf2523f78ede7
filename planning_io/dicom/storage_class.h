#pragma once

#include <string>

// What kind of object a DICOM file is, by its SOP class (DICOM PS3.4 B.5).
namespace planlight {

/// CT or MR image objects, Enhanced ones too.
bool is_volume_class(const std::string& storage_class);

/// A volume of a cone beam CT, stored as another class than CT.
bool is_x_ray_3d(const std::string& storage_class);
inline constexpr const char* kExportAsCt = "Export it from the scanner's program as CT Image Storage.";

/// What a file is that is no CT or MR volume, for people: "a PET image"; of a class that is not known, its modality.
std::string words_of_class(const std::string& storage_class, const std::string& modality);

}  // namespace planlight
