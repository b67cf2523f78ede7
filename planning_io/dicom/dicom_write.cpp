#include "planning_io/dicom/dicom_write.h"

#include <fmt/format.h>
#include <unistd.h>
#include <vtkDICOMCompiler.h>
#include <vtkDICOMDictionary.h>
#include <vtkDICOMItem.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMSequence.h>
#include <vtkDICOMValue.h>
#include <vtkNew.h>

#include <cstdlib>

#include "planning_io/files/content_hash.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/types/utf8_prefix.h"

namespace planlight::dicom_write {

namespace fs = std::filesystem;

namespace {

/// It holds a patient's data: gone on every way out.
struct Temporary {
    std::string name;
    ~Temporary() {
        std::error_code ignored;
        fs::remove(name, ignored);
    }
};

}  // namespace

std::string uid_of(const std::string& content) {
    const std::string hex = content_hash(content);
    unsigned __int128 number = 0;
    for (const char c : hex) number = number * 16 + static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
    std::string digits;
    for (; number > 0; number /= 10)
        digits.insert(digits.begin(), static_cast<char>('0' + static_cast<int>(number % 10)));
    return "2.25." + (digits.empty() ? "0" : digits);
}

std::string decimal_string(double value) {
    constexpr std::size_t kMostChars = 16;
    for (int digits = 15; digits > 0; --digits)
        if (std::string text = fmt::format("{:.{}g}", value, digits); text.size() <= kMostChars) return text;
    return "0";
}

vtkDICOMValue name_value(std::string text) {
    for (char& c : text)
        if (c == '\\' || (c >= 0 && c < ' ')) c = c == '\\' ? '/' : ' ';
    return {vtkDICOMVR::LO, vtkDICOMCharacterSet(vtkDICOMCharacterSet::ISO_IR_192), std::string(utf8_prefix(text, 64))};
}

vtkDICOMSequence sequence_of(const vtkDICOMItem& item) {
    vtkDICOMSequence sequence;
    sequence.AddItem(item);
    return sequence;
}

std::string digits_of(const std::string& iso, std::size_t from, std::size_t count) {
    std::string digits;
    for (const char c : iso)
        if (c >= '0' && c <= '9') digits += c;
    return digits.size() >= from + count ? digits.substr(from, count) : std::string();
}

/// vtk-dicom writes to files only.
std::string compile(vtkDICOMMetaData* meta, const char* transfer_syntax, const fs::path& file) {
    std::string name = (fs::temp_directory_path() / "planlight-dicom-XXXXXX").string();
    const int fd = mkstemp(name.data());
    if (fd < 0)
        throw DiskError(file, "could not be written (no temporary file)",
                        "Make room in the folder for temporary files.");
    const Temporary temporary{name};
    close(fd);
    vtkNew<vtkDICOMCompiler> compiler;
    compiler->SetFileName(name.c_str());
    compiler->SetMetaData(meta);
    compiler->SetSOPInstanceUID(meta->Get(DC::SOPInstanceUID).AsString().c_str());
    compiler->SetSeriesInstanceUID(meta->Get(DC::SeriesInstanceUID).AsString().c_str());
    compiler->SetStudyInstanceUID(meta->Get(DC::StudyInstanceUID).AsString().c_str());
    compiler->SetTransferSyntaxUID(transfer_syntax);
    compiler->WriteHeader();
    // Of pixels the header holds the length alone.
    if (const vtkDICOMValue& pixels = meta->Get(DC::PixelData); pixels.IsValid())
        compiler->WritePixelData(pixels.GetUnsignedCharData(), static_cast<vtkIdType>(pixels.GetNumberOfValues()));
    compiler->Close();
    if (compiler->GetErrorCode() != 0)
        throw DiskError(file, "could not be written", "Make room in the folder for temporary files.");
    return read_whole(name);
}

}  // namespace planlight::dicom_write
