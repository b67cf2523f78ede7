#pragma once

// For the .cpp files of this folder alone: DCMTK's headers are heavy.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmnet/scu.h>

#include <memory>
#include <string>
#include <vector>

#include "planning_io/dicom_net/dicom_peer.h"
#include "planning_io/types/error.h"

class DcmTLSTransportLayer;

namespace planlight {

/// It did not want to talk with us at all.
struct AssociationRefused : DeviceError {
    AssociationRefused(const DeviceError& fault, std::string its_reason)
        : DeviceError(fault), reason(std::move(its_reason)) {}
    std::string reason;  ///< as the peer gave it
};

/// An association with a peer, from its negotiation to its end.
class DicomAssociation : public DcmSCU {
public:
    explicit DicomAssociation(const DicomPeer& peer);
    ~DicomAssociation() override;

    void propose(const std::string& abstract_syntax, const std::vector<std::string>& transfer_syntaxes,
                 bool peer_sends = false);
    /// Throws DeviceError, AssociationRefused where it was refused; InputError for files of certificates that are none.
    void open();
    /// In order, with the peer's consent.
    void close();
    bool is_accepted(const std::string& abstract_syntax);
    /// The context that was accepted for it. Throws CheckFailedError with the words when there is none.
    T_ASC_PresentationContextID accepted(const std::string& abstract_syntax, const std::string& words);
    /// Throws DeviceError for what went wrong on the line.
    void check(const OFCondition& condition) const;

protected:
    const DicomPeer peer_;

private:
    std::unique_ptr<DcmTLSTransportLayer> tls_;
    bool talked_ = false;
};

/// Explicit and implicit little endian.
const std::vector<std::string>& plain_transfer_syntaxes();

/// Those that lose nothing, of packed images.
const std::vector<std::string>& packed_transfer_syntaxes();

/// Only digits and dots, 64 at most, none empty: may be a file's name.
bool is_uid(const std::string& text);

std::string text_of(DcmItem& item, const DcmTagKey& tag);

}  // namespace planlight
