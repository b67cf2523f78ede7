#include "registration/scan/triangulate/triangulate.h"

#include <algorithm>
#include <cmath>

#include <stdexcept>

#include "registration/scan/triangulate/triangulate_matches.h"
#include "registration/scan/triangulate/triangulate_parts.h"

namespace planlight {

void check_views(const DecodedView& left, const DecodedView& right, const RigCalibration& rig) {
    if (left.row.empty() != right.row.empty())
        throw std::invalid_argument("triangulate: one view codes the rows, the other does not");
    for (const DecodedView* view : {&left, &right}) {
        const std::size_t pixels = static_cast<std::size_t>(view->width) * static_cast<std::size_t>(view->height);
        if (view->column.size() != pixels || view->sigma_px.size() != pixels ||
            (!view->row.empty() && view->row.size() != pixels))
            throw std::invalid_argument("triangulate: the arrays of a view do not have its size");
    }
    if (rig.projector.width < 1 || rig.projector.height < 1)
        throw std::invalid_argument("triangulate: the projector has no size");
}

Triangulation triangulate(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                          const TriangulationSettings& settings) {
    check_views(left, right, rig);
    if (left.row.empty()) return triangulate_columns(left, right, rig, settings);
    return triangulate_matches(match_views(left, right, rig, settings), rig, settings);
}

double usual_epipolar_px(const Triangulation& raw) {
    constexpr double kOneSigma = 0.683;
    std::vector<double> sizes;
    for (const auto& point : raw.by_cameras) sizes.push_back(std::abs(point.epipolar_px));
    if (sizes.empty()) return 0;
    const auto rank = sizes.begin() + static_cast<std::ptrdiff_t>(kOneSigma * static_cast<double>(sizes.size()));
    std::nth_element(sizes.begin(), rank, sizes.end());
    return *rank;
}

}  // namespace planlight
