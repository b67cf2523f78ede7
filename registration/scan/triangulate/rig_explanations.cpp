#include "registration/scan/triangulate/rig_explanations.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace planlight {
namespace {

constexpr int kIterations = 8, kIterationsAsCalibrated = 1;
using DeviceMatrix = Eigen::Matrix<double, 10, 10>;

double distance_to(const std::vector<SeenPlace>& places, const CameraModel& device) {
    std::vector<double> depths;
    for (const SeenPlace& place : places) depths.push_back((device.device_from_rig * place.p_in_rig).z());
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    return *middle;
}

/// What the calibration leaves of one device, `distance_mm` away.
DeviceMatrix calibration_covariance(const CameraModel& device, double distance_mm, double worse,
                                    const CalibrationPrior& prior) {
    const double f = device.focal_x, corner = std::hypot(device.width, device.height) / (2 * f);
    DeviceMatrix G = DeviceMatrix::Zero();  // a column an independent cause
    G(6, 0) = prior.focal, G(5, 0) = prior.focal * distance_mm;
    G(7, 1) = prior.centre_px, G(1, 1) = -prior.centre_px / f;
    G(8, 2) = prior.centre_px, G(0, 2) = prior.centre_px / f;
    G(9, 3) = prior.corner_px / (f * corner * corner * corner);
    G(0, 4) = G(1, 5) = prior.left_px / f;
    G(2, 6) = prior.roll;
    G(3, 7) = G(4, 8) = prior.left_px * distance_mm / f;
    G(5, 9) = prior.depth_mm;
    return worse * worse * G * G.transpose();
}

RigMatrix calibration_covariance(const RigCalibration& rig, const std::vector<SeenPlace>& places,
                                 const CalibrationPrior& prior) {
    RigMatrix covariance = RigMatrix::Zero();
    const double worse = std::clamp(rig.reprojection_rms_px / prior.usual_rms_px, 1.0, prior.at_most);
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const CameraModel& device = device_of(rig, static_cast<RigDevice>(d));
        const double factor = static_cast<RigDevice>(d) == RigDevice::projector ? prior.projector : 1;
        const auto at = 10 * static_cast<Eigen::Index>(d);
        covariance.block<10, 10>(at, at) =
            calibration_covariance(device, distance_to(places, device), worse * factor, prior);
    }
    return covariance;
}

std::vector<Explanation> explanations(const RigStateSettings& settings) {
    using D = RigDevice;
    std::vector<Explanation> all;
    const auto add = [&](std::vector<D> moved, std::vector<D> lens, double penalty) {
        Explanation& e = all.emplace_back();
        e.moved = std::move(moved);
        e.lens = std::move(lens);
        e.penalty = penalty;
    };
    for (const D device : {D::projector, D::left_camera, D::right_camera}) {
        add({device}, {}, 0);
        add({}, {device}, 0);
        add({device}, {device}, settings.lens_and_place_penalty);
    }
    add({D::left_camera, D::projector}, {}, settings.two_devices_penalty);
    add({D::right_camera, D::projector}, {}, settings.two_devices_penalty);
    add({D::left_camera, D::right_camera}, {}, settings.two_devices_penalty);
    add({}, {D::left_camera, D::right_camera}, settings.both_lenses_penalty);
    return all;
}

RigMatrix prior_of(const Explanation& explanation, const RigMatrix& calibration, const RigCalibration& rig,
                   const RigStateSettings& settings) {
    RigMatrix covariance = calibration;
    const auto widen = [&](RigDevice device, Eigen::Index number, double sigma) {
        const Eigen::Index i = 10 * static_cast<Eigen::Index>(device) + number;
        covariance(i, i) += sigma * sigma;
    };
    for (const RigDevice device : explanation.moved)
        for (Eigen::Index k = 0; k < 6; ++k) widen(device, k, k < 3 ? settings.moved_turn : settings.moved_mm);
    if (explanation.lens.size() > 1) {
        for (const RigDevice a : explanation.lens)
            for (const RigDevice b : explanation.lens)
                covariance(10 * static_cast<Eigen::Index>(a) + 6, 10 * static_cast<Eigen::Index>(b) + 6) +=
                    settings.both_lenses_focal * settings.both_lenses_focal;
        return covariance;
    }
    for (const RigDevice device : explanation.lens) {
        widen(device, 6, settings.lens_focal);
        for (Eigen::Index k : {7, 8}) widen(device, k, settings.lens_centre * device_of(rig, device).width);
        widen(device, 9, settings.lens_k1);
    }
    return covariance;
}

/// Solves in the units of the prior's standard deviations: the numbers are of very different sizes.
void fit(Explanation& explanation, const RigMatrix& prior, std::vector<SeenPlace> places, const RigCalibration& rig,
         const RigStateSettings& settings, int iterations) {
    const RigNumbers unit = prior.diagonal().cwiseSqrt();
    const RigMatrix correlation = unit.cwiseInverse().asDiagonal() * prior * unit.cwiseInverse().asDiagonal();
    const RigMatrix inverse = correlation.ldlt().solve(RigMatrix::Identity());
    RigResiduals data = rig_residuals(places, changed(rig, explanation.numbers), settings.independent);
    RigMatrix information;
    for (int i = 0; i < iterations; ++i) {
        const RigNumbers now = explanation.numbers.cwiseQuotient(unit);
        information = unit.asDiagonal() * data.normal * unit.asDiagonal();
        information += inverse;
        const RigNumbers right = unit.asDiagonal() * data.right - inverse * now;
        const RigNumbers step = information.ldlt().solve(right);
        if (!step.allFinite()) break;
        explanation.numbers += unit.cwiseProduct(step);
        data = rig_residuals(places, changed(rig, explanation.numbers), settings.independent);
        if (step.cwiseAbs().maxCoeff() < 1e-3) break;
    }
    const RigNumbers now = explanation.numbers.cwiseQuotient(unit);
    information = unit.asDiagonal() * data.normal * unit.asDiagonal();
    information += inverse;
    explanation.covariance = unit.asDiagonal() * information.ldlt().solve(RigMatrix::Identity()) * unit.asDiagonal();
    explanation.chi_square = data.chi_square + now.dot(inverse * now) + explanation.penalty;
    explanation.usual = data.usual;
}

}  // namespace

RigFits fit_explanations(const std::vector<SeenPlace>& places, const RigCalibration& rig,
                         const RigStateSettings& settings) {
    const RigMatrix calibration = calibration_covariance(rig, places, settings.calibration);
    RigFits fits;
    fit(fits.as_calibrated, calibration, places, rig, settings, kIterationsAsCalibrated);
    fits.noise = std::max(1.0, fits.as_calibrated.usual * fits.as_calibrated.usual);
    if (!(fits.as_calibrated.chi_square > settings.moved_chi_square)) return fits;
    fits.others = explanations(settings);
    tbb::parallel_for(std::size_t{0}, fits.others.size(), [&](std::size_t i) {
        fit(fits.others[i], prior_of(fits.others[i], calibration, rig, settings), places, rig, settings, kIterations);
    });
    std::sort(fits.others.begin(), fits.others.end(),
              [](const Explanation& a, const Explanation& b) { return a.chi_square < b.chi_square; });
    const double usual = fits.others.front().usual;
    fits.noise = std::max(1.0, usual * usual);
    return fits;
}

}  // namespace planlight
