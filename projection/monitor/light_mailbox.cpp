#include "projection/monitor/light_mailbox.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <span>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr int kMostWide = 3840, kMostHigh = 2400;
constexpr std::size_t kMostPixels = std::size_t{kMostWide} * kMostHigh;
constexpr std::uint32_t kFresh = 4;  ///< beside the slot's number: not taken yet

struct Slot {
    std::uint64_t number;
    std::int64_t valid_until_ns;
    std::int32_t width, height;  ///< 0: darkness
    Rgb pixels[kMostPixels];
};

/// Whether a picture fits in is a matter of its pixels, not of its shape.
void check_room(std::size_t width, std::size_t height) {
    if (width * height > kMostPixels)
        throw DeviceError("Projector's monitor",
                          "its " + std::to_string(width) + "x" + std::to_string(height) +
                              " pixels are more than can be lit: " + std::to_string(kMostWide) + "x" +
                              std::to_string(kMostHigh) + " at most",
                          "Set it to a smaller resolution.");
}

void keep_text(std::span<char> place, const std::string& text) {
    const std::size_t length = std::min(text.size(), place.size() - 1);
    std::memcpy(place.data(), text.data(), length);
    place[length] = 0;
}

}  // namespace

struct LightMailbox::Shared {
    std::atomic<std::uint32_t> state{static_cast<std::uint32_t>(State::starting)};
    std::int32_t width = 0, height = 0;
    char problem[600] = {}, remedy[300] = {}, monitor[200] = {};
    std::atomic<std::int64_t> lease_until_ns{0}, done_at_ns{0}, alive_at_ns{0}, busy_since_ns{0};
    std::atomic<std::uint64_t> done{0};
    std::atomic<std::uint32_t> middle{0};  ///< the slot that neither side owns, and whether it is fresh
    Slot slots[3];
};

static_assert(std::atomic<std::int64_t>::is_always_lock_free && std::atomic<std::uint32_t>::is_always_lock_free);

LightMailbox::LightMailbox() : descriptor_(memfd_create("planlight-light", MFD_CLOEXEC)) {
    if (descriptor_ < 0 || ftruncate(descriptor_, sizeof(Shared)) != 0)
        throw DeviceError("Projector process", "there is no memory for its pictures", "Close other programs.");
    map();
    new (shared_) Shared;  // a fresh memory file is all zero: the slots need no touch
}

LightMailbox::LightMailbox(int descriptor) : descriptor_(descriptor) {
    map();
}

LightMailbox::~LightMailbox() {
    if (shared_ != nullptr) munmap(shared_, sizeof(Shared));
    if (descriptor_ >= 0) close(descriptor_);
}

void LightMailbox::map() {
    void* const memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
    if (memory == MAP_FAILED)
        throw DeviceError("Projector process", "there is no memory for its pictures", "Close other programs.");
    shared_ = static_cast<Shared*>(memory);
}

std::uint64_t LightMailbox::order(const RgbImage& picture, Instant valid_until) {
    if (!picture.empty()) check_room(static_cast<std::size_t>(picture.width), static_cast<std::size_t>(picture.height));
    Slot& slot = shared_->slots[back_];
    slot.number = ++ordered_;
    slot.valid_until_ns = valid_until.count();
    slot.width = picture.width;
    slot.height = picture.height;
    std::copy(picture.pixels.begin(), picture.pixels.end(), slot.pixels);
    back_ = shared_->middle.exchange(back_ | kFresh, std::memory_order_acq_rel) & 3;
    return ordered_;
}

void LightMailbox::renew_lease(Instant until) {
    shared_->lease_until_ns.store(until.count(), std::memory_order_release);
}

bool LightMailbox::take(Order& order) {
    if ((shared_->middle.load(std::memory_order_acquire) & kFresh) == 0) return false;
    front_ = shared_->middle.exchange(front_, std::memory_order_acq_rel) & 3;
    const Slot& slot = shared_->slots[front_];
    order.number = slot.number;
    order.valid_until = Instant(slot.valid_until_ns);
    order.picture = RgbImage(slot.width, slot.height);
    std::copy(slot.pixels, slot.pixels + order.picture.pixels.size(), order.picture.pixels.begin());
    return true;
}

Instant LightMailbox::lease_until() const {
    return Instant(shared_->lease_until_ns.load(std::memory_order_acquire));
}

void LightMailbox::say_ready(int width, int height, const std::string& monitor) {
    check_room(static_cast<std::size_t>(width), static_cast<std::size_t>(height));
    shared_->width = width;
    shared_->height = height;
    keep_text(shared_->monitor, monitor);
    shared_->state.store(static_cast<std::uint32_t>(State::ready), std::memory_order_release);
}

void LightMailbox::say_failed(const std::string& problem, const std::string& remedy) {
    keep_text(shared_->problem, problem);
    keep_text(shared_->remedy, remedy);
    shared_->state.store(static_cast<std::uint32_t>(State::failed), std::memory_order_release);
}

void LightMailbox::say_done(std::uint64_t number, Instant at) {
    shared_->done_at_ns.store(at.count(), std::memory_order_release);
    shared_->done.store(number, std::memory_order_release);
}

void LightMailbox::say_alive(Instant at) {
    shared_->alive_at_ns.store(at.count(), std::memory_order_release);
}

void LightMailbox::say_busy(Instant since) {
    shared_->busy_since_ns.store(since.count(), std::memory_order_release);
}

LightMailbox::State LightMailbox::state() const {
    return static_cast<State>(shared_->state.load(std::memory_order_acquire));
}
int LightMailbox::width() const {
    return shared_->width;
}
int LightMailbox::height() const {
    return shared_->height;
}
std::string LightMailbox::monitor() const {
    return shared_->monitor;
}
std::string LightMailbox::problem() const {
    return shared_->problem;
}
std::string LightMailbox::remedy() const {
    return shared_->remedy;
}
std::uint64_t LightMailbox::done() const {
    return shared_->done.load(std::memory_order_acquire);
}
Instant LightMailbox::done_at() const {
    return Instant(shared_->done_at_ns.load(std::memory_order_acquire));
}
Instant LightMailbox::busy_since() const {
    return Instant(shared_->busy_since_ns.load(std::memory_order_acquire));
}
Instant LightMailbox::alive_at() const {
    return Instant(shared_->alive_at_ns.load(std::memory_order_acquire));
}

}  // namespace planlight
