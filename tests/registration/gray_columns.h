#pragma once

#include <utility>
#include <vector>

#include "registration/scan/pattern/stripe_patterns.h"

namespace planlight::test {

/// White, black and a Gray code of columns with its inverses, as a capture of others may have it: no fringes, `bits`
/// bits.
inline std::vector<StripePattern> gray_columns(int bits) {
    std::vector<StripePattern> patterns{{StripePattern::Kind::white, false, 0, "white"},
                                        {StripePattern::Kind::black, false, 0, "black"}};
    for (StripePattern& pattern : gray_patterns(bits, false, true)) patterns.push_back(std::move(pattern));
    return patterns;
}

}  // namespace planlight::test
