#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "app/windows/camera_texture.h"

#include <GLFW/glfw3.h>

#include <cstdint>

#include "app/windows/camera_picture.h"
#include "app/windows/gui_window.h"

namespace planlight {

ImTextureID texture_id(unsigned texture) {
    return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));
}

Texture::~Texture() {
    if (name_ == 0) return;
    window_.make_current();
    glDeleteTextures(1, &name_);
}

unsigned Texture::bind() {
    const bool is_new = name_ == 0;
    if (is_new) glGenTextures(1, &name_);
    glBindTexture(GL_TEXTURE_2D, name_);
    if (is_new) {
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    return name_;
}

unsigned CameraTexture::take(const std::shared_ptr<const GrayImage>& picture, int pixels) {
    if (!picture || picture->empty() || pixels <= 0) return 0;
    if (picture == shown_ && pixels == pixels_) return texture_.name();
    shown_ = picture;
    pixels_ = pixels;
    const GrayImage small = brightened(shrunk(*picture, picture->width / pixels));
    const unsigned name = texture_.bind();
    const GLint grey[] = {GL_RED, GL_RED, GL_RED, GL_ONE};
    glTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, grey);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, small.width, small.height, 0, GL_RED, GL_UNSIGNED_BYTE, small.pixels.data());
    return name;
}

unsigned ColourTexture::take(const std::shared_ptr<const RgbImage>& picture) {
    if (!picture || picture->empty()) return 0;
    if (picture == shown_) return texture_.name();
    shown_ = picture;
    const unsigned name = texture_.bind();
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture->width, picture->height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                 picture->pixels.data());
    return name;
}

}  // namespace planlight
