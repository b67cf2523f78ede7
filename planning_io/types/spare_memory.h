#pragma once

namespace planlight {

/// Gives back to the system what was freed and is kept for the next (`allocate_large`, and the C library's own):
/// between a step that took much memory and one that takes as much of another kind.
void release_spare_memory();

}  // namespace planlight
