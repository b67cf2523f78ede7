#pragma once

#include <optional>
#include <string>

namespace planlight {

/// The patient's own.
enum class Side { left, right };

/// The side that a name claims: a word "left", "links", "sinister", "gauche" or "right", "rechts", "dexter", "droit(e)"
/// in any case, or a first or last word "L" or "R". Empty when there is none, or both. "L1" and "Rand" claim nothing.
std::optional<Side> side_named(const std::string& name);

}  // namespace planlight
