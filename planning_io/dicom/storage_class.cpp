#include "planning_io/dicom/storage_class.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <string_view>

namespace planlight {
namespace {

constexpr std::string_view kImageStorage = "1.2.840.10008.5.1.4.1.1.";
const std::set<std::string> kVolumeClasses = {
    "1.2.840.10008.5.1.4.1.1.2",   "1.2.840.10008.5.1.4.1.1.2.1",
    "1.2.840.10008.5.1.4.1.1.2.2",  // CT, Enhanced CT, Legacy Converted Enhanced CT
    "1.2.840.10008.5.1.4.1.1.4",   "1.2.840.10008.5.1.4.1.1.4.1", "1.2.840.10008.5.1.4.1.1.4.4"};  // MR likewise

}  // namespace

bool is_volume_class(const std::string& storage_class) {
    return kVolumeClasses.contains(storage_class);
}

std::string words_of_class(const std::string& storage_class, const std::string& modality) {
    static const std::map<std::string, std::string> kWords = {
        {"1.1", "a computed radiograph"},
        {"3.1", "an ultrasound sequence"},
        {"6.1", "an ultrasound picture"},
        {"7", "a secondary capture"},
        {"7.4", "a secondary capture"},
        {"9.1.1", "an electrocardiogram"},
        {"13.1.1", "an X-ray 3D angiographic image"},
        {"13.1.2", "a cone beam CT stored as an X-ray 3D craniofacial image"},
        {"13.1.3", "an X-ray 3D breast image"},
        {"20", "a nuclear medicine image"},
        {"66.4", "a segmentation"},
        {"88.11", "a report"},
        {"88.22", "a report"},
        {"88.33", "a report"},
        {"88.59", "a list of key pictures"},
        {"104.1", "a PDF"},
        {"128", "a PET image"},
        {"481.2", "a radiotherapy dose"},
        {"481.3", "a plan (RTSTRUCT)"},
        {"481.5", "a radiotherapy plan"}};
    if (storage_class.starts_with(kImageStorage))
        if (const auto words = kWords.find(storage_class.substr(kImageStorage.size())); words != kWords.end())
            return words->second;
    return fmt::format("of modality \"{}\", storage class {}", modality, storage_class);
}

bool is_x_ray_3d(const std::string& storage_class) {
    return storage_class.starts_with("1.2.840.10008.5.1.4.1.1.13.1.");
}

}  // namespace planlight
