#include "planning_io/dicom/header_values.h"

#include <vector>

#include "planning_io/dicom/dicom_slices.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/files/header_text.h"

namespace planlight {

std::string plain(std::string text) {
    while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
    for (char& c : text)
        if (c < ' ' || c > '~') c = '?';
    return text.substr(0, 200);
}

std::string text_at(vtkDICOMMetaData* meta, vtkDICOMTag tag, int frame) {
    return plain(meta->Get(0, frame, tag).AsString());
}

std::string patient_hash(vtkDICOMMetaData* meta) {
    std::string id = text_at(meta, DC::PatientID);
    id.erase(0, id.find_first_not_of(' '));
    return id.empty() ? id : content_hash(id);
}

std::array<double, 6> numbers_at(vtkDICOMMetaData* meta, int frame, vtkDICOMTag tag, unsigned count) {
    std::array<double, 6> list{};
    list.fill(DicomSlice::kUnsaid);
    const vtkDICOMValue& value = meta->Get(0, frame, tag);
    if (!value.IsValid() || value.GetNumberOfValues() < count) return list;
    for (unsigned i = 0; i < count; ++i) {
        const bool is_text = value.GetVR() == vtkDICOMVR::DS || value.GetVR() == vtkDICOMVR::IS;
        const auto numbers = is_text ? numbers_of(plain(value.GetString(i))) : std::vector<double>{value.GetDouble(i)};
        list[i] = numbers.size() == 1 ? numbers[0] : DicomSlice::kUnsaid;  // what is no number is unsaid, not zero
    }
    return list;
}

}  // namespace planlight
