#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace planlight::test {

/// What became of recordings whose programs were killed (SIGKILL) at random instants.
struct KilledWriters {
    int opened = 0;            ///< recordings that were read to their last whole chunk
    std::uint64_t chunks = 0;  ///< whole chunks in all of them
    int torn = 0;              ///< recordings with the beginning of a chunk at their end
    int ahead = 0;             ///< chunks that were handed over and not yet written, the most
    std::string fault;         ///< the first thing that was not as it should be; empty: none
};

/// `count` child processes write frames and events as fast as they can, each into a file of its own; each is killed
/// after 0 to 60 ms. The file must open, hold every chunk in order, and lack nothing that its writer said it had
/// written.
KilledWriters kill_writers(const std::filesystem::path& folder, int count, unsigned seed);

}  // namespace planlight::test
