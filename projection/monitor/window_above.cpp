#include "projection/monitor/window_above.h"

#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#include <X11/extensions/shape.h>

#include <algorithm>
#include <chrono>
#include <span>
#include <vector>

#include "projection/monitor/x11_desktop.h"
#include "projection/monitor/x11_errors.h"
#include "projection/monitor/x11_pointers.h"

namespace planlight {
namespace {

constexpr auto kOrderLooks = std::chrono::milliseconds(20);  ///< how often a composited desktop is asked for its order

struct Rectangle {
    int x = 0, y = 0, width = 0, height = 0;

    bool meets(const Rectangle& o) const {
        return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
    }
};

struct Family {
    ::Window parent = None;
    std::vector<::Window> children;  ///< from the lowest up
};

Family family_of(Display* display, ::Window window) {
    Family family;
    ::Window root = None, *list = nullptr;
    unsigned count = 0;
    if (XQueryTree(display, window, &root, &family.parent, &list, &count) == 0) return family;
    const X11Pointer<::Window, XFree> owned(list);
    family.children.assign(list, list + count);
    return family;
}

/// Of a window, its bounding or input shape, in the root's frame.
bool shape_meets(Display* display, ::Window window, int kind, int x, int y, const Rectangle& wanted) {
    int count = 0, order = 0;
    const X11Pointer<XRectangle, XFree> list(XShapeGetRectangles(display, window, kind, &count, &order));
    const std::span parts(list.get(), static_cast<std::size_t>(count));
    return std::any_of(parts.begin(), parts.end(), [&](const XRectangle& part) {
        return Rectangle{x + part.x, y + part.y, part.width, part.height}.meets(wanted);
    });
}

/// Whether that child of the root is seen in a part of the rectangle. One over the whole root is what a compositor
/// draws all others into: of that one only what takes the mouse counts, a desktop's own bars.
bool covers(Display* display, ::Window window, const Rectangle& wanted) {
    XWindowAttributes a, root;
    if (XGetWindowAttributes(display, window, &a) == 0 || a.map_state != IsViewable || a.c_class != InputOutput)
        return false;
    if (XGetWindowAttributes(display, DefaultRootWindow(display), &root) == 0) return false;
    const Rectangle whole{a.x, a.y, a.width + 2 * a.border_width, a.height + 2 * a.border_width};
    if (!whole.meets(wanted)) return false;
    const bool over_all = a.x == 0 && a.y == 0 && a.width == root.width && a.height == root.height;
    return shape_meets(display, window, over_all ? ShapeInput : ShapeBounding, a.x + a.border_width,
                       a.y + a.border_width, wanted);
}

/// Whether, by the order of the root's children, a window lies before a part of this one.
bool is_below_another(Display* display, ::Window window) {
    forgive_errors_on(display);  // others set a handler of theirs
    const ::Window root = DefaultRootWindow(display);
    XWindowAttributes own;
    int x = 0, y = 0;
    ::Window child = None;
    if (XGetWindowAttributes(display, window, &own) == 0) return false;
    XTranslateCoordinates(display, window, root, 0, 0, &x, &y, &child);
    ::Window frame = window;  // of the window manager's, where it has one
    for (Family up = family_of(display, frame); up.parent != root; up = family_of(display, frame)) {
        if (up.parent == None) return false;
        frame = up.parent;
    }
    const std::vector<::Window> all = family_of(display, root).children;
    const auto at = std::find(all.begin(), all.end(), frame);
    return at != all.end() && std::any_of(at + 1, all.end(), [&](::Window other) {
               return covers(display, other, {x, y, own.width, own.height});
           });
}

}  // namespace

struct WindowAbove::Parts {
    Parts() = default;
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    X11Display connection;
    ::Window window = 0;
    bool obscured = false;  ///< as the window system told it last
    bool below = false;     ///< by the order of a composited desktop
    std::chrono::steady_clock::time_point order_looked_at{};

    ~Parts() {
        if (connection) forget_errors_on(connection.get());
    }

    void read_events() {
        while (XPending(connection.get()) > 0) {
            XEvent event;
            XNextEvent(connection.get(), &event);
            if (event.type == VisibilityNotify) obscured = event.xvisibility.state != VisibilityUnobscured;
        }
    }

    void look_at_order() {
        const auto now = std::chrono::steady_clock::now();
        if (now - order_looked_at < kOrderLooks) return;
        order_looked_at = now;
        below = is_composited(connection.get()) && is_below_another(connection.get(), window);
    }
};

WindowAbove::WindowAbove(GLFWwindow* window) : parts_(std::make_unique<Parts>()) {
    if (glfwGetX11Display() == nullptr) return;
    XSync(glfwGetX11Display(), False);  // the server knows the window then, also for another connection
    parts_->window = glfwGetX11Window(window);
    parts_->connection.reset(XOpenDisplay(DisplayString(glfwGetX11Display())));
    if (!parts_->connection) return;
    forgive_errors_on(parts_->connection.get());
    XSelectInput(parts_->connection.get(), parts_->window, VisibilityChangeMask);
    XSync(parts_->connection.get(), False);
}

WindowAbove::~WindowAbove() = default;

bool WindowAbove::look() {
    if (!parts_->connection) return false;
    parts_->read_events();
    parts_->look_at_order();
    return parts_->obscured || parts_->below;
}

void WindowAbove::raise() {
    if (!parts_->connection) return;
    XRaiseWindow(parts_->connection.get(), parts_->window);
    XFlush(parts_->connection.get());
}

}  // namespace planlight
