#include "planning_io/dicom/dicom_nesting.h"

#include <cstdint>
#include <string>

namespace planlight {
namespace {

constexpr std::uint32_t kUndefined = 0xFFFFFFFF, kItem = 0xFFFEE000, kItemEnd = 0xFFFEE00D, kSequenceEnd = 0xFFFEE0DD,
                        kPixelData = 0x7FE00010;
constexpr int kDeepest = 32;

/// Walks over elements (DICOM part 5, chapter 7). Every function gives false where the bytes do not fit.
class Walker {
public:
    Walker(std::string_view data, bool explicit_vr, bool big_endian)
        : data_(data), explicit_(explicit_vr), big_(big_endian) {}

    bool to_the_end() {
        while (at_ < data_.size())
            if (!element(0)) return false;
        return true;
    }
    bool group_two(std::string& transfer_syntax, std::size_t& end) {
        while (at_ + 4 <= data_.size() && number(at_, 2) == 2) {
            const std::size_t begin = at_;
            if (!element(0)) return false;
            if (number(begin + 2, 2) == 0x0010) transfer_syntax = data_.substr(begin + 8, at_ - begin - 8);
        }
        while (!transfer_syntax.empty() && (transfer_syntax.back() == '\0' || transfer_syntax.back() == ' '))
            transfer_syntax.pop_back();
        end = at_;
        return true;
    }

private:
    std::uint32_t number(std::size_t at, std::size_t bytes) const {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value |= static_cast<std::uint32_t>(static_cast<unsigned char>(data_[at + i]))
                     << (8 * (big_ ? bytes - 1 - i : i));
        return value;
    }
    bool has(std::size_t bytes) const { return bytes <= data_.size() - at_; }
    bool skip(std::size_t bytes) {
        if (!has(bytes)) return false;
        at_ += bytes;
        return true;
    }
    bool tag_and_length(std::uint32_t& tag, std::uint32_t& length, bool& sequence) {
        if (!has(8)) return false;
        tag = number(at_, 2) << 16 | number(at_ + 2, 2);
        sequence = false;
        if ((tag >> 16) == 0xFFFE || !explicit_) {
            length = number(at_ + 4, 4);
            return skip(8);
        }
        const std::string_view vr = data_.substr(at_ + 4, 2);
        if (vr[0] < 'A' || vr[0] > 'Z' || vr[1] < 'A' || vr[1] > 'Z') return false;
        sequence = vr == "SQ";
        for (const char* with_four : {"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"})
            if (vr == with_four) {
                if (!has(12)) return false;
                length = number(at_ + 8, 4);
                return skip(12);
            }
        length = number(at_ + 6, 2);
        return skip(8);
    }
    bool element(int depth) {
        std::uint32_t tag = 0, length = 0;
        bool sequence = false;
        if (depth > kDeepest || !tag_and_length(tag, length, sequence) || (tag >> 16) == 0xFFFE) return false;
        if (length != kUndefined) return sequence ? items_until(depth, length) : skip(length);
        if (tag == kPixelData) return fragments();
        return items(depth);
    }
    bool items_until(int depth, std::uint32_t length) {
        if (!has(length)) return false;
        const std::size_t end = at_ + length;
        while (at_ < end)
            if (!item(depth)) return false;
        return at_ == end;
    }
    bool items(int depth) {
        while (has(8)) {
            if ((number(at_, 2) << 16 | number(at_ + 2, 2)) == kSequenceEnd) return skip(8);
            if (!item(depth)) return false;
        }
        return false;
    }
    bool item(int depth) {
        if (!has(8) || (number(at_, 2) << 16 | number(at_ + 2, 2)) != kItem) return false;
        const std::uint32_t length = number(at_ + 4, 4);
        at_ += 8;
        if (length != kUndefined && !has(length)) return false;
        const std::size_t end = at_ + (length == kUndefined ? 0 : length);
        while (length == kUndefined || at_ < end) {
            if (length == kUndefined && has(8) && (number(at_, 2) << 16 | number(at_ + 2, 2)) == kItemEnd)
                return skip(8);
            if (!element(depth + 1)) return false;
        }
        return at_ == end;
    }
    bool fragments() {
        while (has(8)) {
            const std::uint32_t tag = number(at_, 2) << 16 | number(at_ + 2, 2), length = number(at_ + 4, 4);
            at_ += 8;
            if (tag == kSequenceEnd) return true;
            if (tag != kItem || !skip(length)) return false;
        }
        return false;
    }

    std::string_view data_;
    bool explicit_, big_;
    std::size_t at_ = 0;
};

}  // namespace

bool dicom_nests_to_its_end(std::string_view content) {
    const bool headed = content.size() >= 132 && content.substr(128, 4) == "DICM";
    if (!headed) {  // no header: implicit, unless a value representation stands where it would in explicit
        if (content.size() < 8) return false;
        const bool has_vr = content[4] >= 'A' && content[4] <= 'Z' && content[5] >= 'A' && content[5] <= 'Z';
        return Walker(content, has_vr, false).to_the_end();
    }
    std::string syntax;
    std::size_t end = 0;
    const std::string_view data = content.substr(132);
    if (!Walker(data, true, false).group_two(syntax, end)) return false;
    if (syntax == "1.2.840.10008.1.2.1.99") return true;  // deflated
    return Walker(data.substr(end), syntax != "1.2.840.10008.1.2", syntax == "1.2.840.10008.1.2.2").to_the_end();
}

}  // namespace planlight
