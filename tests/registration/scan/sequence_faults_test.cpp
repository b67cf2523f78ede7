#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "registration/scan/check_sequence.h"
#include "registration/scan/gray_code.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;

struct Scene {
    std::string name;
    StripeSettings stripes;
    std::vector<StripePattern> patterns;
    std::vector<GrayImage> frames;
};

std::vector<GrayImage> noisy(const std::vector<GrayImage>& frames, double sigma, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, sigma);
    std::vector<int> noise(1 << 16);
    for (int& n : noise) n = static_cast<int>(std::lround(normal(random)));
    std::vector<GrayImage> out = frames;
    for (GrayImage& f : out) {
        std::size_t at = random();
        for (auto& p : f.pixels) p = static_cast<std::uint8_t>(std::clamp(p + noise[at++ % noise.size()], 0, 255));
    }
    return out;
}

double changed(const std::vector<GrayImage>& a, const std::vector<GrayImage>& b) {
    std::size_t lit = 0, differ = 0;
    for (std::size_t p = 0; p < a[0].pixels.size(); p += 7) {
        const int contrast = a[0].pixels[p] - a[1].pixels[p];
        if (contrast < 16) continue;
        ++lit;
        for (std::size_t i = 0; i < a.size(); ++i)
            if (3 * std::abs(a[i].pixels[p] - b[i].pixels[p]) > contrast) {
                ++differ;
                break;
            }
    }
    return static_cast<double>(differ) / static_cast<double>(lit);
}

std::vector<GrayImage> gray_frames(const Room& room, const std::vector<StripePattern>& patterns, double cell_px) {
    std::vector<Shown> shown;
    int bits[2] = {};
    for (const auto& p : patterns)
        if (p.kind == StripePattern::Kind::gray_bit) ++bits[p.along_rows];
    for (const auto& p : patterns) {
        RgbImage picture(room.projector.width, room.projector.height);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) {
                const int cell = static_cast<int>((p.along_rows ? y : x) / cell_px), code = cell ^ (cell >> 1);
                const bool bit = (code >> (bits[p.along_rows] - 1 - p.index)) & 1;
                bool lit = p.kind == StripePattern::Kind::white;
                if (p.kind == StripePattern::Kind::gray_bit) lit = bit;
                if (p.kind == StripePattern::Kind::gray_bit_inverse) lit = !bit;
                picture.at(x, y).fill(lit ? 255 : 0);
            }
        shown.push_back({picture, p.along_rows});
    }
    return photograph(room, room.left, shown, 1);
}

std::vector<StripePattern> gray_patterns(int column_bits, int row_bits, bool inverse) {
    using Kind = StripePattern::Kind;
    std::vector<StripePattern> patterns{{Kind::white, false, 0, "white"}, {Kind::black, false, 0, "black"}};
    for (const bool rows : {false, true})
        for (int bit = 0; bit < (rows ? row_bits : column_bits); ++bit) {
            const std::string name = fmt::format("{}-gray-{}", rows ? "row" : "column", bit);
            patterns.push_back({Kind::gray_bit, rows, bit, name});
            if (inverse) patterns.push_back({Kind::gray_bit_inverse, rows, bit, name + "-inverse"});
        }
    return patterns;
}

Room room_of(int which) {
    const Eigen::Vector3d centre(120, -40, 360), place(120, -40, 300);
    Room room = which == 1 ? paper_room(plane(place, Eigen::Vector3d(0.35, 0.2, -1).normalized(), 100))
                           : which == 0 ? paper_room(sphere(centre, 80)) : modern_room(sphere(centre, 60));
    room.light.noise_grey = 0;
    room.light.ambient_grey = which == 1 ? 60 : 18;
    return room;
}

TEST(Explore, DISABLED_Table) {
    std::vector<Scene> scenes;
    const std::vector<double> cells = std::getenv("CELLS") ? std::vector<double>{4.0, 2.0} : std::vector<double>{8.0, 1.0};
    const int most = std::getenv("ROOMS") ? atoi(std::getenv("ROOMS")) : 2;
    for (int which = 0; which < most; ++which) {
        const Room room = room_of(which);
        const int w = room.projector.width, h = room.projector.height;
        const char* surface[] = {"head", "plane", "modern"};
        const StripeSettings fast = fast_stripes(w, h);
        scenes.push_back({fmt::format("fast {}", surface[which]), fast, stripe_sequence(fast), photograph(room, room.left, fast, 1)});
        for (const double cell : cells)
            for (const bool inverse : {false, true}) {
                StripeSettings s = stripes_of(room);
                s.phase_steps = 0;
                s.phase_period_px = 2 * cell;
                s.inverse = inverse;
                const auto p = gray_patterns(gray_bits(s, false), gray_bits(s, true), inverse);
                scenes.push_back({fmt::format("gray {} {} {}", cell, inverse ? "inverse" : "bare", surface[which]), s, p,
                                  gray_frames(room, p, cell)});
            }
    }
    for (const Scene& s : scenes) {
        const std::size_t n = s.frames.size();
        std::map<std::string, std::array<int, 3>> table;
        std::map<std::string, std::string> missed;
        for (unsigned seed = 0; seed < 6; ++seed) {
            const auto clean = check_sequence(noisy(s.frames, 0.5 + 0.5 * seed, seed), s.stripes, s.patterns);
            if (!clean.checked) fmt::print("{} not checked\n", s.name);
            for (const auto& p : clean.problems) fmt::print("{} noise {}: FALSE {} {:.3f}\n", s.name, 0.5 + 0.5 * seed, p.what, p.share);
        }
        const auto look = [&](const std::string& kind, const std::string& where, const std::vector<GrayImage>& spoilt) {
            auto& row = table[kind];
            const double share = changed(s.frames, spoilt);
            if (share < 0.05) { ++row[2]; return; }
            const bool found = !check_sequence(noisy(spoilt, 1.5, 7), s.stripes, s.patterns).problems.empty();
            ++row[found ? 0 : 1];
            if (!found) missed[kind] += fmt::format(" {} ({:.2f});", where, share);
        };
        for (std::size_t m = 0; m < n; ++m) {
            auto f = s.frames;
            const auto& o = s.frames;
            const auto& name = s.patterns[m].name;
            if (m > 0) { f[m] = o[m - 1]; look("late_once", name, f); }
            f = o;
            if (m + 1 < n) { f[m] = o[m + 1]; look("early_once", name, f); }
            if (m > 0) {
                for (std::size_t i = m; i < n; ++i) f[i] = o[i - 1];
                look("late_from", name, f);
            }
            f = o;
            for (std::size_t i = m; i < n; ++i) f[i] = o[std::min(i + 1, n - 1)];
            look("missing", name, f);
            if (m > 1) {
                f = o;
                for (std::size_t i = m; i < n; ++i) f[i] = o[i - 2];
                look("late_by_two", name, f);
            }
            for (std::size_t k = m + 1; k < n; ++k) {
                f = o;
                std::swap(f[m], f[k]);
                look("swap", name + "/" + s.patterns[k].name, f);
            }
        }
        fmt::print("== {} ({} frames)\n", s.name, n);
        for (const auto& [kind, row] : table) fmt::print("  {:12} noticed {:4} missed {:4} harmless {:4} {}\n", kind, row[0], row[1], row[2], missed[kind]);
    }
}

}  // namespace
}  // namespace planlight
#include "registration/scan/scan_movement.h"
#include "registration/scan/camera_gamma.h"
namespace planlight {
namespace {
std::vector<GrayImage> encoded(const std::vector<GrayImage>& frames, double noise_grey, bool srgb, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    std::vector<double> noise(1 << 18);
    for (double& n : noise) n = normal(random);
    std::vector<GrayImage> out = frames;
    for (GrayImage& f : out) {
        std::size_t at = random();
        for (auto& p : f.pixels) {
            if (at % 997 == 0) at = random();
            const double sigma = std::sqrt(noise_grey * noise_grey + p * 0.01);  // shot noise of 25,000 electrons
            const double light = std::clamp((p + sigma * noise[at++ % noise.size()]) / 255, 0.0, 1.0);
            const double value = srgb ? (light < 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055) : std::pow(light, 1 / 2.2);
            p = static_cast<std::uint8_t>(std::lround(255 * value));
        }
    }
    return out;
}
TEST(ExploreGamma, DISABLED_Table) {
    for (const int which : {0, 1})
    for (const double ambient : {0.0, 1.0, 4.0, 18.0})
        for (const double white : {190.0, 60.0}) {
            Room room = room_of(which);
            room.light.ambient_grey = ambient;
            room.light.white_grey = white;
            const StripeSettings s = stripes_of(room);
            const auto frames = photograph(room, room.left, s, 1);
            for (const bool srgb : {false, true})
                for (const double noise : {0.3, 0.5, 0.7, 1.0, 2.0}) {
                    ScanCapture shot;
                    shot.stripes = s;
                    shot.left = encoded(frames, noise, srgb, 5);
                    const auto check = check_sequence(shot.left, s);
                    const double gamma = camera_gamma(shot.left, even_moments(shot));
                    const auto moved = movement_in_pictures(shot, 0.43);
                    fmt::print("room {} ambient {} white {} {} noise {}: {} {} gamma {:.2f} moved {:.3f} {}-{}", which, ambient, white, srgb ? "srgb" : "2.2 ", noise, check.checked ? "" : "NOT CHECKED",
                               check.problems.empty() ? "ok" : fmt::format("REFUSED {} {:.3f}", check.problems[0].what, check.problems[0].share), gamma, moved.moved_mm, moved.from, moved.to);
                    const auto view = decode_stripes(shot.left, s);
                    fmt::print(" decoded {}\n", view.decoded);
                }
        }
}
}  // namespace
}  // namespace planlight
