#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

#include "planning_io/types/error.h"
#include "registration/scan/scan_surface.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
constexpr auto kPatience = 2000ms;           // for a frame once the picture is lit
constexpr Instant kDisplayDelayAtMost = 1s;  // from show() to the light, for the picture's expiry
/// Light that is said to come so long after its order comes after it also by cameras' times that are some milliseconds
/// wrong, and a refresh of the display sooner. Where it is said to come faster, each picture waits.
constexpr Instant kSlowLight = 25ms;
constexpr int kTakenAgainAtMost = 3;  // then each picture waits for the frame before it

/// A picture's order to the projector.
struct Order {
    Instant at, lit_from, valid_until;
};

Instant closed(const StereoFrame& frame) {
    return frame.at + frame.exposure / 2;
}

/// The frame must have seen this picture and nothing else, or a code would be wrong without a sign of it.
void check_frame(const StereoFrame& frame, const StereoFrame& first, Instant lit_from, Instant valid_until,
                 const std::string& name) {
    constexpr Instant kRounding = 2us;
    const Instant opened = frame.at - frame.exposure / 2;
    if (opened + kRounding < lit_from)
        throw DeviceError("Stereo camera",
                          fmt::format("the frame for \"{}\" was exposed {:.1f} ms before the picture was lit", name,
                                      1e3 * seconds(lit_from - opened)),
                          "Check the camera's time stamps against the session's clock.");
    if (closed(frame) > valid_until)
        throw DeviceError("Stereo camera",
                          fmt::format("the frame for \"{}\" was exposed after the picture had expired", name),
                          "Check the camera's frame rate and connection, then scan again.");
    const auto same = [](const GrayImage& a, const GrayImage& b) { return a.width == b.width && a.height == b.height; };
    if (frame.left.empty() || frame.right.empty() || !same(frame.left, first.left) || !same(frame.right, first.right))
        throw DeviceError("Stereo camera",
                          fmt::format("the frame for \"{}\" is empty or has another size than the first", name),
                          "Check both cameras' connections and settings, then scan again.");
}

}  // namespace

ScanCapture capture_scan(Projector& projector, StereoCamera& cameras, const Clock& clock, const StripeSettings& stripes,
                         const std::function<void(int, int)>& progress) {
    const DarkOnExit dark(projector);
    if (stripes.width != projector.width() || stripes.height != projector.height())
        throw std::invalid_argument(fmt::format("capture_scan: stripes of {} x {} for a projector of {} x {}",
                                                stripes.width, stripes.height, projector.width(), projector.height()));
    const auto sequence = stripe_sequence(stripes);
    ScanCapture capture;
    capture.stripes = stripes;
    const auto order = [&](const RgbImage& picture) {
        const Instant now = clock.now(), valid_until = now + kDisplayDelayAtMost + kPatience;
        return Order{now, projector.show(picture, valid_until), valid_until};
    };
    // A picture is ordered as soon as the shutters have closed on the one before, whose frame is still on its way. No
    // light comes before it is ordered, so a frame that had closed by then saw its own picture alone.
    StereoFrame first;
    RgbImage picture = draw_stripes(stripes, sequence.front());
    Order lit = order(picture);
    int taken_again = 0;
    for (std::size_t i = 0; i < sequence.size(); ++i) {
        const bool last = i + 1 == sequence.size();
        RgbImage next = last ? RgbImage() : draw_stripes(stripes, sequence[i + 1]);
        std::optional<Order> ahead;
        const bool slow = lit.lit_from - lit.at >= kSlowLight;
        if (!last && slow && taken_again < kTakenAgainAtMost && cameras.wait_until_exposed(lit.lit_from, kPatience))
            ahead = order(next);
        StereoFrame frame = cameras.grab(lit.lit_from, kPatience);
        if (ahead && closed(frame) > ahead->at) {  // the frame that was meant is lost
            ++taken_again;
            ahead.reset();
            lit = order(picture);
            frame = cameras.grab(lit.lit_from, kPatience);
        }
        if (i == 0) {
            first.left = GrayImage(frame.left.width, frame.left.height);
            first.right = GrayImage(frame.right.width, frame.right.height);
            capture.began = frame.at;
        }
        check_frame(frame, first, lit.lit_from, lit.valid_until, sequence[i].name);
        capture.ended = frame.at;
        capture.left.push_back(std::move(frame.left));
        capture.right.push_back(std::move(frame.right));
        if (progress) progress(static_cast<int>(i) + 1, static_cast<int>(sequence.size()));
        if (last) break;
        lit = ahead ? *ahead : order(next);
        picture = std::move(next);
    }
    return capture;
}

}  // namespace planlight
