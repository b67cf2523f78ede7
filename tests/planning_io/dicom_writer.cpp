#include "tests/planning_io/dicom_writer.h"

#include <fmt/format.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>

namespace planlight::test {
namespace {

std::string little(std::uint64_t value, std::size_t bytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
    return text;
}

std::string number(std::uint64_t value, std::size_t bytes, bool big) {
    std::string text = little(value, bytes);
    if (big) std::reverse(text.begin(), text.end());
    return text;
}

std::string swapped(std::string bytes, const std::string& vr) {
    const std::size_t width = vr == "US" || vr == "SS" || vr == "OW" ? 2
                              : vr == "UL" || vr == "FL"             ? 4
                              : vr == "FD"                           ? 8
                                                                     : 1;
    for (std::size_t at = 0; at + width <= bytes.size(); at += width)
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + width));
    return bytes;
}

std::string encode_set(const DicomObject& object, bool is_explicit, bool big) {
    std::string out;
    for (const auto& [tag, element] : object.elements) {
        std::string value = big ? swapped(element.bytes, element.vr) : element.bytes;
        if (element.vr == "SQ") {
            value.clear();
            for (const auto& item : element.items) {
                const std::string content = encode_set(item, is_explicit, big);
                value += number(0xfffe, 2, big) + number(0xe000, 2, big) + number(content.size(), 4, big) + content;
            }
        }
        if (!element.fragments.empty()) {  // explicit little endian only; the offset table is empty
            out.append(number(tag >> 16, 2, big))
                .append(number(tag & 0xffff, 2, big))
                .append("OB")
                .append(2, '\0')
                .append(4, '\xff');
            out.append(little(0xe000fffe, 4)).append(4, '\0');
            for (const auto& f : element.fragments)
                out.append(little(0xe000fffe, 4)).append(little(f.size(), 4)).append(f);
            out.append(little(0xe0ddfffe, 4)).append(4, '\0');
            continue;
        }
        out += number(tag >> 16, 2, big) + number(tag & 0xffff, 2, big);
        const bool is_long =
            element.vr == "OB" || element.vr == "OW" || element.vr == "SQ" || element.vr == "UN" || element.vr == "UT";
        if (is_explicit) out.append(element.vr).append(is_long ? 2 : 0, '\0');
        out += number(value.size(), is_explicit && !is_long ? 2 : 4, big) + value;
    }
    return out;
}

std::string deflated(const std::string& plain) {
    z_stream z{};
    deflateInit2(&z, 6, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY);
    std::string packed(deflateBound(&z, plain.size()), '\0');
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
    z.avail_in = static_cast<uInt>(plain.size());
    z.next_out = reinterpret_cast<Bytef*>(packed.data());
    z.avail_out = static_cast<uInt>(packed.size());
    deflate(&z, Z_FINISH);
    packed.resize(z.total_out);
    deflateEnd(&z);
    if (packed.size() % 2) packed.push_back('\0');
    return packed;
}

bool pack(gdcm::ImageReader& reader, gdcm::ImageChangeTransferSyntax& change, const std::filesystem::path& file,
          DicomPacking packing) {
    reader.SetFileName(file.c_str());
    if (!reader.Read()) return false;
    change.SetTransferSyntax(packing == DicomPacking::rle             ? gdcm::TransferSyntax::RLELossless
                             : packing == DicomPacking::jpeg_lossless ? gdcm::TransferSyntax::JPEGLosslessProcess14_1
                             : packing == DicomPacking::jpeg_ls       ? gdcm::TransferSyntax::JPEGLSLossless
                                                                      : gdcm::TransferSyntax::JPEG2000Lossless);
    change.SetInput(reader.GetImage());
    return change.Change();
}

}  // namespace

void DicomObject::text(std::uint32_t tag, const std::string& vr, const std::string& value) {
    elements[tag] = {vr, value, {}, {}};
    if (value.size() % 2) elements[tag].bytes.push_back(vr == "UI" ? '\0' : ' ');
}
void DicomObject::number(std::uint32_t tag, std::uint16_t value) {
    elements[tag] = {"US", little(value, 2), {}, {}};
}
void DicomObject::decimals(std::uint32_t tag, const std::vector<double>& values) {
    std::string all;
    for (const double v : values) all.append(all.empty() ? "" : "\\").append(fmt::format("{:.9g}", v));
    text(tag, "DS", all);
}
void DicomObject::items(std::uint32_t tag, std::vector<DicomObject> list) {
    elements[tag] = {"SQ", "", std::move(list), {}};
}
void DicomObject::pixels(const std::vector<std::int16_t>& values) {
    std::string bytes;
    bytes.reserve(values.size() * 2);
    for (const auto v : values) bytes += little(static_cast<std::uint16_t>(v), 2);
    elements[0x7fe00010] = {"OW", bytes, {}, {}};
}

std::string encode_dicom(const DicomObject& object, DicomEncoding encoding, const std::string& transfer_syntax) {
    const std::string uid = !transfer_syntax.empty()                     ? transfer_syntax
                            : encoding == DicomEncoding::implicit_little ? "1.2.840.10008.1.2"
                            : encoding == DicomEncoding::explicit_big    ? "1.2.840.10008.1.2.2"
                            : encoding == DicomEncoding::deflated        ? "1.2.840.10008.1.2.1.99"
                                                                         : "1.2.840.10008.1.2.1";
    DicomObject first;
    first.elements[0x00020001] = {"OB", std::string("\0\1", 2), {}, {}};
    if (object.elements.contains(0x00080016)) first.elements[0x00020002] = {"UI", object.value(0x00080016), {}, {}};
    if (object.elements.contains(0x00080018)) first.elements[0x00020003] = {"UI", object.value(0x00080018), {}, {}};
    first.text(0x00020010, "UI", uid);
    first.text(0x00020012, "UI", "1.2.826.0.1.3680043.9.9999.1");
    const std::string group = encode_set(first, true, false);
    DicomObject length;
    length.elements[0x00020000] = {"UL", little(group.size(), 4), {}, {}};
    const std::string set =
        encode_set(object, encoding != DicomEncoding::implicit_little, encoding == DicomEncoding::explicit_big);
    return std::string(128, '\0') + "DICM" + encode_set(length, true, false) + group +
           (encoding == DicomEncoding::deflated ? deflated(set) : set);
}

bool pack_dicom(const std::filesystem::path& file, DicomPacking packing) {
    gdcm::ImageReader reader;
    gdcm::ImageChangeTransferSyntax change;
    if (!pack(reader, change, file, packing)) return false;
    gdcm::ImageWriter writer;
    writer.SetFile(reader.GetFile());
    writer.SetImage(change.GetOutput());
    const std::string packed = file.string() + ".packed";
    writer.SetFileName(packed.c_str());
    if (!writer.Write()) return false;
    std::filesystem::rename(packed, file);
    return true;
}

std::string encode_packed_dicom(DicomObject object, DicomPacking packing, const std::filesystem::path& scratch_file) {
    std::ofstream(scratch_file, std::ios::binary) << encode_dicom(object, DicomEncoding::explicit_little);
    gdcm::ImageReader reader;
    gdcm::ImageChangeTransferSyntax change;
    const bool good = pack(reader, change, scratch_file, packing);
    std::filesystem::remove(scratch_file);
    if (!good) return {};
    const gdcm::SequenceOfFragments* packed = change.GetOutput().GetDataElement().GetSequenceOfFragments();
    DicomObject::Element& pixels = object.elements[0x7fe00010];
    pixels = {"OB", "", {}, {}};
    for (std::size_t f = 0; packed && f < packed->GetNumberOfFragments(); ++f) {
        const gdcm::ByteValue* bytes =
            packed->GetFragment(static_cast<gdcm::SequenceOfFragments::SizeType>(f)).GetByteValue();
        pixels.fragments.emplace_back(bytes->GetPointer(), bytes->GetLength());
    }
    return encode_dicom(object, DicomEncoding::explicit_little, change.GetTransferSyntax().GetString());
}

}  // namespace planlight::test
