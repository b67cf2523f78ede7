#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace planlight {

/// Runs `work(i)` for i in [0, count) on at most `threads` threads. Which thread does which is not fixed: each piece of
/// work must depend on i only.
template <class Work>
void parallel_for(int count, int threads, const Work& work) {
    std::atomic<int> next{0};
    const auto take_pieces = [&] {
        for (int i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> others;
    for (int t = 1; t < std::min(threads, count); ++t) others.emplace_back(take_pieces);
    take_pieces();
}

}  // namespace planlight
