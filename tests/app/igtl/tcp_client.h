#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <string>

namespace planlight::test {

/// A connection to a port of this computer, as anybody may make one.
class TcpClient {
public:
    /// `receive_bytes`: of the system's memory for what is not read yet; 0: as the system likes.
    explicit TcpClient(int port, int receive_bytes = 0) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        if (receive_bytes > 0) ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof(receive_bytes));
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<std::uint16_t>(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
    }
    ~TcpClient() { close(); }
    TcpClient(const TcpClient&) = delete;
    TcpClient& operator=(const TcpClient&) = delete;

    bool connected() const { return connected_; }
    /// What there is now, at most so much; empty: nothing, or the other side is gone (`gone`).
    std::string read_now(std::size_t most = 1 << 16) {
        std::string bytes(most, '\0');
        const ssize_t got = ::recv(socket_, bytes.data(), most, MSG_DONTWAIT);
        gone_ = gone_ || got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
        bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
        return bytes;
    }
    bool gone() const { return gone_; }
    /// Without taking anything: whether the other side has closed the line.
    void look_whether_gone() {
        char one = 0;
        const ssize_t got = ::send(socket_, &one, 1, MSG_DONTWAIT | MSG_NOSIGNAL);
        gone_ = gone_ || (got < 0 && errno != EAGAIN && errno != EINTR);
    }
    /// How many bytes of it went out.
    ssize_t write_now(const std::string& bytes) {
        return ::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    }
    void end_writing() { ::shutdown(socket_, SHUT_WR); }
    void close() {
        if (socket_ >= 0) ::close(socket_);
        socket_ = -1;
    }

private:
    int socket_;
    bool connected_ = false, gone_ = false;
};

}  // namespace planlight::test
