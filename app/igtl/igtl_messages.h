#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "planning_io/types/rigid_transform.h"

// Messages of OpenIGTLink (protocol version 2 with headers of version 1, as every receiver takes them), ready to be
// sent: header, checksum and body (http://openigtlink.org/protocols/v2_header.html and its neighbours).
//
// Axes: OpenIGTLink's receivers (3D Slicer) speak RAS, mm; inside it is LPS, mm. Each frame is turned alike, about its
// own third axis: p_ras = F p with F = diag(-1, -1, 1). So a point of the CT at (10, 20, 30) in LPS is sent as (-10,
// -20, 30), and a transform b_from_a as F b_from_a F, which takes a's turned points to b's turned points.
namespace planlight {

/// What a message says of itself: its device's name (20 bytes of it are sent) and its moment, UTC, since 1970.
struct LinkLabel {
    std::string device;
    double utc_s = 0;
};

/// A transform of ours (LPS, mm) with its name.
struct NamedTransform {
    std::string name;
    RigidTransform b_from_a;
};

/// TRANSFORM: in RAS, mm; numbers of 32 bit.
std::string transform_message(const LinkLabel& label, const RigidTransform& b_from_a);

/// TDATA: several transforms of one moment, in RAS, mm.
std::string tracking_message(const LinkLabel& label, const std::vector<NamedTransform>& transforms);

/// Codes of STATUS that are used (OpenIGTLink protocol, Status message).
enum class LinkCode : std::uint16_t {
    ok = 1,
    busy = 6,
    connection_lost = 7,
    not_ready = 13,
    disabled = 15,
    shut_down = 19
};

/// STATUS: `word` in 20 bytes, `text` for a person (UTF-8).
std::string status_message(const LinkLabel& label, LinkCode code, std::int64_t subcode, const std::string& word,
                           const std::string& text);

/// SENSOR: lengths in millimetres (the unit is in the message).
std::string lengths_message(const LinkLabel& label, const std::vector<double>& lengths_mm);

/// STRING, UTF-8.
std::string string_message(const LinkLabel& label, const std::string& text);

/// What POLYDATA can show: points, LPS, mm, and what is made of them.
struct LinkedShapes {
    std::vector<Eigen::Vector3d> points_in_ct;
    std::vector<std::uint32_t> dots;                ///< points to be seen as such
    std::vector<std::vector<std::uint32_t>> lines;  ///< through these points; a closed one names its first point again
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::string number_name;              ///< of `numbers`; up to 255 bytes
    std::vector<float> numbers_of_cells;  ///< of dots, then lines, then triangles; empty: none
};

/// POLYDATA, in RAS, mm.
std::string shapes_message(const LinkLabel& label, const LinkedShapes& shapes);

}  // namespace planlight
