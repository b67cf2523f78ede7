#pragma once

#include <string>
#include <utility>
#include <vector>

#include "registration/devices/camera.h"

namespace planlight::test {

/// A camera whose frames the test says.
class ScriptedCamera final : public Camera {
public:
    ScriptedCamera(std::string name, FrameBell& bell, int width = 2, int height = 2)
        : name_(std::move(name)), width_(width), height_(height), frames_(bell) {}
    const std::string& name() const override { return name_; }
    const std::string& serial() const override { return name_; }
    int width() const override { return width_; }
    int height() const override { return height_; }
    std::vector<std::string> notes() const override { return notes_; }
    FrameQueue& frames() override { return frames_; }

    bool global_shutter() const override { return global_; }

    void says(std::vector<std::string> notes) { notes_ = std::move(notes); }
    void has_global_shutter(bool global) { global_ = global; }
    void expose(double at_ms, GrayImage picture, double exposure_ms = 10) {
        frames_.push({std::move(picture), from_seconds(at_ms / 1e3), from_seconds(exposure_ms / 1e3), {}});
    }
    void expose(double at_ms, std::uint8_t grey, double exposure_ms = 10) {
        expose(at_ms, GrayImage(width_, height_, grey), exposure_ms);
    }

private:
    std::string name_;
    int width_, height_;
    bool global_ = true;
    std::vector<std::string> notes_;
    FrameQueue frames_;
};

/// Stands until it is set.
struct SetClock final : Clock {
    explicit SetClock(Instant begin = {}) : t(begin) {}
    Instant t;
    Instant now() const override { return t; }
};

}  // namespace planlight::test
