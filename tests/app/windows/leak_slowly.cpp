// A library that leaks in the process it is loaded into (LD_PRELOAD): 200 KiB a second with LEAK=memory, a descriptor a
// second with LEAK=descriptors. That measure_long_session.sh notices is proved with it; nothing of the product has it.
// Children do not inherit it.
#include <fcntl.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

namespace {

void leak(const std::string& what) {
    constexpr std::size_t kBytes = 200 * 1024;
    for (;;) {
        std::this_thread::sleep_for(std::chrono::seconds(1));
        if (what == "descriptors" && open("/dev/null", O_RDONLY | O_CLOEXEC) < 0) return;  // never closed
        void* const never_freed = what == "memory" ? std::malloc(kBytes) : nullptr;
        if (never_freed) std::memset(never_freed, 1, kBytes);
    }
}

[[gnu::constructor]] void begin() {
    unsetenv("LD_PRELOAD");
    if (const char* what = std::getenv("LEAK")) std::thread(leak, std::string(what)).detach();
}

}  // namespace
