#pragma once

#include <set>

#include "planning_io/dicom_net/dicom_association.h"

namespace planlight {

/// An image of a series as the peer lists it.
struct ImageAtPeer {
    std::string uid, storage_class;  ///< the latter empty where the peer does not say
};

/// C-FIND of the images of one series. Throws as `find_series`.
std::vector<ImageAtPeer> images_of(const DicomPeer& peer, const FoundSeries& series);

/// Of which classes these are; those that series and plans usually are of, where the peer does not say, or too many.
std::set<std::string> storage_classes_of(const std::vector<ImageAtPeer>& images);

/// The question for one series (C-GET, C-MOVE).
DcmDataset keys_of(const FoundSeries& series);

}  // namespace planlight
