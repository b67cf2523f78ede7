#include <string>

#include "app/windows/scene_view.h"
#include "fake_model.h"
#include "write_picture.h"

/// draw_windows scene FILE [azimuth elevation]
int main(int argc, char** argv) {
    using namespace planlight;
    const OperatorModel model = test::fake_model();
    SceneView view = view_of_plan(*model.scene.plan);
    if (argc > 4) view.azimuth = std::stod(argv[3]), view.elevation = std::stod(argv[4]);
    test::write_picture(argv[2], render_scene(model.scene, view, 1280, 960));
}
