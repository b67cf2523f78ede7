#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"

namespace planlight {

/// The memory that the program and its projector process share: the newest picture with its expiry, the lease that the
/// program keeps on its light, and what the projector process says of itself. All moments are of CLOCK_MONOTONIC, which
/// both processes read alike.
///
/// One side orders (`order`, `renew_lease`), the other takes; three slots change hands without a lock, so that neither
/// side can hold up the other, and what is taken is the newest whole picture, never a mixture of two.
class LightMailbox {
public:
    enum class State : std::uint32_t { starting, ready, failed };

    /// A new one, for pictures of at most 3840 x 2400. Throws DeviceError when there is no memory for it.
    LightMailbox();
    /// The one behind a file descriptor that another process made.
    explicit LightMailbox(int descriptor);
    ~LightMailbox();
    LightMailbox(const LightMailbox&) = delete;
    LightMailbox& operator=(const LightMailbox&) = delete;

    int descriptor() const { return descriptor_; }

    // ---- the program ----

    /// The newest order: a picture of the monitor's size until `valid_until`; an empty picture is darkness. Gives its
    /// number. One thread at a time. Throws DeviceError, with nothing written, when it has no room for the picture.
    std::uint64_t order(const RgbImage& picture, Instant valid_until);
    void renew_lease(Instant until);

    // ---- the projector process ----

    struct Order {
        std::uint64_t number = 0;
        Instant valid_until{};
        RgbImage picture;  ///< empty: darkness
    };
    /// True when there is an order that was not taken yet; it is the newest.
    bool take(Order& order);
    Instant lease_until() const;
    /// `monitor`: its name, also where it was asked for by its number. Throws DeviceError when pictures of that size
    /// have no room here.
    void say_ready(int width, int height, const std::string& monitor);
    void say_failed(const std::string& problem, const std::string& remedy);
    void say_done(std::uint64_t number, Instant at);
    void say_alive(Instant at);
    void say_busy(Instant since);  ///< an order is being carried out since then; zero: none is

    // ---- what the program reads of it ----

    State state() const;
    int width() const;
    int height() const;
    std::string monitor() const;  ///< after `State::ready`; empty: it was not told
    std::string problem() const;  ///< after `State::failed`
    std::string remedy() const;
    std::uint64_t done() const;  ///< number of the last order that is on the display
    Instant done_at() const;
    Instant alive_at() const;
    Instant busy_since() const;  ///< zero: with nothing

private:
    struct Shared;
    void map();
    int descriptor_ = -1;
    Shared* shared_ = nullptr;
    std::uint64_t ordered_ = 0;
    std::uint32_t back_ = 1, front_ = 2;  ///< the slots that this side owns
};

}  // namespace planlight
