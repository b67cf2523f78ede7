#include "planning_io/dicom_net/dicom_tls.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <array>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

thread_local TlsFault last_fault;

/// OpenSSL asks this for each certificate of the chain.
int note_fault(int good, X509_STORE_CTX* looked_at) {
    if (good) return good;
    std::array<char, 200> whose{};
    if (X509* const certificate = X509_STORE_CTX_get_current_cert(looked_at))
        X509_NAME_get_text_by_NID(X509_get_subject_name(certificate), NID_commonName, whose.data(), whose.size());
    const int fault = X509_STORE_CTX_get_error(looked_at);
    const std::string why = X509_verify_cert_error_string(fault);
    last_fault.of = fault == X509_V_ERR_CERT_HAS_EXPIRED || fault == X509_V_ERR_CERT_NOT_YET_VALID
                        ? TlsFault::Of::its_time
                        : TlsFault::Of::certificate;
    last_fault.why = whose[0] == '\0' ? why : fmt::format("{} (it is made out to \"{}\")", why, whose.data());
    return good;
}

/// OpenSSL tells this how far it has come with who calls; the library forgets why it ended.
void note_end(const SSL*, int where, int result) {
    if (where != SSL_CB_ACCEPT_EXIT || result > 0 || last_fault.of != TlsFault::Of::nothing) return;
    const unsigned long fault = ERR_peek_error();
    const char* const why = ERR_reason_error_string(fault);
    last_fault.of = TlsFault::Of::line;
    last_fault.why = why ? why : "it was cut";
    if (fault && ERR_GET_REASON(fault) == SSL_R_WRONG_VERSION_NUMBER) last_fault.why = "it does not encrypt it";
}

void check_file(const fs::path& file) {
    std::error_code fault;
    if (!fs::is_regular_file(file, fault))
        throw InputError(file, "is not there", "Name a file of the certificates, in PEM.");
}

/// Throws unless it worked; by then the file is known to be there.
void must(const OFCondition& done, const fs::path& file, const std::string& problem) {
    if (done.bad())
        throw InputError(file, problem, "Ask those who run the archive for it, in PEM, a key without a password.");
}

/// Whom the other side's certificate must be made out to.
void ask_for_name(const DicomPeer& peer, SSL_CTX* context) {
    const std::string name = peer.tls.name.empty() ? peer.host : peer.tls.name;
    X509_VERIFY_PARAM* const asked = SSL_CTX_get0_param(context);
    std::array<unsigned char, sizeof(in6_addr)> number{};
    const bool is_number = ::inet_pton(AF_INET, name.c_str(), number.data()) == 1 ||
                           ::inet_pton(AF_INET6, name.c_str(), number.data()) == 1;
    X509_VERIFY_PARAM_set_hostflags(asked, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
    const int taken = is_number ? X509_VERIFY_PARAM_set1_ip_asc(asked, name.c_str())
                                : X509_VERIFY_PARAM_set1_host(asked, name.c_str(), name.size());
    if (taken != 1) throw InputError({}, fmt::format("{} is no name of a computer", name), "Give --tls-name.");
}

}  // namespace

std::unique_ptr<DcmTLSTransportLayer> tls_layer(const DicomPeer& peer, TlsRole role) {
    const DicomTls& tls = peer.tls;
    auto layer =
        std::make_unique<DcmTLSTransportLayer>(role == TlsRole::asks ? NET_REQUESTOR : NET_ACCEPTOR, nullptr, OFTrue);
    layer->setPrivateKeyPasswd("");  // else the library asks on the terminal
    must(layer->setTLSProfile(TSP_Profile_BCP195_ND), {}, "no safe encryption is installed");
    must(layer->activateCipherSuites(), {}, "no safe encryption is installed");
    SSL_CTX* const context = layer->getNativeHandle();
    if (tls.trusted.empty()) {
        SSL_CTX_set_default_verify_paths(context);
    } else {
        check_file(tls.trusted);
        must(layer->addTrustedCertificateFile(tls.trusted.c_str(), DCF_Filetype_PEM), tls.trusted, "is no certificate");
    }
    if (!tls.certificate.empty() || !tls.key.empty()) {
        check_file(tls.certificate);
        check_file(tls.key);
        must(layer->setPrivateKeyFile(tls.key.c_str(), DCF_Filetype_PEM), tls.key,
             "is no private key that can be used");
        must(layer->setCertificateFile(tls.certificate.c_str(), DCF_Filetype_PEM), tls.certificate,
             "is no certificate");
        if (!layer->checkPrivateKeyMatchesCertificate())
            throw InputError(tls.key, fmt::format("is not the key of {}", tls.certificate.string()),
                             "Name a certificate with its own key.");
    }
    layer->setCertificateVerification(DCV_requireCertificate);
    if (role == TlsRole::asks) ask_for_name(peer, context);
    SSL_CTX_set_verify(context, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, &note_fault);
    SSL_CTX_set_info_callback(context, &note_end);
    return layer;
}

TlsFault tls_fault() {
    return last_fault;
}

void forget_tls_fault() {
    last_fault = {};
}

void refuse_certificate(const TlsFault& fault, const std::string& who, const std::string& host) {
    if (fault.of == TlsFault::Of::its_time)
        throw DeviceError(who, "shows a certificate that does not hold today: " + fault.why,
                          "Look whether the clock of this computer is right; where it is, those who run the archive "
                          "must renew its certificate.");
    throw DeviceError(who, "shows a certificate that is not taken: " + fault.why,
                      fmt::format("Give its certificate, or that of who signed it, with --tls-trusted; where it is "
                                  "made out to another name than {}, give that with --tls-name.",
                                  host));
}

}  // namespace planlight
