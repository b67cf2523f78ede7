#pragma once

#include <cstdint>

namespace planlight::simulation {

/// A well-mixed function of 64 bits (splitmix64, Steele 2014): noise that depends on where and when, not on the order
/// of work.
inline std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
}

}  // namespace planlight::simulation
