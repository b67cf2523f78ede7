#pragma once

#include <initializer_list>
#include <string>

namespace planlight {

/// An error with one decimal, as every sentence, table and banner says it: one over a limit never reads as the limit
/// itself ("2.0" of 2.02 where 2 is the limit), but as the next tenth over it; never "-0.0". Unit: that of `value`.
std::string error_figure(double value, std::initializer_list<double> limits);

}  // namespace planlight
