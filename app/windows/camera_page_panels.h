#pragma once

#include <array>

#include "app/windows/camera_page_model.h"
#include "app/windows/pen.h"

namespace planlight {

/// Where everything stands on the page.
struct CameraPageLayout {
    Box title;
    std::array<Box, 2> picture, figures;  ///< left, right
    Box room;                             ///< pairs, and what the projector shows
    Box dark;
    std::array<Box, 5> buttons;
};
CameraPageLayout camera_page_layout(float width, float height, float scale);

/// The picture as it was exposed, with what is too bright and too dark in it, the markers, and the part that sharpness
/// is measured in.
void draw_aimed_camera(const Pen& pen, const Box& box, const CameraPageModel::Camera& camera, ImTextureID texture);

/// Sharpness with the best that was seen, exposure, rate, loss, markers, and what the camera does by itself.
void draw_camera_figures(const Pen& pen, const Box& box, const CameraPageModel::Camera& camera);

/// Whether both expose together, and what the projector shows.
void draw_page_room(const Pen& pen, const Box& box, const CameraPageModel& model);

/// All of it; what was pressed, but DARK.
CameraPageAction draw_camera_page(const Pen& pen, const CameraPageLayout& place, const CameraPageModel& model,
                                  const std::array<ImTextureID, 2>& textures);

}  // namespace planlight
