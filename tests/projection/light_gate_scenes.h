#pragma once

#include <string>

#include "projection/light_gate.h"

// What CHECK may say of the light.
namespace planlight::test {

inline LightCheck seen_at(double off_mm, int seen = 40, int expected = 40) {
    LightCheck check;
    check.expected = expected;
    check.seen = seen;
    check.lit_seen = seen;
    check.off_mm = check.most_mm = off_mm;
    check.sigma_mm = 0.05;
    check.told_whole = true;
    return check;
}

inline ItemLight item(const std::string& name, int seen, int segments, double off_mm, bool lit = true) {
    ItemLight light;
    light.name = name;
    light.lit = lit;
    light.segments = segments;
    light.seen = seen;
    light.off_mm = off_mm;
    return light;
}

/// Updates 40 ms apart with the same measurement; the last ruling.
inline LightGate::Ruling after(LightGate& gate, Instant& now, int updates, const std::optional<LightCheck>& check,
                               bool lit = true) {
    LightGate::Ruling ruling;
    for (int i = 0; i < updates; ++i) ruling = gate.step(now += std::chrono::milliseconds(40), lit, check);
    return ruling;
}

}  // namespace planlight::test
