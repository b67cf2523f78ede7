#pragma once

#include <cstdint>
#include <vector>

#include "registration/simulation/light.h"
#include "registration/simulation/optics.h"
#include "registration/simulation/surface.h"

namespace planlight::simulation {

/// What is in the room, in ct at one moment.
struct Scene {
    const Surface& skin;
    const SurfaceLook& look;
    Optics camera, projector;          ///< in ct
    double working_distance_mm = 900;  ///< where the projector is in focus and white is 1
    int finer = 4;                     ///< samples along each side of a pixel with an edge in it
};

/// What one camera sees of the head at one pose: for every pixel where its light comes from on the projector's panel,
/// and how much of it comes back. Any number of pictures can be looked up in it while the head is at rest.
class CameraView {
public:
    void look(const Scene& scene);

    /// Light in every pixel before lens and sensor, in units of white light on white paper: `lit` from the projector,
    /// plus `ambient` (a factor) times what the room lights. Rows of the camera's width.
    void expose(const LightMap& light, float lit, float ambient, std::vector<float>& picture);

    int width() const { return width_; }
    int height() const { return height_; }

private:
    struct Sample {
        float u = -9, v = -9, blur = 0;  ///< on the panel
        float hard = 0;                  ///< comes back from where it fell
        float soft = 0;                  ///< goes into the skin
    };
    struct Traced {
        Sample sample;
        float ambient = 0, soft_albedo = 0, translucent = 0, depth_mm = 0;
        Material material = Material::none;
        bool lit = false;
    };
    struct Pixel {
        std::int32_t x = 0;
        std::uint32_t first = 0, count = 0;
        float ambient = 0, soft_albedo = 0;
    };
    struct Row {
        std::vector<Pixel> pixels;
        std::vector<Sample> samples;
    };

    Traced trace(const Scene& scene, const Eigen::Vector2d& pixel) const;
    void find_bounds(const Scene& scene);
    bool needs_more(int x, int y) const;
    void keep_row(const Scene& scene, int y);
    void keep_translucency();
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }

    int width_ = 0, height_ = 0;
    int left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;  ///< where the head can be, half open
    double mm_per_px_ = 1;
    std::vector<Traced> traced_;
    std::vector<Row> rows_;
    std::vector<float> translucency_;  ///< 1 / blurred coverage of translucent skin
    bool any_soft_ = false;            ///< some of what is seen is translucent
    std::vector<float> soft_, scratch_;
};

}  // namespace planlight::simulation
