#include "planning_io/dicom_net/move_series.h"

#include <dcmtk/dcmnet/dstorscp.h>
#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "planning_io/dicom_net/dicom_tls.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr Uint16 kUnknownDestination = 0xA801;

/// Listens for as long as it lives, in a thread of its own, and takes the images that were asked for.
class ImageTaker final : public DcmStorageSCP {
public:
    ImageTaker(const DicomPeer& peer, const std::vector<ImageAtPeer>& images, fs::path folder,
               std::function<void(std::size_t, std::size_t)> progress)
        : peer_(peer), folder_(std::move(folder)), progress_(std::move(progress)) {
        for (const ImageAtPeer& image : images) wanted_.insert(image.uid);
        setPort(static_cast<Uint16>(peer.own_port));
        setAETitle(peer.own_title.c_str());
        setConnectionBlockingMode(DUL_NOBLOCK);
        setConnectionTimeout(1);
        setDIMSEBlockingMode(DIMSE_NONBLOCKING);
        setDIMSETimeout(static_cast<Uint32>(peer.patience.count()));
        setACSETimeout(static_cast<Uint32>(peer.patience.count()));
        setHostLookupEnabled(OFFalse);
        setDatasetStorageMode(DGM_StoreBitPreserving);
        setFilenameGenerationMode(FGM_UniqueFromNewUID);
        if (setOutputDirectory(folder_.c_str()).bad())
            throw DiskError(folder_, "cannot be written to", "Look at its permissions.");
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
    ~ImageTaker() override {
        done_ = true;
        thread_.join();
    }
    std::size_t came() const {
        const std::lock_guard lock(mutex_);
        return came_.size();
    }
    const std::set<std::string>& wanted() const { return wanted_; }
    bool called() const { return called_; }
    bool disk_failed() const { return disk_failed_; }

protected:
    OFBool checkCalledAETitleAccepted(const OFString& title) override {
        called_ = true;
        return title == peer_.own_title.c_str();
    }
    OFBool checkCallingAETitleAccepted(const OFString& title) override { return title == peer_.title.c_str(); }
    void notifyInstanceStored(const OFString& file, const OFString&, const OFString& image_uid,
                              DcmDataset*) const override {
        const std::string uid(image_uid.c_str(), image_uid.size());
        std::error_code fault;
        if (!is_uid(uid) || !wanted_.contains(uid)) {
            fs::remove(file.c_str(), fault);
            return;
        }
        fs::rename(file.c_str(), folder_ / (uid + ".dcm"), fault);
        if (fault) disk_failed_ = true;
        std::size_t count = 0;
        {
            const std::lock_guard lock(mutex_);
            if (!fault) came_.insert(uid);
            count = came_.size();
        }
        if (progress_) progress_(count, wanted_.size());
    }
    OFBool stopAfterCurrentAssociation() override { return done_ ? OFTrue : OFFalse; }
    OFBool stopAfterConnectionTimeout() override { return done_ ? OFTrue : OFFalse; }

private:
    const DicomPeer peer_;
    const fs::path folder_;
    const std::function<void(std::size_t, std::size_t)> progress_;
    std::set<std::string> wanted_;
    std::unique_ptr<DcmTLSTransportLayer> tls_;
    mutable std::mutex mutex_;
    mutable std::set<std::string> came_;
    mutable std::atomic<bool> disk_failed_{false};
    std::atomic<bool> done_{false}, called_{false};
    std::thread thread_;
};

constexpr const char* kMoveModel = UID_MOVEStudyRootQueryRetrieveInformationModel;

/// What came of the request, as the archive says it.
Uint16 ask_to_send(const DicomPeer& peer, const FoundSeries& series) {
    DicomAssociation association(peer);
    association.propose(kMoveModel, plain_transfer_syntaxes());
    association.open();
    const auto context =
        association.accepted(kMoveModel, "neither lets images be fetched (C-GET) nor sends them (C-MOVE)");
    DcmDataset keys = keys_of(series);
    OFList<RetrieveResponse*> responses;
    const OFCondition done = association.sendMOVERequest(context, peer.own_title.c_str(), &keys, &responses);
    Uint16 status = 0xFFFF;
    for (RetrieveResponse* response : responses) {
        status = response->m_status;
        delete response;
    }
    association.check(done);
    association.close();
    return status;
}

[[noreturn]] void tell_what_is_missing(const DicomPeer& peer, const FoundSeries& series, std::size_t came,
                                       std::size_t wanted, Uint16 status, bool called) {
    const std::string us = fmt::format("{} at port {} of this computer", peer.own_title, peer.own_port);
    if (status == kUnknownDestination)
        throw CheckFailedError(
            fmt::format("The DICOM archive {} does not know where {} is", peer.name(), peer.own_title),
            "Ask those who run it to enter " + us + ".");
    throw CheckFailedError(fmt::format("The DICOM archive {} sent {} of the {} images of series {} (status {:04X})",
                                       peer.name(), came, wanted, series.series_uid, status),
                           called ? "Nothing was kept: fetch again, or ask those who run the archive."
                                  : "It never called: ask those who run it whether it has " + us +
                                        ", and look whether a firewall is between.");
}

}  // namespace

std::size_t move_series(const DicomPeer& peer, const FoundSeries& series, const std::vector<ImageAtPeer>& images,
                        const fs::path& folder, const std::function<void(std::size_t, std::size_t)>& progress) {
    if (peer.own_port == 0)
        throw CheckFailedError(
            "The DICOM archive " + peer.name() + " does not let its images be fetched (C-GET)",
            "Ask those who run it to allow this computer to do so; or, where it sends them (C-MOVE), to enter this "
            "computer, and give --own-port.");
    ImageTaker taker(peer, images, folder, progress);
    const Uint16 status = ask_to_send(peer, series);
    if (taker.disk_failed())
        throw DiskError(folder, "the disk did not take an image",
                        "Check the free space and the permissions of the folder, then fetch again.");
    if (taker.came() != taker.wanted().size())
        tell_what_is_missing(peer, series, taker.came(), taker.wanted().size(), status, taker.called());
    for (const std::string& uid : taker.wanted()) sync_file(folder / (uid + ".dcm"));
    return taker.came();
}

}  // namespace planlight
