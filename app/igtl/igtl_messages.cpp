// Packed here and not by OpenIGTLink's library: its version 1.11 sends a byte of unwritten memory in each element of
// TDATA, and numbers of cells as nine components each. Its receiver reads what is packed here (the tests).
#include "app/igtl/igtl_messages.h"

#include <bit>
#include <cmath>

namespace planlight {
namespace {

/// Numbers with their most significant byte first, text in fields of a fixed width.
class Bytes {
public:
    Bytes& u8(std::uint64_t value) { return number(value, 1); }
    Bytes& u16(std::uint64_t value) { return number(value, 2); }
    Bytes& u32(std::uint64_t value) { return number(value, 4); }
    Bytes& u64(std::uint64_t value) { return number(value, 8); }
    Bytes& f32(double value) { return u32(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
    Bytes& f64(double value) { return u64(std::bit_cast<std::uint64_t>(value)); }
    Bytes& text(const std::string& text) {
        bytes_ += text;
        return *this;
    }
    Bytes& field(std::string text, std::size_t width) {
        text.resize(width, '\0');
        bytes_ += text;
        return *this;
    }
    /// RAS from LPS: turned about the third axis. Column by column, without the last row.
    Bytes& transform(const RigidTransform& b_from_a) {
        const Eigen::Matrix4d flip = Eigen::Vector4d(-1, -1, 1, 1).asDiagonal();
        const Eigen::Matrix4d ras = flip * b_from_a.matrix() * flip;
        for (Eigen::Index column = 0; column < 4; ++column)
            for (Eigen::Index row = 0; row < 3; ++row) f32(ras(row, column));
        return *this;
    }
    const std::string& all() const { return bytes_; }

private:
    Bytes& number(std::uint64_t value, int size) {
        for (int byte = size - 1; byte >= 0; --byte) bytes_ += static_cast<char>(value >> (8 * byte) & 0xFF);
        return *this;
    }
    std::string bytes_;
};

/// CRC-64 of ECMA-182, most significant bit first, from 0.
std::uint64_t crc_of(const std::string& bytes) {
    static const std::array<std::uint64_t, 256> table = [] {
        std::array<std::uint64_t, 256> made{};
        for (std::uint64_t i = 0; i < made.size(); ++i) {
            made[i] = i << 56;
            for (int bit = 0; bit < 8; ++bit)
                made[i] = made[i] >> 63 ? made[i] << 1 ^ 0x42F0E1EBA9EA3693 : made[i] << 1;
        }
        return made;
    }();
    std::uint64_t crc = 0;
    for (const char byte : bytes) crc = crc << 8 ^ table[(crc >> 56 ^ static_cast<unsigned char>(byte)) & 0xFF];
    return crc;
}

/// With the header of version 1.
std::string message(const std::string& type, const LinkLabel& label, const Bytes& body) {
    const double whole = std::floor(label.utc_s);
    return Bytes()
        .u16(1)
        .field(type, 12)
        .field(label.device, 20)
        .u32(static_cast<std::uint64_t>(whole))
        .u32(static_cast<std::uint64_t>((label.utc_s - whole) * 4294967296.0))
        .u64(body.all().size())
        .u64(crc_of(body.all()))
        .text(body.all())
        .all();
}

/// Each cell: how many points, and which.
template <class Cells>
Bytes cells_of(const Cells& cells) {
    Bytes bytes;
    for (const auto& cell : cells) {
        bytes.u32(cell.size());
        for (const auto point : cell) bytes.u32(static_cast<std::uint64_t>(point));
    }
    return bytes;
}

}  // namespace

std::string transform_message(const LinkLabel& label, const RigidTransform& b_from_a) {
    return message("TRANSFORM", label, Bytes().transform(b_from_a));
}

std::string tracking_message(const LinkLabel& label, const std::vector<NamedTransform>& transforms) {
    constexpr std::uint64_t kSixDegrees = 2;
    Bytes body;
    for (const NamedTransform& transform : transforms)
        body.field(transform.name, 20).u8(kSixDegrees).u8(0).transform(transform.b_from_a);
    return message("TDATA", label, body);
}

std::string status_message(const LinkLabel& label, LinkCode code, std::int64_t subcode, const std::string& word,
                           const std::string& text) {
    return message("STATUS", label,
                   Bytes()
                       .u16(static_cast<std::uint64_t>(code))
                       .u64(static_cast<std::uint64_t>(subcode))
                       .field(word, 20)
                       .text(text)
                       .u8(0));
}

std::string lengths_message(const LinkLabel& label, const std::vector<double>& lengths_mm) {
    constexpr std::uint64_t kMilli = 0xB, kMetre = 1, kToTheFirst = 1;
    Bytes body;
    body.u8(lengths_mm.size()).u8(0).u64(kMilli << 60 | kMetre << 54 | kToTheFirst << 50);
    for (const double mm : lengths_mm) body.f64(mm);
    return message("SENSOR", label, body);
}

std::string string_message(const LinkLabel& label, const std::string& text) {
    constexpr std::uint64_t kUtf8 = 106;  // IANA's number of the character set
    constexpr std::size_t kMost = 65535;
    const std::string cut = text.substr(0, kMost);
    return message("STRING", label, Bytes().u16(kUtf8).u16(cut.size()).text(cut));
}

std::string shapes_message(const LinkLabel& label, const LinkedShapes& shapes) {
    constexpr std::uint64_t kNumberOfCell = 0x10, kOneComponent = 1;
    std::vector<std::array<std::uint32_t, 1>> dots;
    for (const std::uint32_t dot : shapes.dots) dots.push_back({dot});
    const std::array<Bytes, 3> cells{cells_of(dots), cells_of(shapes.lines), cells_of(shapes.triangles)};
    Bytes body;
    body.u32(shapes.points_in_ct.size());
    body.u32(dots.size()).u32(cells[0].all().size());
    body.u32(shapes.lines.size()).u32(cells[1].all().size());
    body.u32(shapes.triangles.size()).u32(cells[2].all().size());
    body.u32(0).u32(0);  // strips of triangles
    body.u32(shapes.numbers_of_cells.empty() ? 0 : 1);
    for (const Eigen::Vector3d& p : shapes.points_in_ct) body.f32(0 - p.x()).f32(0 - p.y()).f32(p.z());
    for (const Bytes& cell : cells) body.text(cell.all());
    if (!shapes.numbers_of_cells.empty()) {
        const std::size_t width = shapes.number_name.size() + 1;  // with a zero behind it, and to whole 16 bits
        body.u8(kNumberOfCell).u8(kOneComponent).u32(shapes.numbers_of_cells.size());
        body.field(shapes.number_name, width + width % 2);
        for (const float number : shapes.numbers_of_cells) body.f32(number);
    }
    return message("POLYDATA", label, body);
}

}  // namespace planlight
