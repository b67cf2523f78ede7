#pragma once

#include <string>
#include <vector>

#include "registration/scan/stripe_patterns.h"

namespace planlight::test {

/// White, black and a Gray code of columns with its inverses, as a capture of others may have it: no fringes, `bits` bits.
inline std::vector<StripePattern> gray_columns(int bits) {
    std::vector<StripePattern> patterns{{StripePattern::Kind::white, false, 0, "white"},
                                        {StripePattern::Kind::black, false, 0, "black"}};
    for (int bit = 0; bit < bits; ++bit) {
        const std::string name = "column-gray-" + std::to_string(bit);
        patterns.push_back({StripePattern::Kind::gray_bit, false, bit, name});
        patterns.push_back({StripePattern::Kind::gray_bit_inverse, false, bit, name + "-inverse"});
    }
    return patterns;
}

}  // namespace planlight::test
