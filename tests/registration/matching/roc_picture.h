#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planlight::test {

/// One curve: trials that should be accepted against trials that must not be, by a number that should be high for the
/// first.
struct RocCurve {
    std::string name;
    std::vector<double> right, wrong;
};

/// A way to accept that has no number: the shares it takes.
struct RocPoint {
    std::string name;
    double right_share, wrong_share;
};

/// Shares accepted as the limit falls: x the wrong ones (logarithmic; the first mark is "none"), y the right ones; the
/// points are ringed. PNG, 1100 x 800. Throws std::runtime_error when it cannot be written.
void write_roc(const std::vector<RocCurve>& curves, const std::vector<RocPoint>& points, const std::string& title,
               const std::filesystem::path& file);

/// Area under the curve: the probability that a right one has the higher number.
double area_under(const RocCurve& curve);

/// Share of the right ones above the limit that lets this share of the wrong ones pass (rounded down to whole ones).
double accepted_at(const RocCurve& curve, double wrong_share);

}  // namespace planlight::test
