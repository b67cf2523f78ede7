#pragma once

#include "app/evaluation/run_chain.h"

namespace planlight {

/// Runs the chain in every room, `jobs` rooms at a time; the figures come in the order of `rooms`.
/// `watcher_of(i)` is called on the thread that runs room i, `finished(i, figures)` one at a time.
/// Rooms that share a processor slow each other down: read updates a second with one job. The first exception is thrown
/// again when the rooms under way have ended.
std::vector<ChainFigures> run_rooms(const Volume& volume, const Case& the_case, const CaseDrawing& drawing,
                                    const std::vector<ChainSettings>& rooms, int jobs,
                                    const std::function<ChainWatcher(std::size_t)>& watcher_of,
                                    const std::function<void(std::size_t, const ChainFigures&)>& finished);

}  // namespace planlight
