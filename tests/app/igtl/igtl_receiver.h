#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Core>

namespace planlight::test {

/// One message as OpenIGTLink's own library takes it, its check included.
struct ReceivedMessage {
    std::string type, device;
    double utc_s = 0;
    bool sound = false;                                 ///< the check of the body is right, and it could be read
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();   ///< TRANSFORM
    std::map<std::string, Eigen::Matrix4d> transforms;  ///< TDATA
    int code = 0;                                       ///< STATUS
    std::string word, text;                             ///< STATUS; STRING
    std::vector<double> numbers;                        ///< SENSOR
    bool in_mm = false;                                 ///< SENSOR
    int points = 0, polygons = 0, lines = 0;            ///< POLYDATA
};

/// Receives by OpenIGTLink's library in a thread of its own until the sender is gone.
class IgtlReceiver {
public:
    explicit IgtlReceiver(int port);
    ~IgtlReceiver();
    bool connected() const { return connected_; }
    /// After the sender is gone.
    const std::vector<ReceivedMessage>& all();

private:
    void run(int port);
    std::atomic<bool> connected_{false};
    std::vector<ReceivedMessage> messages_;
    std::thread thread_;
};

}  // namespace planlight::test
