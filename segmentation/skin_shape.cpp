#include "segmentation/skin_shape.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "planning_io/types/statistics.h"
#include "segmentation/coarse_body.h"
#include "segmentation/triangle_area.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kBallGrid_mm = 4, kUpperHead_mm = 150, kMostDepth_mm = 130;
constexpr double kStrandGrid_mm = 3, kThin_mm = 7, kLongestStrand_mm = 300;
constexpr double kLeastCut_cm2 = 1;
constexpr double kUsualSkull_mm = 75;  // radius of an adult's: thick hair makes the ball larger, not the head longer
constexpr double kCell_mm = 4, kSteep = 0.4;  // of the nose's search

bool is_cut(const TriangleMesh& skin, const std::array<std::int32_t, 3>& t) {
    return std::all_of(t.begin(), t.end(),
                       [&](std::int32_t c) { return skin.flags[static_cast<std::size_t>(c)] == kCutPlane; });
}

/// What ends at a side with this normal, `below_mm` under the skull's middle. Shoulders and neck end at every side of a
/// volume; an adult's chin lies 110 to 140 mm below.
const char* name_of_end(const Vector3d& normal, double below_mm, double radius_mm) {
    const double skull_mm = std::min(radius_mm, kUsualSkull_mm);
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const bool up = normal[axis] > 0;
    if (axis == 2) return up ? "crown" : below_mm > 1.5 * skull_mm ? "neck" : "chin";
    if (below_mm > 1.3 * skull_mm) return "neck";
    if (axis == 1) return up ? "back" : "face";
    return up ? "left side" : "right side";
}

/// The front of a head, seen from before it: the least y of each cell of x and z.
class Front {
public:
    Front(const TriangleMesh& skin, const HeadBall& ball) {
        const Vector3d& c = ball.centre_in_ct;
        lowest_mm_ = c.z();
        double sum = 0, count = 0;
        for (const auto& p : skin.vertices_in_ct) {
            if (p.z() > c.z() && p.y() < c.y()) sum += p.x(), count += 1;
            lowest_mm_ = std::min(lowest_mm_, p.z());
            if (p.y() > c.y() || std::abs(p.x() - c.x()) > 1.2 * ball.radius_mm) continue;
            const auto [at, fresh] = least_y_.emplace(std::pair(cell(p.x()), cell(p.z())), p.y());
            if (!fresh) at->second = std::min(at->second, p.y());
        }
        middle_x_ = count > 0 ? sum / count : NAN;
    }
    static int cell(double mm) { return static_cast<int>(std::floor(mm / kCell_mm)); }
    double middle_x() const { return middle_x_; }    ///< of the forehead; not a number without one
    double lowest_mm() const { return lowest_mm_; }  ///< the least z

    /// How far the skin near `x` stands out before what lies `scale` times 24 to 36 mm to both sides, if it falls away
    /// as steeply as a nose; a round chin or crown falls away a quarter as much half as far out.
    double ridge_mm(double x, int z, double scale) const {
        const auto ridge = between(x - 6 * scale, x + 6 * scale, z), left = between(x + 24 * scale, x + 36 * scale, z),
                   right = between(x - 36 * scale, x - 24 * scale, z),
                   near_left = between(x + 12 * scale, x + 18 * scale, z),
                   near_right = between(x - 18 * scale, x - 12 * scale, z);
        if (ridge.empty() || left.empty() || right.empty() || near_left.empty() || near_right.empty()) return 0;
        const double tip = *std::min_element(ridge.begin(), ridge.end());
        const double out_mm = std::min(median(left), median(right)) - tip;
        return std::min(median(near_left), median(near_right)) - tip < kSteep * out_mm ? 0 : out_mm;
    }

private:
    std::vector<double> between(double from, double to, int z) const {
        std::vector<double> ys;
        for (int x = cell(from); x <= cell(to); ++x)
            if (const auto at = least_y_.find({x, z}); at != least_y_.end()) ys.push_back(at->second);
        return ys;
    }
    std::map<std::pair<int, int>, double> least_y_;
    double middle_x_ = 0, lowest_mm_ = 0;
};

}  // namespace

HeadBall largest_ball(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin) {
    const CoarseBody coarse = coarse_body(volume, mask, skin, kBallGrid_mm, 1);
    const auto depth = distance_from(coarse.body, 0, coarse.places.grid, kMostDepth_mm);
    HeadBall ball;
    for (std::size_t v = 0; v < coarse.body.size(); ++v) {
        const Vector3d at = coarse.places.place_of(v);
        if (coarse.high_in_ct.z() - at.z() > kUpperHead_mm || static_cast<double>(depth[v]) <= ball.radius_mm) continue;
        if (!coarse.places.measured[v] || !coarse.body[v]) continue;
        ball = {static_cast<double>(depth[v]), at};
    }
    return ball;
}

double strand_length_mm(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin) {
    CoarseBody coarse = coarse_body(volume, mask, skin, kStrandGrid_mm, 0);
    const VoxelGrid& grid = coarse.places.grid;
    Mask& body = coarse.body;
    const auto depth = distance_from(body, 0, grid, kThin_mm + kStrandGrid_mm);
    Mask core(body.size());
    for (std::size_t v = 0; v < core.size(); ++v) core[v] = static_cast<double>(depth[v]) > kThin_mm;
    core = largest_piece(std::move(core), grid).mask;
    const auto from_core = distance_from(core, 1, grid, kThin_mm + 2 * kStrandGrid_mm);
    std::vector<std::size_t> front;
    for (std::size_t v = 0; v < body.size(); ++v)
        if (body[v] && static_cast<double>(from_core[v]) < kThin_mm + kStrandGrid_mm) front.push_back(v), body[v] = 0;
    double reached_mm = 0;
    for (double way_mm = kStrandGrid_mm; !front.empty() && way_mm < kLongestStrand_mm; way_mm += kStrandGrid_mm) {
        std::vector<std::size_t> next;
        for (const std::size_t v : front)
            for_face_neighbours(grid, v, [&](std::size_t n) {
                if (body[n]) body[n] = 0, next.push_back(n);
            });
        if (!next.empty()) reached_mm = way_mm;
        front = std::move(next);
    }
    return reached_mm;
}

std::vector<CutSide> cut_sides_of(const TriangleMesh& skin, const HeadBall& ball) {
    std::map<std::string, CutSide> sides;
    if (!skin.flags.empty())
        for (const auto& t : skin.triangles) {
            if (!is_cut(skin, t)) continue;
            const Vector3d area = area_in_ct(skin, t);
            const double cm2 = area.norm() / 100;
            const double below_mm = ball.centre_in_ct.z() - skin.vertices_in_ct[static_cast<std::size_t>(t[0])].z();
            const std::string name = name_of_end(area.normalized(), below_mm, ball.radius_mm);
            CutSide& side = sides[name];
            side = {name, side.area_cm2 + cm2, name == "neck"};
        }
    std::vector<CutSide> large;
    for (const auto& [name, side] : sides)
        if (side.area_cm2 > kLeastCut_cm2) large.push_back(side);
    return large;
}

double nose_length_mm(const TriangleMesh& skin, const HeadBall& ball) {
    const Front front(skin, ball);
    const Vector3d& c = ball.centre_in_ct;
    const double r = ball.radius_mm;
    if (std::isnan(front.middle_x()) || c.z() - front.lowest_mm() < 0.75 * r) return NAN;
    double best = 0;
    for (int z = Front::cell(c.z() - 1.6 * r); z <= Front::cell(c.z() - 0.2 * r); ++z)
        for (double aside = -16; aside <= 16; aside += 4)  // a head may lie askew
            best = std::max(best, front.ridge_mm(front.middle_x() + aside, z, r / 72));
    return best;
}

}  // namespace planlight
