#pragma once

namespace planlight {

/// Whether a compositor draws the desktop's windows (EWMH, _NET_WM_CM_Sn): what is asked of a window then is not what
/// is seen. False where there is no X display.
bool desktop_is_composited();

/// Whether it is a Wayland desktop, whose X server does not know what is seen of its windows; `ProjectorWindow` refuses
/// it.
bool desktop_is_wayland();

}  // namespace planlight
