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

/// What went wrong the last time that this thread agreed on an encrypted line, or tried to.
struct TlsFault {
    enum class Of { nothing, certificate, its_time, line };  ///< its_time: it has run out, or does not hold yet
    Of of = Of::nothing;
    bool of_certificate() const { return of == Of::certificate || of == Of::its_time; }
    std::string why;  ///< of a certificate also whose it says it is
};
TlsFault tls_fault();
void forget_tls_fault();

/// Throws the DeviceError of a certificate that was not taken. `who` shows it; `host`: what it should be made out to.
[[noreturn]] void refuse_certificate(const TlsFault& fault, const std::string& who, const std::string& host);

}  // namespace planlight
