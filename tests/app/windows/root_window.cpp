#include "root_window.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "write_picture.h"

namespace planlight::test {
namespace {

int& failed() {
    static int count = 0;
    return count;
}

}  // namespace

void expect(bool fact, const std::string& what) {
    fmt::print("{} {}\n", fact ? "ok  " : "FAIL", what);
    std::fflush(stdout);
    if (!fact) ++failed();
}

int failures() {
    return failed();
}

RgbImage screen(const std::string& folder, const std::string& name) {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    const std::string file = folder + "/" + name + ".ppm";
    if (std::system(("import -window root -depth 8 " + file).c_str()) != 0) throw std::runtime_error("import failed");
    return read_picture(file);
}

/// How many pixels of the monitor differ from `wanted`.
long different(const RgbImage& root, const Monitor& monitor, const RgbImage& wanted) {
    long count = 0;
    for (int y = 0; y < monitor.height; ++y)
        for (int x = 0; x < monitor.width; ++x)
            if (root.at(monitor.x + x, monitor.y + y) != wanted.at(x, y)) ++count;
    return count;
}

}  // namespace planlight::test
