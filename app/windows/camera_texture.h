#pragma once

#include <imgui.h>

#include <memory>

#include "planning_io/types/image.h"

namespace planlight {

/// A camera's picture as an OpenGL texture, made anew only for another picture: as small as it is shown, and as bright
/// as a person wants to see it (what is brighter than all but the brightest half per cent becomes white). The context
/// must be current.
class CameraTexture {
public:
    /// For a place `pixels` wide; 0 when there is no picture.
    unsigned take(const std::shared_ptr<const GrayImage>& picture, int pixels);
    void release();

private:
    std::shared_ptr<const GrayImage> shown_;
    unsigned texture_ = 0;
    int pixels_ = 0;
};

/// A picture in colours as an OpenGL texture, as it is.
class ColourTexture {
public:
    /// 0 when there is no picture.
    unsigned take(const std::shared_ptr<const RgbImage>& picture);
    void release();

private:
    std::shared_ptr<const RgbImage> shown_;
    unsigned texture_ = 0;
};

/// As Dear ImGui takes textures.
ImTextureID texture_id(unsigned texture);

}  // namespace planlight
