#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "app/windows/camera_texture.h"

#include <GLFW/glfw3.h>

namespace planlight {

void CameraTexture::release() {
    if (texture_ != 0) glDeleteTextures(1, &texture_);
    texture_ = 0;
    shown_ = nullptr;
}

unsigned CameraTexture::take(const std::shared_ptr<const GrayImage>& picture) {
    if (!picture || picture->empty()) return 0;
    if (texture_ == 0) glGenTextures(1, &texture_);
    if (picture == shown_) return texture_;
    shown_ = picture;
    glBindTexture(GL_TEXTURE_2D, texture_);
    const GLint grey[] = {GL_RED, GL_RED, GL_RED, GL_ONE};
    glTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, grey);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, picture->width, picture->height, 0, GL_RED, GL_UNSIGNED_BYTE,
                 picture->pixels.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    return texture_;
}

}  // namespace planlight
