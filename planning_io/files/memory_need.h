#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace planlight {

/// Memory that this process may still take, in bytes: the least of what the machine has left (with swap), of the limit
/// of its control group (a container's), and of its own limits (`ulimit -v`, `ulimit -d`). Those that cannot be read do
/// not count.
std::uint64_t free_memory_bytes();

/// The most memory that this process ever had, in bytes.
std::uint64_t most_memory_used_bytes();

/// Throws an Error (exit 7) that says the need and what is free, both in MiB, when `need_bytes` is more than
/// `free_memory_bytes()`. `doing` begins a sentence: "FILE: reading it".
void check_memory(const std::string& doing, std::uint64_t need_bytes, const std::string& remedy);

}  // namespace planlight
