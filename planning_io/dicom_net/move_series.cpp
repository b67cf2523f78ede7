#include "planning_io/dicom_net/move_series.h"

#include <fmt/format.h>

#include <algorithm>

#include "planning_io/case/case_names.h"
#include "planning_io/dicom_net/image_taker.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kMoveModel = UID_MOVEStudyRootQueryRetrieveInformationModel;
constexpr Uint16 kUnknownDestination = 0xA801;
constexpr Uint16 kPending = STATUS_MOVE_Pending_SubOperationsAreContinuing;

/// The line on which the archive is asked to send.
class Mover final : public DicomAssociation {
public:
    explicit Mover(const DicomPeer& peer) : DicomAssociation(peer) { propose(kMoveModel, plain_transfer_syntaxes()); }

    /// What came of the request, as the archive says it. It need not say anything here while it sends (DICOM PS3.4,
    /// C.4.2): it is given up when nothing has come here nor to the taker for so long as we have patience.
    Uint16 move(const FoundSeries& series, const ImageTaker& taker) {
        open();
        const auto context = accepted(kMoveModel, "neither lets images be fetched (C-GET) nor sends them (C-MOVE)");
        DcmDataset keys = keys_of(series);
        OFList<RetrieveResponse*> responses;
        auto spoke = Clock::now();
        OFCondition done = sendMOVERequest(context, peer_.own_title.c_str(), &keys, &responses);
        Uint16 status = kPending;
        for (RetrieveResponse* response : responses) {
            status = response->m_status;
            delete response;
        }
        while (status == kPending && (done.good() || done == DIMSE_NODATAAVAILABLE)) {
            if (done.good()) spoke = Clock::now();
            if (std::min<Clock::duration>(Clock::now() - spoke, taker.silence()) >= peer_.patience) break;
            done = next_response(status);
        }
        check(done);
        close();
        return status;
    }

private:
    OFCondition next_response(Uint16& status) {
        T_DIMSE_Message message{};
        T_ASC_PresentationContextID context = 0;
        DcmDataset *detail = nullptr, *failed = nullptr;
        OFCondition received = receiveDIMSECommand(&context, &message, &detail, nullptr, 1);
        delete detail;
        if (received.bad()) return received;
        if (message.CommandField != DIMSE_C_MOVE_RSP) return DIMSE_BADCOMMANDTYPE;
        if (message.msg.CMoveRSP.DataSetType != DIMSE_DATASET_NULL) received = receiveDIMSEDataset(&context, &failed);
        delete failed;
        status = message.msg.CMoveRSP.DimseStatus;
        return received;
    }
};

/// Someone called and was not taken, and the images did not come.
[[noreturn]] void tell_who_was_turned_away(const DicomPeer& peer, const TurnedAway& who) {
    const std::string archive = "The DICOM archive " + peer.name();
    const std::string port = fmt::format("Who called port {} of this computer", peer.own_port);
    if (who.tls.of_certificate()) refuse_certificate(who.tls, port, peer.host);
    if (who.tls.of != TlsFault::Of::nothing)
        throw DeviceError(port, "does not agree on an encrypted line: " + who.tls.why,
                          "Ask those who run the archive to let it send over TLS, to show its certificate when it "
                          "calls, and to trust ours.");
    if (!who.asked.empty())
        throw DeviceError(
            port, fmt::format("asked for {}, and here is {}", without_control_characters(who.asked), peer.own_title),
            "Ask those who run the archive by which title it has this computer, and give that with "
            "--own-title.");
    if (!who.title.empty())
        throw DeviceError(
            port, fmt::format("is {}, and {} was asked to send", without_control_characters(who.title), peer.title),
            "Ask those who run the archive to let it send by the title that it is asked by.");
    throw DeviceError(port, "did not speak DICOM, or was gone at once",
                      peer.tls.wanted ? "Ask those who run the archive what it sends to."
                                      : "It may want the line to be encrypted (--tls).");
}

[[noreturn]] void tell_what_is_missing(const DicomPeer& peer, const FoundSeries& series, const IncomingImages& incoming,
                                       Uint16 status, const ImageTaker& taker) {
    const std::string us = fmt::format("{} at port {} of this computer", peer.own_title, peer.own_port);
    if (status == kUnknownDestination)
        throw CheckFailedError(
            fmt::format("The DICOM archive {} does not know where {} is", peer.name(), peer.own_title),
            "Ask those who run it to enter " + us + ".");
    if (const auto who = taker.turned_away(); who && !taker.peer_called()) tell_who_was_turned_away(peer, *who);
    throw CheckFailedError(fmt::format("The DICOM archive {} sent {} of the {} images of series {} (status {:04X})",
                                       peer.name(), incoming.came(), incoming.asked(), series.series_uid, status),
                           taker.peer_called() ? "Nothing was kept: fetch again, or ask those who run the archive."
                                               : "It never called: ask those who run it whether it has " + us +
                                                     ", and look whether a firewall is between.");
}

}  // namespace

void move_series(const DicomPeer& peer, const FoundSeries& series, const std::vector<ImageAtPeer>& images,
                 IncomingImages& incoming, const std::string& refusal) {
    if (peer.own_port == 0)
        throw CheckFailedError(
            "The DICOM archive " + peer.name() + " does not let its images be fetched (C-GET)" +
                (refusal.empty() ? "" : ", or not now: " + refusal),
            "Ask those who run it to allow this computer to do so; or, where it sends them (C-MOVE), to enter this "
            "computer, and give --own-port.");
    if (peer.tls.wanted && peer.tls.certificate.empty())
        throw InputError({}, "an archive that sends over TLS must be shown a certificate",
                         "Give --tls-certificate and --tls-key.");
    const ImageTaker taker(peer, images, incoming);
    Uint16 status = 0xFFFF;
    try {
        status = Mover(peer).move(series, taker);
    } catch (const DeviceError&) {
        incoming.check_disk();
        throw;
    }
    incoming.check_disk();
    if (!incoming.are_whole()) tell_what_is_missing(peer, series, incoming, status, taker);
}

}  // namespace planlight
