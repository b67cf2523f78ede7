#pragma once

#include <filesystem>
#include <string>

class vtkDICOMItem;
class vtkDICOMMetaData;
class vtkDICOMSequence;
class vtkDICOMValue;

// What the DICOM objects that are written share. Private to planning_io.
namespace planlight::dicom_write {

inline constexpr const char* kImplicitLittleEndian = "1.2.840.10008.1.2";
inline constexpr const char* kExplicitLittleEndian = "1.2.840.10008.1.2.1";

/// UID from content, under the root for UUIDs (2.25): the same content has the same one.
std::string uid_of(const std::string& content);

/// The number with as many digits as the 16 characters of the value representation DS hold.
std::string decimal_string(double value);

/// UTF-8 as one value of at most 64 characters (LO): no backslash, no control characters, cut between two characters.
vtkDICOMValue name_value(std::string text);

vtkDICOMSequence sequence_of(const vtkDICOMItem& item);

/// Of an ISO 8601 date with time: so many digits from that one on; empty where there are fewer.
std::string digits_of(const std::string& iso, std::size_t from, std::size_t count);

/// The file's bytes: what `meta` holds, which names its SOP instance, series and study. `file`: for the words of a
/// DiskError.
std::string compile(vtkDICOMMetaData* meta, const char* transfer_syntax, const std::filesystem::path& file);

}  // namespace planlight::dicom_write
