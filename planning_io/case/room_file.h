#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

namespace planlight {

/// One camera of room.json. What is empty stays as the camera has it.
struct RoomCamera {
    std::string device;        ///< GenICam: serial, identifier or network address; empty where `pipeline` is said
    std::string pipeline;      ///< GStreamer: its source, as for gst-launch-1.0
    std::string pixel_format;  ///< empty: Mono8
    std::string line;          ///< of the hardware trigger, "Line0"; empty: it runs free
    std::optional<double> exposure_ms, gain, frames_hz;
    /// From the end of the exposure to the arrival of the quickest frame; of a pipeline: from mid-exposure to the time
    /// that it stamps.
    std::optional<double> transfer_ms;
    std::optional<std::array<int, 4>> region;  ///< x, y, width, height
    std::optional<bool> global_shutter;        ///< GenICam: empty: as the camera says
};

/// Instead of cameras: what such cameras recorded.
struct RoomRecording {
    std::filesystem::path frames;   ///< frames folder: what the cameras see; empty: the dark picture of `capture`
    std::filesystem::path capture;  ///< capture folder: what they see of its light; empty: no scan was recorded
    bool fastest = false;           ///< the next frame as soon as the one before was taken, not at its own pace
};

/// A room of real devices (room.json): which cameras and which projector, and the files of their calibration.
struct RoomFile {
    std::string name;
    std::filesystem::path rig;              ///< rig.json
    std::filesystem::path projector_file;   ///< projector.json of `planlight projector`; empty: not measured
    std::string monitor;                    ///< of the projector: its name; empty in a recorded room that has none
    RoomCamera left, right;                 ///< empty where `recorded`
    std::optional<RoomRecording> recorded;  ///< empty: cameras are real
    bool together = false;    ///< one camera triggers the other, or one line both: their exposures coincide by wire
    double max_apart_ms = 2;  ///< of two exposures that are one, where they are not triggered together
    double disc_mm = 8, sticker_mm = 16;  ///< of the markers, diameters
};

/// Whether markers of these diameters are any that can be followed.
bool may_be_pasted(double disc_mm, double sticker_mm);

/// Paths in it are relative to its own folder. Throws InputError for what is missing, unknown or out of range.
RoomFile read_room(const std::filesystem::path& file);

/// Written safely; paths as they stand in `room`. Throws DiskError.
void write_room(const RoomFile& room, const std::filesystem::path& file);

}  // namespace planlight
