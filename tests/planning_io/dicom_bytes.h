#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace planlight::test {

/// Writes DICOM by the letter of the standard (explicit little endian), without the library that reads it.
class DicomBytes {
public:
    DicomBytes& add(std::uint32_t tag, const char* vr, std::string value) {
        if (value.size() % 2) value += std::string(vr) == "UI" || std::string(vr) == "OB" ? '\0' : ' ';
        number(tag >> 16, 2);
        number(tag & 0xFFFF, 2);
        bytes_ += vr;
        const std::string type = vr;
        if (type == "OB" || type == "OW" || type == "SQ" || type == "UN") {
            number(0, 2);
            number(static_cast<std::uint32_t>(value.size()), 4);
        } else {
            number(static_cast<std::uint32_t>(value.size()), 2);
        }
        bytes_ += value;
        return *this;
    }
    DicomBytes& add_us(std::uint32_t tag, std::uint16_t value) {
        return add(tag, "US", {static_cast<char>(value & 0xFF), static_cast<char>(value >> 8)});
    }
    DicomBytes& add_sequence(std::uint32_t tag, const std::vector<DicomBytes>& items) {
        DicomBytes all;
        for (const auto& item : items) {
            all.number(0xFFFE, 2);
            all.number(0xE000, 2);
            all.number(static_cast<std::uint32_t>(item.bytes_.size()), 4);
            all.bytes_ += item.bytes_;
        }
        return add(tag, "SQ", all.bytes_);
    }
    /// The whole file: preamble, header, these elements.
    std::string file(const std::string& sop_class) const {
        DicomBytes head;
        head.add(0x00020002, "UI", sop_class)
            .add(0x00020003, "UI", "1.2.3.4.5")
            .add(0x00020010, "UI", "1.2.840.10008.1.2.1");
        DicomBytes length;
        length.add(0x00020000, "UL",
                   std::string{static_cast<char>(head.bytes_.size() & 0xFF), static_cast<char>(head.bytes_.size() >> 8),
                               0, 0});
        return std::string(128, '\0') + "DICM" + length.bytes_ + head.bytes_ + bytes_;
    }

private:
    void number(std::uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) bytes_ += static_cast<char>((value >> (8 * i)) & 0xFF);
    }
    std::string bytes_;
};

}  // namespace planlight::test
