#include "planning_io/dicom/rt_struct.h"

#include <fmt/format.h>
#include <vtkDICOMDictionary.h>
#include <vtkDICOMItem.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMParser.h>
#include <vtkDICOMSequence.h>
#include <vtkNew.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "planning_io/dicom/dicom_nesting.h"
#include "planning_io/dicom/header_values.h"
#include "planning_io/files/header_text.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/files/sandboxed_process.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCopyAgain = "Export the structure set again.";
constexpr const char* kRtStructClass = "1.2.840.10008.5.1.4.1.1.481.3";

std::string text(const vtkDICOMValue& value) {
    std::string result = value.IsValid() ? value.AsUTF8String() : std::string();
    while (!result.empty() && (result.back() == ' ' || result.back() == '\0')) result.pop_back();
    return result;
}

/// Numbers of an ROI. Throws InputError where one is not written as a number: the library would read 12 in "12,9", 0 in
/// "".
std::vector<double> numbers(const vtkDICOMValue& value, const std::string& roi, const fs::path& file) {
    const bool is_text = value.GetVR() == vtkDICOMVR::DS || value.GetVR() == vtkDICOMVR::IS;
    std::vector<double> list;
    if (!is_text) {
        for (std::size_t i = 0; i < value.GetNumberOfValues(); ++i) list.push_back(value.GetDouble(i));
        return list;
    }
    std::string all = value.AsString();
    while (!all.empty() && (all.back() == ' ' || all.back() == '\0')) all.pop_back();
    if (all.empty()) return list;
    std::istringstream words(all + '\\');
    for (std::string word; std::getline(words, word, '\\');) {
        const auto number = numbers_of(word);
        if (number.size() != 1)
            throw InputError(file, fmt::format("ROI \"{}\" has \"{}\" where a number should stand", roi, plain(word)),
                             "Export the structure set with decimal points, not commas.");
        list.push_back(number[0]);
    }
    return list;
}

std::vector<RtRoi> rois_of(vtkDICOMMetaData* meta, const fs::path& file) {
    const std::string kind = text(meta->Get(DC::SOPClassUID)), modality = text(meta->Get(DC::Modality));
    if (kind != kRtStructClass)
        throw InputError(
            file, "is DICOM of modality " + (modality.empty() ? "unknown" : modality) + ", not an RT Structure Set",
            modality == "SEG" ? "Give it to `planlight prepare --surface`, or export the plan's contours as RTSTRUCT."
                              : "Name the file of the RT Structure Set by itself, or export the plan as one.");
    std::vector<RtRoi> rois;
    std::map<int, std::size_t> by_number;
    const vtkDICOMSequence sets = meta->Get(DC::StructureSetROISequence);
    for (std::size_t i = 0; i < sets.GetNumberOfItems(); ++i) {
        const vtkDICOMItem& item = sets.GetItem(i);
        if (!by_number.emplace(item.Get(DC::ROINumber).AsInt(), i).second)
            throw InputError(file, fmt::format("has two ROIs of the number {}", item.Get(DC::ROINumber).AsInt()),
                             kCopyAgain);
        rois.push_back({text(item.Get(DC::ROIName)),
                        text(item.Get(DC::ROIDescription)),
                        text(item.Get(DC::ReferencedFrameOfReferenceUID)),
                        {},
                        {},
                        {}});
    }
    const vtkDICOMSequence observations = meta->Get(DC::RTROIObservationsSequence);
    for (std::size_t i = 0; i < observations.GetNumberOfItems(); ++i) {
        const vtkDICOMItem& item = observations.GetItem(i);
        if (const auto at = by_number.find(item.Get(DC::ReferencedROINumber).AsInt()); at != by_number.end())
            rois[at->second].interpreted_type = text(item.Get(DC::RTROIInterpretedType));
    }
    const vtkDICOMSequence drawn = meta->Get(DC::ROIContourSequence);
    for (std::size_t i = 0; i < drawn.GetNumberOfItems(); ++i) {
        const vtkDICOMItem& item = drawn.GetItem(i);
        const auto at = by_number.find(item.Get(DC::ReferencedROINumber).AsInt());
        if (at == by_number.end())
            throw DamagedFileError(file,
                                   fmt::format("has contours of an ROI {} that it does not name",
                                               item.Get(DC::ReferencedROINumber).AsInt()),
                                   kCopyAgain);
        RtRoi& roi = rois[at->second];
        if (item.Get(DC::ROIDisplayColor).IsValid())
            roi.colour = numbers(item.Get(DC::ROIDisplayColor), roi.name, file);
        const vtkDICOMSequence contours = item.Get(DC::ContourSequence);
        for (std::size_t c = 0; c < contours.GetNumberOfItems(); ++c) {
            const vtkDICOMItem& contour = contours.GetItem(c);
            RtContour read{text(contour.Get(DC::ContourGeometricType)),
                           numbers(contour.Get(DC::ContourData), roi.name, file)};
            const int points = contour.Get(DC::NumberOfContourPoints).AsInt();
            if (static_cast<std::size_t>(3 * std::max(points, 0)) != read.numbers.size())
                throw DamagedFileError(file,
                                       fmt::format("ROI \"{}\", contour {}: announces {} points and holds {} numbers",
                                                   roi.name, c + 1, points, read.numbers.size()),
                                       kCopyAgain);
            roi.contours.push_back(std::move(read));
        }
    }
    return rois;
}

std::vector<std::string> referenced_series_of(const vtkDICOMSequence& frames) {
    std::vector<std::string> uids;
    for (std::size_t f = 0; f < frames.GetNumberOfItems(); ++f) {
        const vtkDICOMSequence studies = frames.GetItem(f).Get(DC::RTReferencedStudySequence);
        for (std::size_t s = 0; s < studies.GetNumberOfItems(); ++s) {
            const vtkDICOMSequence series = studies.GetItem(s).Get(DC::RTReferencedSeriesSequence);
            for (std::size_t i = 0; i < series.GetNumberOfItems(); ++i)
                if (std::string uid = text(series.GetItem(i).Get(DC::SeriesInstanceUID)); !uid.empty())
                    uids.push_back(std::move(uid));
        }
    }
    return uids;
}

void parse(Parcel& parcel, const fs::path& file) {
    if (!dicom_nests_to_its_end(read_whole(file))) throw DamagedFileError(file, "is damaged or cut short", kCopyAgain);
    vtkNew<vtkDICOMMetaData> meta;
    vtkNew<vtkDICOMParser> parser;
    parser->SetFileName(file.c_str());
    parser->SetMetaData(meta);
    parser->Update();
    if (parser->GetErrorCode() != 0) throw DamagedFileError(file, "is damaged or cut short", kCopyAgain);
    const auto rois = rois_of(meta, file);
    const vtkDICOMSequence frames = meta->Get(DC::ReferencedFrameOfReferenceSequence);
    // What the ROIs say goes first: beside their frame the list may name those of registered series.
    std::string frame = text(meta->Get(DC::FrameOfReferenceUID));
    if (frames.GetNumberOfItems() > 0) frame = text(frames.GetItem(0).Get(DC::FrameOfReferenceUID));
    for (auto roi = rois.rbegin(); roi != rois.rend(); ++roi)
        if (!roi->frame_of_reference_uid.empty()) frame = roi->frame_of_reference_uid;
    parcel.put(frame);
    for (const std::string& said :
         {patient_hash(meta), text(meta->Get(DC::StudyInstanceUID)), text(meta->Get(DC::SeriesInstanceUID))})
        parcel.put(said);
    const std::vector<std::string> referenced = referenced_series_of(frames);
    parcel.put(static_cast<std::uint64_t>(referenced.size()));
    for (const std::string& uid : referenced) parcel.put(uid);
    parcel.put(text(meta->Get(DC::Manufacturer)) == "Planlight");
    parcel.put(static_cast<std::uint64_t>(rois.size()));
    for (const RtRoi& roi : rois) {
        for (const auto& said : {roi.name, roi.description, roi.frame_of_reference_uid, roi.interpreted_type})
            parcel.put(said);
        parcel.put(roi.colour);
        parcel.put(static_cast<std::uint64_t>(roi.contours.size()));
        for (const RtContour& contour : roi.contours) parcel.put(contour.type), parcel.put(contour.numbers);
    }
}

std::vector<RtRoi> unpack(Parcel& parcel) {
    std::vector<RtRoi> rois(parcel.get<std::uint64_t>());
    for (RtRoi& roi : rois) {
        roi.name = parcel.get_text();
        roi.description = parcel.get_text();
        roi.frame_of_reference_uid = parcel.get_text();
        roi.interpreted_type = parcel.get_text();
        roi.colour = parcel.get_list<double>();
        roi.contours.resize(parcel.get<std::uint64_t>());
        for (RtContour& contour : roi.contours)
            contour.type = parcel.get_text(), contour.numbers = parcel.get_list<double>();
    }
    return rois;
}

}  // namespace

bool is_closed(const RtContour& contour) {
    return contour.type == "CLOSED_PLANAR" || contour.type == "CLOSEDPLANAR_XOR";
}

std::string no_organ(const RtRoi& roi) {
    static const std::map<std::string, std::string> kinds{{"EXTERNAL", "the outline of the patient"},
                                                          {"PTV", "what is to be treated"},
                                                          {"CTV", "what is to be treated"},
                                                          {"GTV", "what is to be treated"},
                                                          {"TREATED_VOLUME", "what is to be treated"},
                                                          {"IRRAD_VOLUME", "what is irradiated"},
                                                          {"BOLUS", "a bolus"},
                                                          {"SUPPORT", "a support"},
                                                          {"FIXATION", "a fixation"},
                                                          {"REGISTRATION", "for registration only"},
                                                          {"ISOCENTER", "an isocentre"},
                                                          {"MARKER", "a marker"}};
    const auto kind = kinds.find(roi.interpreted_type);
    return kind == kinds.end() ? std::string() : kind->second;
}

bool is_rt_struct(const fs::path& file) {
    std::string head(4096, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(in.gcount()));
    return head.find(kRtStructClass) != std::string::npos;
}

RtStruct read_rt_struct(const fs::path& file) {
    Parcel parcel = parse_in_child(file, {"DICOM file"}, [&](Parcel& p) { parse(p, file); });
    RtStruct set;
    set.frame_of_reference_uid = parcel.get_text();
    for (std::string* said : {&set.identity.patient_hash, &set.identity.study_uid, &set.identity.series_uid})
        *said = parcel.get_text();
    set.referenced_series.resize(parcel.get<std::uint64_t>());
    for (std::string& uid : set.referenced_series) uid = parcel.get_text();
    set.ours = parcel.get<bool>();
    set.rois = unpack(parcel);
    if (set.rois.empty()) throw InputError(file, "names no ROI", "Export the structure set with the plan's contours.");
    for (const RtRoi& roi : set.rois)
        if (!roi.frame_of_reference_uid.empty() && roi.frame_of_reference_uid != set.frame_of_reference_uid)
            throw InputError(file,
                             "ROI \"" + roi.name + "\" is in another frame of reference, " + roi.frame_of_reference_uid,
                             "Export the ROIs of one CT.");
    return set;
}

}  // namespace planlight
