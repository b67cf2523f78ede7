#pragma once

#include "planning_io/dicom_net/dicom_association.h"

namespace planlight {

/// An image of a series as the peer lists it.
struct ImageAtPeer {
    std::string uid, storage_class;  ///< the latter empty where the peer does not say
};

/// C-FIND of the images of one series. Throws as `find_series`.
std::vector<ImageAtPeer> images_of(const DicomPeer& peer, const FoundSeries& series);

}  // namespace planlight
