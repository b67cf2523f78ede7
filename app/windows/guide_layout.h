#pragma once

#include "app/windows/layout.h"

namespace planlight {

/// Where everything stands in the window of a guided calibration.
struct GuideLayout {
    float scale = 1;  ///< as that of the operator window of this size
    Box left, right, projector, progress, tilts, depths, buttons, banner;
};

/// For a window of that size, upright or on end; a small one is shrunk as the operator window is. `with_result`: there
/// are more words to stand in `progress`.
GuideLayout guide_layout(int width, int height, bool with_result);

}  // namespace planlight
