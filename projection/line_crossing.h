#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "projection/skin_paths.h"

namespace planlight {

/// Looks for places where a line on the skin crosses itself, as one does whose points stand in a wrong order.
class LineCrossing {
public:
    /// The next leg of the line, from point `number` to the one after it.
    void add(const SkinLine& leg, std::size_t number);

    /// The legs of the first crossing, the earlier one first; empty where there is none. Places less than 10 mm apart
    /// along the line do not count: a line drawn by hand may have loops.
    std::optional<std::pair<std::size_t, std::size_t>> first(bool closed) const;

private:
    struct Piece {
        Eigen::Vector3d from, to, normal;
        double way_mm = 0;  ///< along the line, to its beginning
        std::size_t leg = 0;
    };
    static bool cross(const Piece& a, const Piece& b);

    std::vector<Piece> pieces_;
    double way_mm_ = 0;
};

}  // namespace planlight
