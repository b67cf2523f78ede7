#include <fmt/format.h>

#include <set>

#include "planning_io/dicom_net/find_series.h"
#include "planning_io/dicom_net/move_series.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// That it does not do this at all, or not for us (DICOM PS3.7, C).
bool is_refusal(Uint16 status) {
    return status == STATUS_GET_Refused_SOPClassNotSupported || status == 0x0124 || status == 0x0211;
}

/// Takes of what the peer sends the images that were asked for, each into a file of its name.
class Getter final : public DicomAssociation {
public:
    Getter(const DicomPeer& peer, const std::vector<ImageAtPeer>& images, fs::path folder,
           std::function<void(std::size_t, std::size_t)> progress)
        : DicomAssociation(peer), folder_(std::move(folder)), progress_(std::move(progress)) {
        for (const ImageAtPeer& image : images) wanted_.insert(image.uid);
        propose(UID_GETStudyRootQueryRetrieveInformationModel, plain_transfer_syntaxes());
        for (const std::string& storage_class : storage_classes_of(images)) {
            propose(storage_class, plain_transfer_syntaxes(), true);
            for (const std::string& syntax : packed_transfer_syntaxes()) propose(storage_class, {syntax}, true);
        }
        setStorageMode(DCMSCU_STORAGE_BIT_PRESERVING);
        setStorageDir(folder_.c_str());
    }

    /// False: it does not let itself be asked so, and nothing came.
    bool get(const FoundSeries& series) {
        try {
            open();
        } catch (const CheckFailedError&) {  // it does nothing of all that
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
        if (!disk_.empty())
            throw DiskError(folder_, disk_,
                            "Check the free space and the permissions of the folder, then fetch again.");
        check(done);
        if (came_.empty() && is_refusal(status_)) return false;
        check_whole(series);
        for (const std::string& uid : came_) sync_file(folder_ / (uid + ".dcm"));
        close();
        return true;
    }
    std::size_t came() const { return came_.size(); }

private:
    OFCondition handleSTORERequestFile(T_ASC_PresentationContextID* context, const OFString&,
                                       T_DIMSE_C_StoreRQ* request) override {
        const std::string uid = request->AffectedSOPInstanceUID;
        if (!wanted_.contains(uid)) return ignoreSTORERequest(*context, *request);
        const fs::path file = folder_ / (uid + ".dcm");
        const OFCondition stored = DicomAssociation::handleSTORERequestFile(context, file.c_str(), request);
        if (stored.bad()) {
            note_full_disk();
            return stored;
        }
        came_.insert(uid);
        if (progress_) progress_(came_.size(), wanted_.size());
        return stored;
    }

    /// The library only says that it did not work.
    void note_full_disk() {
        const fs::path probe = folder_ / "probe";
        try {
            write_safely(probe, std::string(1 << 16, ' '));
            std::error_code ignored;
            fs::remove(probe, ignored);
        } catch (const DiskError& fault) {
            disk_ = "the disk did not take an image";
        }
    }

    void check_whole(const FoundSeries& series) const {
        if (came_.size() == wanted_.size()) return;  // whatever it counted: every image that it listed is here
        throw CheckFailedError(
            fmt::format("The DICOM archive {} sent {} of the {} images of series {} (status {:04X}, {} failed)",
                        peer_.name(), came_.size(), wanted_.size(), series.series_uid, status_, failed_),
            "Nothing was kept: fetch again, or ask those who run the archive.");
    }

    const fs::path folder_;
    const std::function<void(std::size_t, std::size_t)> progress_;
    std::set<std::string> wanted_, came_;
    Uint16 status_ = 0xFFFF, failed_ = 0;
    std::string disk_;
};

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
        Getter getter(peer, images, into, progress);
        const bool got = getter.get(series);
        came = got ? getter.came() : move_series(peer, series, images, into, progress);
    });
    return came;
}

}  // namespace planlight
