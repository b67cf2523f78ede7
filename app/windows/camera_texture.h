#pragma once

#include <imgui.h>

#include <memory>

#include "planning_io/types/image.h"

namespace planlight {

class GuiWindow;

/// An OpenGL texture in the context of a window that outlives it. That context must be current wherever it is used; it
/// is made so to give the texture back.
class Texture {
public:
    explicit Texture(GuiWindow& window) : window_(window) {}
    ~Texture();
    Texture(const Texture&) = delete;
    Texture& operator=(const Texture&) = delete;
    /// Made when it is bound first.
    unsigned bind();
    unsigned name() const { return name_; }  ///< 0: never bound

private:
    GuiWindow& window_;
    unsigned name_ = 0;
};

/// A camera's picture as an OpenGL texture, made anew only for another picture: as small as it is shown, and as bright
/// as a person wants to see it (what is brighter than all but the brightest half per cent becomes white).
class CameraTexture {
public:
    explicit CameraTexture(GuiWindow& window) : texture_(window) {}
    /// For a place `pixels` wide; 0 when there is no picture.
    unsigned take(const std::shared_ptr<const GrayImage>& picture, int pixels);

private:
    Texture texture_;
    std::shared_ptr<const GrayImage> shown_;
    int pixels_ = 0;
};

/// A picture in colours as an OpenGL texture, as it is.
class ColourTexture {
public:
    explicit ColourTexture(GuiWindow& window) : texture_(window) {}
    /// 0 when there is no picture.
    unsigned take(const std::shared_ptr<const RgbImage>& picture);

private:
    Texture texture_;
    std::shared_ptr<const RgbImage> shown_;
};

/// As Dear ImGui takes textures.
ImTextureID texture_id(unsigned texture);

}  // namespace planlight
