#include "planning_io/dicom_net/find_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "planning_io/case/case_names.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

using Answers = std::vector<std::unique_ptr<DcmDataset>>;

/// Takes the answers as they come: an archive may have more of them than this computer has memory.
class Finder final : public DicomAssociation {
public:
    explicit Finder(const DicomPeer& peer) : DicomAssociation(peer) {
        propose(UID_FINDStudyRootQueryRetrieveInformationModel, plain_transfer_syntaxes());
        open();
    }
    Answers answers_to(DcmDataset& keys) {
        answers_.clear();
        const auto context = accepted(UID_FINDStudyRootQueryRetrieveInformationModel, "does not search");
        check(sendFINDRequest(context, &keys, nullptr));
        if (answers_.size() > peer_.most_answers)
            throw CheckFailedError(
                fmt::format("The DICOM archive {} has more than {} answers to that", peer_.name(), peer_.most_answers),
                "Look for less: name the study, the patient or the date.");
        if (last_ != STATUS_Success)
            throw CheckFailedError(
                fmt::format("The DICOM archive {} did not search to its end (status {:04X})", peer_.name(), last_),
                "Look for less: name the study, the patient or the date.");
        return std::move(answers_);
    }

private:
    OFCondition handleFINDResponse(const T_ASC_PresentationContextID context, QRResponse* response,
                                   OFBool& more) override {
        const OFCondition handled = DicomAssociation::handleFINDResponse(context, response, more);
        last_ = response->m_status;
        if (response->m_dataset) {
            answers_.emplace_back(response->m_dataset)->convertToUTF8();  // what cannot be is as it came
            response->m_dataset = nullptr;
        }
        if (answers_.size() > peer_.most_answers) more = OFFalse;
        return handled;
    }

    Answers answers_;
    Uint16 last_ = 0;
};

void ask_for(DcmDataset& keys, const DcmTagKey& tag, const std::string& value = {}) {
    keys.putAndInsertString(tag, value.c_str());
}

Answers studies(Finder& finder, const SeriesQuery& query) {
    DcmDataset keys;
    ask_for(keys, DCM_QueryRetrieveLevel, "STUDY");
    ask_for(keys, DCM_SpecificCharacterSet, "ISO_IR 192");
    ask_for(keys, DCM_PatientID, query.patient_id);
    ask_for(keys, DCM_PatientName, query.patient_name);
    ask_for(keys, DCM_AccessionNumber, query.accession_number);
    ask_for(keys, DCM_StudyDate, query.study_date);
    ask_for(keys, DCM_StudyInstanceUID, query.study_uid);
    ask_for(keys, DCM_StudyDescription);
    if (!query.modality.empty()) ask_for(keys, DCM_ModalitiesInStudy, query.modality);
    return finder.answers_to(keys);
}

/// `study_uid` empty: in any study, which not every archive answers; then what stands above the series is asked for
/// too.
Answers series_of(Finder& finder, const std::string& study_uid, const SeriesQuery& query) {
    DcmDataset keys;
    ask_for(keys, DCM_QueryRetrieveLevel, "SERIES");
    ask_for(keys, DCM_StudyInstanceUID, study_uid);
    ask_for(keys, DCM_SeriesInstanceUID, query.series_uid);
    ask_for(keys, DCM_Modality, query.modality);
    ask_for(keys, DCM_SeriesNumber);
    ask_for(keys, DCM_SeriesDescription);
    ask_for(keys, DCM_NumberOfSeriesRelatedInstances);
    if (study_uid.empty())
        for (const DcmTagKey& above : {DCM_PatientID, DCM_PatientName, DCM_StudyDate, DCM_StudyDescription})
            ask_for(keys, above);
    return finder.answers_to(keys);
}

/// What an answer says, of the study or of the series; what it does not say is left as it was.
void take(DcmDataset& answer, FoundSeries& one) {
    const std::pair<DcmTagKey, std::string*> texts[]{{DCM_PatientID, &one.patient_id},
                                                     {DCM_PatientName, &one.patient_name},
                                                     {DCM_StudyInstanceUID, &one.study_uid},
                                                     {DCM_StudyDate, &one.study_date},
                                                     {DCM_StudyDescription, &one.study_description},
                                                     {DCM_SeriesInstanceUID, &one.series_uid},
                                                     {DCM_Modality, &one.modality},
                                                     {DCM_SeriesNumber, &one.number},
                                                     {DCM_SeriesDescription, &one.description},
                                                     {DCM_NumberOfSeriesRelatedInstances, &one.images}};
    for (const auto& [tag, text] : texts)
        if (answer.tagExists(tag)) *text = text_of(answer, tag);
}

bool names_a_study(const SeriesQuery& query) {
    return !(query.patient_id + query.patient_name + query.accession_number + query.study_date + query.study_uid)
                .empty();
}

}  // namespace

std::vector<FoundSeries> find_series(const DicomPeer& peer, const SeriesQuery& query) {
    Finder finder(peer);
    std::vector<FoundSeries> above(1), found;  // of a series looked for by its UID no study is known
    if (names_a_study(query) || query.series_uid.empty()) {
        above.clear();
        for (const auto& study : studies(finder, query)) take(*study, above.emplace_back());
        std::erase_if(above, [](const FoundSeries& study) { return !is_uid(study.study_uid); });
    }
    for (const FoundSeries& study : above)
        for (const auto& series : series_of(finder, study.study_uid, query)) {
            FoundSeries one = study;
            take(*series, one);
            if (is_uid(one.study_uid) && is_uid(one.series_uid)) found.push_back(std::move(one));
        }
    finder.close();
    std::stable_sort(found.begin(), found.end(), [](const FoundSeries& a, const FoundSeries& b) {
        return std::make_tuple(a.study_date, a.study_uid, a.number.size(), a.number) <
               std::make_tuple(b.study_date, b.study_uid, b.number.size(), b.number);
    });
    return found;
}

std::vector<ImageAtPeer> images_of(const DicomPeer& peer, const FoundSeries& series) {
    Finder finder(peer);
    DcmDataset keys;
    ask_for(keys, DCM_QueryRetrieveLevel, "IMAGE");
    ask_for(keys, DCM_StudyInstanceUID, series.study_uid);
    ask_for(keys, DCM_SeriesInstanceUID, series.series_uid);
    ask_for(keys, DCM_SOPInstanceUID);
    ask_for(keys, DCM_SOPClassUID);
    std::vector<ImageAtPeer> images;
    for (const auto& answer : finder.answers_to(keys)) {
        ImageAtPeer image{text_of(*answer, DCM_SOPInstanceUID), text_of(*answer, DCM_SOPClassUID)};
        if (!is_uid(image.uid))
            throw CheckFailedError(
                fmt::format("The DICOM archive {} lists an image of series {} without a right UID (\"{}\")",
                            peer.name(), series.series_uid, without_control_characters(image.uid)),
                "The series cannot be fetched whole: ask those who run the archive.");
        images.push_back(std::move(image));
    }
    finder.close();
    return images;
}

std::set<std::string> storage_classes_of(const std::vector<ImageAtPeer>& images) {
    // What series that a plan is made on, or a plan itself, are of.
    static const std::set<std::string> usual{UID_CTImageStorage,
                                             UID_EnhancedCTImageStorage,
                                             UID_MRImageStorage,
                                             UID_EnhancedMRImageStorage,
                                             UID_RTStructureSetStorage,
                                             UID_SegmentationStorage,
                                             UID_SurfaceSegmentationStorage,
                                             UID_SecondaryCaptureImageStorage};
    constexpr std::size_t kMost = 15;  // 7 contexts each, of 128
    std::set<std::string> classes;
    for (const ImageAtPeer& image : images)
        if (is_uid(image.storage_class)) classes.insert(image.storage_class);
    return classes.empty() || classes.size() > kMost ? usual : classes;
}

DcmDataset keys_of(const FoundSeries& series) {
    DcmDataset keys;
    ask_for(keys, DCM_QueryRetrieveLevel, "SERIES");
    ask_for(keys, DCM_StudyInstanceUID, series.study_uid);
    ask_for(keys, DCM_SeriesInstanceUID, series.series_uid);
    return keys;
}

}  // namespace planlight
