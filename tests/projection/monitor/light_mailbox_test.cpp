#include "projection/monitor/light_mailbox.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>

#include "planning_io/types/error.h"
#include "projection/monitor/monitor_lock.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

RgbImage filled(std::uint8_t grey) {
    return {40, 30, {grey, grey, grey}};
}

TEST(LightMailbox, HandsOverTheNewestOrderOnceAcrossTwoMappings) {
    LightMailbox program;
    LightMailbox projector(dup(program.descriptor()));
    LightMailbox::Order order;
    EXPECT_FALSE(projector.take(order));
    program.order(filled(7), 5s);
    EXPECT_EQ(program.order(filled(9), 6s), 2U);
    ASSERT_TRUE(projector.take(order));
    EXPECT_EQ(order.number, 2U);
    EXPECT_EQ(order.valid_until, 6s);
    EXPECT_EQ(order.picture.pixels, filled(9).pixels);
    EXPECT_FALSE(projector.take(order));
    program.order({}, {});
    ASSERT_TRUE(projector.take(order));
    EXPECT_TRUE(order.picture.empty());
}

TEST(LightMailbox, HasNoLeaseBeforeItIsGiven) {
    const LightMailbox mailbox;
    EXPECT_EQ(mailbox.lease_until(), Instant{});
    EXPECT_EQ(mailbox.state(), LightMailbox::State::starting);
}

// A reader that is as fast as it can against a writer that is: never a mixture of two pictures, never back in time.
TEST(LightMailbox, NeverMixesTwoPictures) {
    constexpr int kTaken = 500;
    LightMailbox program;
    LightMailbox projector(dup(program.descriptor()));
    std::jthread writer([&](const std::stop_token& stop) {
        for (std::uint64_t i = 1; !stop.stop_requested(); ++i)
            program.order(filled(static_cast<std::uint8_t>(i)), Instant(i));
    });
    LightMailbox::Order order;
    std::uint64_t last = 0;
    for (int taken = 0; taken < kTaken;) {
        if (!projector.take(order)) continue;
        ++taken;
        ASSERT_GT(order.number, last);
        last = order.number;
        ASSERT_EQ(order.valid_until.count(), static_cast<std::int64_t>(last));
        for (const Rgb& pixel : order.picture.pixels) ASSERT_EQ(pixel[0], static_cast<std::uint8_t>(last));
    }
}

// A monitor of 5120 x 2880, say: its picture would be written over the other slots, and past the memory.
TEST(LightMailbox, RefusesAMonitorThatItsPicturesHaveNoRoomFor) {
    LightMailbox program;
    LightMailbox projector(dup(program.descriptor()));
    EXPECT_THROW(projector.say_ready(3840, 2401, "HDMI-2"), DeviceError);
    EXPECT_EQ(program.state(), LightMailbox::State::starting);
    EXPECT_THROW(program.order(RgbImage(5120, 2880), 5s), DeviceError);
    LightMailbox::Order order;
    EXPECT_FALSE(projector.take(order));
    EXPECT_EQ(program.monitor(), "");
    projector.say_ready(3840, 2400, "HDMI-2");
    EXPECT_EQ(program.state(), LightMailbox::State::ready);
    EXPECT_EQ(program.monitor(), "HDMI-2");
    program.order(RgbImage(3840, 2400, {1, 2, 3}), 5s);
    ASSERT_TRUE(projector.take(order));
    EXPECT_EQ(order.picture.pixels.back(), (Rgb{1, 2, 3}));
}

TEST(LightMailbox, TellsWhatWentWrongThere) {
    LightMailbox program;
    LightMailbox projector(dup(program.descriptor()));
    projector.say_failed(std::string(5000, 'x'), "Connect the projector.");
    EXPECT_EQ(program.state(), LightMailbox::State::failed);
    EXPECT_EQ(program.problem(), std::string(599, 'x'));
    EXPECT_EQ(program.remedy(), "Connect the projector.");
}

TEST(MonitorLock, HasOneHolderWhoIsNamed) {
    const std::string monitor = "TEST-" + std::to_string(getpid());
    {
        const MonitorLock first(monitor);
        const MonitorLock other(monitor + "-2");
        try {
            const MonitorLock second(monitor);
            FAIL() << "the second one was given the same monitor";
        } catch (const DeviceError& error) {
            EXPECT_NE(std::string(error.what()).find("process " + std::to_string(getpid())), std::string::npos)
                << error.what();
        }
    }
    const MonitorLock again(monitor);
}

}  // namespace
}  // namespace planlight
