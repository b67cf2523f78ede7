#include "registration/simulation/serve/served_room.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <mutex>
#include <thread>

namespace planlight::simulation {
namespace {

constexpr auto kLook = std::chrono::milliseconds(4);

/// A picture that came onto the monitor.
struct Order {
    RgbImage picture;
    Instant at;
};

bool is_black(const RgbImage& picture) {
    return std::all_of(picture.pixels.begin(), picture.pixels.end(), [](const Rgb& c) { return c == Rgb{}; });
}

}  // namespace

struct ServedRoom::Parts {
    ServedDevices rig;
    LookAtMonitor look;
    ServeSettings settings;
    SteadyClock clock;
    const Instant began = clock.now() - rig.clock.now();  ///< when the room's clock was 0
    Instant interval{}, exposure{};
    std::mutex mutex;
    std::deque<Order> orders;
    std::atomic<std::uint64_t> made{0}, late{0};
    std::atomic<bool> exchanged{false};
    std::atomic<int> right_held_back{0};
    std::deque<std::pair<GrayImage, Instant>> held;  ///< by the right camera, with when its exposure began
    std::atomic<Instant::rep> looked_at{0};          ///< what stood on the monitor until then is known
    std::unique_ptr<ServedCamera> left, right;
    std::jthread monitor, cameras;

    Parts(const ServedDevices& the_rig, LookAtMonitor look_at, const ServeSettings& given)
        : rig(the_rig), look(std::move(look_at)), settings(given) {}
    void watch_monitor(const std::stop_token& stop);
    void expose(const std::stop_token& stop);
    void order_until(Instant until);
    void send(StereoFrame frame, Instant opened);
};

/// Notes when what stands on the monitor changes.
void ServedRoom::Parts::watch_monitor(const std::stop_token& stop) {
    RgbImage last;
    while (!stop.stop_requested()) {
        const Instant at = clock.now();
        RgbImage now = look();
        if (now.pixels != last.pixels) {
            last = now;
            const std::lock_guard lock(mutex);
            orders.push_back({std::move(now), at});
        }
        looked_at = at.count();
        std::this_thread::sleep_for(kLook);
    }
}

/// Gives the room's projector what came onto the monitor before a moment (of the wall).
void ServedRoom::Parts::order_until(Instant until) {
    for (;;) {
        Order order;
        {
            const std::lock_guard lock(mutex);
            if (orders.empty() || orders.front().at > until) return;
            order = std::move(orders.front());
            orders.pop_front();
        }
        const Instant at = order.at - began;
        if (at > rig.clock.now()) rig.wait(at - rig.clock.now());
        // A monitor keeps its picture until it gets another.
        if (is_black(order.picture))
            rig.projector.go_dark();
        else
            rig.projector.show(order.picture, rig.clock.now() + std::chrono::hours(1000));
    }
}

/// One exposure after the other, each made when it is past and sent a fixed while after its end. An order takes effect
/// after the projector's delay, which is longer than an exposure: what came onto the monitor before it began is all
/// that matters.
void ServedRoom::Parts::expose(const std::stop_token& stop) {
    const auto wait_until = [&](Instant wall) {
        while (clock.now() < wall && !stop.stop_requested())
            std::this_thread::sleep_for(
                std::clamp(wall - clock.now(), Instant{}, Instant(std::chrono::milliseconds(2))));
    };
    Instant next = clock.now() - began;
    while (!stop.stop_requested()) {
        const Instant wall = clock.now() - began;
        if (next + exposure + settings.latency < wall) {  // it could not be sent in time any more
            ++late;
            next = wall - exposure;
        }
        wait_until(began + next + exposure);
        while (Instant(looked_at) < began + next && !stop.stop_requested()) std::this_thread::sleep_for(kLook / 4);
        order_until(began + next);
        StereoFrame frame = rig.cameras.grab(std::max(rig.clock.now(), next), std::chrono::seconds(10));
        const Instant opened = frame.at - exposure / 2;
        next = opened + from_seconds(seconds(interval) * std::max(1.0, settings.slower)) - Instant(1000);
        wait_until(began + opened + exposure + settings.latency);
        send(std::move(frame), began + opened);
        ++made;
    }
}

void ServedRoom::Parts::send(StereoFrame frame, Instant opened) {
    if (exchanged) std::swap(frame.left, frame.right);
    left->offer(std::move(frame.left), opened);
    held.emplace_back(std::move(frame.right), opened);
    while (held.size() > static_cast<std::size_t>(right_held_back) + 1) held.pop_front();
    // (While it begins to hold back, it sends nothing for so many frames.)
    if (held.size() <= static_cast<std::size_t>(right_held_back)) return;
    right->offer(std::move(held.front().first), held.front().second);
    held.pop_front();
}

ServedRoom::ServedRoom(SimulatedRig& rig, LookAtMonitor look, const ServeSettings& given)
    : ServedRoom({rig.projector(), rig.cameras(), rig.clock(), [&rig](Instant duration) { rig.wait(duration); }},
                 std::move(look), given) {}

ServedRoom::ServedRoom(const ServedDevices& rig, LookAtMonitor look, const ServeSettings& given)
    : parts_(std::make_unique<Parts>(rig, std::move(look), given)) {
    Parts& p = *parts_;
    const StereoFrame frame = rig.cameras.grab(rig.clock.now(), std::chrono::seconds(10));
    p.interval = rig.cameras.grab(rig.clock.now(), std::chrono::seconds(10)).at - frame.at;
    p.exposure = frame.exposure;
    for (const auto& [camera, picture, made] :
         {std::tuple{&p.settings.left, &frame.left, &p.left}, std::tuple{&p.settings.right, &frame.right, &p.right}}) {
        camera->width = picture->width;
        camera->height = picture->height;
        camera->exposure = frame.exposure;
        camera->frames_hz = 200;  // as soon as there is a picture
        *made = std::make_unique<ServedCamera>(*camera);
    }
    p.monitor = std::jthread([&p](const std::stop_token& stop) { p.watch_monitor(stop); });
    p.cameras = std::jthread([&p](const std::stop_token& stop) { p.expose(stop); });
}

ServedRoom::~ServedRoom() {
    parts_->cameras.request_stop();
    parts_->monitor.request_stop();
}

ServedCamera& ServedRoom::left() {
    return *parts_->left;
}
ServedCamera& ServedRoom::right() {
    return *parts_->right;
}
void ServedRoom::exchange_cameras(bool exchanged) {
    parts_->exchanged = exchanged;
}
void ServedRoom::hold_right_back(int frames) {
    parts_->right_held_back = frames;
}
Instant ServedRoom::room_began() const {
    return parts_->began;
}
std::uint64_t ServedRoom::made() const {
    return parts_->made;
}
std::uint64_t ServedRoom::late() const {
    return parts_->late;
}

}  // namespace planlight::simulation
