#include "planning_io/dicom_net/image_taker.h"

#include <dcmtk/dcmnet/scp.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>

#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

class ImageTaker::Listener final : public DcmSCP {
public:
    Listener(const DicomPeer& peer, const std::vector<ImageAtPeer>& images, IncomingImages& incoming)
        : peer_(peer), incoming_(incoming) {
        setPort(static_cast<Uint16>(peer.own_port));
        setAETitle(peer.own_title.c_str());
        setConnectionBlockingMode(DUL_NOBLOCK);
        setConnectionTimeout(1);
        setDIMSEBlockingMode(DIMSE_NONBLOCKING);
        setDIMSETimeout(static_cast<Uint32>(peer.patience.count()));
        // Of who calls and says nothing, and of who does not hear that we end it: both keep the archive from calling.
        setACSETimeout(static_cast<Uint32>(std::min(peer.patience, std::chrono::seconds(5)).count()));
        setHostLookupEnabled(OFFalse);
        setEnableVerification();
        OFList<OFString> syntaxes;
        for (const auto* some : {&plain_transfer_syntaxes(), &packed_transfer_syntaxes()})
            for (const std::string& syntax : *some) syntaxes.push_back(syntax.c_str());
        for (const std::string& storage_class : storage_classes_of(images))
            addPresentationContext(storage_class.c_str(), syntaxes);
        if (peer.tls.wanted) {
            tls_ = tls_layer(peer, TlsRole::is_asked);
            getConfig().setTransportLayer(tls_.get());
        }
        if (const OFCondition open = openListenPort(); open.bad())
            throw DeviceError(fmt::format("Port {} of this computer", peer.own_port),
                              std::string("cannot be listened on: ") + open.text(),
                              "Give another port that the archive knows of, or end the program that has it.");
        thread_ = std::thread([this] { acceptAssociations(); });
    }
    ~Listener() override {
        done_ = true;
        thread_.join();
    }
    Clock::duration silence() const { return Clock::now() - heard_.load(); }
    bool peer_called() const { return peer_called_; }
    std::optional<TurnedAway> turned_away() const {
        const std::lock_guard lock(mutex_);
        return turned_away_;
    }

protected:
    OFCondition waitForAssociationRQ(T_ASC_Network* network) override {
        forget_tls_fault();
        asked_ = false;
        const OFCondition waited = DcmSCP::waitForAssociationRQ(network);
        if (waited != DUL_NOASSOCIATIONREQUEST && !asked_) turn_away({{}, {}, tls_fault()});
        return waited;
    }
    void notifyAssociationRequest(const T_ASC_Parameters& caller, DcmSCPActionType&) override {
        asked_ = true;
        caller_ = caller.DULparams.callingAPTitle;
    }
    OFBool checkCalledAETitleAccepted(const OFString& title) override {
        if (title == peer_.own_title.c_str()) return OFTrue;
        turn_away({caller_, {title.c_str(), title.size()}, {}});
        return OFFalse;
    }
    OFBool checkCallingAETitleAccepted(const OFString& title) override {
        if (title == peer_.title.c_str()) {
            peer_called_ = true;
            return OFTrue;
        }
        turn_away({caller_, {}, {}});
        return OFFalse;
    }
    /// This one and all that follow: between two of them the library would wait for its whole patience.
    OFCondition handleIncomingCommand(T_DIMSE_Message* first, const DcmPresentationContextInfo& context) override {
        OFCondition handled = handle(*first, context);
        while (handled.good()) {
            T_DIMSE_Message next{};
            DcmPresentationContextInfo its = context;
            handled = next_command(next, its.presentationContextID);
            if (handled.bad()) break;
            OFString syntax;
            findPresentationContext(its.presentationContextID, its.abstractSyntax, syntax);
            handled = handle(next, its);
        }
        return handled;
    }
    void notifyRECEIVEProgress(const unsigned long bytes) override {
        received_ = bytes;
        heard_ = Clock::now();
    }
    OFBool stopAfterCurrentAssociation() override { return done_ ? OFTrue : OFFalse; }
    OFBool stopAfterConnectionTimeout() override { return done_ ? OFTrue : OFFalse; }

private:
    OFCondition next_command(T_DIMSE_Message& message, T_ASC_PresentationContextID& context) {
        OFCondition received = DIMSE_NODATAAVAILABLE;
        for (auto waited = peer_.patience; received == DIMSE_NODATAAVAILABLE && !done_ && waited.count() > 0; --waited)
            received = receiveDIMSECommand(&context, &message, nullptr, nullptr, 1);
        return received;
    }
    OFCondition handle(T_DIMSE_Message& message, const DcmPresentationContextInfo& context) {
        if (done_) return DIMSE_NODATAAVAILABLE;  // nobody waits for it: the association is ended
        if (message.CommandField != DIMSE_C_STORE_RQ) return DcmSCP::handleIncomingCommand(&message, context);
        return take(message.msg.CStoreRQ, context.presentationContextID);
    }
    OFCondition take(T_DIMSE_C_StoreRQ& request, T_ASC_PresentationContextID context) {
        const std::string uid = request.AffectedSOPInstanceUID;
        const bool wanted = incoming_.lack(uid);
        const fs::path file = wanted ? incoming_.file_of(uid) : incoming_.folder() / "unwanted";
        received_ = 0;
        OFCondition taken = receiveSTORERequest(request, context, file.c_str());
        if (taken.good() && wanted && !incoming_.take(uid, received_)) taken = DIMSE_OUTOFRESOURCES;
        std::error_code ignored;
        if (!wanted) fs::remove(file, ignored);
        if (taken.good()) return sendSTOREResponse(context, request, STATUS_Success);
        incoming_.note(taken);
        if (taken == DIMSE_OUTOFRESOURCES) sendSTOREResponse(context, request, STATUS_STORE_Refused_OutOfResources);
        return taken;
    }
    void turn_away(TurnedAway who) {
        const std::lock_guard lock(mutex_);
        turned_away_ = std::move(who);
    }

    const DicomPeer peer_;
    IncomingImages& incoming_;
    std::unique_ptr<DcmTLSTransportLayer> tls_;
    std::atomic<Clock::time_point> heard_{Clock::now()};
    std::atomic<bool> done_{false}, peer_called_{false};
    mutable std::mutex mutex_;
    std::optional<TurnedAway> turned_away_;
    bool asked_ = false;        ///< of the thread alone, as all below
    std::string caller_;        ///< the title that it calls itself
    std::size_t received_ = 0;  ///< of the image that is coming
    std::thread thread_;
};

ImageTaker::ImageTaker(const DicomPeer& peer, const std::vector<ImageAtPeer>& images, IncomingImages& incoming)
    : listener_(std::make_unique<Listener>(peer, images, incoming)) {}

ImageTaker::~ImageTaker() = default;

std::chrono::nanoseconds ImageTaker::silence() const {
    return listener_->silence();
}

bool ImageTaker::peer_called() const {
    return listener_->peer_called();
}

std::optional<TurnedAway> ImageTaker::turned_away() const {
    return listener_->turned_away();
}

}  // namespace planlight
