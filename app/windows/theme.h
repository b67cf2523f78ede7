#pragma once

#include <imgui.h>

#include <array>

#include "app/windows/window_settings.h"

namespace planlight {

/// How the banner of one status looks.
struct BannerLook {
    ImU32 fill, edge, shape, text, strong;
};

/// The colours of a window, by what they are for. Pictures of cameras and the 3-D view are dark in every theme, as
/// pictures are read: what is written on them has the colours of the dark one.
struct Theme {
    ImU32 background, panel, edge, text, quiet;
    ImU32 green, amber, red, blue;  ///< of figures, marks and words on a panel
    ImU32 active, control, hovered, control_edge, leads_edge, disabled, disabled_text;
    ImU32 done;                                        ///< the disc of a step that is done, with a white tick
    ImU32 badge, badge_edge, badge_text, badge_quiet;  ///< what stands out most: DARK, the side of the plan
    ImU32 badge_hovered, badge_held;
    ImU32 swatch_edge;                 ///< round a plan item's own colour
    std::array<BannerLook, 8> banner;  ///< in the order of `StatusKind`
    BannerLook notice;                 ///< an answer to a press, a question
};

const Theme& theme_of(ThemeKind kind);

/// Of words and marks on a picture, in every theme.
inline const Theme& on_pictures() {
    return theme_of(ThemeKind::dark);
}

}  // namespace planlight
