#include "segmentation/skin_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "planning_io/types/statistics.h"
#include "segmentation/coarse_body.h"
#include "segmentation/distance_transform.h"
#include "segmentation/triangle_area.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kBallGrid_mm = 4, kUpperHead_mm = 150, kMostDepth_mm = 130;
constexpr double kStrandGrid_mm = 3, kThin_mm = 7, kLongestStrand_mm = 300;
constexpr double kLeastCut_cm2 = 1;
constexpr double kUsualSkull_mm = 75;  // radius of an adult's: thick hair makes the ball larger, not the head longer
constexpr double kCell_mm = 4, kSteep = 0.4;  // of the nose's search
constexpr double kSureNose_mm = 25;  // of an adult's: what is less is sought askew, where less is no nose (a cut's rim)

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

/// The front of a head, seen from before it in a frame about the skull's middle: the least y of each cell of x and z.
class Front {
public:
    Front(const TriangleMesh& skin, const HeadBall& ball, const Eigen::Matrix3d& head_from_ct, bool with_ends) {
        double sum = 0, count = 0;
        for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
            if (!with_ends && !skin.flags.empty() && skin.flags[v] == kCutPlane) continue;
            const Vector3d p = head_from_ct * (skin.vertices_in_ct[v] - ball.centre_in_ct);
            if (p.z() > 0 && p.y() < 0) sum += p.x(), count += 1;
            lowest_mm_ = std::min(lowest_mm_, p.z());
            if (p.y() > 0 || std::abs(p.x()) > 1.2 * ball.radius_mm) continue;
            const auto [at, fresh] = least_y_.emplace(std::pair(cell(p.x()), cell(p.z())), p.y());
            if (!fresh) at->second = std::min(at->second, p.y());
        }
        middle_x_ = count > 0 ? sum / count : NAN;
    }
    static int cell(double mm) { return static_cast<int>(std::floor(mm / kCell_mm)); }
    double middle_x() const { return middle_x_; }    ///< of the forehead; not a number without one
    double lowest_mm() const { return lowest_mm_; }  ///< the least z, at most 0

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

double longest_ridge_mm(const Front& front, double radius_mm) {
    double best = 0;
    for (int z = Front::cell(-1.6 * radius_mm); z <= Front::cell(-0.2 * radius_mm); ++z)
        for (double aside = -16; aside <= 16; aside += 4)  // a head may lie askew
            best = std::max(best, front.ridge_mm(front.middle_x() + aside, z, radius_mm / 72));
    return best;
}

/// The frame of a head that leans and looks aside as its middle plane does.
Eigen::Matrix3d upright_from_ct(const MiddlePlane& plane) {
    const Vector3d left = plane.left_in_ct(), back = Vector3d::UnitZ().cross(left).normalized();
    Eigen::Matrix3d rows;
    rows << left.transpose(), back.transpose(), left.cross(back).transpose();
    return rows;
}

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

std::string where_on_head(const std::vector<Vector3d>& places_in_ct, const HeadBall& ball) {
    std::map<std::string, std::size_t> counts;
    for (const Vector3d& p : places_in_ct) {
        const Vector3d from = p - ball.centre_in_ct;
        const std::string name = name_of_end(from.normalized(), -from.z(), ball.radius_mm);
        ++counts[name == "face" && from.z() > 0 ? "forehead" : name];
    }
    std::string words;
    for (const auto& [name, count] : counts)
        if (5 * count >= places_in_ct.size()) words += (words.empty() ? "the " : ", the ") + name;
    return words;
}

std::vector<CutSide> cut_sides_of(const TriangleMesh& skin, const HeadBall& ball,
                                  const std::vector<std::uint8_t>& boneless) {
    std::map<std::string, CutSide> sides;
    if (!skin.flags.empty())
        for (const auto& t : skin.triangles) {
            if (!is_cut(skin, t)) continue;
            const Vector3d area = area_in_ct(skin, t);
            const double cm2 = area.norm() / 100;
            const double below_mm = ball.centre_in_ct.z() - skin.vertices_in_ct[static_cast<std::size_t>(t[0])].z();
            const std::string name = name_of_end(area.normalized(), below_mm, ball.radius_mm);
            CutSide& side = sides[name];
            const double bare =
                boneless.empty() ? 0 : std::accumulate(t.begin(), t.end(), 0.0, [&](double sum, auto c) {
                    return sum + boneless[static_cast<std::size_t>(c)] / 3.0;
                });
            side = {name, side.area_cm2 + cm2, name == "neck", side.boneless_cm2 + bare * cm2};
        }
    std::vector<CutSide> large;
    for (const auto& [name, side] : sides)
        if (side.area_cm2 > kLeastCut_cm2) large.push_back(side);
    return large;
}

double nose_length_mm(const TriangleMesh& skin, const HeadBall& ball, const MiddlePlane& plane) {
    const double r = ball.radius_mm;
    const Front straight(skin, ball, Eigen::Matrix3d::Identity(), true);
    if (std::isnan(straight.middle_x()) || straight.lowest_mm() > -0.75 * r) return NAN;
    double best = longest_ridge_mm(straight, r);
    if (!plane.looks_aside() || best > kSureNose_mm * r / 72) return best;
    const Front aside(skin, ball, upright_from_ct(plane), false);
    if (!std::isnan(aside.middle_x()))
        if (const double ridge_mm = longest_ridge_mm(aside, r); ridge_mm > kSureNose_mm * r / 72) return ridge_mm;
    return best;
}

}  // namespace planlight
