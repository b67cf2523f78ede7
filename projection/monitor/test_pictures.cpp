#include "projection/monitor/test_pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "projection/monitor/monitor_card.h"

namespace planlight {
namespace {

constexpr Rgb kWhite{255, 255, 255};

Rgb grey(double share) {
    const auto value = static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
    return {value, value, value};
}

void draw_frame(RgbImage& picture) {
    const int w = picture.width, h = picture.height, arm = std::min(w, h) / 8;
    for (int x = 0; x < w; ++x) picture.at(x, 0) = picture.at(x, h - 1) = kWhite;
    for (int y = 0; y < h; ++y) picture.at(0, y) = picture.at(w - 1, y) = kWhite;
    // The middle of an even number of pixels lies between two: the cross is two pixels wide then.
    for (int x = (w - 1) / 2 - arm; x <= w / 2 + arm; ++x) picture.at(x, (h - 1) / 2) = picture.at(x, h / 2) = kWhite;
    for (int y = (h - 1) / 2 - arm; y <= h / 2 + arm; ++y) picture.at((w - 1) / 2, y) = picture.at(w / 2, y) = kWhite;
}

/// In the white half of its spoke.
bool is_white(const SiemensStar& star, double dx, double dy) {
    const double turn = (std::atan2(dy, dx) / (2 * std::numbers::pi) + 1) * star.spokes;
    return std::hypot(dx, dy) <= star.radius && turn - std::floor(turn) < 0.5;
}

/// The share of light in a pixel: by 4 x 4 places in it, but where no edge is near.
double light_of(const SiemensStar& star, int x, int y) {
    constexpr int kPlaces = 4;
    constexpr double kHalfDiagonal_px = 0.71;
    const double x0 = x - star.x, y0 = y - star.y, radius = std::hypot(x0, y0);
    if (radius > star.radius + kHalfDiagonal_px) return 0;
    const double halves = 2 * star.spokes * (std::atan2(y0, x0) / (2 * std::numbers::pi) + 1);
    const double to_edge_px = std::abs(halves - std::round(halves)) * 2 * std::numbers::pi * radius / (2 * star.spokes);
    if (to_edge_px > 1 && radius < star.radius - kHalfDiagonal_px) return is_white(star, x0, y0) ? 1 : 0;
    int white = 0;
    for (int v = 0; v < kPlaces; ++v)
        for (int u = 0; u < kPlaces; ++u)
            white += is_white(star, x0 + (u + 0.5) / kPlaces - 0.5, y0 + (v + 0.5) / kPlaces - 0.5);
    return static_cast<double>(white) / (kPlaces * kPlaces);
}

void draw_star(const SiemensStar& star, RgbImage& picture) {
    const int low_x = std::max(0, static_cast<int>(star.x - star.radius) - 1),
              high_x = std::min(picture.width - 1, static_cast<int>(star.x + star.radius) + 1),
              low_y = std::max(0, static_cast<int>(star.y - star.radius) - 1),
              high_y = std::min(picture.height - 1, static_cast<int>(star.y + star.radius) + 1);
    for (int y = low_y; y <= high_y; ++y)
        for (int x = low_x; x <= high_x; ++x) {
            const double light = light_of(star, x, y);
            if (light > 0) picture.at(x, y) = grey(light);
        }
}

void draw_steps(RgbImage& picture) {
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            picture.at(x, y) = grey(static_cast<double>(x * kGreySteps / picture.width) / (kGreySteps - 1));
}

}  // namespace

const char* text_of(TestPicture picture) {
    constexpr const char* kTexts[] = {"dark", "frame", "star", "steps", "name"};
    return kTexts[static_cast<std::size_t>(picture)];
}

std::optional<TestPicture> test_picture_of(const std::string& text) {
    for (const TestPicture picture : kTestPictures)
        if (text == text_of(picture)) return picture;
    return std::nullopt;
}

std::vector<SiemensStar> siemens_stars(int width, int height) {
    const double least = std::min(width, height), large = 0.36 * least, small = 0.12 * least, rim = 0.02 * least;
    const double left = rim + small, top = rim + small, right = width - 1 - left, bottom = height - 1 - top;
    return {{(width - 1) / 2.0, (height - 1) / 2.0, large},
            {left, top, small},
            {right, top, small},
            {left, bottom, small},
            {right, bottom, small}};
}

RgbImage draw_test_picture(TestPicture kind, const Monitor& monitor, int number) {
    if (kind == TestPicture::name) return draw_monitor_card(monitor, number);
    RgbImage picture(monitor.width, monitor.height);
    if (kind == TestPicture::frame) draw_frame(picture);
    if (kind == TestPicture::steps) draw_steps(picture);
    if (kind == TestPicture::star)
        for (const SiemensStar& star : siemens_stars(picture.width, picture.height)) draw_star(star, picture);
    return picture;
}

}  // namespace planlight
