#pragma once

namespace planlight::test {

/// AddressSanitizer handles crashes itself, and takes address space without end: limits on either mean nothing then.
#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kUnderASanitizer = true;
#else
inline constexpr bool kUnderASanitizer = false;
#endif

}  // namespace planlight::test
