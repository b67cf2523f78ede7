#pragma once

#include <optional>
#include <string>

namespace planlight {

/// The patient's own.
enum class Side { left, right };

/// The side that a name (UTF-8) claims, by a word in any case: in English, German, Latin, French, Spanish, Portuguese,
/// Italian, Dutch, the Scandinavian languages, Polish, Czech, Russian, Ukrainian, Turkish, Arabic, Chinese, Japanese or
/// Korean; or by a first or last word "L" or "R", or a last word "li" or "re", "lt" or "rt", "sin" or "dx". Empty when
/// there is none, or both. "L1" and "Rand" claim nothing, nor does any word of another language.
std::optional<Side> side_named(const std::string& name);

}  // namespace planlight
