#include "app/recording/frame_choice.h"

#include <algorithm>

namespace planlight {

bool FrameChoice::pay(double bytes) {
    if (left_ < bytes) return false;
    left_ -= bytes;
    return true;
}

bool FrameChoice::keep(Instant at, double bytes) {
    if (last_ >= Instant{} && at > last_)
        left_ = std::min(settings_.bytes_ahead, left_ + settings_.bytes_per_s * seconds(at - last_));
    last_ = std::max(last_, at);
    if (after_ > 0) {
        --after_;
        return pay(bytes);
    }
    if (usual_ >= Instant{} && at - usual_ < settings_.usual_every) return false;
    if (left_ < settings_.bytes_ahead / 2) return false;
    usual_ = at;
    return pay(bytes);
}

std::size_t FrameChoice::event(std::size_t waiting, double bytes) {
    after_ = settings_.after;
    std::size_t kept = 0;
    while (kept < std::min(waiting, settings_.before) && pay(bytes)) ++kept;
    return kept;
}

}  // namespace planlight
