#pragma once

namespace planlight {

/// What this process does with memory that it frees (glibc).
///
/// Volumes and pictures come and go by the dozen; memory that is handed back to the system each time costs a page fault
/// for every 4 KiB when it is asked for again. To be called before there are threads.
void keep_freed_memory();

/// Of what runs for hours: large blocks are handed back at once. Kept, small things come to lie between them, and what
/// is kept grows by a megabyte a minute (registration/devices/ACCURACY.md).
void hand_large_blocks_back();

}  // namespace planlight
