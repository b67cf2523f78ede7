// Ours against Open3D, PCL and VTK on the same scans, in one run: the global match from any pose, and the fine match.
//   compare_matchers [TRIALS [SEED]] [--ch2 FILE] [--mannequin FILE] [--ct-head FOLDER]   (default 24)
// Processor seconds of all threads; what each prepares of the skin once (table, trees, features) is not in them. Errors
// of the global match are of the pose before any fine match. Each method sees every trial; they take turns.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "registration/matching/initial_match.h"
#include "registration/matching/refine_icp.h"
#include "segmentation/build_skin_lut.h"
#include "tests/benchmarks/peer_matchers.h"
#include "tests/registration/matching/trial_heads.h"
#include "tests/registration/matching/trial_options.h"
#include "tests/registration/matching/trial_record.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

struct Row {
    std::string name;
    std::vector<double> error_mm, seconds;
    int found = 0;
};

/// The surface's vertices that are skin, with normals from the triangles round them.
PeerSkin peer_skin(const TriangleMesh& mesh) {
    PeerSkin skin;
    skin.mesh = &mesh;
    std::vector<Vector3d> normals(mesh.vertices_in_ct.size(), Vector3d::Zero());
    for (const auto& t : mesh.triangles) {
        const auto corner = [&](std::size_t i) { return mesh.vertices_in_ct[static_cast<std::size_t>(t[i])]; };
        const Vector3d area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        for (const auto v : t) normals[static_cast<std::size_t>(v)] += area;
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if ((!mesh.flags.empty() && mesh.flags[i] != kSkin) || normals[i].norm() == 0) continue;
        skin.points_in_ct.push_back(mesh.vertices_in_ct[i]);
        skin.normals_in_ct.push_back(normals[i].normalized());
    }
    return skin;
}

/// A scan as a room gives it: 140 to 230 mm wide, from the front to the sides.
TrialScan some_scan(const TrialHead& head, unsigned seed, double noise_mm, double strays, double moved_mm) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit;
    const double azimuth = (2 * unit(random) - 1) * 1.6, up = 0.5 * unit(random) - 0.1;
    TrialScanSettings scan;
    scan.from_in_ct = Vector3d(std::sin(azimuth) * std::cos(up), -std::cos(azimuth) * std::cos(up), std::sin(up));
    scan.roll = 6 * unit(random);
    scan.width_mm = 140 + 90 * unit(random);
    scan.noise_mm = noise_mm;
    scan.stray_share = strays;
    scan.movement = "waves of 25 mm";
    scan.movement_mm = moved_mm;
    scan.seed = seed;
    return trial_scan(head.surface, scan);
}

PeerMatcher our_global(const SkinLut& lut) {
    return {"ours: contact triplets on the table", [&lut](const PointCloud& scan, const RigidTransform&) {
                const InitialMatch match = find_initial_match(scan, lut);
                return match.candidates.empty() ? RigidTransform::Identity() : match.candidates[0].ct_from_rig;
            }};
}

PeerMatcher our_icp(const SkinLut& lut, IcpSettings::Mode mode, const std::string& name) {
    return {name, [&lut, mode](const PointCloud& scan, const RigidTransform& start) {
                IcpSettings settings;
                settings.mode = mode;
                return refine_icp(scan, lut, start, settings).ct_from_rig;
            }};
}

double rms_over(const PointCloud& scan, const RigidTransform& a, const RigidTransform& b) {
    double sum = 0;
    for (const auto& p : scan.points_in_rig) sum += (a * p - b * p).squaredNorm();
    return std::sqrt(sum / static_cast<double>(scan.size()));
}

void compete(const std::vector<PeerMatcher>& matchers, const TrialScan& scan, const RigidTransform& start, bool global,
             std::vector<Row>& rows) {
    rows.resize(matchers.size());
    constexpr double kSlow_s = 4;
    for (std::size_t i = 0; i < matchers.size(); ++i) {
        if (rows[i].seconds.size() >= 3 && quantile(rows[i].seconds, 0.5) > kSlow_s) continue;
        const double before = processor_seconds();
        const RigidTransform ct_from_rig = matchers[i].match(scan.cloud, start);
        rows[i].seconds.push_back(processor_seconds() - before);
        rows[i].name = matchers[i].name;
        const PoseError error = pose_error(ct_from_rig.inverse(), scan);
        const bool found = error.turn_deg < 3 && error.middle_mm < 5;
        rows[i].found += found;
        if (!global)
            rows[i].error_mm.push_back(rms_over(scan.cloud, ct_from_rig, scan.rig_from_ct.inverse()));
        else if (found)
            rows[i].error_mm.push_back(error.target_mm);
    }
}

void print_rows(const std::string& title, const std::string& error, const std::vector<Row>& rows) {
    fmt::print(
        "\n{}\n\n| | within 3 degrees, 5 mm | processor s: median, 95 % | {}: median, worst |\n|---|---|---|---|\n",
        title, error);
    for (const Row& row : rows)
        fmt::print("| {} | {} of {} | {:.4f}, {:.4f} | {:.3f}, {:.3f} |\n", row.name, row.found, row.seconds.size(),
                   quantile(row.seconds, 0.5), quantile(row.seconds, 0.95), quantile(row.error_mm, 0.5),
                   quantile(row.error_mm, 1));
}

RigidTransform disturbed(const RigidTransform& ct_from_rig, const Vector3d& middle_in_ct, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> any;
    const double x = any(random), y = any(random), z = any(random), a = any(random), b = any(random), c = any(random);
    RigidTransform off = RigidTransform::Identity();
    off.linear() = Eigen::AngleAxisd(5 * std::numbers::pi / 180, Vector3d(x, y, z).normalized()).toRotationMatrix();
    off.translation() = middle_in_ct - off.linear() * middle_in_ct + 10 * Vector3d(a, b, c).normalized();
    return off * ct_from_rig;
}

void add(std::vector<PeerMatcher>& all, std::vector<PeerMatcher> more) {
    for (PeerMatcher& one : more) all.push_back(std::move(one));
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    using namespace planlight;
    using namespace planlight::test;
    const TrialOptions options = trial_options(argc, argv, 24);
    const std::vector<TrialHead> heads = trial_heads(options.files);
    std::vector<Row> clean, room, fine;
    for (std::size_t h = 0; h < heads.size(); ++h) {
        const TriangleMesh& mesh = heads[h].surface.mesh();
        const PeerSkin skin = peer_skin(mesh);
        const SkinLut of_truth =
            build_skin_lut(mesh);  // the fine match: scan and target are the same surface for everyone
        std::vector<PeerMatcher> global{our_global(heads[h].lut)};
        add(global, open3d_global(skin));
        add(global, pcl_global(skin));
        std::vector<PeerMatcher> icp{
            our_icp(of_truth, IcpSettings::Mode::signed_distance, "ours: signed distance, robust"),
            our_icp(of_truth, IcpSettings::Mode::closest_point, "ours: the paper's closest point")};
        add(icp, open3d_icp(skin));
        add(icp, pcl_icp(skin));
        add(icp, vtk_icp(skin));
        for (unsigned i = static_cast<unsigned>(h); i < options.trials; i += static_cast<unsigned>(heads.size())) {
            const unsigned seed = options.seed + i;
            const TrialScan good = some_scan(heads[h], seed, 0.3, 0.05, 0);
            compete(global, good, RigidTransform::Identity(), true, clean);
            compete(global, some_scan(heads[h], seed, 0.5, 0.2, 0.8), RigidTransform::Identity(), true, room);
            compete(icp, good, disturbed(good.rig_from_ct.inverse(), good.middle_in_ct, seed), false, fine);
            fmt::print(stderr, "\r{}: scan {}   ", heads[h].name, i);
        }
        print_rows("Global match, noise 0.3 mm, 5 % strays", "error at targets of those found, mm", clean);
        print_rows("Global match, noise 0.5 mm, 20 % strays, skin moved by 0.8 mm",
                   "error at targets of those found, mm", room);
        print_rows("Fine match from 5 degrees and 10 mm off, about 20000 points, noise 0.3 mm, 5 % strays",
                   "rms over the scan, mm", fine);
        std::fflush(stdout);
    }
}
