#include "registration/tracking/find_markers.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "registration/tracking/measure_disc.h"

namespace planlight {
namespace {

/// Rough discs in a window of a picture, searched at 1/`scale` of its resolution.
struct Window {
    cv::Mat pixels;  ///< 8 bit, smoothed
    double scale = 1;
    Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< of the window in the picture, pixels

    Ellipse in_picture(const Ellipse& e) const {
        // The centre of a block of `scale` pixels lies (scale - 1) / 2 past its first.
        return {origin + (scale * e.centre).array().matrix() + Eigen::Vector2d::Constant(0.5 * (scale - 1)),
                scale * scale * e.shape};
    }
};

Window make_window(const GrayImage& picture, const cv::Rect& part, int scale) {
    const cv::Mat whole(picture.height, picture.width, CV_8U, const_cast<std::uint8_t*>(picture.pixels.data()));
    Window window{cv::Mat(), static_cast<double>(scale), {part.x, part.y}};
    if (scale == 1) {
        cv::GaussianBlur(whole(part), window.pixels, cv::Size(3, 3), 0.8, 0,
                         cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
    } else {
        cv::resize(whole(part), window.pixels, cv::Size(part.width / scale, part.height / scale), 0, 0, cv::INTER_AREA);
    }
    return window;
}

/// Circles by the Hough transform on the gradients.
void add_hough_circles(const Window& window, const MarkerSettings& settings, std::vector<Ellipse>& rough) {
    constexpr double kCannyThreshold = 60, kVotes = 14;
    constexpr std::size_t kMost = 60;
    const int least = std::max(3, static_cast<int>(settings.min_radius_px / window.scale));
    const int largest = std::max(least + 1, std::min(30, static_cast<int>(settings.max_radius_px / window.scale)));
    std::vector<cv::Vec3f> circles;
    cv::HoughCircles(window.pixels, circles, cv::HOUGH_GRADIENT, 1.5, 2.5 * least, kCannyThreshold, kVotes, least,
                     largest);
    if (circles.size() > kMost) circles.resize(kMost);
    for (const auto& c : circles) rough.push_back(window.in_picture(circle({c[0], c[1]}, c[2])));
}

/// Dark blobs of about elliptic outline: what the Hough transform for circles misses when a disc is strongly tilted.
void add_dark_blobs(const Window& window, const MarkerSettings& settings, int block, std::vector<Ellipse>& rough) {
    cv::Mat dark;
    const double step = std::max(3.0, 0.25 * settings.min_contrast);
    cv::adaptiveThreshold(window.pixels, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, block, step);
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(dark, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    const double least = settings.min_radius_px / window.scale, largest = settings.max_radius_px / window.scale;
    for (const auto& contour : contours) {
        const double length = static_cast<double>(contour.size());
        if (length < 4 * least || length > 9 * largest) continue;
        const cv::Moments m = cv::moments(contour);
        if (m.m00 < least * least || m.m00 > 4 * largest * largest) continue;
        Eigen::Matrix2d shape;  // of the ellipse with these second moments
        shape << m.mu20, m.mu11, m.mu11, m.mu02;
        shape *= 4 / m.m00;
        const double ellipse_area = std::numbers::pi * std::sqrt(std::max(0.0, shape.determinant()));
        if (ellipse_area > 1.25 * m.m00 || ellipse_area < 0.8 * m.m00) continue;
        rough.push_back(window.in_picture({{m.m10 / m.m00, m.m01 / m.m00}, shape}));
    }
}

bool is_new(const std::vector<MarkerObservation>& markers, const Eigen::Vector2d& place, double radius_px) {
    return std::none_of(markers.begin(), markers.end(), [&](const MarkerObservation& m) {
        return (m.pixel - place).norm() < 0.7 * std::max(m.radius_px, radius_px);
    });
}

void measure_all(const GrayImage& picture, const MarkerSettings& settings, const std::vector<Ellipse>& rough,
                 std::vector<MarkerObservation>& markers) {
    for (const Ellipse& e : rough) {
        if (!is_new(markers, e.centre, 0)) continue;
        const auto marker = measure_disc(picture, e, settings);
        if (marker && is_new(markers, marker->pixel, marker->radius_px)) markers.push_back(*marker);
    }
}

}  // namespace

std::vector<MarkerObservation> find_markers(const GrayImage& picture, const MarkerSettings& settings) {
    std::vector<MarkerObservation> markers;
    if (picture.width < 16 || picture.height < 16) return markers;
    const Window window = make_window(picture, {0, 0, picture.width, picture.height}, picture.width > 1000 ? 2 : 1);
    std::vector<Ellipse> rough;
    add_dark_blobs(window, settings, 41, rough);
    add_dark_blobs(window, settings, 101, rough);
    add_hough_circles(window, settings, rough);
    measure_all(picture, settings, rough, markers);
    return markers;
}

std::optional<MarkerObservation> measure_marker(const GrayImage& picture, const Eigen::Vector2d& near_pixel,
                                                double radius_px, double search_px, const MarkerSettings& settings) {
    const auto fits = [&](const MarkerObservation& m) {
        return (m.pixel - near_pixel).norm() <= search_px && m.radius_px > 0.7 * radius_px &&
               m.radius_px < 1.4 * radius_px;
    };
    if (!near_pixel.allFinite() || !(radius_px > 0)) return std::nullopt;
    const auto there = measure_disc(picture, circle(near_pixel, radius_px), settings);
    if (there && fits(*there)) return there;
    const double reach = search_px + 3 * radius_px;
    const cv::Rect wanted(static_cast<int>(near_pixel.x() - reach), static_cast<int>(near_pixel.y() - reach),
                          static_cast<int>(2 * reach), static_cast<int>(2 * reach));
    const cv::Rect part = wanted & cv::Rect(0, 0, picture.width, picture.height);
    if (part.width < 16 || part.height < 16) return std::nullopt;
    const Window window = make_window(picture, part, radius_px > 14 ? 2 : 1);
    std::vector<Ellipse> rough;
    const int block = 2 * static_cast<int>(2.5 * radius_px / window.scale) + 1;
    add_dark_blobs(window, settings, std::max(block, 9), rough);
    std::sort(rough.begin(), rough.end(), [&](const Ellipse& a, const Ellipse& b) {
        return (a.centre - near_pixel).squaredNorm() < (b.centre - near_pixel).squaredNorm();
    });
    for (const Ellipse& e : rough) {
        const auto marker = measure_disc(picture, e, settings);
        if (marker && fits(*marker)) return marker;
    }
    return std::nullopt;
}

}  // namespace planlight
