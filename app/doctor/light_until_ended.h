#pragma once

#include <functional>
#include <mutex>
#include <stop_token>
#include <utility>

#include "registration/devices/projector.h"

namespace planlight {

/// Thrown where an examination that somebody ended stops; no error.
struct ExaminationEnded {};

/// A projector that is dark as soon as somebody ends the examination, by whoever ends it, and takes no picture any
/// more: whoever asks for light is sent home. The projector is touched by one thread at a time.
class LightUntilEnded : public Projector {
public:
    LightUntilEnded(Projector& projector, std::stop_token ended)
        : projector_(projector), ended_(std::move(ended)), when_ended_(ended_, [this] { go_dark(); }) {}

    int width() const override { return projector_.width(); }
    int height() const override { return projector_.height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        const std::lock_guard lock(mutex_);
        if (ended_.stop_requested()) {
            projector_.go_dark();
            throw ExaminationEnded();
        }
        return projector_.show(picture, valid_until);
    }
    void go_dark() noexcept override {
        const std::lock_guard lock(mutex_);
        projector_.go_dark();
    }

private:
    Projector& projector_;
    std::stop_token ended_;
    std::mutex mutex_;
    std::stop_callback<std::function<void()>> when_ended_;  ///< gone first
};

}  // namespace planlight
