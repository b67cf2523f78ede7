#pragma once

#include "planning_io/dicom_net/incoming_images.h"

namespace planlight {

/// C-MOVE of these images to ourselves: the peer calls us on `own_port`, which is open only meanwhile and takes nobody
/// but the peer by its title. `refusal` is what it said when the images were asked for by C-GET, empty if nothing.
///
/// Throws CheckFailedError where it does not send either, does not know us, or some did not come; InputError where the
/// line is encrypted and we have no certificate to show; DeviceError when the port is another program's, or the archive
/// is gone or silent; DiskError.
void move_series(const DicomPeer& peer, const FoundSeries& series, const std::vector<ImageAtPeer>& images,
                 IncomingImages& incoming, const std::string& refusal);

}  // namespace planlight
