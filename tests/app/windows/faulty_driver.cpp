// Loaded before the projector process (LD_PRELOAD), for watch_darkness: a graphics driver that hangs in the swap of its
// buffers from the moment on that the file $HANG_WHEN is there, or that has lost its context once $LOSE_CONTEXT_WHEN
// is: nothing is drawn, nothing is read back, no error is told, and buffers go on to be swapped.
#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

struct GLFWwindow;

namespace {

bool is_time(const char* name) {
    const char* const file = std::getenv(name);
    return file != nullptr && access(file, F_OK) == 0;
}

template <class... Values>
void unless_lost(const char* name, Values... values) {
    if (is_time("LOSE_CONTEXT_WHEN")) return;
    reinterpret_cast<void (*)(Values...)>(dlsym(RTLD_NEXT, name))(values...);
}

}  // namespace

extern "C" {
void glfwSwapBuffers(GLFWwindow* window) {
    while (is_time("HANG_WHEN")) usleep(10000);
    static const auto swap = reinterpret_cast<void (*)(GLFWwindow*)>(dlsym(RTLD_NEXT, "glfwSwapBuffers"));
    swap(window);
}
void glClear(unsigned mask) {
    unless_lost("glClear", mask);
}
void glDrawArrays(unsigned mode, int first, int count) {
    unless_lost("glDrawArrays", mode, first, count);
}
void glReadPixels(int x, int y, int width, int height, unsigned format, unsigned type, void* pixels) {
    if (is_time("LOSE_CONTEXT_WHEN") && std::getenv("READS_ZERO") != nullptr) std::memset(pixels, 0, 4);
    unless_lost("glReadPixels", x, y, width, height, format, type, pixels);
}
}
