#pragma once

#include <memory>

#include "planning_io/types/image.h"

namespace planlight {

/// A grey picture on the graphics card; uploaded again only when it is another one.
class CameraTexture {
public:
    CameraTexture() = default;
    CameraTexture(const CameraTexture&) = delete;
    CameraTexture& operator=(const CameraTexture&) = delete;
    /// Gives the texture back; needs the window's context, so before the window ends.
    void release();
    /// The texture's GL name for this picture; 0 when there is none. Needs the window's context.
    unsigned take(const std::shared_ptr<const GrayImage>& picture);

private:
    std::shared_ptr<const GrayImage> shown_;
    unsigned texture_ = 0;
};

}  // namespace planlight
