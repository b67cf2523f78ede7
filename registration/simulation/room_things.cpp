#include "registration/simulation/room_things.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "registration/simulation/hash.h"
#include "registration/simulation/sheet_on_head.h"

namespace planlight::simulation {

using Eigen::Vector3d;
using Eigen::Vector3f;

void ThingsMesh::add(const ThingsMesh& part) {
    const auto first = static_cast<std::uint32_t>(vertices_in_ct.size());
    vertices_in_ct.insert(vertices_in_ct.end(), part.vertices_in_ct.begin(), part.vertices_in_ct.end());
    for (const auto& t : part.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    made_of.insert(made_of.end(), part.made_of.begin(), part.made_of.end());
}

namespace {

/// The table's frame: origin on the skin, z up to the projector. How high the head stands over it, every 4 mm.
class Table {
public:
    static constexpr double kWidth_mm = 560, kCell_mm = 4, kNothing_mm = -1000;
    static constexpr int kSide = 141;

    Table(const Surface& skin, const Vector3d& middle, const Vector3d& eye) : z_(kSide * kSide, kNothing_mm) {
        const Vector3d up = (eye - middle).normalized();
        Vector3d hint = std::abs(up.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX();
        const Vector3d right = hint.cross(up).normalized();
        ct_from_table.linear() << right, up.cross(right), up;
        ct_from_table.translation() = middle;
        if (const auto hit = skin.first_hit(eye, -up)) ct_from_table.translation() = hit->p_in_ct;
        for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i) {
                const Vector3d from =
                    ct_from_table * Vector3d(i * kCell_mm - kWidth_mm / 2, j * kCell_mm - kWidth_mm / 2, 500);
                const auto hit = skin.first_hit(from, -up);
                if (hit) z_[static_cast<std::size_t>(j * kSide + i)] = 500 - hit->distance_mm;
            }
    }
    /// Height of the head, or of the table where there is none.
    double height(double x, double y, double table_mm) const {
        const double u = std::clamp((x + kWidth_mm / 2) / kCell_mm, 0., kSide - 1.001),
                     v = std::clamp((y + kWidth_mm / 2) / kCell_mm, 0., kSide - 1.001);
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        const double a = u - i, b = v - j;
        const auto z = [&](int k, int l) { return std::max(table_mm, z_[static_cast<std::size_t>(l * kSide + k)]); };
        return (1 - b) * ((1 - a) * z(i, j) + a * z(i + 1, j)) + b * ((1 - a) * z(i, j + 1) + a * z(i + 1, j + 1));
    }
    Eigen::Isometry3d ct_from_table = Eigen::Isometry3d::Identity();

private:
    std::vector<double> z_;
};

/// A pipe along points with radii; round ends.
ThingsMesh pipe(const std::vector<Vector3d>& line, const std::vector<double>& radius_mm, Material made_of) {
    constexpr std::uint32_t kRound = 32;
    ThingsMesh mesh;
    std::vector<Vector3d> centres;
    std::vector<double> radii;
    const auto round_end = [&](const Vector3d& end, const Vector3d& out, double r, bool first) {
        for (int k = 0; k <= 5; ++k) {
            const double a = (first ? 5 - k : k) * std::numbers::pi / 10;
            centres.push_back(end + r * std::sin(a) * out);
            radii.push_back(std::max(0.01, r * std::cos(a)));
        }
    };
    const std::size_t last = line.size() - 1;
    round_end(line[0], (line[0] - line[1]).normalized(), radius_mm[0], true);
    for (std::size_t i = 1; i < last; ++i) centres.push_back(line[i]), radii.push_back(radius_mm[i]);
    round_end(line[last], (line[last] - line[last - 1]).normalized(), radius_mm[last], false);
    Vector3d side = (line[1] - line[0]).unitOrthogonal();
    for (std::size_t i = 0; i < centres.size(); ++i) {
        const Vector3d along =
            (centres[std::min(i + 1, centres.size() - 1)] - centres[i == 0 ? 0 : i - 1]).normalized();
        side = (side - side.dot(along) * along).normalized();
        for (std::uint32_t k = 0; k < kRound; ++k) {
            const double a = 2 * std::numbers::pi * k / kRound;
            mesh.vertices_in_ct.push_back(
                (centres[i] + radii[i] * (std::cos(a) * side + std::sin(a) * along.cross(side))).cast<float>());
        }
    }
    for (std::uint32_t i = 0; i + 1 < centres.size(); ++i)
        for (std::uint32_t k = 0; k < kRound; ++k) {
            const std::uint32_t a = i * kRound + k, b = i * kRound + (k + 1) % kRound;
            mesh.triangles.push_back({a, b, b + kRound});
            mesh.triangles.push_back({a, b + kRound, a + kRound});
        }
    mesh.made_of.assign(mesh.triangles.size(), made_of);
    return mesh;
}

/// A strip of metal along a line, `wide_mm` across.
ThingsMesh blade(const std::vector<Vector3d>& line, const Vector3d& across, double wide_mm, double thick_mm) {
    ThingsMesh mesh;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const Vector3d along = (line[std::min(i + 1, line.size() - 1)] - line[i == 0 ? 0 : i - 1]).normalized();
        const Vector3d up = along.cross(across).normalized();
        for (const auto& [s, t] : {std::pair{-1., -1.}, {1., -1.}, {1., 1.}, {-1., 1.}})
            mesh.vertices_in_ct.push_back(
                (line[i] + 0.5 * s * wide_mm * across + 0.5 * t * thick_mm * up).cast<float>());
    }
    const auto square = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (std::uint32_t i = 0; i + 1 < line.size(); ++i)
        for (std::uint32_t k = 0; k < 4; ++k)
            square(4 * i + k, 4 * i + (k + 1) % 4, 4 * i + 4 + (k + 1) % 4, 4 * i + 4 + k);
    square(0, 1, 2, 3);
    const auto end = static_cast<std::uint32_t>(4 * (line.size() - 1));
    square(end, end + 3, end + 2, end + 1);
    mesh.made_of.assign(mesh.triangles.size(), Material::metal);
    return mesh;
}

double strand(double across, double along, std::uint64_t seed) {  // smooth noise of unit width, long along one way
    const auto value = [&](std::int64_t i, std::int64_t j) {
        return static_cast<double>(mixed(seed + static_cast<std::uint64_t>(i) * 0x8da6b343U +
                                         static_cast<std::uint64_t>(j) * 0xd8163841U) >>
                                   40) *
               0x1p-24;
    };
    const double u = across, v = along / 12;
    const auto i = static_cast<std::int64_t>(std::floor(u)), j = static_cast<std::int64_t>(std::floor(v));
    const double a = u - static_cast<double>(i), b = v - static_cast<double>(j);
    return (1 - b) * ((1 - a) * value(i, j) + a * value(i + 1, j)) +
           b * ((1 - a) * value(i, j + 1) + a * value(i + 1, j + 1));
}

/// Over the scalp: all directions from the head's middle above a plane that rises from the ears to the forehead.
ThingsMesh hair_on(const Surface& skin, std::mt19937& random) {
    std::uniform_real_distribution<double> unit;
    const double thick = 3 + 6 * unit(random), line = 0.25 + 0.25 * unit(random), wide_mm = 2.5 + 2 * unit(random);
    const auto seed = static_cast<std::uint64_t>(random());
    const Vector3d middle = skin.middle_in_ct();
    constexpr int kRows = 130, kColumns = 400;
    ThingsMesh mesh;
    std::vector<int> index(kRows * kColumns, -1);
    for (int j = 0; j < kRows; ++j)
        for (int i = 0; i < kColumns; ++i) {
            const double a = 2 * std::numbers::pi * i / kColumns, up = std::numbers::pi / 2 * (1 - 1.6 * j / kRows);
            const Vector3d d(std::cos(up) * std::sin(a), std::cos(up) * std::cos(a), std::sin(up));
            const double rise = d.z() - (d.y() < 0 ? 0.55 + line : 0.55 + line) * std::max(0., -d.y()) * 1.3 + 0.25;
            if (rise < 0) continue;
            const auto hit = skin.first_hit(middle + 400 * d, -d);
            if (!hit || hit->distance_mm > 390) continue;
            const double r = 400 - hit->distance_mm;
            const double height = 0.5 + std::min(1., rise / 0.12) * thick *
                                            (0.5 + strand(a * 90 * std::cos(up) / wide_mm, up * 90, seed));
            index[static_cast<std::size_t>(j * kColumns + i)] = static_cast<int>(mesh.vertices_in_ct.size());
            mesh.vertices_in_ct.push_back((middle + (r + height) * d).cast<float>());
        }
    const auto at = [&](int i, int j) { return index[static_cast<std::size_t>(j * kColumns + i % kColumns)]; };
    const auto add = [&](int a, int b, int c) {
        if (a < 0 || b < 0 || c < 0) return;
        mesh.triangles.push_back(
            {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
        mesh.made_of.push_back(Material::hair);
    };
    for (int j = 0; j + 1 < kRows; ++j)
        for (int i = 0; i < kColumns; ++i) {
            add(at(i, j), at(i + 1, j + 1), at(i + 1, j));
            add(at(i, j), at(i, j + 1), at(i + 1, j + 1));
        }
    return mesh;
}

/// Forearm, palm and five fingers, from the rim of the picture; the fingers lie just over what is below them.
ThingsMesh hand_over(const Ground& ground, double field_mm, std::mt19937& random) {
    std::uniform_real_distribution<double> unit;
    const double way = 2 * std::numbers::pi * unit(random), reach = field_mm * (0.3 + 0.25 * unit(random)),
                 lift = 4 + 25 * unit(random);
    const Vector3d in(-std::cos(way), -std::sin(way), 0), aside(in.y(), -in.x(), 0);
    const auto over = [&](Vector3d p, double by) {
        p.z() = ground(p.x(), p.y()) + by;
        return p;
    };
    const Vector3d knuckles = over(-reach * in, 15 + lift);
    Vector3d wrist = over(-(reach + 85) * in, 28 + lift);
    wrist.z() = std::max(wrist.z(), knuckles.z() - 20);
    const Vector3d elbow = wrist - 270 * in + Vector3d(0, 0, 20 + 100 * unit(random));
    ThingsMesh mesh = pipe({elbow, 0.5 * (elbow + wrist), wrist}, {48, 40, 28}, Material::cloth);
    for (int k = -1; k <= 1; ++k)
        mesh.add(pipe({wrist + 13 * k * aside, knuckles + 21 * k * aside}, {17, 13}, Material::glove));
    for (int f = 0; f < 5; ++f) {
        const bool thumb = f == 4;
        const Vector3d root =
            thumb ? Vector3d(wrist + 35 * in - 34 * aside) : Vector3d(knuckles + (f - 1.5) * 20 * aside);
        const Vector3d tip =
            over(root + (thumb ? 45 : 55 + 25 * unit(random)) * in - (thumb ? 25. : 0.) * aside, 10 + 0.4 * lift);
        Vector3d bent = 0.5 * (root + tip);
        bent.z() = std::max(bent.z() + 6, ground(bent.x(), bent.y()) + 11);
        mesh.add(pipe({root, bent, tip}, {11, 10, 8}, Material::glove));
    }
    return mesh;
}

ThingsMesh tube_over(const Ground& ground, double field_mm, std::mt19937& random) {
    std::uniform_real_distribution<double> unit;
    const double way = 2 * std::numbers::pi * unit(random), bend = 1.2 * (unit(random) - 0.5),
                 radius = 5 + 6 * unit(random);
    std::vector<Vector3d> line;
    for (double far = field_mm * 0.2; far < 270; far += 8) {
        const double a = way + bend * far / 200, x = far * std::cos(a), y = far * std::sin(a);
        double z = ground(x, y) + radius + 1;
        if (!line.empty()) z = std::clamp(z, line.back().z() - 5, line.back().z() + 8);
        line.emplace_back(x, y, z);
    }
    return pipe(line, std::vector<double>(line.size(), radius), Material::plastic);
}

ThingsMesh retractors(const Ground& ground, double field_mm, std::mt19937& random) {
    std::uniform_real_distribution<double> unit;
    ThingsMesh mesh;
    const double first = 2 * std::numbers::pi * unit(random);
    for (int k = 0; k < 2; ++k) {
        const double way = first + k * (2 + unit(random));
        const Vector3d out(std::cos(way), std::sin(way), 0), across(-out.y(), out.x(), 0);
        std::vector<Vector3d> line;
        for (double far = field_mm * (0.25 + 0.15 * unit(random)); far < 250; far += 15) {
            Vector3d p = far * out;
            p.z() = ground(p.x(), p.y()) + 4;
            if (!line.empty()) p.z() = std::max(p.z(), line.back().z() + 3);
            line.push_back(p);
        }
        mesh.add(blade(line, across, 18 + 14 * unit(random), 2));
    }
    return mesh;
}

double noise_at(const Vector3d& p, double size_mm, std::uint64_t seed) {
    const auto c = (p / size_mm).array().floor().cast<std::int64_t>().eval();
    return static_cast<double>(mixed(seed + static_cast<std::uint64_t>(c.x()) * 0x8da6b343U +
                                     static_cast<std::uint64_t>(c.y()) * 0xd8163841U +
                                     static_cast<std::uint64_t>(c.z()) * 0xcb1ab31fU) >>
                               40) *
               0x1p-23 -
           1;
}

}  // namespace

ThingsMesh lay_things(const Surface& skin, const Vector3d& middle_in_ct, const Vector3d& eye_in_ct,
                      const ThingsSettings& settings, std::mt19937& random) {
    const Table table(skin, middle_in_ct, eye_in_ct);
    std::uniform_real_distribution<double> unit;
    const double table_mm = -(60 + 20 * unit(random));
    const Ground ground = [&](double x, double y) { return table.height(x, y, table_mm); };
    const double field_mm = settings.drape_hole ? settings.hole_mm : 150;
    ThingsMesh mesh;  // in the table's frame
    if (settings.drape_behind) {
        SheetSettings sheet;
        sheet.width_mm = 540;
        sheet.slack = 0.03;
        const double wave = 1.5 + 2.5 * unit(random), a = 25 + 40 * unit(random), b = 6 * unit(random);
        mesh.add(sheet_on(
            [&](double x, double y) {
                return table_mm + wave * (std::sin(x / a + b) + std::sin(y / (0.7 * a) + x / (2 * a)));
            },
            sheet, random));
    }
    if (settings.drape_hole) {
        SheetSettings sheet;
        sheet.hole_mm = settings.hole_mm;
        mesh.add(sheet_on(ground, sheet, random));
    }
    if (settings.hand) mesh.add(hand_over(ground, field_mm, random));
    if (settings.tube) mesh.add(tube_over(ground, field_mm, random));
    if (settings.retractor) mesh.add(retractors(ground, field_mm, random));
    for (Vector3f& p : mesh.vertices_in_ct) p = (table.ct_from_table * p.cast<double>()).cast<float>();
    if (settings.hair) mesh.add(hair_on(skin, random));
    return mesh;
}

Look look_of(Material made_of, const Vector3d& p) {
    const double fine = noise_at(p, 0.8, 11), coarse = noise_at(p, 5, 12);
    switch (made_of) {
        case Material::cloth:
            return {made_of, 0.45 + 0.03 * fine + 0.01 * coarse, 0.01, 0.1};
        case Material::glove:
            return {made_of, 0.66 + 0.01 * coarse, 0.12, 0.15};
        case Material::plastic:
            return {made_of, 0.55, 0.4, 0.25};
        case Material::metal:
            return {made_of, 0.22 + 0.02 * fine, 0.9, 0};
        case Material::hair:
            return {made_of, 0.07 + 0.03 * fine, 0.15, 0};
        default:
            return {made_of, 0.5, 0, 0};
    }
}

}  // namespace planlight::simulation
