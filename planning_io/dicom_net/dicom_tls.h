#pragma once

// For the .cpp files of this folder alone: DCMTK's headers are heavy.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmtls/tlslayer.h>

#include <memory>
#include <string>

#include "planning_io/dicom_net/dicom_peer.h"

namespace planlight {

/// Who asks for the line, and who is asked.
enum class TlsRole { asks, is_asked };

/// The encryption of a line by DICOM's profile of today (PS3.15, B.10: TLS 1.2 or newer). The other side must show a
/// certificate that is trusted and, where we ask for the line, made out to it. Throws InputError for files that are no
/// certificate or no key, or do not belong together.
std::unique_ptr<DcmTLSTransportLayer> tls_layer(const DicomPeer& peer, TlsRole role);

/// Why the certificate of the other side was not taken, and whose it says it is, the last time that this thread looked
/// at one; empty: it was taken, or none was looked at.
std::string why_not_trusted();
void forget_why_not_trusted();

}  // namespace planlight
