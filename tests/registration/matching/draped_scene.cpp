#include "tests/registration/matching/draped_scene.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/registration/matching/draped_objects.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDistance_mm = 900, kBaseline_mm = 220, kSteepest_cosine = 0.26, kNothing_mm = -250;

/// The view: origin on the skin in the middle of the picture, x right, y down, z to the devices.
struct ViewFrame {
    Eigen::Isometry3d ct_from_view = Eigen::Isometry3d::Identity();
    Vector3d to_ct(const Vector3d& p) const { return ct_from_view * p; }
};

ViewFrame frame_of(const TrialSurface& head, const DrapedSceneSettings& s) {
    ViewFrame view;
    const Vector3d back = s.from_in_ct.normalized();
    const Vector3d level =
        back.cross(Vector3d::UnitZ()).norm() > 0.1 ? back.cross(Vector3d::UnitZ()).normalized() : Vector3d::UnitX();
    const Vector3d right = std::cos(s.roll) * level + std::sin(s.roll) * back.cross(level);
    view.ct_from_view.linear() << right, back.cross(right), back;
    const auto hit = head.first_hit(s.face_in_ct + 500 * back, -back);
    view.ct_from_view.translation() = hit ? hit->p_in_ct : s.face_in_ct;
    return view;
}

/// How high the head stands over the view's plane, on a grid of 3 mm; `kNothing_mm` beside it.
class HeadHeights {
public:
    static constexpr double kCell_mm = 3, kWidth_mm = 480;
    static constexpr int kSide = 161;

    HeadHeights(const TrialSurface& head, const ViewFrame& view) : z_(kSide * kSide, kNothing_mm) {
        for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i) {
                const Vector3d from(i * kCell_mm - kWidth_mm / 2, j * kCell_mm - kWidth_mm / 2, 400);
                const auto hit = head.first_hit(view.to_ct(from), -view.ct_from_view.linear().col(2));
                if (hit) at(i, j) = (view.ct_from_view.inverse() * hit->p_in_ct).z();
            }
    }
    /// A tight skin over the head and a floor: closed by discs of the radius, then smoothed; nowhere under the head.
    HeadHeights covered(double floor_mm, double radius_mm) const {
        HeadHeights result = *this;
        for (double& z : result.z_) z = std::max(z, floor_mm);
        result.take(radius_mm, true);
        result.take(radius_mm, false);
        for (int pass = 0; pass < 3; ++pass) result.smooth();
        for (std::size_t i = 0; i < z_.size(); ++i) result.z_[i] = std::max(result.z_[i], z_[i]);
        return result;
    }
    double operator()(double x, double y) const {
        const double u = std::clamp((x + kWidth_mm / 2) / kCell_mm, 0., kSide - 1.001),
                     v = std::clamp((y + kWidth_mm / 2) / kCell_mm, 0., kSide - 1.001);
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        const double a = u - i, b = v - j;
        return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) + b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
    }

private:
    double& at(int i, int j) { return z_[static_cast<std::size_t>(j * kSide + i)]; }
    double at(int i, int j) const { return z_[static_cast<std::size_t>(j * kSide + i)]; }
    void take(double radius_mm, bool highest) {
        const int r = static_cast<int>(radius_mm / kCell_mm);
        const std::vector<double> old = z_;
        for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i)
                for (int dj = -r; dj <= r; ++dj)
                    for (int di = -r; di <= r; ++di) {
                        const int k = i + di, l = j + dj;
                        if (di * di + dj * dj > r * r || k < 0 || l < 0 || k >= kSide || l >= kSide) continue;
                        const double z = old[static_cast<std::size_t>(l * kSide + k)];
                        at(i, j) = highest ? std::max(at(i, j), z) : std::min(at(i, j), z);
                    }
    }
    void smooth() {
        const std::vector<double> old = z_;
        for (int j = 1; j + 1 < kSide; ++j)
            for (int i = 1; i + 1 < kSide; ++i) {
                double sum = 0;
                for (int dj = -1; dj <= 1; ++dj)
                    for (int di = -1; di <= 1; ++di) sum += old[static_cast<std::size_t>((j + dj) * kSide + i + di)];
                at(i, j) = sum / 9;
            }
    }
    std::vector<double> z_;
};

/// Lays things round the face, in the view's frame.
class Dresser {
public:
    Dresser(const HeadHeights& head, const DrapedSceneSettings& s) : head_(head), s_(s), random_(s.seed + 977) {}

    TriangleMesh dress() {
        const std::string& kind = s_.draping;
        if (kind == "sheet behind")
            sheet_behind();
        else if (kind == "wrapped, with a hole")
            wrapped();
        else if (kind == "hand and forearm")
            sheet_behind(), hand();
        else if (kind == "tubes")
            between(0, 1) < 0.5 ? sheet_behind() : wrapped(), tubes();
        else if (kind == "towel rolls")
            sheet_behind(), rolls();
        else if (kind == "sheet touching the brow")
            sheet_behind(), touching();
        else if (kind == "crumpled cloth")
            crumpled();
        else if (kind == "table edge, retractors")
            sheet_behind(), table(), retractors();
        else
            throw std::invalid_argument("no such draping: " + kind);
        return mesh_;
    }

private:
    double between(double low, double high) { return low + (high - low) * unit_(random_); }
    double any_way() { return between(0, 2 * std::numbers::pi); }
    void add(const TriangleMesh& part) { append(part, mesh_); }

    /// Flat, 60 to 80 mm behind the face, leaning up to 8 degrees, with low waves.
    void sheet_behind() {
        const double deep = between(60, 80), lean = between(0, 0.14), way = any_way();
        const Folds folds(40, 200, between(0, 5), random_);
        add(sheet_mesh(
            [&](double x, double y) { return -deep + lean * (std::cos(way) * x + std::sin(way) * y) + folds(x, y); },
            600, 4));
    }
    /// Follows the head 2 to 20 mm over the skin, folds on it; a hole with a rim.
    void wrapped() {
        const HeadHeights over = head_.covered(-between(70, 110), between(15, 40));
        const double gap = between(2, 20), across = s_.opening_mm / 2 * between(0.95, 1.2),
                     down = s_.opening_mm / 2 * between(0.95, 1.3);
        const double turn = any_way(), height = between(0.5, 4);
        const Folds folds(25, 120, height, random_), rim(25, 80, 4, random_);
        add(sheet_mesh(
            [&](double x, double y) {
                const double u = std::cos(turn) * x + std::sin(turn) * y, v = std::cos(turn) * y - std::sin(turn) * x;
                const double r = std::hypot(u, v), to_rim = 1 - std::hypot(u / across, v / down);
                if (to_rim > 0 && to_rim * r + rim(x, y) > 0 && std::hypot(u / across, v / down) < 1)
                    return std::nan("");
                return over(x, y) + std::max(0.8, gap + folds(x, y));
            },
            470, 2.5));
    }
    void hand() {
        const int hands = between(0, 1) < 0.7 ? 1 : 2;
        for (int h = 0; h < hands; ++h) {
            const double way = any_way();
            const Vector3d in(-std::cos(way), -std::sin(way), 0), aside(in.y(), -in.x(), 0);
            const double reach = s_.opening_mm * between(0.35, 0.6), lift = between(8, 40);
            Vector3d wrist = -in * (reach + 90), knuckles = -in * (reach + 10);
            wrist.z() = head_(wrist.x(), wrist.y()) < -100 ? -20 + lift : head_(wrist.x(), wrist.y()) + 30 + lift;
            knuckles.z() = std::max(head_(knuckles.x(), knuckles.y()), -60.) + 16 + lift;
            Vector3d elbow = wrist - 260 * in;
            elbow.z() += between(20, 120);
            add(pipe_mesh({elbow, 0.5 * (elbow + wrist), wrist}, {46, 38, 27}));
            for (int k = -1; k <= 1; ++k) add(pipe_mesh({wrist + 12 * k * aside, knuckles + 20 * k * aside}, {16, 13}));
            for (int f = 0; f < 4; ++f) {
                Vector3d root = knuckles + (f - 1.5) * 19 * aside,
                         tip = root + between(40, 75) * in + between(-8, 8) * aside;
                tip.z() = std::max(head_(tip.x(), tip.y()), -60.) + between(9, 9 + lift);
                Vector3d middle = 0.5 * (root + tip);
                middle.z() = std::max({middle.z(), head_(middle.x(), middle.y()) + 9, root.z()}) + between(0, 6);
                add(pipe_mesh({root, middle, tip}, {10, 9, 7.5}));
            }
        }
    }
    void tubes() {
        const int count = 1 + static_cast<int>(between(0, 3));
        for (int t = 0; t < count; ++t) {
            const double way = any_way(), radius = between(4, 11), bend = between(-0.8, 0.8), lift = between(0, 25);
            std::vector<Vector3d> line;
            std::vector<double> radii;
            for (int i = 0; i <= 24; ++i) {
                const double far = s_.opening_mm * between(0.24, 0.26) + 9. * i, a = way + bend * far / 200;
                Vector3d p(far * std::cos(a), far * std::sin(a), 0);
                p.z() = std::max(head_(p.x(), p.y()), -70.) + radius + lift;
                if (!line.empty()) p.z() = std::clamp(p.z(), line.back().z() - 6, line.back().z() + 12);
                line.push_back(p);
                radii.push_back(radius);
            }
            add(pipe_mesh(line, radii));
        }
    }
    void rolls() {
        const int count = 2 + static_cast<int>(between(0, 3));
        const double first = any_way();
        for (int r = 0; r < count; ++r) {
            const double way = first + 2 * std::numbers::pi * r / count + between(-0.2, 0.2), radius = between(20, 36);
            const double off = s_.opening_mm / 2 + radius + between(-4, 12), half = between(70, 140);
            std::vector<Vector3d> line;
            std::vector<double> radii;
            for (int i = -10; i <= 10; ++i) {
                Vector3d p(off * std::cos(way) - i * half / 10 * std::sin(way),
                           off * std::sin(way) + i * half / 10 * std::cos(way), 0);
                p.z() = std::max(head_(p.x(), p.y()), -75.) + 0.9 * radius;
                if (!line.empty()) p.z() = std::clamp(p.z(), line.back().z() - 5, line.back().z() + 9);
                line.push_back(p);
                radii.push_back(radius * (1 + 0.06 * std::sin(1.3 * i + way)));
            }
            add(pipe_mesh(line, radii));
        }
    }
    /// Begins on the skin along a line and leaves it slowly, with no step but its thickness.
    void touching() {
        const int sides = between(0, 1) < 0.6 ? 1 : 2;
        const double first = any_way();
        for (int k = 0; k < sides; ++k) {
            const double way = first + k * std::numbers::pi + between(-0.3, 0.3),
                         rim = s_.opening_mm / 2 * between(0.9, 1.15);
            const double thick = between(0.4, 1.5), rise = between(0.02, 0.5), bow = between(0, 0.004);
            const Folds folds(40, 150, between(0, 3), random_);
            const HeadHeights over = head_.covered(-90, between(20, 45));
            add(sheet_mesh(
                [&, way, rim, thick, rise, bow](double x, double y) {
                    const double v = std::cos(way) * x + std::sin(way) * y - rim;
                    if (v < 0) return std::nan("");
                    const double soft = std::min(1., v / 40);
                    return over(x, y) + thick + rise * v * soft + bow * v * v + soft * std::abs(folds(x, y));
                },
                470, 2.5));
        }
    }
    /// Folds of all lengths about a plane; the head comes out of it, and it is pulled back from the opening.
    void crumpled() {
        const double deep = between(35, 65);
        const Folds folds(18, 130, between(7, 18), random_);
        const double hole = s_.opening_mm / 2;
        add(sheet_mesh(
            [&](double x, double y) {
                const double in = std::max(0., 1 - std::hypot(x, y) / (1.4 * hole));
                const double z = -deep + folds(x, y) - 90 * in;
                return std::hypot(x, y) < hole && z > head_(x, y) - 1 ? std::nan("") : z;
            },
            600, 3));
    }
    void table() {
        const double way = any_way(), rim = s_.opening_mm / 2 * between(0.9, 1.3), high = between(15, 70),
                     lean = between(-0.2, 0.2);
        Eigen::Matrix3d axes;
        axes.col(0) = Vector3d(std::cos(way), std::sin(way), lean).normalized();
        axes.col(1) = Vector3d(-std::sin(way), std::cos(way), 0);
        axes.col(2) = axes.col(0).cross(axes.col(1));
        add(box_mesh((rim + 200) * axes.col(0) + high * Vector3d::UnitZ(), axes, {400, 500, between(3, 25)}));
        for (int i = 0; i < 4; ++i) {  // what lies on it
            const Vector3d p = (rim + between(15, 90)) * axes.col(0) + between(-120, 120) * axes.col(1) +
                               (high + 15) * Vector3d::UnitZ();
            add(pipe_mesh({p, p + 120 * (axes.col(0) + between(-0.5, 0.5) * axes.col(1)).normalized()},
                          {between(3, 9), between(3, 9)}));
        }
    }
    void retractors() {
        const int count = 1 + static_cast<int>(between(0, 2));
        for (int r = 0; r < count; ++r) {
            const double way = any_way(), tip = s_.opening_mm / 2 * between(0.5, 0.8);
            Vector3d from(tip * std::cos(way), tip * std::sin(way), 0), to = 3.2 * from;
            from.z() = head_(from.x(), from.y()) + between(3, 8);
            to.z() = from.z() + between(25, 70);
            Eigen::Matrix3d axes;
            axes.col(0) = (to - from).normalized();
            axes.col(1) = Vector3d(-std::sin(way), std::cos(way), 0);
            axes.col(2) = axes.col(0).cross(axes.col(1)).normalized();
            add(box_mesh(0.5 * (from + to), axes, {(to - from).norm(), between(15, 30), 2.5}));
        }
    }

    const HeadHeights& head_;
    const DrapedSceneSettings& s_;
    std::mt19937 random_;
    std::uniform_real_distribution<double> unit_;
    TriangleMesh mesh_;
};

/// What each ray of a grid met.
struct Grid {
    int columns = 0, rows = 0;
    double spacing_mm = 0;
    std::vector<Vector3d> direction, p;
    std::vector<char> met, skin;
};

struct Seen {
    const TrialSurface& head;
    const TrialSurface& things;
    bool between(const Vector3d& p, const Vector3d& eye) const {
        const Vector3d way = (eye - p).normalized(), start = p + 0.6 * way;
        const double far = (eye - start).norm();
        for (const TrialSurface* surface : {&head, &things}) {
            const auto hit = surface->first_hit(start, way);
            if (hit && (hit->p_in_ct - start).norm() < far) return true;
        }
        return false;
    }
};

Grid cast(const Seen& seen, const ViewFrame& view, double width_mm, int columns, bool without_head) {
    Grid grid;
    grid.columns = columns;
    grid.rows = columns * 3 / 4;
    grid.spacing_mm = width_mm / columns;
    const Vector3d eye = view.to_ct({0, 0, kDistance_mm});
    const Vector3d cameras[2] = {view.to_ct({-kBaseline_mm, 0, kDistance_mm}),
                                 view.to_ct({kBaseline_mm, 0, kDistance_mm})};
    for (int j = 0; j < grid.rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const Vector3d through((i + 0.5 - 0.5 * columns) * grid.spacing_mm,
                                   (j + 0.5 - 0.5 * grid.rows) * grid.spacing_mm, 0);
            const Vector3d d = (view.to_ct(through) - eye).normalized();
            const auto thing = seen.things.first_hit(eye, d);
            const auto skin = without_head ? std::nullopt : seen.head.first_hit(eye, d);
            const bool is_skin = skin && (!thing || (skin->p_in_ct - eye).norm() < (thing->p_in_ct - eye).norm());
            const auto& hit = is_skin ? skin : thing;
            const bool met = hit && (!is_skin || hit->flag == kSkin) &&
                             std::abs(hit->normal_in_ct.dot(d)) > kSteepest_cosine &&
                             !(seen.between(hit->p_in_ct, cameras[0]) && seen.between(hit->p_in_ct, cameras[1]));
            grid.direction.push_back(d);
            grid.met.push_back(met);
            grid.skin.push_back(met && is_skin);
            grid.p.push_back(met ? hit->p_in_ct : Vector3d::Zero());
        }
    return grid;
}

/// The plane through 7 x 7 rays of what was seen; towards the devices.
Vector3d normal_of(const Grid& grid, std::size_t at) {
    constexpr int kReach = 3;
    const double farthest_mm = 2.5 * kReach * grid.spacing_mm + 1;
    const int row = static_cast<int>(at) / grid.columns, column = static_cast<int>(at) % grid.columns;
    Vector3d sum = Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int count = 0;
    for (int j = std::max(0, row - kReach); j <= std::min(grid.rows - 1, row + kReach); ++j)
        for (int i = std::max(0, column - kReach); i <= std::min(grid.columns - 1, column + kReach); ++i) {
            const auto k = static_cast<std::size_t>(j * grid.columns + i);
            if (!grid.met[k]) continue;
            const Vector3d d = grid.p[k] - grid.p[at];
            if (d.norm() > farthest_mm) continue;
            sum += d;
            squares += d * d.transpose();
            ++count;
        }
    if (count < 6) return -grid.direction[at];
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(squares / count - sum * sum.transpose() / (count * count));
    const Vector3d n = solver.eigenvectors().col(0);
    return n.dot(grid.direction[at]) > 0 ? Vector3d(-n) : n;
}

void set_truth(const Grid& grid, const std::vector<char>& of_interest, const Vector3d& from_in_ct, DrapedScene& scene) {
    double count = 0;
    for (std::size_t i = 0; i < grid.p.size(); ++i)
        if (of_interest[i]) scene.scan.middle_in_ct += grid.p[i], ++count;
    scene.scan.middle_in_ct /= count;
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < grid.p.size(); ++i)
        if (of_interest[i])
            squares +=
                (grid.p[i] - scene.scan.middle_in_ct) * (grid.p[i] - scene.scan.middle_in_ct).transpose() / count;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares);
    scene.skin_width_mm = std::sqrt(12 * std::max(axes.eigenvalues()[1], 0.));
    const Vector3d deep = scene.scan.middle_in_ct - 60 * from_in_ct.normalized();
    scene.scan.targets_in_ct.push_back(deep);
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-40., 40.}) scene.scan.targets_in_ct.emplace_back(deep + side * Vector3d::Unit(axis));
}

}  // namespace

const std::vector<Draping>& drapings() {
    static const std::vector<Draping> all{{"sheet behind", true},     {"wrapped, with a hole", true},
                                          {"hand and forearm", true}, {"tubes", true},
                                          {"towel rolls", false},     {"sheet touching the brow", false},
                                          {"crumpled cloth", false},  {"table edge, retractors", false}};
    return all;
}

DrapedScene draped_scene(const TrialSurface& head, const DrapedSceneSettings& settings) {
    DrapedScene scene;
    const ViewFrame view = frame_of(head, settings);
    const HeadHeights heights(head, view);
    TriangleMesh things = Dresser(heights, settings).dress();
    for (Vector3d& p : things.vertices_in_ct) p = view.to_ct(p);
    const TrialSurface dress(std::move(things));
    Grid grid = cast({head, dress}, view, settings.window_mm, static_cast<int>(std::sqrt(settings.points * 4. / 3)),
                     settings.without_head);
    const std::vector<char>& of_interest = settings.without_head ? grid.met : grid.skin;
    if (std::count(of_interest.begin(), of_interest.end(), 1) < 400) return scene;
    set_truth(grid, of_interest, settings.from_in_ct, scene);
    std::mt19937 random(settings.seed);
    std::normal_distribution<double> noise(0, 1);
    std::uniform_real_distribution<double> unit;
    TrialScan& scan = scene.scan;
    for (std::size_t i = 0; i < grid.p.size(); ++i) {
        if (!grid.met[i]) continue;
        const double off = settings.noise_mm * noise(random), stray = unit(random), way = unit(random),
                     far = unit(random);
        const bool is_stray = stray < settings.stray_share;
        grid.p[i] += (off + (is_stray ? (way < 0.5 ? -1 : 1) * (15 + 85 * far) : 0)) * grid.direction[i];
        ++(is_stray ? scan.stray_points : grid.skin[i] ? scan.bare_points : scan.drape_points);
    }
    scan.rig_from_ct = random_pose(settings.seed);
    scan.viewpoint_in_rig = scan.rig_from_ct * view.to_ct({0, 0, kDistance_mm});
    for (std::size_t i = 0; i < grid.p.size(); ++i) {
        if (!grid.met[i]) continue;
        scan.cloud.points_in_rig.emplace_back(scan.rig_from_ct * grid.p[i]);
        scan.cloud.normals_in_rig.emplace_back(scan.rig_from_ct.linear() * normal_of(grid, i));
        scene.is_skin.push_back(grid.skin[i]);
    }
    return scene;
}

}  // namespace planlight::test
