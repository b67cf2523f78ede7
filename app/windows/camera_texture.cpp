#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "app/windows/camera_texture.h"

#include <GLFW/glfw3.h>

#include <cstdint>

#include "app/windows/camera_picture.h"

namespace planlight {

ImTextureID texture_id(unsigned texture) {
    return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));
}

void CameraTexture::release() {
    if (texture_ != 0) glDeleteTextures(1, &texture_);
    texture_ = 0;
    shown_ = nullptr;
}

unsigned CameraTexture::take(const std::shared_ptr<const GrayImage>& picture, int pixels) {
    if (!picture || picture->empty() || pixels <= 0) return 0;
    if (texture_ == 0) glGenTextures(1, &texture_);
    if (picture == shown_ && pixels == pixels_) return texture_;
    shown_ = picture;
    pixels_ = pixels;
    const GrayImage small = brightened(shrunk(*picture, picture->width / pixels));
    glBindTexture(GL_TEXTURE_2D, texture_);
    const GLint grey[] = {GL_RED, GL_RED, GL_RED, GL_ONE};
    glTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, grey);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, small.width, small.height, 0, GL_RED, GL_UNSIGNED_BYTE, small.pixels.data());
    return texture_;
}

void ColourTexture::release() {
    if (texture_ != 0) glDeleteTextures(1, &texture_);
    texture_ = 0;
    shown_ = nullptr;
}

unsigned ColourTexture::take(const std::shared_ptr<const RgbImage>& picture) {
    if (!picture || picture->empty()) return 0;
    if (texture_ == 0) glGenTextures(1, &texture_);
    if (picture == shown_) return texture_;
    shown_ = picture;
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture->width, picture->height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                 picture->pixels.data());
    return texture_;
}

}  // namespace planlight
