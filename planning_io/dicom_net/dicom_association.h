#pragma once

// For the .cpp files of this folder alone: DCMTK's headers are heavy.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmnet/scu.h>

#include <string>
#include <vector>

#include "planning_io/dicom_net/dicom_peer.h"

namespace planlight {

/// An association with a peer, from its negotiation to its end.
class DicomAssociation : public DcmSCU {
public:
    explicit DicomAssociation(const DicomPeer& peer);
    ~DicomAssociation() override;

    void propose(const std::string& abstract_syntax, const std::vector<std::string>& transfer_syntaxes,
                 bool peer_sends = false);
    /// Throws DeviceError.
    void open();
    /// In order, with the peer's consent.
    void close();
    /// The context that was accepted for it. Throws CheckFailedError with the words when there is none.
    T_ASC_PresentationContextID accepted(const std::string& abstract_syntax, const std::string& words);
    /// Throws DeviceError for what went wrong on the line.
    void check(const OFCondition& condition) const;

protected:
    const DicomPeer peer_;
};

/// Explicit and implicit little endian.
const std::vector<std::string>& plain_transfer_syntaxes();

/// Only digits and dots, 64 at most, none empty: may be a file's name.
bool is_uid(const std::string& text);

std::string text_of(DcmItem& item, const DcmTagKey& tag);

}  // namespace planlight
