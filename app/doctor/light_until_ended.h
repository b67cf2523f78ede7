#pragma once

#include <stop_token>

#include "registration/devices/projector.h"

namespace planlight {

/// Thrown where an examination that somebody ended stops; no error.
struct ExaminationEnded {};

/// A projector that takes no picture any more once somebody has ended the examination: it is dark by then, and whoever
/// asks for light is sent home.
class LightUntilEnded : public Projector {
public:
    LightUntilEnded(Projector& projector, std::stop_token ended) : projector_(projector), ended_(std::move(ended)) {}

    int width() const override { return projector_.width(); }
    int height() const override { return projector_.height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        if (ended_.stop_requested()) {
            projector_.go_dark();
            throw ExaminationEnded();
        }
        return projector_.show(picture, valid_until);
    }
    void go_dark() noexcept override { projector_.go_dark(); }

private:
    Projector& projector_;
    std::stop_token ended_;
};

}  // namespace planlight
