#include "tests/registration/scan/draw_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace planlight::scan_rooms {
namespace {

constexpr Rgb kBackground{24, 26, 30}, kInk{235, 235, 235};

Rgb between(const std::vector<Rgb>& stops, double share) {
    if (!(share > 0)) return stops.front();
    if (share >= 1) return stops.back();
    const double at = share * static_cast<double>(stops.size() - 1);
    const auto i = static_cast<std::size_t>(at);
    Rgb mixed;
    for (std::size_t c = 0; c < 3; ++c)
        mixed[c] = static_cast<std::uint8_t>(
            std::lround(stops[i][c] + (at - static_cast<double>(i)) * (stops[i + 1][c] - stops[i][c])));
    return mixed;
}

Rgb shaded(Rgb colour, double light) {
    for (auto& c : colour) c = static_cast<std::uint8_t>(std::clamp(light * c, 0.0, 255.0));
    return colour;
}

}  // namespace

Rgb sequential_colour(double share) {
    return between({{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}, share);
}

Rgb signed_colour(double share) {
    return between({{33, 90, 200}, {140, 180, 235}, {240, 240, 240}, {240, 160, 120}, {200, 40, 30}}, share);
}

RgbImage draw_cloud(const PointCloud& cloud, const std::vector<Rgb>& colours, const Eigen::Matrix3d& view_from_rig,
                    double mm_per_px, int width, int height, int radius_px) {
    RgbImage picture(width, height, kBackground);
    std::vector<float> depth(picture.pixels.size(), 1e30F);
    Eigen::AlignedBox3d box;
    for (const auto& p : cloud.points_in_rig) box.extend(Eigen::Vector3d(view_from_rig * p));
    const Eigen::Vector3d middle = box.center();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Eigen::Vector3d p = view_from_rig * cloud.points_in_rig[i] - middle;
        const int x0 = static_cast<int>(std::lround(width / 2.0 + p.x() / mm_per_px)),
                  y0 = static_cast<int>(std::lround(height / 2.0 + p.y() / mm_per_px));
        double light = 1;
        if (!cloud.normals_in_rig.empty())
            light =
                0.35 +
                0.65 * std::abs((view_from_rig * cloud.normals_in_rig[i]).dot(Eigen::Vector3d(-0.35, -0.45, -0.82)));
        for (int y = y0 - radius_px; y <= y0 + radius_px; ++y)
            for (int x = x0 - radius_px; x <= x0 + radius_px; ++x) {
                if (x < 0 || y < 0 || x >= width || y >= height) continue;
                float& nearest = depth[picture.index(x, y)];
                if (static_cast<float>(p.z()) >= nearest) continue;
                nearest = static_cast<float>(p.z());
                picture.at(x, y) = shaded(colours[i], light);
            }
    }
    return picture;
}

RgbImage draw_columns(const DecodedView& view, int projector_width) {
    const int step = view.width > 1000 ? 2 : 1;
    RgbImage picture(view.width / step, view.height / step, kBackground);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const float code = view.column[static_cast<std::size_t>(y * step) * static_cast<std::size_t>(view.width) +
                                           static_cast<std::size_t>(x * step)];
            if (!std::isnan(code)) picture.at(x, y) = sequential_colour(static_cast<double>(code) / projector_width);
        }
    return picture;
}

void write_words(RgbImage& picture, const std::string& words, int x, int y) {
    cv::Mat pixels(picture.height, picture.width, CV_8UC3, picture.pixels.data());
    cv::putText(pixels, words, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(0, 0, 0), 3, cv::LINE_AA);
    cv::putText(pixels, words, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(kInk[0], kInk[1], kInk[2]), 1,
                cv::LINE_AA);
}

RgbImage with_legend(const RgbImage& picture, const std::string& words, double low, double high,
                     Rgb (*colour)(double)) {
    constexpr int kBar = 44;
    RgbImage whole(picture.width, picture.height + kBar, kBackground);
    std::copy(picture.pixels.begin(), picture.pixels.end(), whole.pixels.begin());
    const int left = 60, right = std::min(picture.width - 60, left + 260);
    for (int x = left; x < right; ++x)
        for (int y = picture.height + 8; y < picture.height + 22; ++y)
            whole.at(x, y) = colour(static_cast<double>(x - left) / (right - left));
    write_words(whole, fmt::format("{:g}", low), 8, picture.height + 20);
    write_words(whole, fmt::format("{:g}", high), right + 8, picture.height + 20);
    write_words(whole, words, left, picture.height + 37);
    return whole;
}

RgbImage half_size(const RgbImage& picture) {
    RgbImage half(picture.width / 2, picture.height / 2);
    for (int y = 0; y < half.height; ++y)
        for (int x = 0; x < half.width; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                half.at(x, y)[c] = static_cast<std::uint8_t>(
                    (picture.at(2 * x, 2 * y)[c] + picture.at(2 * x + 1, 2 * y)[c] + picture.at(2 * x, 2 * y + 1)[c] +
                     picture.at(2 * x + 1, 2 * y + 1)[c] + 2) /
                    4);
    return half;
}

RgbImage coloured(const GrayImage& picture) {
    RgbImage colour(picture.width, picture.height);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) colour.pixels[i].fill(picture.pixels[i]);
    return colour;
}

RgbImage side_by_side(const std::vector<RgbImage>& pictures, int columns) {
    constexpr int kGap = 6;
    const int w = pictures.front().width, h = pictures.front().height,
              rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
    RgbImage whole(columns * (w + kGap) - kGap, rows * (h + kGap) - kGap, {255, 255, 255});
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        const int x0 = static_cast<int>(k) % columns * (w + kGap), y0 = static_cast<int>(k) / columns * (h + kGap);
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) whole.at(x0 + x, y0 + y) = pictures[k].at(x, y);
    }
    return whole;
}

}  // namespace planlight::scan_rooms
