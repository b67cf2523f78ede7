// Clients as they may come: good, slow, deaf, talkative, hasty, too many.
#include "app/igtl/message_server.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "planning_io/types/error.h"
#include "tests/app/igtl/tcp_client.h"

namespace planlight {
namespace {

using std::chrono::milliseconds;
using test::TcpClient;

MessageServer::Message message(std::string bytes) {
    return std::make_shared<const std::string>(std::move(bytes));
}

MessageServerSettings quick() {
    MessageServerSettings settings;
    settings.port = 0;
    settings.most_new_per_s = 100000;
    settings.patience = milliseconds(150);
    settings.when_full = "full";
    return settings;
}

/// Rounds until it holds; false where it did not in some ten seconds.
bool turned_until(MessageServer& server, const std::function<bool()>& holds) {
    for (int i = 0; i < 5000 && !holds(); ++i) server.turn(milliseconds(2));
    return holds();
}

/// Reads while the server turns, until it has had so many bytes.
std::string read(MessageServer& server, TcpClient& client, std::size_t bytes) {
    std::string got;
    turned_until(server, [&] {
        got += client.read_now();
        return got.size() >= bytes || client.gone();
    });
    return got;
}

TEST(MessageServer, GivesEachNewClientTheFirstMessagesAndThenTheNewest) {
    MessageServer server(quick());
    server.set_first({message("skin,"), message("plan,")});
    server.set_newest(1, message("pose 1,"));
    server.set_newest(1, message("pose 2,"));
    server.set_newest(0, message("gate,"));
    for (int i = 0; i < 2; ++i) {  // one who comes later is given the same
        TcpClient client(server.port());
        EXPECT_EQ(read(server, client, 22), "skin,plan,gate,pose 2,");
    }
}

// A client whom the system has no room for stays in its queue: asking for him again at once would be all that we do.
TEST(MessageServer, AClientThatCannotBeTakenIsNotAskedForAgainAtOnce) {
    MessageServerSettings settings = quick();
    settings.most_new_per_s = 0;  // one, and then none
    MessageServer server(settings);
    TcpClient client(server.port());
    rlimit was{};
    ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &was), 0);
    const rlimit none{0, was.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
    for (int i = 0; i < 3; ++i) server.turn(milliseconds(1));
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &was), 0);
    for (int i = 0; i < 3; ++i) server.turn(milliseconds(1));
    EXPECT_EQ(server.counts().taken, 0u) << "the failed one was its turn";
}

TEST(MessageServer, SaysNothingOfWhatIsNotKnownAnyMore) {
    MessageServer server(quick());
    server.set_newest(0, message("pose,"));
    server.set_newest(1, message("gate,"));
    server.set_newest(0, nullptr);
    TcpClient client(server.port());
    EXPECT_EQ(read(server, client, 5), "gate,");
}

TEST(MessageServer, AClientThatNeverReadsIsClosedAndNothingIsKeptForIt) {
    MessageServer server(quick());
    TcpClient deaf(server.port(), 4096), good(server.port());
    ASSERT_TRUE(turned_until(server, [&] { return server.counts().clients == 2; }));
    std::size_t got = 0;
    int rounds = 0;
    ASSERT_TRUE(turned_until(server, [&] {
        server.set_newest(0, message(std::string(20000, 'x')));
        ++rounds;
        got += good.read_now(1 << 20).size();
        return server.counts().dropped == 1;
    }));
    EXPECT_EQ(server.counts().clients, 1u);
    EXPECT_GT(got, static_cast<std::size_t>(rounds) * 20000 / 2);  // the good one had nearly all meanwhile
}

// The system opens no room for a byte: nothing goes out to it, and that ends its patience whatever rate is asked for.
TEST(MessageServer, AClientThatReadsAByteNowAndThenIsClosedThoughNoRateIsAskedFor) {
    MessageServerSettings settings = quick();
    settings.least_bytes_per_s = 1;
    MessageServer server(settings);
    server.set_first({message(std::string(4'000'000, 's'))});
    TcpClient slow(server.port(), 4096);
    EXPECT_TRUE(turned_until(server, [&] {
        slow.read_now(1);
        return server.counts().dropped == 1;
    }));
}

/// Reads a steady megabyte a second, and says how long it got nothing at the longest.
class SteadyReader {
public:
    explicit SteadyReader(TcpClient& client) : client_(client) {}
    void read() {
        const auto now = std::chrono::steady_clock::now();
        const auto due = static_cast<std::size_t>(1e6 * std::chrono::duration<double>(now - began_).count());
        const std::size_t took = due > got ? client_.read_now(due - got).size() : 0;
        got += took;
        if (took == 0) return;
        longest_pause = std::max(longest_pause, now - last_);
        last_ = now;
    }
    std::size_t got = 0;
    std::chrono::steady_clock::duration longest_pause{};

private:
    TcpClient& client_;
    const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point last_ = began_;
};

// It takes something all the time, so that no patience ends: too little all in all.
TEST(MessageServer, AClientThatReadsSteadilyAndTooSlowlyIsClosedByItsRateAlone) {
    constexpr std::size_t kBytes = 3'000'000;  // three seconds of its reading, and a half is allowed with the patience
    for (const double least_bytes_per_s : {1e8, 1e5}) {
        MessageServerSettings settings = quick();
        settings.patience = milliseconds(500);
        settings.least_bytes_per_s = least_bytes_per_s;
        MessageServer server(settings);
        server.set_first({message(std::string(kBytes, 's'))});
        TcpClient client(server.port(), 1 << 15);
        SteadyReader reader(client);
        EXPECT_TRUE(turned_until(server, [&] {
            reader.read();
            return reader.got == kBytes || server.counts().dropped == 1;
        }));
        const bool too_slow = least_bytes_per_s > 1e6;
        EXPECT_EQ(server.counts().dropped, too_slow ? 1U : 0U) << least_bytes_per_s << " bytes a second asked for";
        EXPECT_EQ(reader.got == kBytes, !too_slow);
        EXPECT_LT(reader.longest_pause, settings.patience) << "the patience has not ended: this proves nothing";
    }
}

TEST(MessageServer, ALargeFirstMessageReachesAClientThatReads) {
    MessageServer server(quick());
    const std::string skin(8'000'000, 's');
    server.set_first({message(skin)});
    server.set_newest(0, message("pose"));
    TcpClient client(server.port());
    EXPECT_EQ(read(server, client, skin.size() + 4), skin + "pose");
}

TEST(MessageServer, WhatClientsSayIsThrownAway) {
    MessageServer server(quick());
    TcpClient talker(server.port()), good(server.port());
    ASSERT_TRUE(turned_until(server, [&] { return server.counts().clients == 2; }));
    const std::string garbage(100'000, '\xff');
    std::string got;
    int said = 0;
    EXPECT_TRUE(turned_until(server, [&] {
        talker.write_now(garbage);
        talker.read_now();
        if (said < 200) server.set_newest(0, message(fmt::format("{:04}", said++)));
        got += good.read_now();
        return said == 200 && got.ends_with("0199");
    }));
    EXPECT_EQ(server.counts().dropped, 0u);
}

TEST(MessageServer, ThousandsThatComeAndGoLeaveNothingAndHoldNobodyUp) {
    MessageServer server(quick());
    TcpClient good(server.port());
    ASSERT_TRUE(turned_until(server, [&] { return server.counts().clients == 1; }));
    std::string got;
    for (int i = 0; i < 2000; ++i) {
        TcpClient hasty(server.port());
        if (i % 3 == 0) hasty.write_now("GET / HTTP/1.0\r\n\r\n");
        server.set_newest(0, message(fmt::format("{:04}", i)));
        server.turn(milliseconds(0));
        got += good.read_now();
    }
    got += read(server, good, 4);
    EXPECT_TRUE(got.ends_with("1999"));
    EXPECT_TRUE(turned_until(server, [&] { return server.counts().clients == 1; }));
}

TEST(MessageServer, NewClientsAreTakenNoFasterThanSaid) {
    MessageServerSettings settings = quick();
    settings.most_new_per_s = 4;  // and one at once
    MessageServer server(settings);
    std::vector<std::unique_ptr<TcpClient>> clients;
    for (int i = 0; i < 6; ++i) clients.push_back(std::make_unique<TcpClient>(server.port()));
    for (int i = 0; i < 100; ++i) server.turn(milliseconds(0));
    EXPECT_LE(server.counts().clients, 2u);
    EXPECT_TRUE(turned_until(server, [&] { return server.counts().clients == 6; }));  // none is lost
}

TEST(MessageServer, OneTooManyIsToldAndClosed) {
    MessageServerSettings settings = quick();
    settings.most_clients = 2;
    MessageServer server(settings);
    TcpClient one(server.port()), two(server.port()), three(server.port());
    EXPECT_EQ(read(server, three, 5), "full");
    EXPECT_TRUE(three.gone());
    EXPECT_EQ(server.counts().clients, 2u);
    EXPECT_EQ(server.counts().turned_away, 1u);
}

TEST(MessageServer, AClientThatEndedItsSideIsClosed) {
    MessageServer server(quick());
    TcpClient half(server.port());
    ASSERT_TRUE(turned_until(server, [&] { return server.counts().clients == 1; }));
    half.end_writing();
    EXPECT_TRUE(turned_until(server, [&] { return server.counts().closed_by_them == 1; }));
}

TEST(MessageServer, APortThatIsTakenIsADevicesFault) {
    MessageServer first(quick());
    MessageServerSettings settings = quick();
    settings.port = first.port();
    try {
        const MessageServer second(settings);
        FAIL() << "two listen on one port";
    } catch (const DeviceError& fault) {
        EXPECT_NE(std::string(fault.what()).find("another program has it"), std::string::npos) << fault.what();
    }
}

TEST(MessageServer, WhatIsNoAddressOfThisComputerIsRefused) {
    MessageServerSettings settings = quick();
    for (const char* address : {"hospital", "300.1.2.3", "192.0.2.1", ""}) {
        settings.address = address;
        EXPECT_THROW(MessageServer{settings}, InputError) << address;
    }
    settings.address = "::1";
    EXPECT_NO_THROW(MessageServer{settings});
}

TEST(MessageServer, ListensToThisComputerAlone) {
    EXPECT_EQ(MessageServerSettings{}.address, "127.0.0.1");
}

}  // namespace
}  // namespace planlight
