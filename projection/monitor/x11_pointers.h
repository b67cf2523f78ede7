#pragma once

#include <X11/Xlib.h>

#include <memory>

namespace planlight {

/// Frees what Xlib handed over.
template <auto Free>
struct X11Free {
    template <class T>
    void operator()(T* pointer) const {
        Free(pointer);
    }
};
template <class T, auto Free>
using X11Pointer = std::unique_ptr<T, X11Free<Free>>;

/// A connection to the X server; null where there is none.
using X11Display = X11Pointer<Display, XCloseDisplay>;

}  // namespace planlight
