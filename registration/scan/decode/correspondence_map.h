#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "registration/scan/decode/decode_stripes.h"

namespace planlight {

/// The code around a camera pixel as an affine map, fitted to its neighbours (5 x 5).
struct Correspondence {
    Eigen::Vector2d code;      ///< projector pixel (column, row) at the centre pixel; row 0 when rows are not coded
    Eigen::Matrix2d by_pixel;  ///< its derivative by the camera pixel; second row zero when rows are not coded
    bool whole = false;        ///< every neighbour took part: no edge of an object, a shadow or the picture is near
    double sigma_px = 0;       ///< one standard deviation of `code`, projector pixels, from the noise alone
};

/// Fits the code around camera pixel (x, y). Empty where the pixel itself is not decoded, or has too few neighbours, or
/// where the neighbours do not lie on one smooth map (a depth edge, a hair, a glint).
std::optional<Correspondence> correspondence_at(const DecodedView& view, int x, int y);

/// The same without a copy: false, and `local` not to be used, where there is none.
bool fit_correspondence(const DecodedView& view, int x, int y, Correspondence& local);

/// Where in a view a projector pixel is seen: the inverse of the view's code.
class CorrespondenceIndex {
public:
    CorrespondenceIndex(const DecodedView& view, int projector_width, int projector_height);

    struct Match {
        Eigen::Vector2d code, pixel;    ///< as asked for, and where it is: sub-pixel
        Correspondence local;           ///< around the nearest whole pixel
        Eigen::Matrix2d pixel_by_code;  ///< inverse of its derivative
    };
    /// The sub-pixel place in the view that has this code; false when no smooth piece of code there contains it
    /// (`match` is then not to be used).
    bool find(const Eigen::Vector2d& code, Match& match) const;

    /// The same, searched from a place nearby; false also when the way there is broken.
    bool find_from(const Eigen::Vector2d& code, const Eigen::Vector2d& pixel, Match& match) const;

private:
    const DecodedView& view_;
    int columns_, rows_;  ///< cells
    std::vector<std::int32_t>
        pixel_in_;  ///< per cell of the projector's picture a camera pixel that sees it, -1 where none
};

}  // namespace planlight
