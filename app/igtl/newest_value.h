#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace planlight {

/// One value handed from one thread to one other, without a lock and without a queue: whoever takes gets the newest
/// whole one, and whoever gives never waits. Three slots change hands; what was not taken is overwritten.
template <class Value>
class NewestValue {
public:
    /// By the giving thread alone.
    void give(const Value& value) {
        slots_[back_] = value;
        back_ = middle_.exchange(back_ | kNew, std::memory_order_acq_rel) & kSlot;
    }

    /// By the taking thread alone. False, and `value` as it was, when there is nothing newer than what was taken.
    bool take(Value& value) {
        if (!(middle_.load(std::memory_order_acquire) & kNew)) return false;
        front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kSlot;
        value = slots_[front_];
        return true;
    }

private:
    static constexpr std::uint32_t kSlot = 3, kNew = 4;
    std::array<Value, 3> slots_{};
    std::uint32_t back_ = 0, front_ = 1;  ///< the slots that each side owns
    std::atomic<std::uint32_t> middle_{2};
};

}  // namespace planlight
