#include "planning_io/dicom_net/dicom_association.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "planning_io/dicom_net/dicom_tls.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// The library writes to the terminal unless told otherwise; what it says comes back as conditions all the same.
void be_quiet() {
    static const bool once = [] {
        OFLog::configure(OFLogger::OFF_LOG_LEVEL);
        return true;
    }();
    (void)once;
}

std::string one_line(const char* text) {
    std::string line = text;
    std::replace(line.begin(), line.end(), '\n', ' ');
    return line;
}

void check_title(const std::string& title, const std::string& whose) {
    constexpr std::size_t kMost = 16;
    const bool plain = std::all_of(title.begin(), title.end(), [](char c) { return c > ' ' && c < 0x7F && c != '\\'; });
    if (title.empty())
        throw InputError({}, fmt::format("the AE title of {} is missing", whose), "Ask those who run the archive.");
    if (title.size() > kMost || !plain)
        throw InputError({}, fmt::format("\"{}\" is no AE title", title),
                         "Give at most 16 letters and digits without spaces.");
}

void check_tls(const DicomTls& tls) {
    if (tls.certificate.empty() != tls.key.empty())
        throw InputError(tls.certificate.empty() ? tls.key : tls.certificate,
                         tls.key.empty() ? "is a certificate without its key" : "is a key without its certificate",
                         "Give both --tls-certificate and --tls-key, or neither.");
    if (!tls.wanted && !(tls.trusted.empty() && tls.certificate.empty() && tls.name.empty()))
        throw InputError({}, "certificates are named for a line that is not encrypted", "Give --tls as well.");
}

/// What an encrypted line was refused for, by us or by the archive.
[[noreturn]] void refuse_tls(const std::string& who, const std::string& why, const std::string& host) {
    if (const TlsFault fault = tls_fault(); fault.of_certificate()) refuse_certificate(fault, who, host);
    throw DeviceError(who, "does not agree on an encrypted line: " + why,
                      "Check that this port of it speaks TLS. It may want to see a certificate of ours that it knows "
                      "(--tls-certificate, --tls-key).");
}

/// `talked`: the association had been agreed on.
[[noreturn]] void refuse(const DicomPeer& peer, const OFCondition& condition, bool talked) {
    const std::string who = "The DICOM archive " + peer.name(), why = one_line(condition.text());
    if (condition.module() == OFM_dcmnet) switch (condition.code()) {
            case DULC_ASSOCIATIONREJECTED:
                throw AssociationRefused(
                    DeviceError(
                        who, "refuses to talk with " + peer.own_title + ": " + why,
                        "Check both AE titles, and that the archive knows this computer by its title and address."),
                    why);
            case DULC_UNKNOWNHOST:
            case DULC_TCPINITERROR:
            case DULC_REQUESTASSOCIATIONFAILED:
                throw DeviceError(who, "cannot be reached: " + why, "Check host and port, and that it runs.");
            default:
                break;
        }
    throw DeviceError(who, "was gone in the middle, or gave no answer: " + why,
                      std::string("Look whether it runs, and do it again; what was there before is unchanged.") +
                          (talked            ? ""
                           : peer.tls.wanted ? " It may want to see a certificate of ours that it knows."
                                             : " It may want the line to be encrypted (--tls)."));
}

}  // namespace

std::string DicomPeer::name() const {
    return fmt::format("{} at {}:{}", title, host, port);
}

void check_peer(const DicomPeer& peer) {
    if (peer.host.empty())
        throw InputError({}, "no archive is named",
                         "Say host, port and AE title of it, here or in the site's settings.");
    if (peer.port < 1 || peer.port > 65535)
        throw InputError({}, fmt::format("{} is no port", peer.port), "Give a number from 1 to 65535.");
    check_title(peer.title, "the archive");
    check_title(peer.own_title, "this computer");
    check_tls(peer.tls);
}

const std::vector<std::string>& plain_transfer_syntaxes() {
    static const std::vector<std::string> syntaxes{UID_LittleEndianExplicitTransferSyntax,
                                                   UID_LittleEndianImplicitTransferSyntax};
    return syntaxes;
}

const std::vector<std::string>& packed_transfer_syntaxes() {
    static const std::vector<std::string> syntaxes{
        UID_JPEGProcess14SV1TransferSyntax,     UID_JPEGProcess14TransferSyntax,
        UID_JPEGLSLosslessTransferSyntax,       UID_RLELosslessTransferSyntax,
        UID_JPEG2000LosslessOnlyTransferSyntax, UID_DeflatedExplicitVRLittleEndianTransferSyntax};
    return syntaxes;
}

bool is_uid(const std::string& text) {
    constexpr std::size_t kMost = 64;
    return !text.empty() && text.size() <= kMost && text.front() != '.' &&
           std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) || c == '.'; });
}

std::string text_of(DcmItem& item, const DcmTagKey& tag) {
    OFString text;
    item.findAndGetOFStringArray(tag, text);
    return {text.c_str(), text.size()};
}

DicomAssociation::DicomAssociation(const DicomPeer& peer) : peer_(peer) {
    check_peer(peer);
    be_quiet();
    setAETitle(peer.own_title.c_str());
    setPeerAETitle(peer.title.c_str());
    setPeerHostName(peer.host.c_str());
    setPeerPort(static_cast<Uint16>(peer.port));
    setDIMSEBlockingMode(DIMSE_NONBLOCKING);
    setDIMSETimeout(static_cast<Uint32>(peer.patience.count()));
    setACSETimeout(static_cast<Uint32>(peer.patience.count()));
    setConnectionTimeout(static_cast<Sint32>(peer.patience.count()));
}

DicomAssociation::~DicomAssociation() {
    if (isConnected()) abortAssociation();
}

void DicomAssociation::propose(const std::string& abstract_syntax, const std::vector<std::string>& transfer_syntaxes,
                               bool peer_sends) {
    OFList<OFString> syntaxes;
    for (const std::string& syntax : transfer_syntaxes) syntaxes.push_back(syntax.c_str());
    check(
        addPresentationContext(abstract_syntax.c_str(), syntaxes, peer_sends ? ASC_SC_ROLE_SCP : ASC_SC_ROLE_DEFAULT));
}

void DicomAssociation::open() {
    check(initNetwork());
    if (peer_.tls.wanted) {
        tls_ = tls_layer(peer_, TlsRole::asks);
        check(useSecureConnection(tls_.get()));
    }
    forget_tls_fault();
    const OFCondition opened = negotiateAssociation();
    if (opened == NET_EC_NoAcceptablePresentationContexts)
        throw CheckFailedError("The DICOM archive " + peer_.name() + " does nothing of what is asked of it",
                               "Ask those who run it to allow this computer to search, to fetch and to store.");
    if (opened.bad() && peer_.tls.wanted && (opened.module() == OFM_dcmtls || tls_fault().of_certificate()))
        refuse_tls("The DICOM archive " + peer_.name(), one_line(opened.text()), peer_.host);
    check(opened);
    talked_ = true;
}

void DicomAssociation::close() {
    if (isConnected() && releaseAssociation().bad()) abortAssociation();
}

bool DicomAssociation::is_accepted(const std::string& abstract_syntax) {
    return findPresentationContextID(abstract_syntax.c_str(), "") != 0;
}

T_ASC_PresentationContextID DicomAssociation::accepted(const std::string& abstract_syntax, const std::string& words) {
    const auto id = findPresentationContextID(abstract_syntax.c_str(), "");
    if (id == 0)
        throw CheckFailedError("The DICOM archive " + peer_.name() + " " + words,
                               "Ask those who run it to allow this computer to do so.");
    return id;
}

void DicomAssociation::check(const OFCondition& condition) const {
    if (condition.bad()) refuse(peer_, condition, talked_);
}

void ask_whether_it_answers(const DicomPeer& peer) {
    DicomAssociation association(peer);
    association.propose(UID_VerificationSOPClass, plain_transfer_syntaxes());
    association.open();
    association.check(association.sendECHORequest(0));
    association.close();
}

}  // namespace planlight
