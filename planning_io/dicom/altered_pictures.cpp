#include "planning_io/dicom/altered_pictures.h"

#include <fmt/format.h>
#include <vtkDICOMItem.h>

#include <cctype>
#include <utility>

#include "planning_io/dicom/header_values.h"
#include "planning_io/files/header_text.h"

namespace planlight {
namespace {

/// MIP, MinIP or VRT as a word of a series' description; "thin, for MIP" is none.
std::string projection_word_in(const std::string& description) {
    std::string word, before;
    for (const char c : lower_case(description) + " ") {
        if (std::isalnum(static_cast<unsigned char>(c))) {
            word += c;
            continue;
        }
        const bool is_one = word == "mip" || word == "minip" || word == "vrt";
        if (is_one && before != "for" && before != "fuer" && before != "no")
            return word == "minip" ? "MinIP" : word == "mip" ? "MIP" : "VRT";
        if (!word.empty()) before = std::exchange(word, {});
    }
    return {};
}

}  // namespace

std::string defaced(vtkDICOMMetaData* meta) {
    if (text_at(meta, vtkDICOMTag(0x0028, 0x0302)) == "NO") return "Recognizable Visual Features = NO";
    const vtkDICOMValue& codes = meta->Get(0, vtkDICOMTag(0x0012, 0x0064));
    const vtkDICOMItem* items = codes.GetSequenceData();
    for (std::size_t i = 0; items && i < codes.GetNumberOfValues(); ++i)
        if (plain(items[i].Get(DC::CodeValue).AsString()) == "113102")
            return "de-identification by code 113102, Clean Recognizable Visual Features";
    const std::string word =
        defacing_word_in(text_at(meta, vtkDICOMTag(0x0012, 0x0063)) + " " + text_at(meta, DC::SeriesDescription));
    return word.empty() ? "" : "\"" + word + "\" in its description";
}

std::string projected(vtkDICOMMetaData* meta) {
    const std::string type = "\\" + text_at(meta, DC::ImageType) + "\\";
    for (const char* word : {"MIP", "MINIP", "MAX_IP", "MIN_IP", "PROJECTION IMAGE", "SUBTRACTION", "SUBTRACT"})
        if (type.find(fmt::format("\\{}\\", word)) != std::string::npos) return std::string("Image Type ") + word;
    const std::string word = projection_word_in(text_at(meta, DC::SeriesDescription));
    return word.empty() ? "" : "\"" + word + "\" in its description";
}

}  // namespace planlight
