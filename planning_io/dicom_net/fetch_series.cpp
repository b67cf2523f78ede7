#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <set>

#include "planning_io/dicom_net/find_series.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// What series that a plan is made on, or a plan itself, are of.
const std::set<std::string>& usual_classes() {
    static const std::set<std::string> classes{UID_CTImageStorage,
                                               UID_EnhancedCTImageStorage,
                                               UID_MRImageStorage,
                                               UID_EnhancedMRImageStorage,
                                               UID_RTStructureSetStorage,
                                               UID_SegmentationStorage,
                                               UID_SurfaceSegmentationStorage,
                                               UID_SecondaryCaptureImageStorage};
    return classes;
}

/// Without loss, each in a context of its own, so that the peer can send each image as it has it.
const std::vector<std::string>& packed_syntaxes() {
    static const std::vector<std::string> syntaxes{
        UID_JPEGProcess14SV1TransferSyntax,     UID_JPEGProcess14TransferSyntax,
        UID_JPEGLSLosslessTransferSyntax,       UID_RLELosslessTransferSyntax,
        UID_JPEG2000LosslessOnlyTransferSyntax, UID_DeflatedExplicitVRLittleEndianTransferSyntax};
    return syntaxes;
}

void sync(const fs::path& file) {
    const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    const int failed = fd < 0 ? -1 : ::fsync(fd);
    const int why = errno;
    if (fd >= 0) ::close(fd);
    if (failed) throw DiskError(file, std::strerror(why), "Check the free space of the disk, then fetch again.");
}

/// Takes of what the peer sends the images that were asked for, each into a file of its name.
class Getter final : public DicomAssociation {
public:
    Getter(const DicomPeer& peer, const std::vector<ImageAtPeer>& images, fs::path folder,
           std::function<void(std::size_t, std::size_t)> progress)
        : DicomAssociation(peer), folder_(std::move(folder)), progress_(std::move(progress)) {
        std::set<std::string> classes;
        for (const ImageAtPeer& image : images) {
            wanted_.insert(image.uid);
            if (is_uid(image.storage_class)) classes.insert(image.storage_class);
        }
        constexpr std::size_t kMostClasses = 15;  // 7 contexts each, of 128
        if (classes.empty() || classes.size() > kMostClasses) classes = usual_classes();
        propose(UID_GETStudyRootQueryRetrieveInformationModel, plain_transfer_syntaxes());
        for (const std::string& storage_class : classes) {
            propose(storage_class, plain_transfer_syntaxes(), true);
            for (const std::string& syntax : packed_syntaxes()) propose(storage_class, {syntax}, true);
        }
        setStorageMode(DCMSCU_STORAGE_BIT_PRESERVING);
        setStorageDir(folder_.c_str());
    }

    void get(const FoundSeries& series) {
        open();
        DcmDataset keys;
        keys.putAndInsertString(DCM_QueryRetrieveLevel, "SERIES");
        keys.putAndInsertString(DCM_StudyInstanceUID, series.study_uid.c_str());
        keys.putAndInsertString(DCM_SeriesInstanceUID, series.series_uid.c_str());
        OFList<RetrieveResponse*> responses;
        const OFCondition done = sendCGETRequest(
            accepted(UID_GETStudyRootQueryRetrieveInformationModel, "does not let its images be fetched (C-GET)"),
            &keys, &responses);
        for (RetrieveResponse* response : responses) {
            status_ = response->m_status;
            failed_ = response->m_numberOfFailedSubops;
            delete response;
        }
        if (!disk_.empty())
            throw DiskError(folder_, disk_,
                            "Check the free space and the permissions of the folder, then fetch again.");
        check(done);
        check_whole(series);
        for (const std::string& uid : came_) sync(folder_ / (uid + ".dcm"));
        close();
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
        getter.get(series);
        came = getter.came();
    });
    return came;
}

}  // namespace planlight
