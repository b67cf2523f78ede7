#include "registration/simulation/camera_view.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "registration/simulation/blur.h"
#include "registration/simulation/room_things.h"

namespace planlight::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {
constexpr double kScatter_mm = 0.9;    ///< how far light wanders in the skin
constexpr double kFocusDepth_mm = 90;  ///< from the focus to the full blur
constexpr double kShine = 28;          ///< exponent of the highlight
}  // namespace

CameraView::Traced CameraView::trace(const Scene& scene, const Vector2d& pixel) const {
    Traced result;
    const Vector3d way = scene.camera.direction_of(pixel);
    const auto hit = scene.skin.first_hit(scene.camera.eye, way);
    if (!hit) return result;
    const Vector3d& p = hit->p_in_ct;
    Vector3d n = hit->normal_in_ct;
    const double away = n.dot(way);
    if (away > -0.02) n = (n - (away + 0.02) * way).normalized();  // smooth normals may tip over the horizon
    const Look look = hit->made_of == Material::none ? scene.look.at(p) : look_of(hit->made_of, p);
    result.material = look.material;
    result.depth_mm = static_cast<float>(hit->distance_mm);
    result.ambient = static_cast<float>(look.albedo * (0.65 - 0.35 * n.dot(way)));
    result.soft_albedo = static_cast<float>(look.albedo * look.translucent);
    result.translucent = look.translucent > 0 ? 1.0F : 0.0F;

    const Vector3d to_light = scene.projector.eye - p;
    const double distance = to_light.norm(), cosine = n.dot(to_light) / distance;
    if (cosine <= 0 || scene.projector.depth(p) <= 0) return result;
    const Vector2d uv = scene.projector.pixel_of(p);
    if (uv.x() < -1 || uv.y() < -1 || uv.x() > scene.projector.columns || uv.y() > scene.projector.rows) return result;
    if (scene.skin.in_shadow(p, hit->normal_in_ct, scene.projector.eye)) return result;
    result.lit = true;
    const double fall = scene.working_distance_mm / distance;
    const double off_axis = scene.projector.depth(p) / distance;
    const double light = cosine * fall * fall * off_axis * off_axis;
    const Vector3d half = (to_light / distance - way).normalized();
    const double shine = look.specular * (kShine + 8) / 8 * std::pow(std::max(0.0, n.dot(half)), kShine);
    result.sample.u = static_cast<float>(uv.x());
    result.sample.v = static_cast<float>(uv.y());
    result.sample.blur = static_cast<float>(
        std::min(1.0, std::abs(scene.projector.depth(p) - scene.working_distance_mm) / kFocusDepth_mm));
    result.sample.hard = static_cast<float>(light * (look.albedo * (1 - look.translucent) + shine));
    result.sample.soft = look.translucent > 0 ? static_cast<float>(light) : 0.0F;
    return result;
}

void CameraView::find_bounds(const Scene& scene) {
    const Vector3d low = scene.skin.low_in_ct(), high = scene.skin.high_in_ct();
    Vector2d least(1e9, 1e9), most(-1e9, -1e9);
    for (int c = 0; c < 8; ++c) {
        const Vector3d corner((c & 1) ? high.x() : low.x(), (c & 2) ? high.y() : low.y(), (c & 4) ? high.z() : low.z());
        const Vector2d pixel = scene.camera.pixel_of(corner);
        least = least.cwiseMin(pixel);
        most = most.cwiseMax(pixel);
    }
    left_ = std::clamp(static_cast<int>(least.x()) - 2, 0, width_);
    right_ = std::clamp(static_cast<int>(most.x()) + 3, left_, width_);
    top_ = std::clamp(static_cast<int>(least.y()) - 2, 0, height_);
    bottom_ = std::clamp(static_cast<int>(most.y()) + 3, top_, height_);
    const double distance = (scene.skin.middle_in_ct() - scene.camera.eye).norm();
    mm_per_px_ = distance * scene.camera.pitch_mm.x() / scene.camera.focal_mm;
}

/// An edge runs through or beside the pixel: of the head, a shadow or a sticker.
bool CameraView::needs_more(int x, int y) const {
    const Traced& me = traced_[index(x, y)];
    const double jump_mm = 6 * mm_per_px_;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const int i = x + dx, j = y + dy;
            if (i < 0 || j < 0 || i >= width_ || j >= height_) continue;
            const Traced& other = traced_[index(i, j)];
            if (other.material != me.material || other.lit != me.lit) return true;
            if (std::abs(static_cast<double>(other.depth_mm - me.depth_mm)) > jump_mm) return true;
        }
    return false;
}

void CameraView::keep_row(const Scene& scene, int y) {
    Row& row = rows_[static_cast<std::size_t>(y)];
    row.pixels.clear();
    row.samples.clear();
    for (int x = left_; x < right_; ++x) {
        Traced& me = traced_[index(x, y)];
        Pixel pixel;
        pixel.x = x;
        pixel.first = static_cast<std::uint32_t>(row.samples.size());
        if (!needs_more(x, y)) {
            if (me.material == Material::none) continue;
            pixel.ambient = me.ambient;
            pixel.soft_albedo = me.soft_albedo;
            if (me.lit) row.samples.push_back(me.sample);
            translucency_[index(x, y)] = me.translucent;
        } else {
            const int finer = scene.finer;
            const float share = 1.0F / static_cast<float>(finer * finer);
            float translucent = 0;
            for (int s = 0; s < finer * finer; ++s) {
                const Vector2d at(x + (s % finer + 0.5) / finer - 0.5, y + (s / finer + 0.5) / finer - 0.5);
                Traced fine = trace(scene, at);
                pixel.ambient += share * fine.ambient;
                pixel.soft_albedo += share * fine.soft_albedo;
                translucent += share * fine.translucent;
                if (!fine.lit) continue;
                fine.sample.hard *= share;
                fine.sample.soft *= share;
                row.samples.push_back(fine.sample);
            }
            translucency_[index(x, y)] = translucent;
        }
        pixel.count = static_cast<std::uint32_t>(row.samples.size()) - pixel.first;
        row.pixels.push_back(pixel);
    }
}

void CameraView::look(const Scene& scene) {
    width_ = scene.camera.columns;
    height_ = scene.camera.rows;
    find_bounds(scene);
    traced_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), Traced{});
    translucency_.assign(traced_.size(), 0);
    rows_.resize(static_cast<std::size_t>(height_));
    for (Row& row : rows_) row.pixels.clear();
    const tbb::blocked_range<int> all(top_, bottom_, 4);
    tbb::parallel_for(all, [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y)
            for (int x = left_; x < right_; ++x) traced_[index(x, y)] = trace(scene, {x, y});
    });
    tbb::parallel_for(all, [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) keep_row(scene, y);
    });
    any_soft_ = std::any_of(traced_.begin(), traced_.end(), [](const Traced& t) { return t.translucent > 0; });
    if (any_soft_) keep_translucency();
}

void CameraView::keep_translucency() {
    wide_blur(translucency_, scratch_, width_, height_,
              std::max(1, static_cast<int>(std::lround(kScatter_mm / mm_per_px_))));
    for (float& t : translucency_) t = t > 0.02F ? 1 / t : 0;
}

void CameraView::expose(const LightMap& light, float lit, float ambient, std::vector<float>& picture) {
    picture.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
    soft_.assign(picture.size(), 0);
    tbb::parallel_for(tbb::blocked_range<int>(top_, bottom_, 8), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            const Row& row = rows_[static_cast<std::size_t>(y)];
            for (const Pixel& pixel : row.pixels) {
                float hard = 0, soft = 0;
                for (std::uint32_t s = pixel.first; s < pixel.first + pixel.count; ++s) {
                    const Sample& sample = row.samples[s];
                    const float value = light.at(sample.u, sample.v, sample.blur);
                    hard += sample.hard * value;
                    soft += sample.soft * value;
                }
                picture[index(pixel.x, y)] = ambient * pixel.ambient + lit * hard;
                soft_[index(pixel.x, y)] = soft;
            }
        }
    });
    if (!any_soft_) return;
    wide_blur(soft_, scratch_, width_, height_, std::max(1, static_cast<int>(std::lround(kScatter_mm / mm_per_px_))));
    tbb::parallel_for(tbb::blocked_range<int>(top_, bottom_, 8), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y)
            for (const Pixel& pixel : rows_[static_cast<std::size_t>(y)].pixels) {
                const std::size_t i = index(pixel.x, y);
                picture[i] += lit * pixel.soft_albedo * soft_[i] * translucency_[i];
            }
    });
}

}  // namespace planlight::simulation
