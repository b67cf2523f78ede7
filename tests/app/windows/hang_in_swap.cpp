// Loaded before the projector process (LD_PRELOAD): a graphics driver that hangs in the swap of its buffers from the
// moment on that the file $HANG_WHEN is there. For watch_darkness.
#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>

struct GLFWwindow;

extern "C" void glfwSwapBuffers(GLFWwindow* window) {
    const char* const file = std::getenv("HANG_WHEN");
    while (file != nullptr && access(file, F_OK) == 0) usleep(10000);
    static const auto swap = reinterpret_cast<void (*)(GLFWwindow*)>(dlsym(RTLD_NEXT, "glfwSwapBuffers"));
    swap(window);
}
