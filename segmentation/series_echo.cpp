#include "segmentation/series_echo.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "planning_io/types/statistics.h"
#include "segmentation/distance_transform.h"
#include "segmentation/head_survey.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr int kSize = 128;  // of the cube that is transformed
constexpr double kStep_mm = 2;
constexpr double kTaper_mm = 24;  // to the volume's ends: they are no edges of the head
constexpr double kLeast_mm = 5, kMost_mm = 24, kAside_mm = 6;
constexpr int kFirst = 4, kLast = 50;  // of the frequencies that are used, cycles over the cube
constexpr double kOverNoise = 6;       // power at which a frequency still counts
constexpr double kLeastLog = -3, kMostLog = 2;

constexpr double kLeastStrength = 0.25, kLeastRatio = 1.5;
constexpr double kThick_mm = 3.4;  // values between thick slices are a ripple of their own

using Spectrum = std::vector<std::complex<float>>;

std::size_t at(int i, int j, int k) {
    constexpr int m = kSize - 1;
    return (static_cast<std::size_t>(k & m) * kSize + static_cast<std::size_t>(j & m)) * kSize +
           static_cast<std::size_t>(i & m);
}

/// Along each axis; forwards and backwards differ in no way that matters to a power.
void transform(Spectrum& cube) {
    for (const std::size_t stride : {std::size_t{1}, std::size_t{kSize}, std::size_t{kSize} * kSize})
        tbb::parallel_for(0, kSize, [&](int slab) {
            Eigen::FFT<float> fft;
            std::vector<std::complex<float>> line(kSize), turned(kSize);
            for (int row = 0; row < kSize; ++row) {
                const std::size_t first = stride == 1       ? at(0, row, slab)
                                          : stride == kSize ? at(row, 0, slab)
                                                            : at(row, slab, 0);
                for (std::size_t n = 0; n < kSize; ++n) line[n] = cube[first + n * stride];
                fft.fwd(turned, line);
                for (std::size_t n = 0; n < kSize; ++n) cube[first + n * stride] = turned[n];
            }
        });
}

/// The survey's values in a cube, its brightest cut, faded out towards the volume's ends.
Spectrum cube_of(const HeadSurvey& survey) {
    const std::vector<float> from_end = distance_from(survey.measured, 0, survey.grid, kTaper_mm);
    std::vector<float> shown;
    for (std::size_t v = 0; v < survey.values.size(); v += 5)
        if (survey.measured[v]) shown.push_back(survey.values[v]);
    const float most = quantile(std::move(shown), 0.98);
    Spectrum cube(std::size_t{kSize} * kSize * kSize, 0);
    for (std::size_t v = 0; v < survey.values.size(); ++v) {
        if (!survey.measured[v]) continue;
        const int i = static_cast<int>(v % survey.grid.row()), k = static_cast<int>(v / survey.grid.slab()),
                  j = static_cast<int>(v / survey.grid.row()) % survey.grid.size[1];
        float ends_mm = from_end[v];
        const std::array<int, 3> place{i, j, k};
        for (std::size_t a = 0; a < 3; ++a)
            ends_mm = std::min(ends_mm, static_cast<float>(kStep_mm) *
                                            static_cast<float>(std::min(place[a] + 1, survey.grid.size[a] - place[a])));
        const float share = std::min(1.0F, ends_mm / static_cast<float>(kTaper_mm));
        cube[at(i, j, k)] += std::min(survey.values[v], most) * share * share * (3 - 2 * share);
    }
    return cube;
}

int folded(int n) {
    return n < kSize / 2 ? n : n - kSize;
}

/// Calls `visit(index, distance from the middle)` for each place of the cube.
template <class Visit>
void for_places(Visit&& visit) {
    for (int k = 0; k < kSize; ++k)
        for (int j = 0; j < kSize; ++j)
            for (int i = 0; i < kSize; ++i)
                visit(at(i, j, k), std::sqrt(static_cast<double>(folded(i) * folded(i) + folded(j) * folded(j) +
                                                                 folded(k) * folded(k))));
}

/// The logarithm of the power, less its mean at that frequency; 0 where it is not used. False where too little rises
/// above the noise.
bool whiten(Spectrum& cube) {
    std::array<double, kSize> sum{}, count{};
    for_places([&](std::size_t v, double frequency) {
        const double power = std::log(static_cast<double>(std::norm(cube[v])) + 1e-12);
        cube[v] = static_cast<float>(power);
        const auto shell = static_cast<std::size_t>(std::min(frequency + 0.5, kSize - 1.0));
        sum[shell] += power;
        count[shell] += 1;
    });
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] /= std::max(count[n], 1.0);
    const double noise = sum[kSize / 2 - 1];
    int last = kFirst;
    while (last < kLast && sum[static_cast<std::size_t>(last)] > noise + std::log(kOverNoise)) ++last;
    double used = 0;
    for_places([&](std::size_t v, double frequency) {
        const bool counts = frequency >= kFirst && frequency <= last;
        const double over =
            static_cast<double>(cube[v].real()) - sum[static_cast<std::size_t>(std::min(frequency + 0.5, kSize - 1.0))];
        cube[v] = counts ? static_cast<float>(std::clamp(over, kLeastLog, kMostLog)) : 0;
        used += counts;
    });
    for (auto& value : cube) value /= static_cast<float>(used);
    return last >= 20;
}

}  // namespace

bool SeriesEcho::is_movement() const {
    return strength > kLeastStrength && ratio > kLeastRatio;
}

std::optional<SeriesEcho> strongest_echo(const Volume& volume) {
    if (volume.spacing_mm().maxCoeff() > kThick_mm) return std::nullopt;
    SurveySettings settings;
    settings.step_mm = kStep_mm;
    const HeadSurvey survey = survey_of(volume, settings);
    Spectrum cube = cube_of(survey);
    transform(cube);
    if (!whiten(cube)) return std::nullopt;
    transform(cube);
    SeriesEcho echo;
    const int reach = static_cast<int>(kMost_mm / kStep_mm);
    const auto each = [&](auto&& visit) {
        for (int k = -reach; k <= reach; ++k)
            for (int j = -reach; j <= reach; ++j)
                for (int i = -reach; i <= reach; ++i) {
                    const Vector3d shift = kStep_mm * Vector3d(i, j, k);
                    if (shift.norm() >= kLeast_mm && shift.norm() <= kMost_mm)
                        visit(shift, static_cast<double>(cube[at(i, j, k)].real()));
                }
    };
    each([&](const Vector3d& shift, double height) {
        if (height > echo.strength) echo.strength = height, echo.shift_in_ct = shift;
    });
    double beside = 1e-6;
    each([&](const Vector3d& shift, double height) {
        const double apart = std::min((shift - echo.shift_in_ct).norm(), (shift + echo.shift_in_ct).norm());
        if (apart > kAside_mm) beside = std::max(beside, height);
    });
    echo.ratio = echo.strength / beside;
    return echo;
}

}  // namespace planlight
