#include "registration/matching/find_skin.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "planning_io/types/triangle_mesh.h"
#include "registration/matching/cloud_pieces.h"
#include "registration/matching/gauss_newton.h"
#include "registration/matching/pose_search.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kDistinct_mm = 8, kDistinct_rad = 8 * std::numbers::pi / 180;
constexpr double kFacing = 0.6;          // cosine between the scan's normal and the skin's
constexpr std::size_t kJudging = 1200;   // cells that a pose is judged on at first
constexpr std::size_t kLeastCells = 60;  // of a part that is tried: 15 cm^2

struct Cell {
    Vector3d position, normal;
};

/// The cells that are no strays, and where they are in `CloudPieces::cells`.
struct Scan {
    std::vector<Cell> cells;
    std::vector<int> of_pieces;
    std::vector<int> judging;  ///< a random part of them
    const SkinLut& lut;
    const DistanceField& field;
    const FindSkinSettings& settings;
};

Scan scan_of(const CloudPieces& pieces, const SkinLut& lut, const DistanceField& field,
             const FindSkinSettings& settings, unsigned seed) {
    Scan scan{{}, {}, {}, lut, field, settings};
    for (std::size_t c = 0; c < pieces.cells.size(); ++c) {
        if (pieces.cells[c].stray) continue;
        scan.cells.push_back({pieces.cells[c].position.cast<double>(), pieces.cells[c].normal.cast<double>()});
        scan.of_pieces.push_back(static_cast<int>(c));
    }
    std::vector<int> order(scan.cells.size());
    std::iota(order.begin(), order.end(), 0);
    std::mt19937 random(seed);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    order.resize(std::min(order.size(), kJudging));
    std::sort(order.begin(), order.end());
    scan.judging = std::move(order);
    return scan;
}

enum class Place { beyond, outside, on, inside };
struct Lying {
    Place place = Place::beyond;
    double mm = 0;
};

Lying lying_of(const Scan& scan, const Cell& cell, const RigidTransform& ct_from_rig) {
    const Vector3d x = ct_from_rig * cell.position;
    Lying lying;
    Vector3d gradient;
    if (!scan.field.sample(x, lying.mm, gradient)) return lying;
    lying.place = Place::outside;
    if (lying.mm > scan.settings.near_mm) return lying;
    const SkinPoint* nearest = scan.lut.nearest_skin(x);
    if (!nearest || nearest->flags != kSkin) {
        lying.place = Place::beyond;
        return lying;
    }
    if (lying.mm < -scan.settings.inside_mm)
        lying.place = Place::inside;
    else if (std::abs(lying.mm) < scan.settings.near_mm &&
             gradient.dot(ct_from_rig.linear() * cell.normal) > kFacing * gradient.norm())
        lying.place = Place::on;
    return lying;
}

/// What a pose explains of some of the cells: those on the skin, the nearer the more, less those inside.
double explained(const Scan& scan, const std::vector<int>& which, const RigidTransform& ct_from_rig) {
    double sum = 0;
    for (const int c : which) {
        const Lying lying = lying_of(scan, scan.cells[static_cast<std::size_t>(c)], ct_from_rig);
        if (lying.place == Place::on) {
            const double u = lying.mm / scan.settings.near_mm;
            sum += (1 - u * u) * (1 - u * u);
        } else if (lying.place == Place::inside) {
            sum -= scan.settings.inside_penalty * std::min(1., -lying.mm / scan.settings.inside_mm - 1 + 0.3);
        }
    }
    return sum;
}

/// A part of the scan to be tried alone.
struct Part {
    std::vector<int> cells;  ///< of CloudPieces
    double holds = 0;        ///< how well its shape holds a pose
};

/// The cells within reach of one, gone to over the surface; `within_piece`: over no crease.
std::vector<int> cells_round(const CloudPieces& pieces, int start, double reach_mm, bool within_piece) {
    std::vector<int> found{start};
    std::vector<char> seen(pieces.cells.size(), 0);
    seen[static_cast<std::size_t>(start)] = 1;
    const CloudCell& first = pieces.cells[static_cast<std::size_t>(start)];
    for (std::size_t i = 0; i < found.size(); ++i)
        for (const int next : pieces.cells[static_cast<std::size_t>(found[i])].touching) {
            const CloudCell& cell = pieces.cells[static_cast<std::size_t>(next)];
            if (seen[static_cast<std::size_t>(next)] || (within_piece && cell.piece != first.piece)) continue;
            seen[static_cast<std::size_t>(next)] = 1;
            if ((cell.position - first.position).norm() < reach_mm) found.push_back(next);
        }
    return found;
}

/// The weakest way's share of the information of point to plane: nothing for a plane, a ball or a cylinder.
double holds_a_pose(const CloudPieces& pieces, const std::vector<int>& part, double reach_mm) {
    Vector3d middle = Vector3d::Zero();
    for (const int c : part)
        middle += pieces.cells[static_cast<std::size_t>(c)].position.cast<double>() / static_cast<double>(part.size());
    Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
    for (const int c : part) {
        const CloudCell& cell = pieces.cells[static_cast<std::size_t>(c)];
        const Vector3d n = cell.normal.cast<double>();
        Eigen::Matrix<double, 6, 1> row;
        row << (cell.position.cast<double>() - middle).cross(n) / (0.7 * reach_mm), n;
        H += row * row.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(H, Eigen::EigenvaluesOnly);
    return std::max(solver.eigenvalues()(0), 0.);
}

/// Places spread over the scan, each farthest from those before, with the part round each. Those that hold a pose best
/// come first, among some that cover the whole scan thinly and then among the others: the most shapely part of a scan
/// may be crumpled cloth.
std::vector<Part> parts_of(const CloudPieces& pieces, const Scan& scan, const FindSkinSettings& settings) {
    constexpr double kApart_mm = 22, kThinly_mm = 40, kFlat = 1e-3;
    std::vector<Part> parts;
    if (scan.cells.empty()) return parts;
    std::vector<double> nearest_mm(scan.cells.size(), std::numeric_limits<double>::infinity());
    std::size_t next = 0, thin = 0;
    for (double apart_mm = kThinly_mm; apart_mm >= kApart_mm; apart_mm = nearest_mm[next]) {
        if (apart_mm >= kThinly_mm) thin = parts.size();
        for (std::size_t i = 0; i < scan.cells.size(); ++i)
            nearest_mm[i] = std::min(nearest_mm[i], (scan.cells[i].position - scan.cells[next].position).norm());
        std::vector<int> alone = cells_round(pieces, scan.of_pieces[next], settings.reach_mm, true);
        std::vector<int> with_others = cells_round(pieces, scan.of_pieces[next], settings.reach_mm, false);
        const bool same = 100 * with_others.size() < 115 * alone.size();
        for (auto* cells : {&alone, &with_others}) {
            if (cells->size() < kLeastCells || (same && cells == &alone)) continue;
            const double holds = holds_a_pose(pieces, *cells, settings.reach_mm);
            if (holds > kFlat * static_cast<double>(cells->size())) parts.push_back({std::move(*cells), holds});
        }
        next = static_cast<std::size_t>(std::max_element(nearest_mm.begin(), nearest_mm.end()) - nearest_mm.begin());
    }
    const auto better = [](const Part& a, const Part& b) { return a.holds > b.holds; };
    std::stable_sort(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(thin), better);
    std::stable_sort(parts.begin() + static_cast<std::ptrdiff_t>(thin), parts.end(), better);
    if (parts.size() > static_cast<std::size_t>(settings.max_places))
        parts.resize(static_cast<std::size_t>(settings.max_places));
    return parts;
}

struct Pose {
    RigidTransform ct_from_rig;
    double explained = 0;
    int agreeing = 1;
};

/// The poses that one part leads to, the best by what they explain of the whole scan.
std::vector<Pose> poses_of_part(const CloudPieces& pieces, const Scan& scan, const Part& part, const MatchingSkin& skin,
                                const InitialMatchSettings& search_settings) {
    constexpr std::size_t kKept = 8;
    std::vector<SurfaceSite> sites;
    for (const int c : part.cells) {
        const CloudCell& cell = pieces.cells[static_cast<std::size_t>(c)];
        Vector3f sum = Vector3f::Zero();
        float count = 1;
        sum += cell.normal;
        for (const int other : cell.touching) sum += pieces.cells[static_cast<std::size_t>(other)].normal, count += 1;
        sites.push_back({cell.position, sum.normalized(), sum.norm() > 0.75F * count});
    }
    const std::vector<Base> bases = choose_bases(sites, scan.settings.bases_per_place, search_settings.seed);
    const PoseSearch search = prepare_search(std::move(sites), skin, search_settings);
    std::vector<Pose> poses;
    std::size_t scored = 0;
    for (const Base& base : bases) {
        std::vector<MatchCandidate> candidates = candidates_of_base(search, base, scored);
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const auto& a, const auto& b) { return a.cost_mm < b.cost_mm; });
        for (std::size_t i = 0; i < std::min(candidates.size(), kKept); ++i)
            poses.push_back({candidates[i].ct_from_rig, explained(scan, scan.judging, candidates[i].ct_from_rig)});
    }
    return poses;
}

struct Known {
    std::vector<Pose> poses;  ///< distinct, best first
    Vector3d centre_in_rig;

    bool same(const RigidTransform& a, const RigidTransform& b) const {
        return (a * centre_in_rig - b * centre_in_rig).norm() < kDistinct_mm && angle_between(a, b) < kDistinct_rad;
    }
    void sort() {
        std::stable_sort(poses.begin(), poses.end(),
                         [](const Pose& a, const Pose& b) { return a.explained > b.explained; });
    }
    /// Adds what one part led to; a pose that is known gains an agreeing part, once.
    void add(const std::vector<Pose>& fresh) {
        const std::size_t before = poses.size();
        std::vector<char> agreed(before, 0);
        for (const Pose& pose : fresh) {
            const auto known = std::find_if(poses.begin(), poses.end(),
                                            [&](const Pose& p) { return same(p.ct_from_rig, pose.ct_from_rig); });
            if (known == poses.end()) {
                poses.push_back(pose);
                continue;
            }
            const auto at = static_cast<std::size_t>(known - poses.begin());
            if (at < before && !agreed[at]) ++known->agreeing, agreed[at] = 1;
            if (pose.explained > known->explained)
                known->ct_from_rig = pose.ct_from_rig, known->explained = pose.explained;
        }
        sort();
    }
    void drop_twins() {
        sort();
        std::vector<Pose> distinct;
        for (const Pose& pose : poses) {
            const auto known = std::find_if(distinct.begin(), distinct.end(),
                                            [&](const Pose& p) { return same(p.ct_from_rig, pose.ct_from_rig); });
            if (known == distinct.end())
                distinct.push_back(pose);
            else
                known->agreeing = std::max(known->agreeing, pose.agreeing);
        }
        poses = std::move(distinct);
    }
    double ratio() const {
        return poses.size() < 2 ? 0 : (poses[0].explained + 1) / std::max(poses[1].explained + 1, 1.);
    }
};

std::vector<int> all_of(const Scan& scan) {
    std::vector<int> all(scan.cells.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

/// Draws the pose onto the cells near the skin alone, a few times.
void settle(const Scan& scan, const std::vector<int>& all, Pose& pose) {
    constexpr int kRounds = 3;
    constexpr double kNear_mm = 4;
    pose.explained = explained(scan, all, pose.ct_from_rig);
    for (int round = 0; round < kRounds; ++round) {
        std::vector<Vector3d> near;
        for (const int c : all) {
            const Cell& cell = scan.cells[static_cast<std::size_t>(c)];
            double mm;
            Vector3d gradient;
            if (!scan.field.sample(pose.ct_from_rig * cell.position, mm, gradient) || std::abs(mm) > kNear_mm) continue;
            if (gradient.dot(pose.ct_from_rig.linear() * cell.normal) > kFacing * gradient.norm())
                near.push_back(cell.position);
        }
        if (near.size() < 12) return;
        Vector3d centre = Vector3d::Zero();
        for (const Vector3d& p : near) centre += p / static_cast<double>(near.size());
        const RigidTransform moved = refine_roughly(PointArrays(near, centre), scan.field, pose.ct_from_rig);
        const double now = explained(scan, all, moved);
        if (now <= pose.explained) return;
        pose.ct_from_rig = moved;
        pose.explained = now;
    }
}

/// Connected cells on the skin: those that stand alone go, holes are filled, small islands go.
std::vector<char> skin_cells(const CloudPieces& pieces, const Scan& scan, const RigidTransform& ct_from_rig) {
    constexpr double kAlone = 0.4, kHole = 0.6, kIsland = 0.1;
    std::vector<char> on(pieces.cells.size(), 0);
    for (std::size_t i = 0; i < scan.cells.size(); ++i)
        on[static_cast<std::size_t>(scan.of_pieces[i])] = lying_of(scan, scan.cells[i], ct_from_rig).place == Place::on;
    const auto share_round = [&](const std::vector<char>& marks, std::size_t c) {
        const auto& touching = pieces.cells[c].touching;
        double count = 0;
        for (const int other : touching) count += marks[static_cast<std::size_t>(other)];
        return touching.empty() ? 0 : count / static_cast<double>(touching.size());
    };
    std::vector<char> opened = on;
    for (std::size_t c = 0; c < on.size(); ++c) opened[c] = on[c] && share_round(on, c) >= kAlone;
    std::vector<char> closed = opened;
    for (std::size_t c = 0; c < on.size(); ++c)
        closed[c] = opened[c] || (!pieces.cells[c].stray && share_round(opened, c) >= kHole);
    std::vector<char> kept(on.size(), 0), seen(on.size(), 0);
    std::vector<std::vector<int>> islands;
    std::size_t largest = 0;
    for (std::size_t c = 0; c < on.size(); ++c) {
        if (!closed[c] || seen[c]) continue;
        std::vector<int> island{static_cast<int>(c)};
        seen[c] = 1;
        for (std::size_t i = 0; i < island.size(); ++i)
            for (const int next : pieces.cells[static_cast<std::size_t>(island[i])].touching)
                if (closed[static_cast<std::size_t>(next)] && !seen[static_cast<std::size_t>(next)])
                    seen[static_cast<std::size_t>(next)] = 1, island.push_back(next);
        largest = std::max(largest, island.size());
        islands.push_back(std::move(island));
    }
    for (const auto& island : islands)
        if (static_cast<double>(island.size()) >= std::max(12., kIsland * static_cast<double>(largest)))
            for (const int c : island) kept[static_cast<std::size_t>(c)] = 1;
    return kept;
}

/// The cells that go on smoothly from the skin found, near the skin of the CT and facing as it does, against those of
/// the skin.
double goes_on(const CloudPieces& pieces, const Scan& scan, const RigidTransform& ct_from_rig,
               const std::vector<char>& skin) {
    constexpr double kBeside_mm = 10;
    std::vector<char> beside(pieces.cells.size(), 0);
    for (std::size_t i = 0; i < scan.cells.size(); ++i) {
        const auto c = static_cast<std::size_t>(scan.of_pieces[i]);
        double mm;
        Vector3d gradient;
        if (skin[c] || !scan.field.sample(ct_from_rig * scan.cells[i].position, mm, gradient)) continue;
        beside[c] = std::abs(mm) < kBeside_mm && lying_of(scan, scan.cells[i], ct_from_rig).place != Place::beyond &&
                    gradient.dot(ct_from_rig.linear() * scan.cells[i].normal) > kFacing * gradient.norm();
    }
    std::vector<int> front;
    for (std::size_t c = 0; c < skin.size(); ++c)
        if (skin[c]) front.push_back(static_cast<int>(c));
    const auto count = static_cast<double>(front.size());
    for (std::size_t i = 0; i < front.size(); ++i) {
        const CloudCell& cell = pieces.cells[static_cast<std::size_t>(front[i])];
        for (const int next : cell.touching) {
            const auto n = static_cast<std::size_t>(next);
            if (!beside[n] || pieces.cells[n].piece != cell.piece) continue;
            beside[n] = 0;
            front.push_back(next);
        }
    }
    return count == 0 ? 0 : (static_cast<double>(front.size()) - count) / count;
}

FoundSkin evidence(const PointCloud& cloud, const CloudPieces& pieces, const Scan& scan, const Known& known) {
    FoundSkin found;
    const Pose& best = known.poses.front();
    found.ct_from_rig = best.ct_from_rig;
    found.explained = best.explained;
    found.rival_ratio = known.ratio();
    found.places_agreeing = best.agreeing;
    const std::vector<char> kept = skin_cells(pieces, scan, best.ct_from_rig);
    found.goes_on_fraction = goes_on(pieces, scan, best.ct_from_rig, kept);
    found.is_skin.assign(cloud.size(), 0);
    for (std::size_t i = 0; i < cloud.size(); ++i)
        if (pieces.cell_of_point[i] >= 0) found.is_skin[i] = kept[static_cast<std::size_t>(pieces.cell_of_point[i])];
    double skin = 0, inside = 0;
    for (std::size_t i = 0; i < scan.cells.size(); ++i) {
        skin += kept[static_cast<std::size_t>(scan.of_pieces[i])];
        inside += lying_of(scan, scan.cells[i], best.ct_from_rig).place == Place::inside;
    }
    const double count = std::max(1., static_cast<double>(scan.cells.size()));
    found.skin_fraction = skin / count;
    found.inside_fraction = inside / count;
    return found;
}

}  // namespace

std::optional<FoundSkin> find_skin(const PointCloud& cloud, const CloudPieces& pieces, const SkinLut& lut,
                                   const MatchingSkin& skin, const InitialMatch& of_whole,
                                   const InitialMatchSettings& search, const FindSkinSettings& settings) {
    constexpr int kFirst = 8, kBatch = 4, kAgreeing = 3;
    constexpr std::size_t kSettled = 12;
    const Scan scan = scan_of(pieces, lut, skin.parts().field, settings, search.seed);
    if (scan.cells.size() < kLeastCells) return std::nullopt;
    const std::vector<Part> parts = parts_of(pieces, scan, settings);
    Known known;
    known.centre_in_rig.setZero();
    for (const Cell& cell : scan.cells) known.centre_in_rig += cell.position / static_cast<double>(scan.cells.size());
    std::vector<Pose> of_all;
    for (std::size_t i = 0; i < std::min<std::size_t>(of_whole.candidates.size(), 10); ++i)
        of_all.push_back(
            {of_whole.candidates[i].ct_from_rig, explained(scan, scan.judging, of_whole.candidates[i].ct_from_rig)});
    known.add(of_all);
    const int count = static_cast<int>(parts.size());
    int tried = 0;
    while (tried < count) {
        const int batch = std::min(tried == 0 ? kFirst : kBatch, count - tried);
        std::vector<std::vector<Pose>> found(static_cast<std::size_t>(batch));
        tbb::parallel_for(0, batch, [&](int i) {
            found[static_cast<std::size_t>(i)] =
                poses_of_part(pieces, scan, parts[static_cast<std::size_t>(tried + i)], skin, search);
        });
        for (const auto& of_part : found) known.add(of_part);
        tried += batch;
        if (!known.poses.empty() && known.poses[0].agreeing >= kAgreeing && known.ratio() >= settings.clear_ratio)
            break;
    }
    if (known.poses.empty()) return std::nullopt;
    known.poses.resize(std::min(known.poses.size(), kSettled));
    const std::vector<int> all = all_of(scan);
    tbb::parallel_for(std::size_t{0}, known.poses.size(), [&](std::size_t i) { settle(scan, all, known.poses[i]); });
    known.drop_twins();
    FoundSkin found = evidence(cloud, pieces, scan, known);
    found.places_tried = tried;
    return found;
}

}  // namespace planlight
