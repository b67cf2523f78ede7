#include "planning_io/dicom_net/dicom_tls.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <array>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

thread_local std::string not_trusted;

/// OpenSSL asks this for each certificate of the chain.
int note_fault(int good, X509_STORE_CTX* looked_at) {
    if (good) return good;
    std::array<char, 200> whose{};
    if (X509* const certificate = X509_STORE_CTX_get_current_cert(looked_at))
        X509_NAME_get_text_by_NID(X509_get_subject_name(certificate), NID_commonName, whose.data(), whose.size());
    const std::string why = X509_verify_cert_error_string(X509_STORE_CTX_get_error(looked_at));
    not_trusted = whose[0] == '\0' ? why : fmt::format("{} (it is made out to \"{}\")", why, whose.data());
    return good;
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
    return layer;
}

std::string why_not_trusted() {
    return not_trusted;
}

void forget_why_not_trusted() {
    not_trusted.clear();
}

}  // namespace planlight
