#include "app/evaluation/log_histogram.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace planlight {
namespace {

constexpr double kWidth = 0.01;       ///< of a bin, in the natural logarithm
constexpr double kLeast = 1e-9;       ///< what is smaller counts as this
constexpr int kNoNumber = 1'000'000;  ///< NaN and infinity: they sort last

int bin_of(double value) {
    if (!std::isfinite(value)) return kNoNumber;
    return static_cast<int>(std::floor(std::log(std::max(std::abs(value), kLeast)) / kWidth));
}

double middle_of(int bin) {
    if (bin == kNoNumber) return std::numeric_limits<double>::quiet_NaN();
    if (bin == bin_of(0)) return 0;
    return std::exp((bin + 0.5) * kWidth);
}

template <class Number>
Number number(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) throw std::invalid_argument("no histogram");
    return value;
}

}  // namespace

void LogHistogram::add(double value) {
    ++bins_[bin_of(value)];
    ++count_;
    if (std::isnan(value) || std::abs(value) > worst_) worst_ = std::abs(value);
}

void LogHistogram::add(const LogHistogram& other) {
    for (const auto& [bin, count] : other.bins_) bins_[bin] += count;
    count_ += other.count_;
    if (std::isnan(other.worst_) || other.worst_ > worst_) worst_ = other.worst_;
}

double LogHistogram::quantile(double share) const {
    const auto rank =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(share * static_cast<double>(count_))));
    std::size_t seen = 0;
    for (const auto& [bin, count] : bins_)
        if ((seen += count) >= rank) return std::isnan(worst_) ? middle_of(bin) : std::min(middle_of(bin), worst_);
    return 0;
}

Distribution LogHistogram::distribution() const {
    if (count_ == 0) return {};
    return {count_, quantile(0.5), quantile(0.95), worst_};
}

std::string LogHistogram::text() const {
    std::string text;
    for (const auto& [bin, count] : bins_) text += fmt::format("{}:{} ", bin, count);
    return text + fmt::format("<={}", worst_);
}

LogHistogram LogHistogram::from_text(const std::string& text) {
    LogHistogram histogram;
    std::istringstream in(text);
    bool ended = false;
    for (std::string word; in >> word;) {
        if (ended) throw std::invalid_argument("no histogram");
        if (word.starts_with("<=")) {
            histogram.worst_ = word == "<=nan" || word == "<=-nan" ? std::numeric_limits<double>::quiet_NaN()
                                                                   : number<double>(std::string_view(word).substr(2));
            ended = true;
            continue;
        }
        const auto colon = word.find(':');
        if (colon == std::string::npos) throw std::invalid_argument("no histogram");
        const auto count = number<std::size_t>(std::string_view(word).substr(colon + 1));
        histogram.bins_[number<int>(std::string_view(word).substr(0, colon))] += count;
        histogram.count_ += count;
    }
    if (!ended) throw std::invalid_argument("no histogram");
    return histogram;
}

LogHistogram histogram_of(const std::vector<double>& values) {
    LogHistogram histogram;
    for (const double value : values) histogram.add(value);
    return histogram;
}

}  // namespace planlight
