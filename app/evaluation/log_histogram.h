#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "app/evaluation/distribution.h"

namespace planlight {

/// A sample of values from 0 up, counted in bins one per cent wide, so that the samples of many runs can be joined:
/// count and worst of the whole are exact, median and 95th percentile right to half a per cent.
class LogHistogram {
public:
    void add(double value);
    void add(const LogHistogram& other);
    /// What is left of the sample: quantiles by the same rule of rank as `distribution_of`.
    Distribution distribution() const;

    /// The value below which that share of the sample lies, to half a per cent; 0 when it is empty.
    double quantile(double share) const;

    /// "BIN:COUNT BIN:COUNT ...", and the worst value behind "<=". Throws std::invalid_argument for a text that is
    /// none.
    std::string text() const;
    static LogHistogram from_text(const std::string& text);

private:
    std::map<int, std::size_t> bins_;
    std::size_t count_ = 0;
    double worst_ = 0;
};

LogHistogram histogram_of(const std::vector<double>& values);

}  // namespace planlight
