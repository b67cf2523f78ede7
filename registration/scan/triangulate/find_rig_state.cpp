#include "registration/scan/triangulate/find_rig_state.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "registration/scan/triangulate/rig_residuals.h"

namespace planlight {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr int kIterations = 8;
constexpr std::size_t kPlacesOfDoubt = 80;
constexpr Eigen::Index kModes = 3;
using DeviceMatrix = Eigen::Matrix<double, 10, 10>;

/// Places spread evenly over the matches, with a start for their points by the two cameras.
std::vector<SeenPlace> places_of(const ViewMatches& matches, const RigCalibration& rig, std::size_t wanted) {
    std::vector<SeenPlace> places;
    const std::size_t every = 1 + matches.both.size() / wanted;
    for (std::size_t i = every / 2; i < matches.both.size(); i += every) {
        const ViewMatch& m = matches.both[i];
        if (!m.whole) continue;
        const auto a = ray_through(rig.left_camera, m.pixel), b = ray_through(rig.right_camera, m.right);
        if (!a || !b) continue;
        // Midpoint method (Hartley & Zisserman, 12.2).
        const Eigen::Vector3d between = b->origin - a->origin;
        const double c = a->direction.dot(b->direction), u = a->direction.dot(between), v = b->direction.dot(between);
        if (!(1 - c * c > 1e-6)) continue;
        const double s = (u - c * v) / (1 - c * c), t = (c * u - v) / (1 - c * c);
        if (!(s > 0) || !(t > 0)) continue;
        const Eigen::Vector3d p = 0.5 * (a->origin + s * a->direction + b->origin + t * b->direction);
        places.push_back({{m.pixel, m.right, m.code}, p});
    }
    return places;
}

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

/// One way in which the rig may have changed.
struct Explanation {
    std::vector<RigDevice> moved, lens;
    double penalty = 0;

    RigNumbers numbers = RigNumbers::Zero();  // found
    RigMatrix covariance = RigMatrix::Zero();
    double chi_square = 0, usual = 0;
};

bool contains(const std::vector<RigDevice>& devices, RigDevice device) {
    return std::find(devices.begin(), devices.end(), device) != devices.end();
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

/// The change from `used` to `other`, moved so that the places of both lie on each other.
RigDoubt doubt_between(const RigCalibration& used, const RigCalibration& other, const std::vector<SeenPlace>& places) {
    std::vector<Eigen::Vector3d> here, there;
    for (const SeenPlace& place : places) {
        const auto a = point_of_pixels(used, place.pixels, place.p_in_rig),
                   b = point_of_pixels(other, place.pixels, place.p_in_rig);
        if (a && b) here.push_back(*a), there.push_back(*b);
    }
    RigDoubt doubt;
    for (auto& by : doubt.by) by.setZero();
    if (here.size() < 6) return doubt;
    const auto columns = [](const std::vector<Eigen::Vector3d>& points) {
        return Eigen::Matrix3Xd(
            Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3, static_cast<Eigen::Index>(points.size())));
    };
    const RigidTransform there_from_here = fit_rigid_transform(columns(here), columns(there));
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const CameraModel &a = device_of(used, static_cast<RigDevice>(d)),
                          &b = device_of(other, static_cast<RigDevice>(d));
        const RigidTransform step = b.device_from_rig * there_from_here * a.device_from_rig.inverse();
        doubt.by[d] << rotation_vector(step.linear()), step.translation(), std::log(b.focal_x / a.focal_x),
            b.centre_x - a.centre_x, b.centre_y - a.centre_y, b.k1 - a.k1;
    }
    return doubt;
}

/// The few directions in which the explanation's own uncertainty bends the cloud most.
std::vector<RigDoubt> own_doubts(const Explanation& explanation, const RigCalibration& used,
                                 const std::vector<SeenPlace>& places) {
    const Eigen::LLT<RigMatrix> root(explanation.covariance + 1e-18 * RigMatrix::Identity());
    if (root.info() != Eigen::Success) return {};
    const RigMatrix L = root.matrixL();
    const auto rows = 3 * static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(rows, kRigNumbers);
    const auto move_of = [&](const RigNumbers& numbers) {
        const RigDoubt doubt = doubt_between(used, changed(used, numbers), places);
        const RigCalibration other = doubted(used, doubt);
        Eigen::VectorXd move = Eigen::VectorXd::Zero(rows);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const auto p = point_of_pixels(other, places[i].pixels, places[i].p_in_rig);
            const auto q = point_of_pixels(used, places[i].pixels, places[i].p_in_rig);
            if (p && q) move.segment<3>(3 * static_cast<Eigen::Index>(i)) = *p - *q;
        }
        return move;
    };
    tbb::parallel_for(Eigen::Index{0}, Eigen::Index{kRigNumbers},
                      [&](Eigen::Index k) { moves.col(k) = move_of(L.col(k)); });
    const RigMatrix squares = moves.transpose() * moves;
    const Eigen::SelfAdjointEigenSolver<RigMatrix> axes(squares);  // ascending
    std::vector<RigDoubt> doubts;
    for (Eigen::Index k = 0; k < kModes; ++k) {
        RigDoubt doubt =
            doubt_between(used, changed(used, RigNumbers(L * axes.eigenvectors().col(kRigNumbers - 1 - k))), places);
        doubt.sigma = true;
        doubt.what = "what the calibration and this scan leave open";
        doubts.push_back(doubt);
    }
    return doubts;
}

std::vector<RigDevice> devices_of(const Explanation& e) {
    return e.moved.empty() ? e.lens : e.moved;
}

std::string names_of(const std::vector<RigDevice>& devices) {
    std::string text;
    for (const RigDevice device : devices)
        text += fmt::format("{}the {}", text.empty() ? "" : " and ", text_of(device));
    return text;
}

/// "the projector moved", "the left camera moved or its lens was changed (focus, zoom or shift)".
std::string words_of(const std::vector<RigDevice>& devices, bool moved, bool lens) {
    constexpr const char* kLens = "lens was changed (focus, zoom or shift)";
    if (!moved) return fmt::format("{}'s {}", names_of(devices), kLens);
    return names_of(devices) + (lens ? fmt::format(" moved or its {}", kLens) : std::string(" moved"));
}

/// Explanations that blame the same devices are one: "the projector moved, or the left camera moved".
std::string words_of(const std::vector<const Explanation*>& possible) {
    std::vector<std::vector<RigDevice>> blamed;
    std::string text;
    for (const Explanation* e : possible) {
        const auto devices = devices_of(*e);
        if (std::find(blamed.begin(), blamed.end(), devices) != blamed.end()) continue;
        blamed.push_back(devices);
        bool moved = false, lens = false;
        for (const Explanation* other : possible)
            if (devices_of(*other) == devices) moved |= !other->moved.empty(), lens |= !other->lens.empty();
        const bool simple = moved && !e->moved.empty() && e->lens.empty() && devices.size() > 1;
        text += (text.empty() ? "" : ", or ") + words_of(devices, moved, lens && !simple);
    }
    return text;
}

void find_devices(const RigCalibration& before, const std::vector<const Explanation*>& possible, RigState& state) {
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto device = static_cast<RigDevice>(d);
        DeviceFinding& finding = state.devices[d];
        const CameraModel &a = device_of(before, device), &b = device_of(state.rig, device);
        finding.moved_mm = (a.centre_in_rig() - b.centre_in_rig()).norm();
        finding.turned = angle_between(a.device_from_rig, b.device_from_rig);
        finding.focal_change = b.focal_x / a.focal_x - 1;
        std::size_t blamed = 0;
        for (const Explanation* e : possible) blamed += contains(e->moved, device) || contains(e->lens, device);
        finding.moved = blamed == possible.size() && blamed > 0;
        finding.maybe = blamed > 0 && !finding.moved;
        if (possible.empty()) continue;
        finding.best = contains(possible.front()->moved, device) || contains(possible.front()->lens, device);
        finding.lens = contains(possible.front()->lens, device);
    }
}

std::string size_of(const Explanation& best, const RigState& state) {
    std::string text;
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto device = static_cast<RigDevice>(d);
        const DeviceFinding& f = state.devices[d];
        if (contains(best.moved, device))
            text += fmt::format("{}{:.2f} mm and {:.3f} degrees", text.empty() ? "" : "; ", f.moved_mm,
                                f.turned * kDegrees);
        if (contains(best.lens, device))
            text += fmt::format("{}{:+.2f} % of its focal length", text.empty() ? "" : "; ", 100 * f.focal_change);
    }
    return text;
}

double hidden_over(const RigState& state, const std::vector<SeenPlace>& places) {
    std::vector<double> hidden;
    for (const SeenPlace& place : places)
        if (const auto p = point_of_pixels(state.rig, place.pixels, place.p_in_rig))
            hidden.push_back(hidden_light_mm(state, *p));
    if (hidden.empty()) return 0;
    const auto rank = hidden.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(hidden.size() - 1));
    std::nth_element(hidden.begin(), rank, hidden.end());
    return *rank;
}

void judge(const Explanation& best, const std::vector<const Explanation*>& possible, const RigStateSettings& settings,
           RigState& state) {
    const bool fits = best.usual <= settings.max_usual_residual;
    const std::string since =
        state.rig.made_on.empty() ? "since the calibration" : "since the calibration of " + state.rig.made_on;
    state.verdict = fits && state.hidden_light_mm <= settings.max_hidden_mm ? RigState::Verdict::corrected
                                                                            : RigState::Verdict::not_trusted;
    state.sentence = fmt::format("{} {} (by {})", words_of(possible), since, size_of(best, state));
    const auto others = [&](const Explanation* e) { return devices_of(*e) != devices_of(best); };
    if (std::any_of(possible.begin(), possible.end(), others)) state.sentence += "; one scan cannot tell which";
    state.sentence +=
        fits ? fmt::format("; light may be off by up to {:.2f} mm without a sign of it", state.hidden_light_mm)
             : "; the devices fit each other from no place";
    state.remedy =
        state.verdict == RigState::Verdict::corrected
            ? "The cloud is made, the patient followed and the light drawn with the rig as it stands now; calibrate it "
              "again as soon as there is time."
            : "No light is drawn with it: calibrate the rig again.";
}

}  // namespace

RigState find_rig_state(const ViewMatches& matches, const RigCalibration& rig, const RigStateSettings& settings) {
    RigState state;
    state.rig = rig;
    std::vector<SeenPlace> places = places_of(matches, rig, settings.places);
    if (places.size() < settings.min_places) {
        state.sentence = "whether the rig moved is not known: too little is seen by both cameras under the light";
        return state;
    }
    const RigMatrix calibration = calibration_covariance(rig, places, settings.calibration);
    Explanation as_calibrated;
    fit(as_calibrated, calibration, places, rig, settings, 3);
    std::vector<Explanation> all = explanations(settings);
    const auto fit_all = [&] {
        tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
            fit(all[i], prior_of(all[i], calibration, rig, settings), places, rig, settings, kIterations);
        });
        std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.chi_square < b.chi_square; });
    };
    std::vector<SeenPlace> some;
    for (std::size_t i = 0; i < places.size(); i += 1 + places.size() / kPlacesOfDoubt) some.push_back(places[i]);
    if (as_calibrated.chi_square > settings.moved_chi_square) fit_all();  // else none can be so much better
    const Explanation& best = all.front();
    // Where the light is read with more noise than expected, differences say less.
    const double noise = std::max(1.0, best.usual * best.usual);
    const bool moved = as_calibrated.chi_square > settings.moved_chi_square &&
                       as_calibrated.chi_square - best.chi_square > noise * settings.moved_chi_square;
    std::vector<const Explanation*> possible;
    if (moved) state.rig = changed(rig, best.numbers);
    state.doubts = own_doubts(moved ? best : as_calibrated, state.rig, some);
    if (moved)
        for (const Explanation& e : all) {
            if (e.chi_square > best.chi_square + noise * settings.doubt_chi_square) continue;
            possible.push_back(&e);
            if (&e == &best) continue;
            RigDoubt doubt = doubt_between(state.rig, changed(rig, e.numbers), some);
            doubt.what = words_of({&e});
            doubt.chi_square = e.chi_square - best.chi_square;
            state.doubts.push_back(doubt);
        }
    find_devices(rig, possible, state);
    state.hidden_light_mm = hidden_over(state, some);
    if (moved) {
        judge(best, possible, settings, state);
    } else if (as_calibrated.usual > settings.max_usual_residual) {
        state.verdict = RigState::Verdict::not_trusted;
        state.sentence =
            "the devices fit each other from no place: another rig, or a lens or a distortion that is wrong";
        state.remedy = "Use the rig.json of this rig, or calibrate it again.";
    } else {
        state.verdict = RigState::Verdict::as_calibrated;
        state.sentence = "the rig is as it was calibrated";
    }
    return state;
}

}  // namespace planlight
