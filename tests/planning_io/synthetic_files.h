#pragma once

#include <cstring>
#include <filesystem>
#include <functional>
#include <string>

#include "tests/planning_io/synthetic_series.h"

namespace planlight::test {

/// The bytes of a NIfTI-1 header that says where the phantom's grid lies (sform, code 1), for a test to spoil.
std::string nifti_header(const Grid& grid);
/// Puts a number of type T into the header, little endian.
template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}
/// Header, 4 empty bytes, int16 voxels.
std::string nifti_bytes(const std::string& header, const Grid& grid);

/// Header texts, to the empty line or to ElementDataFile's.
std::string nrrd_header(const Grid& grid, const std::string& encoding = "raw");
std::string metaimage_header(const Grid& grid, bool packed = false);
std::string int16_bytes(const Grid& grid, bool big_endian = false);

std::string gzipped(const std::string& plain);
std::string zlibbed(const std::string& plain);

/// A FreeSurfer volume of int16 voxels; `tags` follow them.
std::string mgh_bytes(const Grid& grid, const std::string& tags = {});

/// The main.plist of a project imported from axial DICOM, for a test to spoil.
std::string invesalius_plist(const Grid& grid);
/// A small InVesalius project of the phantom: gzip tar of main.plist and matrix.dat.
void write_invesalius_project(const std::filesystem::path& file, const Grid& grid = {},
                              const std::string& plist = invesalius_plist({}));

}  // namespace planlight::test
