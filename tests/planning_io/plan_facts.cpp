#include "tests/planning_io/plan_facts.h"

#include <Eigen/Geometry>
#include <random>

namespace planlight::test {
namespace {

using Eigen::Vector3d;

class RandomPlan {
public:
    explicit RandomPlan(unsigned seed) : random_(seed) {}

    Plan make() {
        Plan plan;
        plan.boreholes.push_back(
            {name(), Vector3d(-50, 0, 10), std::nullopt, 7, 6, std::nullopt});  // so that the plan is never tiny
        plan.boreholes.push_back({name(), Vector3d(50, 0, 10), std::nullopt, 0, 0, std::nullopt});
        for (int i = count(4); i > 0; --i) plan.trajectories.push_back({name(), point(), point(), size(100), colour()});
        for (int i = count(4); i > 0; --i)
            plan.boreholes.push_back({name(), point(), chance(0.5) ? std::optional(direction()) : std::nullopt,
                                      size(100), size(200), colour()});
        for (int i = count(4); i > 0; --i) {
            OsteotomyLine line{name(), {}, chance(0.5), colour()};
            for (int p = 3 + count(20); p > 0; --p) line.points_in_ct.push_back(point());
            plan.osteotomy_lines.push_back(std::move(line));
        }
        for (int i = count(3); i > 0; --i) {
            const Vector3d normal = direction();
            plan.cut_planes.push_back(
                {name(), point(), normal, normal.unitOrthogonal(), 1 + size(200), 1 + size(200), colour()});
        }
        return plan;
    }

private:
    double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
    bool chance(double probability) { return share() < probability; }
    int count(int most) { return static_cast<int>(share() * (most + 1)); }
    double size(double most) { return chance(0.2) ? 0 : most * share(); }
    Vector3d point() { return {400 * share() - 200, 400 * share() - 200, 400 * share() - 200}; }
    Vector3d direction() { return Vector3d(share() - 0.5, share() - 0.5, share() - 0.5 + 1e-3).normalized(); }
    std::optional<Colour> colour() {
        if (chance(0.3)) return std::nullopt;
        return Colour{static_cast<float>(share()), static_cast<float>(share()), static_cast<float>(share())};
    }
    std::string name() {
        static const char* const kNames[] = {"",
                                             "B1",
                                             "Osteotomy α β",
                                             "left \"quoted\"",
                                             "comma, semicolon; tab",
                                             "Bohrloch Ø 7 äöü",
                                             "a=b diameter_mm=3",
                                             "ein sehr langer Name, länger als die vierundsechzig Zeichen",
                                             "slash/and",
                                             "x"};
        return kNames[std::uniform_int_distribution<std::size_t>(0, std::size(kNames) - 1)(random_)];
    }
    std::mt19937 random_;
};

}  // namespace

Plan random_plan(unsigned seed) {
    return RandomPlan(seed).make();
}

}  // namespace planlight::test
