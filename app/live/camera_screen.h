#pragma once

#include <string>

#include "app/live/camera_watch.h"
#include "app/windows/camera_page_model.h"
#include "planning_io/case/room_file.h"

namespace planlight {

/// What the window shows of two cameras that are watched; of the projector nothing yet.
CameraPageModel camera_page_model_of(const WatchedRoom& watched, const RoomFile& room);

}  // namespace planlight
