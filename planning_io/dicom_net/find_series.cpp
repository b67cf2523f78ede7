#include "planning_io/dicom_net/find_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

using Answers = std::vector<std::unique_ptr<DcmDataset>>;

void ask_for(DcmDataset& keys, const DcmTagKey& tag, const std::string& value = {}) {
    keys.putAndInsertString(tag, value.c_str());
}

Answers answers_to(DicomAssociation& association, const DicomPeer& peer, DcmDataset& keys) {
    constexpr std::size_t kMost = 200000;
    const auto context = association.accepted(UID_FINDStudyRootQueryRetrieveInformationModel, "does not search");
    OFList<QRResponse*> responses;
    const OFCondition done = association.sendFINDRequest(context, &keys, &responses);
    Answers answers;
    Uint16 last = 0;
    for (QRResponse* response : responses) {
        last = response->m_status;
        if (response->m_dataset && answers.size() < kMost) {
            answers.emplace_back(response->m_dataset);
            response->m_dataset = nullptr;
        }
        delete response;
    }
    association.check(done);
    if (last != STATUS_Success)
        throw CheckFailedError(
            fmt::format("The DICOM archive {} did not search to its end (status {:04X})", peer.name(), last),
            "Look for less: name the study, the patient or the date.");
    return answers;
}

Answers studies(DicomAssociation& association, const DicomPeer& peer, const SeriesQuery& query) {
    DcmDataset keys;
    ask_for(keys, DCM_QueryRetrieveLevel, "STUDY");
    ask_for(keys, DCM_SpecificCharacterSet, "ISO_IR 192");
    ask_for(keys, DCM_PatientID, query.patient_id);
    ask_for(keys, DCM_PatientName, query.patient_name);
    ask_for(keys, DCM_AccessionNumber, query.accession_number);
    ask_for(keys, DCM_StudyDate, query.study_date);
    ask_for(keys, DCM_StudyInstanceUID, query.study_uid);
    ask_for(keys, DCM_StudyDescription);
    return answers_to(association, peer, keys);
}

Answers series_of(DicomAssociation& association, const DicomPeer& peer, const std::string& study_uid,
                  const SeriesQuery& query) {
    DcmDataset keys;
    ask_for(keys, DCM_QueryRetrieveLevel, "SERIES");
    ask_for(keys, DCM_StudyInstanceUID, study_uid);
    ask_for(keys, DCM_SeriesInstanceUID, query.series_uid);
    ask_for(keys, DCM_Modality, query.modality);
    ask_for(keys, DCM_SeriesNumber);
    ask_for(keys, DCM_SeriesDescription);
    ask_for(keys, DCM_NumberOfSeriesRelatedInstances);
    return answers_to(association, peer, keys);
}

}  // namespace

std::vector<FoundSeries> find_series(const DicomPeer& peer, const SeriesQuery& query) {
    DicomAssociation association(peer);
    association.propose(UID_FINDStudyRootQueryRetrieveInformationModel, plain_transfer_syntaxes());
    association.open();
    std::vector<FoundSeries> found;
    for (const auto& study : studies(association, peer, query)) {
        FoundSeries one;
        one.patient_id = text_of(*study, DCM_PatientID);
        one.patient_name = text_of(*study, DCM_PatientName);
        one.study_uid = text_of(*study, DCM_StudyInstanceUID);
        one.study_date = text_of(*study, DCM_StudyDate);
        one.study_description = text_of(*study, DCM_StudyDescription);
        if (!is_uid(one.study_uid)) continue;
        for (const auto& series : series_of(association, peer, one.study_uid, query)) {
            one.series_uid = text_of(*series, DCM_SeriesInstanceUID);
            one.modality = text_of(*series, DCM_Modality);
            one.number = text_of(*series, DCM_SeriesNumber);
            one.description = text_of(*series, DCM_SeriesDescription);
            one.images = text_of(*series, DCM_NumberOfSeriesRelatedInstances);
            if (is_uid(one.series_uid)) found.push_back(one);
        }
    }
    association.close();
    std::stable_sort(found.begin(), found.end(), [](const FoundSeries& a, const FoundSeries& b) {
        return std::make_tuple(a.study_date, a.study_uid, a.number.size(), a.number) <
               std::make_tuple(b.study_date, b.study_uid, b.number.size(), b.number);
    });
    return found;
}

std::vector<ImageAtPeer> images_of(const DicomPeer& peer, const FoundSeries& series) {
    DicomAssociation association(peer);
    association.propose(UID_FINDStudyRootQueryRetrieveInformationModel, plain_transfer_syntaxes());
    association.open();
    DcmDataset keys;
    ask_for(keys, DCM_QueryRetrieveLevel, "IMAGE");
    ask_for(keys, DCM_StudyInstanceUID, series.study_uid);
    ask_for(keys, DCM_SeriesInstanceUID, series.series_uid);
    ask_for(keys, DCM_SOPInstanceUID);
    ask_for(keys, DCM_SOPClassUID);
    std::vector<ImageAtPeer> images;
    for (const auto& answer : answers_to(association, peer, keys)) {
        ImageAtPeer image{text_of(*answer, DCM_SOPInstanceUID), text_of(*answer, DCM_SOPClassUID)};
        if (is_uid(image.uid)) images.push_back(std::move(image));
    }
    association.close();
    return images;
}

}  // namespace planlight
