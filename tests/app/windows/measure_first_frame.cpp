// How long a person looks at nothing after a session was called for: from the start of the program until its window
// shows words. `xvfb-run -a -s "-screen 0 1920x1080x24" build/tests/app/windows/measure_first_frame TIMES PROGRAM ...`
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

using std::chrono::steady_clock;

/// Bright pixels on the screen: letters. An empty screen is black, and so is a window before its first frame.
bool shows_words(Display* display) {
    const Window root = DefaultRootWindow(display);
    XWindowAttributes size{};
    XGetWindowAttributes(display, root, &size);
    XImage* const picture = XGetImage(display, root, 0, 0, static_cast<unsigned>(size.width),
                                      static_cast<unsigned>(size.height), AllPlanes, ZPixmap);
    if (picture == nullptr) return false;
    long bright = 0;
    for (int y = 0; y < picture->height; y += 2)
        for (int x = 0; x < picture->width; x += 2) {
            const unsigned long pixel = XGetPixel(picture, x, y);
            bright += (pixel & 0xFF) > 120 && (pixel >> 8 & 0xFF) > 120 && (pixel >> 16 & 0xFF) > 120;
        }
    XDestroyImage(picture);
    return bright > 150;
}

/// Processor time of a process so far, and of its threads.
double processor_s(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 2)));
    std::string skipped;
    for (int i = 3; i < 14; ++i) fields >> skipped;
    double user = 0, system = 0;
    fields >> user >> system;
    return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

struct FirstFrame {
    double s = -1;  ///< below 0: nothing was seen in 20 s
    double processor_s = 0;
};

FirstFrame first_frame(char** command, Display* screen) {
    const auto began = steady_clock::now();
    const pid_t child = fork();
    if (child == 0) {
        execvp(command[0], command);
        _exit(127);
    }
    FirstFrame seen;
    while (seen.s < 0 && steady_clock::now() - began < std::chrono::seconds(20)) {
        const auto looked = steady_clock::now();
        const double used_s = processor_s(child);
        if (shows_words(screen)) seen = {std::chrono::duration<double>(looked - began).count(), used_s};
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(child, SIGTERM);
    waitpid(child, nullptr, 0);
    return seen;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        fmt::print(stderr, "measure_first_frame TIMES PROGRAM ARGUMENT...\n");
        return 2;
    }
    Display* const screen = XOpenDisplay(nullptr);
    if (screen == nullptr) {
        fmt::print(stderr, "There is no display: use xvfb-run.\n");
        return 5;
    }
    std::vector<double> times;
    for (int i = 0; i < std::stoi(argv[1]); ++i) {
        const FirstFrame seen = first_frame(argv + 2, screen);
        times.push_back(seen.s);
        fmt::print("first frame after {:.2f} s, {:.2f} s of a processor\n", seen.s, seen.processor_s);
        for (int k = 0; k < 100 && shows_words(screen); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    XCloseDisplay(screen);
    std::sort(times.begin(), times.end());
    const bool all = times.front() >= 0;
    fmt::print("{} starts: median {:.2f} s, worst {:.2f} s{}\n", times.size(), times[times.size() / 2], times.back(),
               all ? "" : "; in some nothing was seen");
    return all ? 0 : 6;
}
