#include "app/windows/render_target.h"

#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// Calls a function on an event of VTK.
class OnEvent final : public vtkCommand {
public:
    static OnEvent* New() { return new OnEvent; }
    void Execute(vtkObject*, unsigned long, void* data) override { call(data); }
    std::function<void(void*)> call;
};

void on(vtkObject& object, unsigned long event, std::function<void(void*)> call) {
    vtkNew<OnEvent> command;
    command->call = std::move(call);
    object.AddObserver(event, command);
}

}  // namespace

vtkSmartPointer<vtkGenericOpenGLRenderWindow> render_target(int width, int height, int samples,
                                                            std::function<void()> make_current) {
    auto window = vtkSmartPointer<vtkGenericOpenGLRenderWindow>::New();
    window->SetReadyForRendering(true);
    window->SetOwnContext(0);
    window->SetMultiSamples(samples);
    window->SetDPI(72);
    window->SetSize(width, height);
    on(*window, vtkCommand::WindowMakeCurrentEvent, [make_current](void*) { make_current(); });
    on(*window, vtkCommand::WindowIsCurrentEvent, [](void* answer) { *static_cast<bool*>(answer) = true; });
    on(*window, vtkCommand::WindowSupportsOpenGLEvent, [](void* answer) { *static_cast<int*>(answer) = 1; });
    vtkObject::GlobalWarningDisplayOff();  // GLEW complains that there is no GLX, and works
    const bool usable = window->InitializeFromCurrentContext();
    vtkObject::GlobalWarningDisplayOn();
    if (!usable)
        throw DeviceError("3-D view", "VTK cannot use the graphics driver",
                          "Install an OpenGL 3.3 driver, or set LIBGL_ALWAYS_SOFTWARE=1.");
    window->SetFrameBlitModeToNoBlit();
    return window;
}

RgbImage picture_of(vtkGenericOpenGLRenderWindow& window) {
    const int* const size = window.GetSize();
    RgbImage picture(size[0], size[1]);
    vtkNew<vtkUnsignedCharArray> pixels;
    window.GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels, 0);
    const unsigned char* from = pixels->GetPointer(0);
    for (int y = size[1] - 1; y >= 0; --y)
        for (int x = 0; x < size[0]; ++x, from += 3) picture.at(x, y) = {from[0], from[1], from[2]};
    return picture;
}

}  // namespace planlight
