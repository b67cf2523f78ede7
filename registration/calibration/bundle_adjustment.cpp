#include "registration/calibration/bundle_adjustment.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <memory>

#include "planning_io/types/statistics.h"
#include "registration/calibration/bundle_costs.h"
#include "registration/calibration/covariance_over_poses.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Numbers9 = std::array<double, 9>;
using Numbers6 = std::array<double, 6>;

Numbers9 lens_of(const CameraModel& d) {
    return {d.focal_x, d.focal_y, d.centre_x, d.centre_y, d.k1, d.k2, d.p1, d.p2, d.k3};
}

Numbers6 twist_of(const RigidTransform& t) {
    const Vector3d turn = rotation_vector(t.linear());
    return {turn.x(), turn.y(), turn.z(), t.translation().x(), t.translation().y(), t.translation().z()};
}

RigidTransform transform_of(const Numbers6& twist) {
    return transform_from_twist(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(twist.data()));
}

/// One corner or lit pixel, and whether it takes part.
struct Measurement {
    std::size_t pose;
    DeviceName camera;
    DeviceName judged_by;  ///< the camera for a corner, the projector for light
    std::size_t index;     ///< of the corner or the light sample
    bool used = true;
    Vector2d residual_px = Vector2d::Zero();
};

class Bundle {
public:
    Bundle(const std::vector<PoseObservation>& poses, const BoardSpec& board, const RigEstimate& start,
           const BundleSettings& settings);
    BundleResult run();

private:
    void build(double huber);
    bool solve();
    void measure_residuals();
    void update_sigmas();
    bool leave_out_outliers();
    std::vector<double*> shared_blocks(std::vector<Eigen::Index>& where);
    CovarianceOverPoses covariance();
    ceres::CostFunction* cost_of(const Measurement& m) const;
    std::vector<double*> blocks_of(const Measurement& m);
    BundleResult result(bool converged);
    double* lens(DeviceName name) { return lenses_[static_cast<std::size_t>(name)].data(); }
    double* place(DeviceName name) { return places_[static_cast<std::size_t>(name)].data(); }
    double& sigma(DeviceName name) { return sigma_px_[static_cast<std::size_t>(name)]; }
    double sigma(DeviceName name) const { return sigma_px_[static_cast<std::size_t>(name)]; }

    const std::vector<PoseObservation>& poses_;
    const BoardSpec& board_;
    RigEstimate rig_;
    BundleSettings settings_;
    std::array<Numbers9, 3> lenses_{};
    std::array<Numbers6, 3> places_{};
    std::vector<Numbers6> boards_;
    std::array<double, 3> bend_{};
    std::array<double, 3> sigma_px_{0.3, 0.3, 0.7};
    std::vector<Measurement> measurements_;
    std::unique_ptr<ceres::Problem> problem_;
    std::vector<std::vector<ceres::ResidualBlockId>> residuals_of_pose_;
    std::vector<ceres::ResidualBlockId> priors_;
};

Bundle::Bundle(const std::vector<PoseObservation>& poses, const BoardSpec& board, const RigEstimate& start,
               const BundleSettings& settings)
    : poses_(poses), board_(board), rig_(start), settings_(settings), boards_(poses.size()) {
    for (const DeviceName name : kDevices)
        if (const auto& d = rig_.device(name)) {
            lenses_[static_cast<std::size_t>(name)] = lens_of(*d);
            places_[static_cast<std::size_t>(name)] = twist_of(d->device_from_rig);
        }
    for (std::size_t i = 0; i < 3; ++i) bend_[i] = rig_.bend_mm[static_cast<Eigen::Index>(i)];
    for (std::size_t i = 0; i < poses_.size(); ++i) {
        if (!rig_.rig_from_board[i]) continue;
        boards_[i] = twist_of(*rig_.rig_from_board[i]);
        for (const DeviceName camera : {DeviceName::left_camera, DeviceName::right_camera}) {
            if (!rig_.device(camera)) continue;
            const CameraObservation& seen = view_of(poses_[i], camera);
            for (std::size_t c = 0; c < seen.corners.size(); ++c) measurements_.push_back({i, camera, camera, c});
            if (!rig_.device(DeviceName::projector) || !settings_.light) continue;
            for (std::size_t c = 0; c < seen.light.size(); ++c)
                measurements_.push_back({i, camera, DeviceName::projector, c});
        }
    }
}

ceres::CostFunction* Bundle::cost_of(const Measurement& m) const {
    const CameraObservation& seen = view_of(poses_[m.pose], m.camera);
    if (m.judged_by == m.camera)
        return new ceres::AutoDiffCostFunction<CornerCost, 2, 9, 6, 6, 3>(
            new CornerCost{seen.corners.pixels[m.index], board_.corner_in_board(seen.corners.ids[m.index]),
                           BoardShape(board_), sigma(m.camera)});
    return new ceres::AutoDiffCostFunction<LightCost, 2, 9, 6, 9, 6, 6, 3>(
        new LightCost{seen.light[m.index], BoardShape(board_), sigma(DeviceName::projector)});
}

std::vector<double*> Bundle::blocks_of(const Measurement& m) {
    if (m.judged_by == m.camera) return {lens(m.camera), place(m.camera), boards_[m.pose].data(), bend_.data()};
    return {lens(m.camera),         place(m.camera), lens(DeviceName::projector), place(DeviceName::projector),
            boards_[m.pose].data(), bend_.data()};
}

void Bundle::build(double huber) {
    problem_ = std::make_unique<ceres::Problem>();
    residuals_of_pose_.assign(poses_.size(), {});
    priors_.clear();
    for (const Measurement& m : measurements_)
        if (m.used)
            residuals_of_pose_[m.pose].push_back(
                problem_->AddResidualBlock(cost_of(m), new ceres::HuberLoss(huber), blocks_of(m)));
    for (const DeviceName name : kDevices) {
        const auto& d = rig_.device(name);
        if (!d || !problem_->HasParameterBlock(lens(name))) continue;
        const double diagonal = std::hypot(d->width, d->height),
                     corner_px = (name == DeviceName::projector ? 0.8 : 0.5) * diagonal;
        priors_.push_back(problem_->AddResidualBlock(
            new ceres::AutoDiffCostFunction<LensPrior, 6, 9>(
                new LensPrior{settings_.aspect_sigma, corner_px / d->focal_x, corner_px, settings_.sixth_order}),
            nullptr, lens(name)));
        if (settings_.rig_fixed)
            problem_->SetParameterBlockConstant(lens(name));
        else if (!settings_.sixth_order)
            problem_->SetManifold(lens(name), new ceres::SubsetManifold(9, {8}));
        if (settings_.rig_fixed || name == DeviceName::left_camera) problem_->SetParameterBlockConstant(place(name));
    }
    if (!problem_->HasParameterBlock(bend_.data())) return;
    priors_.push_back(problem_->AddResidualBlock(
        new ceres::AutoDiffCostFunction<BendPrior, 3, 3>(new BendPrior{settings_.bend_sigma_mm}), nullptr,
        bend_.data()));
    if (settings_.rig_fixed || !settings_.bend) problem_->SetParameterBlockConstant(bend_.data());
}

bool Bundle::solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 60;
    options.function_tolerance = 1e-10;
    options.num_threads = 2;
    options.logging_type = ceres::SILENT;
    FLAGS_minloglevel = google::GLOG_FATAL;  // a step that fails is tried again; the result says whether it settled
    ceres::Solver::Summary summary;
    ceres::Solve(options, problem_.get(), &summary);
    return summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
}

void Bundle::measure_residuals() {
    for (Measurement& m : measurements_) {
        const std::unique_ptr<ceres::CostFunction> cost(cost_of(m));
        const auto blocks = blocks_of(m);
        double residual[2];
        cost->Evaluate(blocks.data(), residual, nullptr);
        m.residual_px = sigma(m.judged_by) * Vector2d(residual[0], residual[1]);
        if (!m.residual_px.allFinite()) m.residual_px = Vector2d::Constant(1e6);
    }
}

/// One standard deviation per axis from the median length (Rayleigh: median 1.1774 sigma).
/// Pictures that are cleaner than any camera's leave errors of their own, alike within a pose: they are no outliers.
void Bundle::update_sigmas() {
    constexpr double kFinest_px = 0.02;
    for (const DeviceName name : kDevices) {
        std::vector<double> lengths;
        for (const Measurement& m : measurements_)
            if (m.judged_by == name) lengths.push_back(m.residual_px.norm());
        if (lengths.size() < 20) continue;
        sigma(name) = std::max(kFinest_px, median(std::move(lengths)) / 1.1774);
    }
}

bool Bundle::leave_out_outliers() {
    bool changed = false;
    for (Measurement& m : measurements_) {
        const bool use = m.residual_px.norm() < settings_.outlier * sigma(m.judged_by);
        changed |= use != m.used;
        m.used = use;
    }
    return changed;
}

/// Columns of the numbers that all poses share: the devices' (those that are free), then the board's bend.
std::vector<double*> Bundle::shared_blocks(std::vector<Eigen::Index>& where) {
    std::vector<double*> blocks;
    Eigen::Index next = 0;
    for (const DeviceName name : kDevices) {
        if (!rig_.device(name)) continue;
        blocks.push_back(lens(name));
        const int terms = settings_.sixth_order ? 9 : 8;
        for (int i = 0; i < terms; ++i) where.push_back(next + i);
        next += 9;
        if (name == DeviceName::left_camera) continue;
        blocks.push_back(place(name));
        for (int i = 0; i < 6; ++i) where.push_back(next + i);
        next += 6;
    }
    if (!problem_->IsParameterBlockConstant(bend_.data())) blocks.push_back(bend_.data());
    return blocks;
}

/// Normal matrix and score of the columns `shared` of some rows, the other columns (the pose of the board) eliminated.
PoseInformation information_of(const Eigen::MatrixXd& rows, const Eigen::VectorXd& residuals, Eigen::Index shared) {
    const Eigen::MatrixXd normal = rows.transpose() * rows;
    const Eigen::VectorXd score = rows.transpose() * residuals;
    const Eigen::Index own = rows.cols() - shared;
    if (own == 0) return {normal, score};
    const Eigen::MatrixXd carried =
        normal.bottomRightCorner(own, own).ldlt().solve(normal.bottomLeftCorner(own, shared)).transpose();
    return {normal.topLeftCorner(shared, shared) - carried * normal.bottomLeftCorner(own, shared),
            score.head(shared) - carried * score.tail(own)};
}

/// Of `numbers_of(rig)`. Ceres weighs the residuals by their sigmas.
CovarianceOverPoses Bundle::covariance() {
    std::vector<Eigen::Index> where;  // of every shared column in numbers_of(rig)
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = shared_blocks(where);
    std::vector<PoseInformation> poses;
    const auto evaluate = [&](const std::vector<ceres::ResidualBlockId>& residuals, double* board) {
        ceres::Problem::EvaluateOptions some = options;
        some.residual_blocks = residuals;
        if (board) some.parameter_blocks.push_back(board);
        std::vector<double> r;
        ceres::CRSMatrix crs;
        problem_->Evaluate(some, nullptr, &r, nullptr, &crs);
        const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> J(
            crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(), crs.cols.data(),
            crs.values.data());
        return information_of(Eigen::MatrixXd(J), Eigen::Map<const Eigen::VectorXd>(r.data(), crs.num_rows),
                              crs.num_cols - (board ? 6 : 0));
    };
    for (std::size_t i = 0; i < boards_.size(); ++i)
        if (!residuals_of_pose_[i].empty()) poses.push_back(evaluate(residuals_of_pose_[i], boards_[i].data()));
    CovarianceOverPoses found = covariance_over_poses(poses, evaluate(priors_, nullptr).normal);
    const auto all = numbers_of(rig_).size();
    Eigen::MatrixXd of_numbers = Eigen::MatrixXd::Zero(all, all);
    for (std::size_t r = 0; r < where.size(); ++r)
        for (std::size_t c = 0; c < where.size(); ++c)
            of_numbers(where[r], where[c]) =
                found.covariance(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
    found.covariance = of_numbers;
    return found;
}

BundleResult Bundle::result(bool converged) {
    BundleResult out;
    out.converged = converged;
    out.rig = rig_;
    for (const DeviceName name : kDevices) {
        auto& d = out.rig.device(name);
        if (!d) continue;
        const Numbers9& k = lenses_[static_cast<std::size_t>(name)];
        d->focal_x = k[0], d->focal_y = k[1], d->centre_x = k[2], d->centre_y = k[3];
        d->k1 = k[4], d->k2 = k[5], d->p1 = k[6], d->p2 = k[7], d->k3 = k[8];
        d->device_from_rig = transform_of(places_[static_cast<std::size_t>(name)]);
    }
    for (std::size_t i = 0; i < boards_.size(); ++i)
        if (out.rig.rig_from_board[i]) out.rig.rig_from_board[i] = transform_of(boards_[i]);
    out.rig.bend_mm = Vector3d(bend_[0], bend_[1], bend_[2]);
    out.sigma_px = sigma_px_;
    for (const Measurement& m : measurements_) {
        const auto d = static_cast<std::size_t>(m.judged_by);
        auto entry = std::find_if(out.residuals.begin(), out.residuals.end(),
                                  [&](const PoseResidual& r) { return r.pose == m.pose && r.device == m.judged_by; });
        if (entry == out.residuals.end()) entry = out.residuals.insert(entry, {m.pose, m.judged_by, 0, 0, 0});
        ++(m.used ? entry->used : entry->left_out);
        ++(m.used ? out.used[d] : out.left_out[d]);
        if (!m.used) continue;
        entry->rms_px += m.residual_px.squaredNorm();
        out.rms_px[d] += m.residual_px.squaredNorm();
    }
    for (PoseResidual& r : out.residuals) r.rms_px = r.used ? std::sqrt(r.rms_px / static_cast<double>(r.used)) : 0;
    for (std::size_t d = 0; d < 3; ++d)
        out.rms_px[d] = out.used[d] ? std::sqrt(out.rms_px[d] / static_cast<double>(out.used[d])) : 0;
    return out;
}

BundleResult Bundle::run() {
    constexpr int kRounds = 4;
    bool converged = false;
    for (int round = 0; round < kRounds; ++round) {
        build(round == 0 ? 1.0 : 2.5);
        converged = solve();
        if (!converged) return result(false);
        measure_residuals();
        update_sigmas();
        if (!leave_out_outliers() && round > 1) break;
    }
    build(2.5);
    BundleResult out = result(converged);
    if (settings_.rig_fixed) return out;
    // The covariance is of the turns that numbers_of says, also beyond 180 degrees.
    for (Numbers6& place : places_) place = twist_of(transform_of(place));
    const CovarianceOverPoses uncertain = covariance();
    out.covariance = uncertain.covariance;
    out.uncertainty_factor = uncertain.factor;
    return out;
}

}  // namespace

BundleResult adjust_bundle(const std::vector<PoseObservation>& poses, const BoardSpec& board, const RigEstimate& start,
                           const BundleSettings& settings) {
    return Bundle(poses, board, start, settings).run();
}

}  // namespace planlight
