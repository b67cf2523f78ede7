#include <fmt/format.h>

#include <set>

#include "planning_io/dicom_net/incoming_images.h"
#include "planning_io/dicom_net/move_series.h"
#include "planning_io/files/keep_to_owner.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// That it does not do this at all, or not for us (DICOM PS3.7, C).
bool is_refusal(Uint16 status) {
    return status == STATUS_GET_Refused_SOPClassNotSupported || status == 0x0124 || status == 0x0211;
}

/// Takes of what the peer sends the images that were asked for.
class Getter final : public DicomAssociation {
public:
    Getter(const DicomPeer& peer, const std::vector<ImageAtPeer>& images, IncomingImages& incoming)
        : DicomAssociation(peer), incoming_(incoming) {
        propose(UID_GETStudyRootQueryRetrieveInformationModel, plain_transfer_syntaxes());
        for (const std::string& storage_class : storage_classes_of(images)) {
            propose(storage_class, plain_transfer_syntaxes(), true);
            for (const std::string& syntax : packed_transfer_syntaxes()) propose(storage_class, {syntax}, true);
        }
        setStorageMode(DCMSCU_STORAGE_BIT_PRESERVING);
        setStorageDir(incoming.folder().c_str());
    }

    /// False: it does not let itself be asked so, and nothing came; `refusal` is what it said of that, if anything.
    bool get(const FoundSeries& series, std::string& refusal) {
        try {
            open();
        } catch (const CheckFailedError&) {  // it does nothing of all that
            return false;
        } catch (const AssociationRefused& fault) {  // so some say the same: it has just listed the images to us
            refusal = fault.reason;
            return false;
        }
        if (!is_accepted(UID_GETStudyRootQueryRetrieveInformationModel)) return false;
        DcmDataset keys = keys_of(series);
        OFList<RetrieveResponse*> responses;
        const OFCondition done = sendCGETRequest(
            findPresentationContextID(UID_GETStudyRootQueryRetrieveInformationModel, ""), &keys, &responses);
        for (RetrieveResponse* response : responses) {
            status_ = response->m_status;
            failed_ = response->m_numberOfFailedSubops;
            delete response;
        }
        if (image_failed_) incoming_.check_disk();
        check(done);
        if (incoming_.came() == 0 && is_refusal(status_)) return false;
        check_whole(series);
        close();
        return true;
    }

private:
    OFCondition handleSTORERequestFile(T_ASC_PresentationContextID* context, const OFString&,
                                       T_DIMSE_C_StoreRQ* request) override {
        const std::string uid = request->AffectedSOPInstanceUID;
        if (!incoming_.lack(uid)) return ignoreSTORERequest(*context, *request);
        received_ = 0;
        OFCondition stored = DicomAssociation::handleSTORERequestFile(context, incoming_.file_of(uid).c_str(), request);
        if (stored.good() && !incoming_.take(uid, received_)) stored = DIMSE_OUTOFRESOURCES;
        if (stored.bad()) {
            incoming_.note(stored);
            image_failed_ = true;
        }
        return stored;
    }
    void notifyRECEIVEProgress(const unsigned long bytes) override { received_ = bytes; }

    void check_whole(const FoundSeries& series) const {
        if (incoming_.are_whole()) return;  // whatever it counted: every image that it listed is here
        throw CheckFailedError(
            fmt::format("The DICOM archive {} sent {} of the {} images of series {} (status {:04X}, {} failed)",
                        peer_.name(), incoming_.came(), incoming_.asked(), series.series_uid, status_, failed_),
            "Nothing was kept: fetch again, or ask those who run the archive.");
    }

    IncomingImages& incoming_;
    Uint16 status_ = 0xFFFF, failed_ = 0;
    std::size_t received_ = 0;  ///< of the image that is coming
    bool image_failed_ = false;
};

/// While images were fetched more of them may have come to the archive, at one end, where no gap shows it.
void check_still_the_same(const DicomPeer& peer, const FoundSeries& series, const std::vector<ImageAtPeer>& before) {
    const auto uids = [](const std::vector<ImageAtPeer>& images) {
        std::set<std::string> all;
        for (const ImageAtPeer& image : images) all.insert(image.uid);
        return all;
    };
    const auto was = uids(before), is = uids(images_of(peer, series));
    if (was != is)
        throw CheckFailedError(
            fmt::format("The DICOM archive {} listed {} images of series {} before they were fetched, and {} after",
                        peer.name(), was.size(), series.series_uid, is.size()),
            "The series is still being sent to it: nothing was kept; fetch it when it is whole.");
}

}  // namespace

std::size_t fetch_series(const DicomPeer& peer, const FoundSeries& series, const fs::path& folder,
                         const std::function<void(std::size_t, std::size_t)>& progress) {
    check_new_folder(folder);
    const std::vector<ImageAtPeer> images = images_of(peer, series);
    if (images.empty())
        throw InputError({}, fmt::format("the archive {} lists no image of series {}", peer.name(), series.series_uid),
                         "Look with `planlight fetch` what it has.");
    std::size_t came = 0;
    write_folder_safely(folder, false, [&](const fs::path& into) {
        keep_to_owner(into);  // it names the patient
        IncomingImages incoming(images, into, progress);
        std::string refusal;
        if (!Getter(peer, images, incoming).get(series, refusal)) move_series(peer, series, images, incoming, refusal);
        incoming.sync();
        check_still_the_same(peer, series, images);
        keep_to_owner(into);
        came = incoming.came();
    });
    return came;
}

}  // namespace planlight
