#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace planlight {

/// Who may listen, and how long he may take.
struct MessageServerSettings {
    std::string address = "127.0.0.1";         ///< IPv4 or IPv6, as a number; of the network card that is listened on
    int port = 18944;                          ///< 0: any that is free
    std::size_t most_clients = 16;             ///< one more is told that it is full, and closed
    int most_new_per_s = 20;                   ///< clients; more wait in the system's queue
    std::chrono::milliseconds patience{2000};  ///< a client that takes nothing for so long is closed
    double least_bytes_per_s = 1e5;            ///< a client that takes what it was given more slowly is closed
    int kept_by_system_bytes = 1 << 17;        ///< of one client, not taken yet: how old its messages may get
    std::string when_full;                     ///< what a client too many is sent before it is closed
};

/// What came of the clients so far.
struct MessageServerCounts {
    std::size_t clients = 0;  ///< now
    std::size_t taken = 0, turned_away = 0, closed_by_them = 0, dropped = 0;
};

/// Bytes to any number of clients over TCP, one way, and without ever waiting for one of them.
///
/// Each client is given `first` once, and then of each of the `newest` messages the newest that he has not had: what
/// was replaced before he could take it is never sent. What clients send is read a little at a time and thrown away.
/// No thread of its own: whoever calls `turn` is it.
class MessageServer {
public:
    using Message = std::shared_ptr<const std::string>;

    /// Listens. Throws DeviceError when the port is taken or may not be used, InputError for what is no address of this
    /// computer.
    explicit MessageServer(const MessageServerSettings& settings);
    ~MessageServer();
    MessageServer(const MessageServer&) = delete;
    MessageServer& operator=(const MessageServer&) = delete;

    int port() const;
    void set_first(std::vector<Message> first);
    /// Null: there is nothing to be said there, also not to who comes later.
    void set_newest(std::size_t place, Message message);
    MessageServerCounts counts() const;

    /// One round: new clients, what they can take, and who is dropped. Waits at most so long for something to do.
    void turn(std::chrono::milliseconds longest);
    /// Ends such a wait; from any thread, and without ever waiting itself.
    void wake() noexcept;
    /// The last word to all, as far as they take it at once.
    void say_at_the_end(const Message& message);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
