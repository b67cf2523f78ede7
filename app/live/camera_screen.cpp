#include "app/live/camera_screen.h"

namespace planlight {
namespace {

CameraPageModel::Camera camera_of(const WatchedCamera& watched, const RoomCamera& room, const std::string& title) {
    CameraPageModel::Camera camera;
    camera.title = title;
    camera.picture = watched.picture;
    for (const MarkerObservation& marker : watched.markers) camera.markers.push_back({marker.pixel, marker.radius_px});
    camera.sharpness = watched.sharpness;
    camera.best_sharpness = watched.best_sharpness;
    camera.too_bright_percent = 100 * watched.clipped.too_bright;
    camera.too_dark_percent = 100 * watched.clipped.too_dark;
    camera.exposure_ms = watched.exposure_ms;
    camera.frames_hz = watched.frames_hz;
    camera.asked_hz = room.frames_hz;
    camera.lost = watched.lost;
    camera.notes = watched.notes;
    if (watched.fault) {
        camera.trouble = watched.fault->problem;
        camera.trouble_remedy = watched.fault->remedy;
    }
    return camera;
}

}  // namespace

CameraPageModel camera_page_model_of(const WatchedRoom& watched, const RoomFile& room) {
    CameraPageModel model;
    model.title = "Aim, focus and expose the cameras";
    model.subtitle = room.name;
    model.left = camera_of(watched.left, room.left, "Left camera");
    model.right = camera_of(watched.right, room.right, "Right camera");
    model.apart_ms = watched.apart_ms;
    model.allowed_ms = watched.allowed_ms;
    return model;
}

}  // namespace planlight
