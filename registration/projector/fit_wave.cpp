#include "registration/projector/fit_wave.h"

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

}  // namespace

WaveFit fit_wave(const PairedTrace& trace, double hz, int harmonics, const std::vector<double>& beside_hz) {
    std::vector<double> all_hz;
    const int counted = hz > 0 ? harmonics : 0;
    for (int m = 1; m <= counted; ++m) all_hz.push_back(m * hz);
    all_hz.insert(all_hz.end(), beside_hz.begin(), beside_hz.end());
    const MatrixXd X = columns_of(trace.at_s, all_hz);
    Eigen::ColPivHouseholderQR<MatrixXd> qr(X);
    qr.setThreshold(kCollinear);
    const VectorXd a = as_vector(trace.a), b = as_vector(trace.b), of_a = qr.solve(a), of_b = qr.solve(b);
    const double freedom = static_cast<double>(std::max<Index>(1, X.rows() - qr.rank()));
    const VectorXd left_a = a - X * of_a, left_b = b - X * of_b;

    WaveFit fit;
    fit.mean = (of_a[0] + of_b[0]) / 2;
    fit.left_over = covariance_of(left_a, left_b, freedom);
    VectorXd slope = VectorXd::Zero(X.cols());  // of the variance by the coefficients
    slope.segment(2, 2 * counted) = ((of_a + of_b) / 2).segment(2, 2 * counted);
    fit.variance = of_a.segment(2, 2 * counted).dot(of_b.segment(2, 2 * counted)) / 2;
    const double noise = ((left_a + left_b) / 2).squaredNorm() / freedom;
    MatrixXd normal = X.transpose() * X;
    normal.diagonal().array() += kCollinear * kCollinear * static_cast<double>(X.rows());
    fit.variance_sigma = std::sqrt(std::max(0.0, noise * slope.dot(normal.ldlt().solve(slope))));
    return fit;
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
