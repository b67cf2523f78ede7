#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace planlight::test {

/// A DICOM data set in memory, every element of which can be spoilt. Values are little endian bytes; sequences hold
/// items.
struct DicomObject {
    struct Element {
        std::string vr, bytes;
        std::vector<DicomObject> items;
        std::vector<std::string> fragments;  ///< packed pixels, one a frame
    };
    std::map<std::uint32_t, Element> elements;  ///< by group << 16 | element

    void text(std::uint32_t tag, const std::string& vr, const std::string& value);
    void number(std::uint32_t tag, std::uint16_t value);                  ///< US
    void decimals(std::uint32_t tag, const std::vector<double>& values);  ///< DS
    void items(std::uint32_t tag, std::vector<DicomObject> items);        ///< SQ
    void pixels(const std::vector<std::int16_t>& values);                 ///< (7FE0,0010), OW
    void erase(std::uint32_t tag) { elements.erase(tag); }
    std::string value(std::uint32_t tag) const { return elements.at(tag).bytes; }
};

enum class DicomEncoding { implicit_little, explicit_little, explicit_big, deflated };

/// The whole file: preamble, group 2, data set. `transfer_syntax` replaces the UID that `encoding` has (a lie, for
/// tests).
std::string encode_dicom(const DicomObject& object, DicomEncoding encoding, const std::string& transfer_syntax = {});

/// Packs an explicit little endian file anew with GDCM, in place. False when GDCM cannot.
enum class DicomPacking { rle, jpeg_lossless, jpeg_ls, jpeg_2000 };
bool pack_dicom(const std::filesystem::path& file, DicomPacking packing);

/// The file with its pixels packed by GDCM and every other element as it is: GDCM's own writer makes the frames of an
/// Enhanced object evenly spaced in the order in which they lie in the file, whatever their positions were. Empty when
/// GDCM cannot.
std::string encode_packed_dicom(DicomObject object, DicomPacking packing, const std::filesystem::path& scratch_file);

}  // namespace planlight::test
