#pragma once

#include <array>

#include "app/windows/guide_layout.h"
#include "app/windows/guide_model.h"
#include "app/windows/pen.h"

namespace planlight {

/// A camera's picture with the board's corners as they are seen now, and cells where poses have been.
void draw_guide_camera(const Pen& pen, const Box& box, const GuideModel::Camera& camera, ImTextureID texture);
/// Where in the projector's light the board has been.
void draw_guide_cells(const Pen& pen, const Box& box, const std::string& title, const GuideModel::Cells& cells);
/// Which way the board was tilted, as one looks along the cameras: a dot a pose, and the board now.
void draw_guide_tilts(const Pen& pen, const Box& box, const GuideModel& model);
/// How near and how far it was.
void draw_guide_depths(const Pen& pen, const Box& box, const GuideModel& model);
/// The word, the reason, what to do, and the bar.
void draw_guide_banner(const Pen& pen, const Box& box, const GuideModel& model);
/// Poses, predicted error, what is still wanted; then the result.
void draw_guide_progress(const Pen& pen, const Box& box, const GuideModel& model);

/// All of the window; `textures`: of the left and the right camera's picture, null where there is none. What was
/// pressed with the mouse.
GuideAction draw_guide(const Pen& pen, const GuideLayout& place, const GuideModel& model,
                       const std::array<ImTextureID, 2>& textures);

}  // namespace planlight
