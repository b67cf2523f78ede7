#include "segmentation/bias_field.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "planning_io/types/statistics.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

using Row = Eigen::Matrix<double, 10, 1>;

constexpr std::size_t kSamples = 300000;
constexpr std::size_t kLeastTissue = 1000;
constexpr int kRounds = 12;
constexpr double kSettled = 0.005;  // of a factor: no voxel of the skin moves by it
constexpr double kOutlying = 2.5;   // deviations

double unit(int i, int size) {
    return size > 1 ? 2.0 * i / (size - 1) - 1 : 0;
}

Row terms(double x, double y, double z) {
    Row row;
    row << 1, x, y, z, x * x, y * y, z * z, x * y, x * z, y * z;
    return row;
}

struct Sample {
    Row terms;
    double log_value = 0;
};

/// Evenly through the volume, those that are greater than zero.
std::vector<Sample> samples_of(const Volume& volume) {
    std::size_t count = 1;
    for (const int n : volume.size) count *= static_cast<std::size_t>(n);
    const int stride =
        std::max(1, static_cast<int>(std::cbrt(static_cast<double>(count) / static_cast<double>(kSamples))));
    std::vector<Sample> samples;
    for (int k = stride / 2; k < volume.size[2]; k += stride)
        for (int j = stride / 2; j < volume.size[1]; j += stride)
            for (int i = stride / 2; i < volume.size[0]; i += stride)
                if (const double value = static_cast<double>(volume.at(i, j, k)); value > 0 && std::isfinite(value))
                    samples.push_back({terms(unit(i, volume.size[0]), unit(j, volume.size[1]), unit(k, volume.size[2])),
                                       std::log(value)});
    return samples;
}

/// The polynomial nearest to the tissue's logarithms. `row` is a voxel of the tissue with what the polynomial leaves
/// there.
Row fitted(const std::vector<const Sample*>& tissue) {
    Eigen::Matrix<double, 10, 10> normal =
        1e-6 * static_cast<double>(tissue.size()) * Eigen::Matrix<double, 10, 10>::Identity();
    Row right = Row::Zero();
    for (const Sample* s : tissue) {
        normal.noalias() += s->terms * s->terms.transpose();
        right += s->log_value * s->terms;
    }
    return normal.ldlt().solve(right);
}

/// What lies over the threshold with `log_bias` taken out; far outlying values (fat, marrow, vessels) are left out.
std::vector<const Sample*> tissue_of(const std::vector<Sample>& samples, const Row& log_bias) {
    Volume line;  // the samples as a volume, for the threshold of its histogram
    line.size = {static_cast<int>(samples.size()), 1, 1};
    line.values.reserve(samples.size());
    std::vector<double> level;
    for (const Sample& s : samples)
        line.values.push_back(static_cast<float>(std::exp(s.log_value - s.terms.dot(log_bias))));
    const double threshold = skin_threshold(line);
    std::vector<const Sample*> over;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (static_cast<double>(line.values[i]) >= threshold) {
            over.push_back(&samples[i]);
            level.push_back(samples[i].log_value - samples[i].terms.dot(log_bias));
        }
    if (over.size() < kLeastTissue) return {};
    const double middle = median(level);
    std::vector<double> off;
    for (const double l : level) off.push_back(std::abs(l - middle));
    const double most = kOutlying * 1.4826 * median(off) + 1e-9;
    std::vector<const Sample*> tissue;
    for (std::size_t i = 0; i < over.size(); ++i)
        if (std::abs(level[i] - middle) <= most) tissue.push_back(over[i]);
    return tissue;
}

}  // namespace

double BiasField::ratio() const {
    return std::exp(log_high - log_low);
}

BiasField fit_bias(const Volume& volume) {
    const std::vector<Sample> samples = samples_of(volume);
    if (samples.size() < kLeastTissue) return {};
    Row log_bias = Row::Zero();
    std::vector<double> over_tissue;
    for (int round = 0; round < kRounds; ++round) {
        const auto tissue = tissue_of(samples, log_bias);
        if (tissue.size() < kLeastTissue) return {};
        Row next = fitted(tissue);
        over_tissue.clear();
        double mean = 0;
        for (const Sample* s : tissue) over_tissue.push_back(s->terms.dot(next));
        for (const double l : over_tissue) mean += l / static_cast<double>(over_tissue.size());
        next[0] -= mean;
        for (double& l : over_tissue) l -= mean;
        const double change = (next - log_bias).cwiseAbs().maxCoeff();
        log_bias = next;
        if (change < kSettled) break;
    }
    BiasField bias;
    std::copy(log_bias.begin(), log_bias.end(), bias.log_coefficients.begin());
    std::sort(over_tissue.begin(), over_tissue.end());
    bias.log_low = over_tissue[over_tissue.size() / 200];
    bias.log_high = over_tissue[over_tissue.size() - 1 - over_tissue.size() / 200];
    return bias;
}

Volume without_bias(Volume volume, const BiasField& bias) {
    const Row log_bias = Eigen::Map<const Row>(bias.log_coefficients.data());
    tbb::parallel_for(0, volume.size[2], [&](int k) {
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const double at =
                    log_bias.dot(terms(unit(i, volume.size[0]), unit(j, volume.size[1]), unit(k, volume.size[2])));
                volume.values[volume.index(i, j, k)] *=
                    static_cast<float>(std::exp(-std::clamp(at, bias.log_low, bias.log_high)));
            }
    });
    return volume;
}

}  // namespace planlight
