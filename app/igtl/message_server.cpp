#include "app/igtl/message_server.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

using SteadyTime = std::chrono::steady_clock::time_point;
using Message = MessageServer::Message;

SteadyTime now() {
    return std::chrono::steady_clock::now();
}

/// A file descriptor with its owner.
class Descriptor {
public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    int number() const { return number_; }

private:
    int number_;
};

void set_option(int socket, int level, int option, int value) {
    ::setsockopt(socket, level, option, &value, sizeof(value));
}

Descriptor listen_on(const MessageServerSettings& settings) {
    addrinfo hints{}, *found = nullptr;
    hints.ai_flags = AI_NUMERICHOST | AI_PASSIVE;
    hints.ai_socktype = SOCK_STREAM;
    if (::getaddrinfo(settings.address.c_str(), std::to_string(settings.port).c_str(), &hints, &found) != 0)
        throw InputError({}, fmt::format("{} is no address of a network card", settings.address),
                         "Give the number of one, 127.0.0.1 for this computer alone or 0.0.0.0 for all networks.");
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(found, &::freeaddrinfo);
    Descriptor listener(::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const int socket = listener.number();
    set_option(socket, SOL_SOCKET, SO_REUSEADDR, 1);
    set_option(socket, SOL_SOCKET, SO_SNDBUF, settings.kept_by_system_bytes);  // its clients have it from it
    constexpr int kWaiting = 8;
    if (socket >= 0 && ::bind(socket, found->ai_addr, found->ai_addrlen) == 0 && ::listen(socket, kWaiting) == 0)
        return listener;
    const int why = errno;
    if (why == EADDRNOTAVAIL)
        throw InputError({}, fmt::format("no network card of this computer has the address {}", settings.address),
                         "Give the number of one, 127.0.0.1 for this computer alone or 0.0.0.0 for all networks.");
    throw DeviceError("OpenIGTLink",
                      fmt::format("port {} of {} cannot be listened on: {}", settings.port, settings.address,
                                  why == EADDRINUSE ? "another program has it" : std::strerror(why)),
                      "Give another port, or end the program that has it.");
}

/// One listener: what he is being sent, and since when he took nothing of it.
struct Client {
    Descriptor socket;
    std::deque<Message> given;
    std::size_t taken_of_first = 0;  ///< bytes of the first of `given`
    std::size_t bytes_given = 0;     ///< in `given` when it was filled
    SteadyTime given_at = now(), moved_at = now();
    std::vector<std::uint64_t> had;  ///< number of the newest message of each place that was given
    bool ended = false;
};

enum class Sent { all, some, broken };

/// As much as the system takes at once.
Sent send_now(Client& client) {
    constexpr std::size_t kAtOnce = 16;
    while (!client.given.empty()) {
        std::array<iovec, kAtOnce> pieces{};
        const std::size_t count = std::min(kAtOnce, client.given.size());
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t skip = i == 0 ? client.taken_of_first : 0;
            pieces[i] = {const_cast<char*>(client.given[i]->data()) + skip, client.given[i]->size() - skip};
        }
        msghdr header{};
        header.msg_iov = pieces.data();
        header.msg_iovlen = count;
        const ssize_t sent = ::sendmsg(client.socket.number(), &header, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0) return errno == EAGAIN || errno == EINTR ? Sent::some : Sent::broken;
        client.moved_at = now();
        for (auto left = static_cast<std::size_t>(sent); left > 0;) {
            const std::size_t of_first = client.given.front()->size() - client.taken_of_first;
            const std::size_t took = std::min(left, of_first);
            client.taken_of_first += took;
            left -= took;
            if (took < of_first) break;
            client.given.pop_front();
            client.taken_of_first = 0;
        }
    }
    return Sent::all;
}

}  // namespace

struct MessageServer::Parts {
    /// What is said at one place, and how many messages it has had there.
    struct Newest {
        Message message;
        std::uint64_t number = 0;
    };

    explicit Parts(const MessageServerSettings& s)
        : settings(s), listener(listen_on(s)), waker(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

    void give(Client& client);
    bool to_be_closed(Client& client);
    void read_and_forget(Client& client);
    void accept_new();
    void wait(std::chrono::milliseconds longest);
    bool may_accept();
    void note();

    const MessageServerSettings settings;
    Descriptor listener, waker;
    std::vector<Message> first;
    std::vector<Newest> newest;
    std::vector<Client> clients;
    double may_come = 1;  ///< clients, now
    SteadyTime counted_at = now(), read_at{};
    std::atomic<std::size_t> present{0}, taken{0}, turned_away{0}, closed_by_them{0}, dropped{0};
};

/// Only who has taken all that he was given is given more, and then the newest alone.
void MessageServer::Parts::give(Client& client) {
    if (!client.given.empty()) return;
    client.had.resize(newest.size());
    for (std::size_t i = 0; i < newest.size(); ++i) {
        if (client.had[i] == newest[i].number) continue;
        client.had[i] = newest[i].number;
        if (newest[i].message) client.given.push_back(newest[i].message);
    }
    if (client.given.empty()) return;
    client.given_at = client.moved_at = now();
    client.bytes_given = 0;
    for (const Message& message : client.given) client.bytes_given += message->size();
}

bool MessageServer::Parts::to_be_closed(Client& client) {
    const Sent sent = send_now(client);
    if (sent == Sent::broken || client.ended) {
        ++closed_by_them;
        return true;
    }
    if (sent == Sent::all) return false;
    const SteadyTime at = now();
    const double allowed_s = std::chrono::duration<double>(settings.patience).count() +
                             static_cast<double>(client.bytes_given) / settings.least_bytes_per_s;
    if (at - client.moved_at < settings.patience && at - client.given_at < std::chrono::duration<double>(allowed_s))
        return false;
    ++dropped;
    return true;
}

/// So that a client that talks is not held up by us; a flood of it waits in the client.
void MessageServer::Parts::read_and_forget(Client& client) {
    std::array<char, 4096> thrown_away{};
    const ssize_t got = ::recv(client.socket.number(), thrown_away.data(), thrown_away.size(), MSG_DONTWAIT);
    client.ended = got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
}

bool MessageServer::Parts::may_accept() {
    const SteadyTime at = now();
    may_come += settings.most_new_per_s * std::chrono::duration<double>(at - counted_at).count();
    may_come = std::min(may_come, std::max(1.0, settings.most_new_per_s / 4.0));
    counted_at = at;
    return may_come >= 1;
}

void MessageServer::Parts::accept_new() {
    while (may_accept()) {
        Descriptor socket(::accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
        // Where the system has no room for another one he stays in its queue, and is asked for no sooner than the next.
        if (socket.number() < 0 && errno != EAGAIN && errno != EINTR) may_come = 0;
        if (socket.number() < 0) return;
        may_come -= 1;
        if (clients.size() >= settings.most_clients) {
            ++turned_away;
            if (!settings.when_full.empty())
                (void)!::send(socket.number(), settings.when_full.data(), settings.when_full.size(),
                              MSG_NOSIGNAL | MSG_DONTWAIT);
            continue;
        }
        ++taken;
        set_option(socket.number(), IPPROTO_TCP, TCP_NODELAY, 1);
        set_option(socket.number(), IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(settings.patience.count()));
        Client client{std::move(socket), {}, 0, 0, now(), now(), {}, false};
        client.given.assign(first.begin(), first.end());
        for (const Message& message : first) client.bytes_given += message->size();
        clients.push_back(std::move(client));
    }
}

void MessageServer::Parts::wait(std::chrono::milliseconds longest) {
    std::vector<pollfd> watched{{waker.number(), POLLIN, 0}};
    watched.push_back({may_accept() ? listener.number() : -1, POLLIN, 0});
    for (const Client& client : clients)
        watched.push_back({client.socket.number(), static_cast<short>(client.given.empty() ? 0 : POLLOUT), 0});
    ::poll(watched.data(), watched.size(), static_cast<int>(longest.count()));
    std::uint64_t times = 0;
    (void)!::read(waker.number(), &times, sizeof(times));
    for (std::size_t i = 0; i < clients.size(); ++i)
        if (watched[i + 2].revents & (POLLERR | POLLHUP | POLLNVAL)) clients[i].ended = true;
}

void MessageServer::Parts::note() {
    present = clients.size();
}

MessageServer::MessageServer(const MessageServerSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}
MessageServer::~MessageServer() = default;

int MessageServer::port() const {
    sockaddr_storage address{};
    socklen_t size = sizeof(address);
    ::getsockname(parts_->listener.number(), reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(address).sin6_port
                                               : reinterpret_cast<sockaddr_in&>(address).sin_port);
}

void MessageServer::set_first(std::vector<Message> first) {
    parts_->first = std::move(first);
}

void MessageServer::set_newest(std::size_t place, Message message) {
    if (place >= parts_->newest.size()) parts_->newest.resize(place + 1);
    if (!message && !parts_->newest[place].message) return;
    parts_->newest[place].message = std::move(message);
    ++parts_->newest[place].number;
}

MessageServerCounts MessageServer::counts() const {
    return {parts_->present, parts_->taken, parts_->turned_away, parts_->closed_by_them, parts_->dropped};
}

void MessageServer::turn(std::chrono::milliseconds longest) {
    constexpr auto kReadEvery = std::chrono::milliseconds(100);
    Parts& p = *parts_;
    p.wait(longest);
    p.accept_new();
    const bool read = now() - p.read_at > kReadEvery;
    if (read) p.read_at = now();
    std::erase_if(p.clients, [&](Client& client) {
        if (read) p.read_and_forget(client);
        p.give(client);
        return p.to_be_closed(client);
    });
    p.note();
}

void MessageServer::wake() noexcept {
    constexpr std::uint64_t kOnce = 1;
    (void)!::write(parts_->waker.number(), &kOnce, sizeof(kOnce));
}

void MessageServer::say_at_the_end(const Message& message) {
    for (Client& client : parts_->clients) {
        client.given.push_back(message);
        send_now(client);
    }
}

}  // namespace planlight
