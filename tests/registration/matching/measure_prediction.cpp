// How true is the predicted error? Scans of skin that moved since the CT, by models that the prediction does not know,
// are registered from any pose; the true error at targets inside the head is compared with the 95 % bound.
// measure_prediction [CASES [FIRST_SEED [MOVEMENT]]]   (default 2000 cases, seed 1, all ways in turn); about 0.5 s a
// case. With PLANLIGHT_LOG=FILE a line for each case: what the verdict could be judged by, and the error.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numeric>
#include <random>

#include <Eigen/Eigenvalues>

#include "planning_io/types/pose_covariance.h"
#include "registration/matching/register_patient.h"
#include "tests/registration/matching/ct_head_scene.h"
#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/moved_skin.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

struct Target {
    double error_mm, bound_mm;
    double drawn_mm;  ///< an error drawn from the stated covariance: what could be told if that were exactly right
};
struct Case {
    std::string movement;
    Verdict verdict = Verdict::no;
    std::vector<Target> targets;  ///< empty when there is no pose
    RegistrationResult found;
    double moved_mm = 0, noise_mm = 0, strays = 0;

    double worst_error_mm() const {
        double worst = 0;
        for (const Target& t : targets) worst = std::max(worst, t.error_mm);
        return worst;
    }
};

std::vector<double> ranks(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return values[a] < values[b]; });
    std::vector<double> rank(values.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<double>(i);
    return rank;
}

template <class Error>
double rank_correlation(const std::vector<Target>& targets, Error error_of) {
    std::vector<double> errors, bounds;
    for (const auto& t : targets) {
        errors.push_back(error_of(t));
        bounds.push_back(t.bound_mm);
    }
    const auto a = ranks(errors), b = ranks(bounds);
    const double middle = (static_cast<double>(a.size()) - 1) / 2;
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        ab += (a[i] - middle) * (b[i] - middle);
        aa += (a[i] - middle) * (a[i] - middle);
        bb += (b[i] - middle) * (b[i] - middle);
    }
    return ab / std::sqrt(aa * bb);
}

/// The length of an error at a point, drawn from the covariance of the pose.
double drawn_error_mm(const PoseCovariance& covariance, const Vector3d& p_in_ct, std::mt19937& random) {
    const Eigen::Matrix<double, 3, 6> J = movement_by_twist(p_in_ct - covariance.centre_in_ct);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(J * covariance.of_turn_and_shift * J.transpose());
    std::normal_distribution<double> unit;
    double squares = 0;
    for (int axis = 0; axis < 3; ++axis) squares += std::max(axes.eigenvalues()[axis], 0.) * std::pow(unit(random), 2);
    return std::sqrt(squares);
}

/// A scan of one of the heads from somewhere in front or at a side, 92 to 250 mm wide.
PointCloud some_scan(unsigned seed, std::mt19937& random, const SkinLut*& lut) {
    std::uniform_real_distribution<double> width(92, 250), across(-1.6, 1.6), up(-0.3, 0.5);
    const double azimuth = across(random), elevation = up(random), w = width(random);
    const Vector3d from(std::sin(azimuth) * std::cos(elevation), -std::cos(azimuth) * std::cos(elevation),
                        std::sin(elevation));
    const CtHead* head = seed % 4 == 0 ? nullptr : ct_head();
    if (!head) {
        lut = &head_lut();
        return head_view(static_cast<View>(seed / 4 % 4), w, 8000, seed);
    }
    lut = &head->lut;
    const Vector3d size(head->volume.size[0], head->volume.size[1], head->volume.size[2]);
    return scan_of_ct(head->volume, head->volume.ct_from_voxel * Vector3d(0.5 * size) + 900 * from, w, 8000, seed);
}

Case run(unsigned seed, const std::string& movement) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> size(0, 2), noise(0.05, 1), strays(0, 0.4);
    const SkinLut* lut = nullptr;
    const PointCloud still = some_scan(seed, random, lut);
    Case result;
    const auto& movements = skin_movements();
    result.movement = movement.empty() ? movements[seed % movements.size()].name : movement;
    const double rms_mm = size(random), noise_mm = noise(random), stray_share = strays(random);
    const PointCloud in_ct =
        spoiled(with_moved_skin(still, result.movement, rms_mm, seed + 7), noise_mm, stray_share, seed);
    const RigidTransform rig_from_ct = random_pose(seed);
    const PointCloud cloud = moved(in_ct, rig_from_ct);
    const RegistrationResult found = register_patient(cloud, *lut);
    result.verdict = found.verdict;
    result.found = found;
    result.moved_mm = rms_mm, result.noise_mm = noise_mm, result.strays = stray_share;
    if (found.verdict == Verdict::no) return result;
    const RigidTransform ct_from_rig = found.patient_from_ct.inverse();
    Vector3d middle = Vector3d::Zero(), outwards = Vector3d::Zero();
    for (std::size_t i = 0; i < still.size(); ++i) {
        middle += still.points_in_rig[i] / static_cast<double>(still.size());
        outwards += still.normals_in_rig[i];
    }
    // Targets 10 to 80 mm under the scanned skin, up to 40 mm aside.
    std::uniform_real_distribution<double> depth(10, 80), aside(-40, 40);
    for (int i = 0; i < 3; ++i) {
        const double d = depth(random), x = aside(random), y = aside(random), z = aside(random);
        const Vector3d p_in_ct = middle - d * outwards.normalized() + Vector3d(x, y, z);
        const double error_mm = (ct_from_rig * (rig_from_ct * p_in_ct) - p_in_ct).norm();
        result.targets.push_back({error_mm, predicted_error(found.covariance, p_in_ct).bound_95_mm,
                                  drawn_error_mm(found.covariance, p_in_ct, random)});
    }
    return result;
}

void print_row(const std::string& name, const std::array<unsigned, 3>& verdicts, std::vector<Target> targets) {
    const auto covered =
        std::count_if(targets.begin(), targets.end(), [](const auto& t) { return t.error_mm <= t.bound_mm; });
    const double correlation = rank_correlation(targets, [](const Target& t) { return t.error_mm; });
    const double possible = rank_correlation(targets, [](const Target& t) { return t.drawn_mm; });
    const auto at = [&](double share, auto key) {
        std::sort(targets.begin(), targets.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
        return key(targets[static_cast<std::size_t>(share * static_cast<double>(targets.size() - 1))]);
    };
    const auto error = [](const Target& t) { return t.error_mm; };
    const auto ratio = [](const Target& t) { return t.error_mm / t.bound_mm; };
    const auto bound = [](const Target& t) { return t.bound_mm; };
    fmt::print(
        "| {} | {} / {} / {} | {} | {:.1f} % | {:.2f} ({:.2f}) | {:.2f} / {:.2f} / {:.2f} | {:.2f} / {:.2f} | {:.2f} "
        "|\n",
        name, verdicts[0], verdicts[1], verdicts[2], targets.size(),
        100. * static_cast<double>(covered) / static_cast<double>(targets.size()), correlation, possible,
        at(0.5, error), at(0.95, error), at(1, error), at(0.5, bound), at(0.95, bound), at(1, ratio));
}

void log_case(std::ostream& log, unsigned seed, const Case& done) {
    const RegistrationResult& r = done.found;
    double bound_mm = 0;
    for (const Target& t : done.targets) bound_mm = std::max(bound_mm, t.bound_mm);
    log << fmt::format("{},{},{},{:.2f},{:.2f},{:.2f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.2f},{:.2f},\"{}\"\n",
                       seed, done.movement, static_cast<int>(done.verdict), done.moved_mm, done.noise_mm, done.strays,
                       r.skin_movement_mm.value_or(NAN), spread_of_skin_mm(r.skin), r.skin_offset_mm.value_or(NAN),
                       r.residual_rms_mm, r.weakest_sigma_mm.value_or(INFINITY), r.inlier_fraction,
                       done.worst_error_mm(), bound_mm, fmt::join(r.reasons, "; "))
        << std::flush;
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    using namespace planlight::test;
    const unsigned cases = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 2000;
    const unsigned first = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
    const std::string movement = argc > 3 ? argv[3] : "";
    std::ofstream log;
    if (const char* file = std::getenv("PLANLIGHT_LOG")) {
        log.open(file);
        log << "seed,movement,verdict,moved_mm,noise_mm,strays,skin_movement_mm,skin_spread_mm,skin_offset_mm,residual_"
               "rms_mm,"
               "weakest_sigma_mm,inlier_fraction,worst_error_mm,bound_mm,reasons\n";
    }
    std::map<std::string, std::vector<Target>> by_movement;
    std::map<std::string, std::array<unsigned, 3>> verdicts;  // yes, ask, no
    std::vector<Target> others;
    std::array<double, 2> worst_mm{};  // yes, ask
    for (unsigned i = 0; i < cases; ++i) {
        const auto done = run(first + i, movement);
        if (log) log_case(log, first + i, done);
        auto& into = by_movement[done.movement];
        into.insert(into.end(), done.targets.begin(), done.targets.end());
        for (const Target& target : done.targets) {
            double& worst = worst_mm[done.verdict == planlight::Verdict::yes ? 0 : 1];
            worst = std::max(worst, target.error_mm);
        }
        ++verdicts[done.movement][done.verdict == planlight::Verdict::yes   ? 0
                                  : done.verdict == planlight::Verdict::ask ? 1
                                                                            : 2];
    }
    std::array<unsigned, 3> of_others{};
    fmt::print(
        "| skin moved by | yes / ask / no | targets | within the 95 % bound | rank correlation (if the covariances "
        "were exactly right) | true error mm: median "
        "/ 95 % / worst | bound mm: median / 95 % | worst error / bound |\n|---|---|---|---|---|---|---|---|\n");
    for (const auto& way : skin_movements()) {
        const auto& targets = by_movement[way.name];
        if (targets.empty()) continue;
        if (!way.tuned_on) {
            others.insert(others.end(), targets.begin(), targets.end());
            for (std::size_t i = 0; i < 3; ++i) of_others[i] += verdicts[way.name][i];
        }
        print_row(way.name + (way.tuned_on ? " (tuned on)" : ""), verdicts[way.name], targets);
    }
    if (const auto& targets = by_movement[kSwollenSide]; !targets.empty())
        print_row(kSwollenSide, verdicts[kSwollenSide], targets);
    if (!others.empty()) print_row("**all not tuned on**", of_others, others);
    fmt::print("\nWorst error at a target: {:.2f} mm where the verdict is yes, {:.2f} mm where it is ask.\n",
               worst_mm[0], worst_mm[1]);
}
