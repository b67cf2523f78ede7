#pragma once

#include <filesystem>
#include <functional>

#include "planning_io/types/series_identity.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// What `parse` makes of the file or folder `path`, parsed in a child process (sandboxed_process.h) with 4 GiB of
/// memory, 1 s of processor and 1 s more for each MB to read, 300 s of waiting. A parser that crashes or hangs costs
/// the child: it becomes a DamagedFileError here; an Error of its own comes through. What `parse` writes to `identity`
/// comes back, too.
Volume volume_in_child(const std::filesystem::path& path, const std::function<Volume()>& parse,
                       SeriesIdentity* identity = nullptr);

}  // namespace planlight
