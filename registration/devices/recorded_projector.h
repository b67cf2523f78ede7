#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "registration/devices/projector.h"
#include "registration/devices/recorded_light.h"

namespace planlight {

/// The projector of a recorded scan: the recorded cameras answer each of its pictures with what they saw of it then.
/// Where there is a real one behind it that is lit as well.
class RecordedProjector final : public Projector {
public:
    /// Which picture of the recording is the one that is to be shown; empty: none.
    using Which = std::function<std::optional<std::size_t>(const RgbImage&)>;

    /// `behind`: may be null. Throws DeviceError when that has another size.
    RecordedProjector(int width, int height, Which which, std::shared_ptr<RecordedLight> light, const Clock& clock,
                      Projector* behind = nullptr);

    int width() const override { return width_; }
    int height() const override { return height_; }
    Instant show(const RgbImage& picture, Instant valid_until) override;
    void go_dark() noexcept override;

private:
    int width_, height_;
    Which which_;
    std::shared_ptr<RecordedLight> light_;
    const Clock& clock_;
    Projector* behind_;
};

}  // namespace planlight
