#pragma once

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkSmartPointer.h>
#include <functional>

#include "planning_io/types/image.h"

namespace planlight {

/// A VTK render window inside the graphics context that is current now; `make_current` makes it so again;
/// `samples` per pixel smooth the edges, 0 is much faster without a graphics card.
/// Throws DeviceError when VTK cannot use the context.
vtkSmartPointer<vtkGenericOpenGLRenderWindow> render_target(int width, int height, int samples,
                                                            std::function<void()> make_current);

/// What it rendered last, top row first.
RgbImage picture_of(vtkGenericOpenGLRenderWindow& window);

}  // namespace planlight
