#include "app/evaluation/run_rooms.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace planlight {

std::vector<ChainFigures> run_rooms(const Volume& volume, const Case& the_case, const CaseDrawing& drawing,
                                    const std::vector<ChainSettings>& rooms, int jobs,
                                    const std::function<ChainWatcher(std::size_t)>& watcher_of,
                                    const std::function<void(std::size_t, const ChainFigures&)>& finished) {
    std::vector<ChainFigures> figures(rooms.size());
    std::atomic<std::size_t> next{0};
    std::mutex one_at_a_time;
    std::exception_ptr failed;
    const auto work = [&] {
        for (std::size_t i = next++; i < rooms.size(); i = next++) try {
                figures[i] = run_chain(volume, the_case, drawing, rooms[i], watcher_of(i));
                const std::lock_guard lock(one_at_a_time);
                finished(i, figures[i]);
            } catch (...) {
                const std::lock_guard lock(one_at_a_time);
                if (!failed) failed = std::current_exception();
                next = rooms.size();
            }
    };
    std::vector<std::thread> others;
    for (int i = 1; i < std::min(jobs, static_cast<int>(rooms.size())); ++i) others.emplace_back(work);
    work();
    for (auto& other : others) other.join();
    if (failed) std::rethrow_exception(failed);
    return figures;
}

}  // namespace planlight
