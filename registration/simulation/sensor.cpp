#include "registration/simulation/sensor.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "registration/simulation/blur.h"
#include "registration/simulation/hash.h"

namespace planlight::simulation {

namespace {

constexpr float kElectronsAtFullScale = 12000;  ///< shot noise: 2.3 grey at full scale
constexpr float kReadNoise_grey = 0.7F;

/// A large bag of normally distributed numbers, mean 0 and deviation 1 exactly.
const std::vector<float>& bag_of_noise() {
    static const std::vector<float> bag = [] {
        std::mt19937 random(20011);
        std::normal_distribution<double> unit;
        std::vector<double> values(1U << 16U);
        double mean = 0, square = 0;
        for (double& v : values) mean += (v = unit(random));
        mean /= static_cast<double>(values.size());
        for (double& v : values) square += (v - mean) * (v - mean);
        const double deviation = std::sqrt(square / static_cast<double>(values.size()));
        std::vector<float> result;
        for (const double v : values) result.push_back(static_cast<float>((v - mean) / deviation));
        return result;
    }();
    return bag;
}

}  // namespace

GrayImage sense(const Sensor& sensor, std::vector<float>& light, std::uint64_t frame) {
    std::vector<float> scratch;
    gaussian_blur(light, scratch, sensor.width, sensor.height, sensor.blur_px);
    GrayImage picture(sensor.width, sensor.height);
    const auto& bag = bag_of_noise();
    const auto w = static_cast<float>(sensor.width), h = static_cast<float>(sensor.height);
    const float loss = static_cast<float>(1 - sensor.corner_light) / (w * w + h * h) * 4;
    const std::uint64_t stream = mixed(sensor.seed ^ mixed(frame));
    tbb::parallel_for(tbb::blocked_range<int>(0, sensor.height, 16), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            const float dy = static_cast<float>(y) - h / 2;
            for (int x = 0; x < sensor.width; ++x) {
                const std::size_t i = picture.index(x, y);
                const float dx = static_cast<float>(x) - w / 2;
                float grey = 255 * light[i] * (1 - loss * (dx * dx + dy * dy));
                if (sensor.noise) {
                    const float variance = kReadNoise_grey * kReadNoise_grey + grey * (255 / kElectronsAtFullScale);
                    grey += std::sqrt(variance) * bag[mixed(stream + i) >> 48U];
                }
                picture.pixels[i] = static_cast<std::uint8_t>(std::clamp(grey + 0.5F, 0.0F, 255.0F));
            }
        }
    });
    return picture;
}

}  // namespace planlight::simulation
