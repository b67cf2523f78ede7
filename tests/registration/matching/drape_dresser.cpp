#include "tests/registration/matching/drape_dresser.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/registration/matching/draped_objects.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

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

}  // namespace

TriangleMesh things_round(const HeadHeights& head, const DrapedSceneSettings& settings) {
    return Dresser(head, settings).dress();
}

}  // namespace planlight::test
