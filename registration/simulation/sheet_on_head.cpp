#include "registration/simulation/sheet_on_head.h"

#include <algorithm>
#include <cmath>

namespace planlight::simulation {

using Eigen::Vector3f;

namespace {

struct Thread {
    int a, b;
    float length_mm;
};

struct Net {
    int side = 0;
    std::vector<Vector3f> now, before;
    std::vector<char> there;
    std::vector<Thread> threads;
    int at(int i, int j) const { return j * side + i; }
};

Net hung_over(const Ground& ground, const SheetSettings& s, std::mt19937& random) {
    std::uniform_real_distribution<double> unit;
    std::normal_distribution<double> any;
    Net net;
    net.side = static_cast<int>(s.width_mm / s.knot_mm) + 1;
    double highest = -1e9;
    for (int j = 0; j < net.side; ++j)
        for (int i = 0; i < net.side; ++i)
            highest = std::max(highest, ground(i * s.knot_mm - s.width_mm / 2, j * s.knot_mm - s.width_mm / 2));
    const double longer = 0.8 + 0.4 * unit(random), turn = 3.14159 * unit(random);
    for (int j = 0; j < net.side; ++j)
        for (int i = 0; i < net.side; ++i) {
            const double x = i * s.knot_mm - s.width_mm / 2, y = j * s.knot_mm - s.width_mm / 2;
            const double u = std::cos(turn) * x + std::sin(turn) * y, v = std::cos(turn) * y - std::sin(turn) * x;
            const bool hole = s.hole_mm > 0 && std::hypot(u, v / longer) < s.hole_mm / 2;
            net.now.push_back(
                {static_cast<float>(x), static_cast<float>(y), static_cast<float>(highest + 3 + any(random))});
            net.there.push_back(!hole);
        }
    net.before = net.now;
    const auto tie = [&](int a, int b) {
        if (!net.there[static_cast<std::size_t>(a)] || !net.there[static_cast<std::size_t>(b)]) return;
        const float flat =
            (net.now[static_cast<std::size_t>(a)] - net.now[static_cast<std::size_t>(b)]).head<2>().norm();
        net.threads.push_back({a, b, static_cast<float>(1 + s.slack) * flat});
    };
    for (int j = 0; j < net.side; ++j)
        for (int i = 0; i < net.side; ++i) {
            if (i + 1 < net.side) tie(net.at(i, j), net.at(i + 1, j));
            if (j + 1 < net.side) tie(net.at(i, j), net.at(i, j + 1));
            if (i + 1 < net.side && j + 1 < net.side)
                tie(net.at(i, j), net.at(i + 1, j + 1)), tie(net.at(i + 1, j), net.at(i, j + 1));
            if (i + 2 < net.side) tie(net.at(i, j), net.at(i + 2, j));
            if (j + 2 < net.side) tie(net.at(i, j), net.at(i, j + 2));
        }
    return net;
}

void fall(Net& net, const Ground& ground, const SheetSettings& s) {
    constexpr float kDown_mm = 0.35F, kKeeps = 0.96F, kRubs = 0.6F;
    constexpr int kPulls = 4;
    for (int step = 0; step < s.steps; ++step) {
        for (std::size_t k = 0; k < net.now.size(); ++k) {
            const Vector3f next = net.now[k] + kKeeps * (net.now[k] - net.before[k]) - Vector3f(0, 0, kDown_mm);
            net.before[k] = net.now[k];
            net.now[k] = next;
        }
        for (int pull = 0; pull < kPulls; ++pull)
            for (const Thread& t : net.threads) {
                Vector3f &a = net.now[static_cast<std::size_t>(t.a)], &b = net.now[static_cast<std::size_t>(t.b)];
                const Vector3f way = b - a;
                const float length = way.norm();
                if (length <= t.length_mm * 0.9F && length > 0) {  // pushed together it folds, it is not squeezed
                    const Vector3f apart = 0.1F * (1 - 0.9F * t.length_mm / length) * way;
                    a += apart, b -= apart;
                } else if (length > t.length_mm) {
                    const Vector3f together = 0.5F * (1 - t.length_mm / length) * way;
                    a += together, b -= together;
                }
            }
        for (std::size_t k = 0; k < net.now.size(); ++k) {
            Vector3f& p = net.now[k];
            const auto least =
                static_cast<float>(ground(static_cast<double>(p.x()), static_cast<double>(p.y())) + s.thickness_mm);
            if (p.z() >= least) continue;
            p.z() = least;
            net.before[k] = p - (1 - kRubs) * (p - net.before[k]);
            net.before[k].z() = p.z();
        }
    }
}

}  // namespace

ThingsMesh sheet_on(const Ground& ground, const SheetSettings& settings, std::mt19937& random) {
    Net net = hung_over(ground, settings, random);
    fall(net, ground, settings);
    ThingsMesh mesh;
    mesh.vertices_in_ct = net.now;
    const auto add = [&](int a, int b, int c) {
        for (const int k : {a, b, c})
            if (!net.there[static_cast<std::size_t>(k)]) return;
        mesh.triangles.push_back(
            {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
        mesh.made_of.push_back(Material::cloth);
    };
    for (int j = 0; j + 1 < net.side; ++j)
        for (int i = 0; i + 1 < net.side; ++i) {
            add(net.at(i, j), net.at(i + 1, j), net.at(i + 1, j + 1));
            add(net.at(i, j), net.at(i + 1, j + 1), net.at(i, j + 1));
        }
    return mesh;
}

}  // namespace planlight::simulation
