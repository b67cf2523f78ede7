#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "planning_io/dicom_net/dicom_tls.h"
#include "planning_io/dicom_net/incoming_images.h"

namespace planlight {

/// Who called our port and was not taken, and why.
struct TurnedAway {
    std::string title;  ///< the one by which it calls itself; empty where it did not come so far
    std::string asked;  ///< the one that it asked for, where that is not ours
    TlsFault tls;       ///< of a line that was to be encrypted
};

/// Listens on the peer's `own_port` for as long as it lives, in a thread of its own, and takes from the peer, by its
/// title, the images that were asked for; what was not is thrown away. The constructor throws InputError for files that
/// are no certificates and DeviceError when the port is another program's.
class ImageTaker {
public:
    ImageTaker(const DicomPeer& peer, const std::vector<ImageAtPeer>& images, IncomingImages& incoming);
    ~ImageTaker();  ///< waits for an image that is just coming, and for none after it
    ImageTaker(const ImageTaker&) = delete;
    ImageTaker& operator=(const ImageTaker&) = delete;

    /// Since something of an image came last, or since it listens.
    std::chrono::nanoseconds silence() const;
    bool peer_called() const;
    /// The last that was turned away; empty: nobody was.
    std::optional<TurnedAway> turned_away() const;

private:
    class Listener;
    std::unique_ptr<Listener> listener_;
};

}  // namespace planlight
