#pragma once

// A function compiled for AVX-512, AVX2 and any x86-64; the processor's own is chosen when the program starts. With
// -DPLANLIGHT_BASELINE=ON only the last is compiled, to test it on any machine.
#ifndef PLANLIGHT_CLONES
#define PLANLIGHT_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
#define PLANLIGHT_INLINE inline __attribute__((always_inline))
