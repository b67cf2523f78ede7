#pragma once

#include "planning_io/dicom_net/find_series.h"

namespace planlight {

/// C-MOVE of these images to ourselves: the peer calls us on `own_port`, which is open only meanwhile and takes nobody
/// but the peer by its title. Each becomes a file of its UID in the folder; what was not asked for is thrown away.
/// Gives their number: all of them.
///
/// Throws CheckFailedError where it does not send either, does not know us, or some did not come; DeviceError when the
/// port is another program's; DiskError.
std::size_t move_series(const DicomPeer& peer, const FoundSeries& series, const std::vector<ImageAtPeer>& images,
                        const std::filesystem::path& folder,
                        const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace planlight
