#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/registration/scan/solid_room.h"

namespace planlight::solid_room {
namespace {

/// The light along a direction of a picture, blurred; at any place.
class Profile {
public:
    Profile(const std::vector<double>& values, double blur_px, double leak) {
        constexpr int kFine = 8;
        cv::Mat fine(1, static_cast<int>(values.size()) * kFine, CV_64F);
        for (int i = 0; i < fine.cols; ++i)
            fine.at<double>(0, i) = leak + (1 - leak) * values[static_cast<std::size_t>(i / kFine)];
        cv::GaussianBlur(fine, fine, cv::Size(0, 0), std::max(0.05, blur_px) * kFine, 1e-6, cv::BORDER_CONSTANT);
        values_.assign(fine.begin<double>(), fine.end<double>());
    }
    float at(float pixel) const {
        const float s = (pixel + 0.5F) * 8 - 0.5F;
        const int i = static_cast<int>(std::floor(s));
        if (i < 0 || i + 1 >= static_cast<int>(values_.size())) return 0;
        const auto k = static_cast<std::size_t>(i);
        return static_cast<float>(values_[k]) +
               (s - static_cast<float>(i)) * static_cast<float>(values_[k + 1] - values_[k]);
    }

private:
    std::vector<double> values_;
};

}  // namespace

GrayImage Exposure::picture(const std::vector<double>& values, bool along_rows) {
    const Photography& how = room_.photography;
    const Profile profile(values, how.projector_blur_px, 1 / how.contrast);
    const int across = along_rows ? room_.projector.width : room_.projector.height;
    const Profile rim(std::vector<double>(static_cast<std::size_t>(across), 1.0), how.projector_blur_px, 0);
    const auto light_of = [&](const Path& path) {
        return path.share <= 0
                   ? 0.0F
                   : path.share * profile.at(along_rows ? path.v : path.u) * rim.at(along_rows ? path.u : path.v);
    };
    const int columns = camera_.width / kLattice_px + 1, rows = camera_.height / kLattice_px + 1;
    cv::Mat coarse = cv::Mat::zeros(rows, columns, CV_32F), seen(camera_.height, camera_.width, CV_32F),
            mirrored = seen.clone();
    for (std::size_t k = 0; k < bounced_.size(); ++k)
        for (const Path& path : bounced_[k]) coarse.ptr<float>()[k] += light_of(path);
    for (int y = 0; y < camera_.height; ++y)
        for (int x = 0; x < camera_.width; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x);
            float sum = 0;
            for (const auto& sub : direct_) sum += 0.25F * light_of(sub[i]);
            seen.at<float>(y, x) = sum;
            mirrored.at<float>(y, x) = light_of(mirrored_[i]);
        }
    if (room_.material.into_skin_px > 0) {
        cv::Mat spread;
        cv::GaussianBlur(seen, spread, cv::Size(0, 0), room_.material.into_skin_px);
        for (int y = 0; y < camera_.height; ++y)
            for (int x = 0; x < camera_.width; ++x) {
                const bool skin = albedo_[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                                          static_cast<std::size_t>(x)] > 0;
                seen.at<float>(y, x) = 0.67F * seen.at<float>(y, x) + (skin ? 0.33F * spread.at<float>(y, x) : 0.0F);
            }
    }
    const auto between = [&](int x,
                             int y) {  // of the four lattice places round a pixel, those that have light paths at all
        float sum = 0, weights = 0;
        const float fx = static_cast<float>(x) / kLattice_px, fy = static_cast<float>(y) / kLattice_px;
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                const int c = static_cast<int>(fx) + i, r = static_cast<int>(fy) + j;
                if (c >= columns || r >= rows) continue;
                const float w = (1 - std::abs(fx - static_cast<float>(c))) * (1 - std::abs(fy - static_cast<float>(r)));
                sum += w * coarse.at<float>(r, c);
                weights += w;
            }
        return weights > 0 ? sum / weights : 0.0F;
    };
    for (int y = 0; y < camera_.height; ++y)
        for (int x = 0; x < camera_.width; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x);
            if (albedo_[i] > 0 && !bounced_.empty()) seen.at<float>(y, x) += between(x, y);
            seen.at<float>(y, x) += mirrored.at<float>(y, x);
        }
    if (how.camera_blur_px > 0) cv::GaussianBlur(seen, seen, cv::Size(0, 0), how.camera_blur_px);
    std::mt19937 random(seed_++);
    std::normal_distribution<float> normal;
    GrayImage grey(camera_.width, camera_.height);
    const float* value = seen.ptr<float>();
    for (std::size_t i = 0; i < grey.pixels.size(); ++i) {
        double light = how.white_grey / 0.8 * static_cast<double>(value[i]) +
                       how.dark_grey * (0.4 + static_cast<double>(albedo_[i]));
        light += normal(random) * std::hypot(how.read_noise_grey, how.shot_noise * std::sqrt(std::max(0.0, light)) * 4);
        if (how.camera_gamma != 1) light = 255 * std::pow(std::clamp(light / 255, 0.0, 1.0), 1 / how.camera_gamma);
        grey.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(light), 0L, 255L));
    }
    return grey;
}

std::vector<double> shown(const StripeSettings& s, const StripePattern& pattern) {
    constexpr double kGamma = 1.8;  // of the projector
    using Kind = StripePattern::Kind;
    const int size = pattern.along_rows ? s.height : s.width,
              begins = pattern.along_rows ? s.begins_at_row : s.begins_at_column;
    const double cell_px = s.phase_period_px / 2;
    int bits = 1;
    while (std::pow(2.0, bits) < begins + size / cell_px) ++bits;
    std::vector<double> values(static_cast<std::size_t>(size), pattern.kind == Kind::white ? 1.0 : 0.0);
    for (int i = 0; i < size; ++i) {
        double& value = values[static_cast<std::size_t>(i)];
        const int number = begins + static_cast<int>(i / cell_px), gray = number ^ (number / 2);
        const bool set = gray / (1 << (bits - 1 - pattern.index)) % 2 == 1;
        if (pattern.kind == Kind::gray_bit) value = set ? 1 : 0;
        if (pattern.kind == Kind::gray_bit_inverse) value = set ? 0 : 1;
        if (pattern.kind != Kind::phase) continue;
        const double period = pattern.frequency == 0
                                  ? s.phase_period_px
                                  : s.order_periods_px.at(static_cast<std::size_t>(pattern.frequency - 1));
        const double steps = pattern.frequency == 0 ? s.phase_steps : s.order_steps;
        value = std::pow(
            std::round(127.5 + 127.5 * std::cos(2 * std::numbers::pi * (i / period - pattern.index / steps))) / 255,
            kGamma);
    }
    return values;
}

}  // namespace planlight::solid_room
