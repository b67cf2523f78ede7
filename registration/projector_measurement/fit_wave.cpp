#include "registration/projector_measurement/fit_wave.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd as_vector(const std::vector<double>& values) {
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

/// Columns: one, straight line, cosine and sine of each frequency.
MatrixXd columns_of(const std::vector<double>& at_s, const std::vector<double>& hz) {
    const VectorXd t = as_vector(at_s).array() - as_vector(at_s).mean();
    MatrixXd X(t.size(), 2 + 2 * static_cast<Index>(hz.size()));
    X.col(0).setOnes();
    X.col(1) = t / std::max(1e-9, t.cwiseAbs().maxCoeff());
    for (std::size_t i = 0; i < hz.size(); ++i) {
        const auto phase = (2 * M_PI * hz[i] * t).array();
        X.col(2 + 2 * static_cast<Index>(i)) = phase.cos();
        X.col(3 + 2 * static_cast<Index>(i)) = phase.sin();
    }
    return X;
}

Covariance covariance_of(const VectorXd& a, const VectorXd& b, double freedom) {
    const double ab = a.dot(b), aa = a.squaredNorm(), bb = b.squaredNorm();
    Covariance c;
    c.common = ab / freedom;
    c.sigma = std::sqrt((aa * bb / (freedom * freedom) + c.common * c.common) / freedom);
    c.correlation = aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
    return c;
}

/// Columns that are as good as a sum of others count for nothing.
constexpr double kCollinear = 1e-3;

/// One least-squares fit of both halves.
struct Solved {
    VectorXd of_a, of_b;      ///< coefficients
    VectorXd left_a, left_b;  ///< residuals
    double freedom = 1;
};

Solved solve(const MatrixXd& X, const PairedTrace& trace) {
    Eigen::ColPivHouseholderQR<MatrixXd> qr(X);
    qr.setThreshold(kCollinear);
    Solved s;
    const VectorXd a = as_vector(trace.a), b = as_vector(trace.b);
    s.of_a = qr.solve(a), s.of_b = qr.solve(b);
    s.left_a = a - X * s.of_a, s.left_b = b - X * s.of_b;
    s.freedom = static_cast<double>(std::max<Index>(1, X.rows() - qr.rank()));
    return s;
}

/// Every frame's part of a turn of `hz`: half the way to the phases beside it.
VectorXd parts_of_turn(const std::vector<double>& at_s, double hz) {
    std::vector<std::pair<double, Index>> phases;
    for (std::size_t i = 0; i < at_s.size(); ++i) {
        const double turns = (at_s[i] - at_s.front()) * hz;
        phases.emplace_back(turns - std::floor(turns), static_cast<Index>(i));
    }
    std::sort(phases.begin(), phases.end());
    VectorXd parts(static_cast<Index>(at_s.size()));
    for (std::size_t i = 0; i < phases.size(); ++i) {
        const double before = i > 0 ? phases[i - 1].first : phases.back().first - 1,
                     after = i + 1 < phases.size() ? phases[i + 1].first : phases.front().first + 1;
        parts[phases[i].second] = (after - before) / 2;
    }
    return parts;
}

WaveFit fitted(const PairedTrace& trace, const std::vector<double>& waves_hz, const std::vector<double>& beside_hz) {
    std::vector<double> all_hz = waves_hz;
    all_hz.insert(all_hz.end(), beside_hz.begin(), beside_hz.end());
    const MatrixXd X = columns_of(trace.at_s, all_hz);
    const Solved s = solve(X, trace);
    const VectorXd parts = parts_of_turn(trace.at_s, waves_hz.front());
    const auto counted = 2 * static_cast<Index>(waves_hz.size());
    const auto waves = X.middleCols(2, counted);
    const VectorXd of_a = s.of_a.segment(2, counted), of_b = s.of_b.segment(2, counted);
    const VectorXd wave_a = waves * of_a, wave_b = waves * of_b;
    const double rest_a = parts.dot(s.left_a), rest_b = parts.dot(s.left_b);
    WaveFit fit;
    fit.mean = (s.of_a[0] + s.of_b[0] + rest_a + rest_b) / 2;
    fit.variance =
        of_a.dot(of_b) / 2 - rest_a * rest_b +
        parts.dot(wave_a.cwiseProduct(s.left_b) + wave_b.cwiseProduct(s.left_a) + s.left_a.cwiseProduct(s.left_b));
    fit.left_over = covariance_of(s.left_a, s.left_b, s.freedom);
    return fit;
}

PairedTrace without(const PairedTrace& trace, std::size_t from, std::size_t to) {
    PairedTrace rest;
    for (std::size_t i = 0; i < trace.at_s.size(); ++i) {
        if (i >= from && i < to) continue;
        rest.at_s.push_back(trace.at_s[i]);
        rest.a.push_back(trace.a[i]);
        rest.b.push_back(trace.b[i]);
    }
    return rest;
}

}  // namespace

WaveFit fit_wave(const PairedTrace& trace, const std::vector<double>& waves_hz, const std::vector<double>& beside_hz) {
    WaveFit fit = fitted(trace, waves_hz, beside_hz);
    constexpr std::size_t kStretches = 20;
    double mean = 0, means = 0, variance = 0, variances = 0;
    for (std::size_t k = 0; k < kStretches; ++k) {
        const std::size_t n = trace.at_s.size();
        const WaveFit less = fitted(without(trace, k * n / kStretches, (k + 1) * n / kStretches), waves_hz, beside_hz);
        const double m = less.mean - fit.mean, v = less.variance - fit.variance;
        mean += m / kStretches, means += m * m, variance += v / kStretches, variances += v * v;
    }
    const double share = (kStretches - 1.0) / kStretches;
    fit.mean_sigma = std::sqrt(std::max(0.0, share * (means - kStretches * mean * mean)));
    // Phases that were not met are missing from every stretch: what is assumed of them is what the harmonics differ in.
    const auto half = waves_hz.begin() + static_cast<std::ptrdiff_t>((waves_hz.size() + 1) / 2);
    const WaveFit coarse = fitted(trace, {waves_hz.begin(), half}, beside_hz);
    fit.variance_sigma = std::hypot(std::sqrt(std::max(0.0, share * (variances - kStretches * variance * variance))),
                                    fit.variance - coarse.variance);
    fit.mean_sigma = std::hypot(fit.mean_sigma, fit.mean - coarse.mean);
    return fit;
}

Covariance covariance_beside(const PairedTrace& trace, const std::vector<double>& beside_hz, double* mean) {
    const Solved s = solve(columns_of(trace.at_s, beside_hz), trace);
    if (mean) *mean = (s.of_a[0] + s.of_b[0]) / 2;
    return covariance_of(s.left_a, s.left_b, s.freedom);
}

std::optional<double> strongest_hz(const std::vector<PairedTrace>& traces, double highest_hz,
                                   const std::vector<double>& beside_hz) {
    struct Rest {
        VectorXd t, v;
        MatrixXd known;  ///< orthonormal: mean, straight line, the sines beside
    };
    std::vector<Rest> rests;
    double all = 0, lasted = 0;
    for (const PairedTrace& trace : traces) {
        const MatrixXd X = columns_of(trace.at_s, beside_hz);
        Eigen::ColPivHouseholderQR<MatrixXd> qr(X);
        qr.setThreshold(kCollinear);
        Rest rest;
        rest.known = qr.householderQ() * MatrixXd::Identity(X.rows(), qr.rank());
        rest.t = as_vector(trace.at_s).array() - as_vector(trace.at_s).mean();
        const VectorXd v = (as_vector(trace.a) + as_vector(trace.b)) / 2;
        rest.v = v - rest.known * (rest.known.transpose() * v);
        all += rest.v.squaredNorm();
        lasted = std::max(lasted, trace.lasted_s());
        rests.push_back(std::move(rest));
    }
    if (all <= 0 || lasted <= 0) return std::nullopt;
    const auto explained = [&](double hz) {
        double power = 0;
        for (const Rest& rest : rests) {
            const auto phase = (2 * M_PI * hz * rest.t).array();
            VectorXd c = phase.cos(), s = phase.sin();
            c -= rest.known * (rest.known.transpose() * c);
            s -= rest.known * (rest.known.transpose() * s);
            const double cc = c.squaredNorm(), ss = s.squaredNorm(), cs = c.dot(s), det = cc * ss - cs * cs;
            const double vc = rest.v.dot(c), vs = rest.v.dot(s);
            const double least = kCollinear * static_cast<double>(rest.t.size());
            if (cc + ss < least) continue;
            if (det < least * (cc + ss))  // one direction only: at half the frame rate, or hidden by what is known
                power += cc > ss ? vc * vc / cc : vs * vs / ss;
            else
                power += (ss * vc * vc - 2 * cs * vc * vs + cc * vs * vs) / det;
        }
        return power;
    };
    const double first = 0.2 / lasted, step = 0.15 / lasted;
    double best = 0, best_hz = 0;
    const auto look = [&](double from, double to, double by) {
        for (double hz = std::max(from, first); hz <= std::min(to, highest_hz); hz += by)
            if (const double power = explained(hz); power > best) best = power, best_hz = hz;
    };
    look(first, highest_hz, step);
    for (double by = step / 4; by > step / 300; by /= 4) look(best_hz - 4 * by, best_hz + 4 * by, by);
    if (best < 0.5 * all) return std::nullopt;
    return best_hz;
}

double widest_gap(const std::vector<double>& at_s, double hz) {
    std::vector<double> phases;
    for (const double t : at_s) {
        const double turns = (t - at_s.front()) * hz;
        phases.push_back(turns - std::floor(turns));
    }
    std::sort(phases.begin(), phases.end());
    double widest = 1 - phases.back() + phases.front();
    for (std::size_t i = 1; i < phases.size(); ++i) widest = std::max(widest, phases[i] - phases[i - 1]);
    return widest;
}

}  // namespace planlight
