#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace planlight {

/// The contents of the wanted regular files of a tar archive (gzip or plain), by their names without folders.
///
/// Nothing is written to the disk. The whole stream is read, so that gzip's checksum is verified. Throws InputError
/// when the file is no such archive, DamagedFileError when it is cut or damaged, or grows beyond all sense; an Error of
/// exit code 7 when less memory is free than `memory_times` an entry's size, which is what using it takes.
std::map<std::string, std::string> read_tar_entries(const std::filesystem::path& file,
                                                    const std::function<bool(const std::string& name)>& wanted,
                                                    std::uint64_t memory_times = 1,
                                                    std::uint64_t max_entry_bytes = std::uint64_t{4} << 30);

}  // namespace planlight
