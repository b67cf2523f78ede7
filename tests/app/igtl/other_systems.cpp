#include "tests/app/igtl/other_systems.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <stdexcept>
#include <vector>

#include "tests/app/igtl/tcp_client.h"

namespace planlight::test {
namespace {

struct Order {
    Listening who;
    int port;
};

/// What one round of each kind does; rounds come every few milliseconds.
class Systems {
public:
    explicit Systems(const Order& order) : order_(order) {
        const int count = order.who == Listening::nobody    ? 0
                          : order.who == Listening::eight   ? 8
                          : order.who == Listening::hostile ? 3
                                                            : 1;
        for (int i = 0; i < count; ++i) clients_.push_back(come());
    }

    void round() {
        for (std::size_t i = 0; i < clients_.size(); ++i) {
            TcpClient& client = *clients_[i];
            if (order_.who == Listening::one || order_.who == Listening::eight) {
                while (!client.read_now().empty()) {
                }
            } else if (order_.who == Listening::slow) {
                client.read_now(100);
            } else if (order_.who == Listening::hostile) {
                client.write_now(garbage_);
                if (i == 0) client.end_writing();
                if (i == 1) clients_[i] = come();
            }
            if (client.gone()) clients_[i] = come();
        }
        if (order_.who == Listening::dead && ++rounds_ % 100 == 0) clients_[0]->look_whether_gone();
        if (order_.who == Listening::dead && clients_[0]->gone()) clients_[0] = come();
    }

private:
    std::unique_ptr<TcpClient> come() const {
        constexpr int kFewBytes = 4096;
        const bool takes = order_.who == Listening::one || order_.who == Listening::eight;
        return std::make_unique<TcpClient>(order_.port, takes ? 0 : kFewBytes);
    }
    const Order order_;
    const std::string garbage_ = std::string(1 << 16, 'G');
    std::vector<std::unique_ptr<TcpClient>> clients_;
    int rounds_ = 0;
};

[[noreturn]] void run(int orders) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    constexpr int kGivesWay = 19, kRound_ms = 5;
    (void)!::nice(kGivesWay);
    std::unique_ptr<Systems> systems;
    for (;;) {
        pollfd waiting{orders, POLLIN, 0};
        if (::poll(&waiting, 1, systems ? kRound_ms : -1) > 0) {
            Order order{};
            if (::read(orders, &order, sizeof(order)) != sizeof(order)) ::_exit(0);
            systems.reset();
            systems = std::make_unique<Systems>(order);
        }
        if (systems) systems->round();
    }
}

}  // namespace

std::string words_of(Listening who) {
    constexpr std::array kWords{"nobody", "one", "eight", "a slow one", "a dead one", "hostile ones"};
    return kWords[static_cast<std::size_t>(who)];
}

OtherSystems::OtherSystems() {
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    process_ = ::fork();
    if (process_ == 0) {
        ::close(pipe[1]);
        run(pipe[0]);
    }
    ::close(pipe[0]);
    orders_ = pipe[1];
}

OtherSystems::~OtherSystems() {
    ::close(orders_);
    ::waitpid(process_, nullptr, 0);
}

void OtherSystems::listen(Listening who, int port) const {
    const Order order{who, port};
    (void)!::write(orders_, &order, sizeof(order));
}

}  // namespace planlight::test
