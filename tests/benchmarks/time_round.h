#pragma once

#include <chrono>
#include <ctime>
#include <functional>
#include <vector>

namespace planlight::test {

/// Runs it once and adds how long that took: seconds by the wall, and of the processor, all threads.
inline void time_round(const std::function<void()>& run, std::vector<double>& wall_s,
                       std::vector<double>& processor_s) {
    const auto began = std::chrono::steady_clock::now();
    const std::clock_t began_processor = std::clock();
    run();
    wall_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    processor_s.push_back(static_cast<double>(std::clock() - began_processor) / CLOCKS_PER_SEC);
}

}  // namespace planlight::test
