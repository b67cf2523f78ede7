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

/// Below 0: nothing was seen in 20 s.
double first_frame_s(char** command, Display* screen) {
    const auto began = steady_clock::now();
    const pid_t child = fork();
    if (child == 0) {
        execvp(command[0], command);
        _exit(127);
    }
    double seen_s = -1;
    while (seen_s < 0 && steady_clock::now() - began < std::chrono::seconds(20)) {
        const auto looked = steady_clock::now();
        if (shows_words(screen)) seen_s = std::chrono::duration<double>(looked - began).count();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(child, SIGTERM);
    waitpid(child, nullptr, 0);
    return seen_s;
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
        times.push_back(first_frame_s(argv + 2, screen));
        fmt::print("first frame after {:.2f} s\n", times.back());
        for (int k = 0; k < 100 && shows_words(screen); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    XCloseDisplay(screen);
    std::sort(times.begin(), times.end());
    const bool all = times.front() >= 0;
    fmt::print("{} starts: median {:.2f} s, worst {:.2f} s{}\n", times.size(), times[times.size() / 2], times.back(),
               all ? "" : "; in some nothing was seen");
    return all ? 0 : 6;
}
