#pragma once

#include <vector>

namespace planlight {

/// The cells of a code (projector pixels, NaN where there is none; `width` x `height`) smoothed: `code` becomes the
/// value of the plane through the cells round each pixel, up to `reach` pixels away and without those beyond a jump of
/// four cells. NaN where fewer than four in ten have a part in it, or the plane is more than a cell and a half off.
/// `code` has the size of `cells`.
void smooth_cells(const std::vector<float>& cells, int width, int height, int reach, float cell_px,
                  std::vector<float>& code);

}  // namespace planlight
