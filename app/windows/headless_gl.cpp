#include "app/windows/headless_gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <thread>

#include "planning_io/files/memory_need.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

void check(bool worked, const std::string& step) {
    if (!worked)
        throw DeviceError("Picture without display", step + " failed",
                          "Install the package libgl1-mesa-dri, which draws without any graphics card.");
}

/// The renderer without a card (Mesa's llvmpipe) ends the whole program where it is given no memory, so it is asked
/// before. Measured: 200 MiB in use, and address space for each of its threads' heaps besides.
void check_memory_to_draw() {
    constexpr std::size_t kMiB = std::size_t{1} << 20;
    check_memory("Drawing without display", 200 * kMiB, "Close other programs.");
    const std::size_t room = (700 + 96 * std::min<std::size_t>(std::thread::hardware_concurrency(), 32)) * kMiB;
    void* const at = mmap(nullptr, room, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (at == MAP_FAILED)
        throw Error(
            ExitCode::disk,
            fmt::format("Drawing without display needs {} MiB of address space, which are not to be had", room / kMiB),
            "Raise the limit of address space (`ulimit -v`).");
    munmap(at, room);
}

struct Context {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    EGLSurface surface = EGL_NO_SURFACE;

    Context(int width, int height) {
        const auto get_display =
            reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
        check(get_display != nullptr, "eglGetPlatformDisplayEXT");
        display = get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
        check(display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE, "eglInitialize");
        eglBindAPI(EGL_OPENGL_API);
        const EGLint wanted[] = {EGL_RENDERABLE_TYPE,
                                 EGL_OPENGL_BIT,
                                 EGL_SURFACE_TYPE,
                                 EGL_PBUFFER_BIT,
                                 EGL_RED_SIZE,
                                 8,
                                 EGL_GREEN_SIZE,
                                 8,
                                 EGL_BLUE_SIZE,
                                 8,
                                 EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        check(eglChooseConfig(display, wanted, &config, 1, &count) == EGL_TRUE && count > 0, "eglChooseConfig");
        const EGLint size[] = {EGL_WIDTH, width, EGL_HEIGHT, height, EGL_NONE};
        surface = eglCreatePbufferSurface(display, config, size);
        const EGLint version[] = {
            EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
        context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
        check(context != EGL_NO_CONTEXT, "eglCreateContext");
        check(eglMakeCurrent(display, surface, surface, context) == EGL_TRUE, "eglMakeCurrent");
    }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() {
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display, context);
        eglDestroySurface(display, surface);
    }
};

}  // namespace

std::shared_ptr<void> headless_gl(int width, int height) {
    check_memory_to_draw();
    return std::make_shared<Context>(width, height);
}

}  // namespace planlight
