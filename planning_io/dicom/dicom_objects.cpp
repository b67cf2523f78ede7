#include "planning_io/dicom/dicom_objects.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vtkDICOMDictionary.h>
#include <vtkDICOMItem.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMSequence.h>
#include <vtkDICOMValue.h>
#include <vtkNew.h>

#include <ctime>
#include <vector>

#include "planning_io/dicom/dicom_write.h"
#include "planning_io/files/safe_write.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using namespace dicom_write;

constexpr const char* kSpatialRegistration = "1.2.840.10008.5.1.4.1.1.66.1";
constexpr const char* kEncapsulatedPdf = "1.2.840.10008.5.1.4.1.1.104.1";
constexpr const char* kSecondaryCapture = "1.2.840.10008.5.1.4.1.1.7";

/// A set of elements that is being filled.
class Elements {
public:
    explicit Elements(vtkDICOMMetaData* meta) : meta_(meta) {}
    void text(vtkDICOMTag tag, vtkDICOMVR vr, const std::string& value) {
        meta_->Set(tag, vtkDICOMValue(vr, vtkDICOMCharacterSet(vtkDICOMCharacterSet::ISO_IR_192), value));
    }
    void name(vtkDICOMTag tag, const std::string& value) { meta_->Set(tag, name_value(value)); }
    void number(vtkDICOMTag tag, unsigned short value) { meta_->Set(tag, vtkDICOMValue(vtkDICOMVR::US, &value, 1)); }
    void items(vtkDICOMTag tag, const vtkDICOMSequence& items) { meta_->Set(tag, items); }
    void bytes(vtkDICOMTag tag, const std::string& value) {
        meta_->Set(tag,
                   vtkDICOMValue(vtkDICOMVR::OB, reinterpret_cast<const unsigned char*>(value.data()), value.size()));
    }

private:
    vtkDICOMMetaData* meta_;
};

vtkDICOMItem code_item(const char* value, const char* scheme, const char* meaning) {
    vtkDICOMItem code;
    code.Set(DC::CodeValue, vtkDICOMValue(vtkDICOMVR::SH, std::string(value)));
    code.Set(DC::CodingSchemeDesignator, vtkDICOMValue(vtkDICOMVR::SH, std::string(scheme)));
    code.Set(DC::CodeMeaning, vtkDICOMValue(vtkDICOMVR::LO, std::string(meaning)));
    return code;
}

/// A moment of UTC as this computer's clock on the wall has it, as the scanner's times are: yyyymmddhhmmss. What is
/// no such moment stays as it is, without its separators.
std::string on_the_wall(const std::string& iso) {
    const std::string digits = digits_of(iso, 0, 14);
    std::tm parts{};
    if (digits.empty() || !iso.ends_with('Z') || strptime(digits.c_str(), "%Y%m%d%H%M%S", &parts) == nullptr)
        return digits.empty() ? digits_of(iso, 0, 8) : digits;
    const std::time_t moment = timegm(&parts);
    std::tm here{};
    if (localtime_r(&moment, &here) == nullptr) return digits;
    return fmt::format("{:%Y%m%d%H%M%S}", here);
}

/// Patient, study, series, equipment, object: what all of them have. `content`: what else makes the object what it is.
Elements set_head(vtkDICOMMetaData* meta, const DicomStudy& study, const DicomObjectName& name, const char* sop_class,
                  const char* modality, const std::string& content) {
    meta->Initialize();
    Elements set(meta);
    const std::string of = study.study_uid + study.series_uid + name.series;
    const std::string made = on_the_wall(name.made), date = made.substr(0, 8),
                      time = made.size() > 8 ? made.substr(8) : std::string();
    const std::string object = uid_of(name.made + '\n' + name.program + '\n' + name.description + '\n' + content);
    set.text(DC::SpecificCharacterSet, vtkDICOMVR::CS, "ISO_IR 192");
    set.text(DC::SOPClassUID, vtkDICOMVR::UI, sop_class);
    set.text(DC::SOPInstanceUID, vtkDICOMVR::UI,
             uid_of("object" + of + name.id + std::to_string(name.number) + object));
    set.text(DC::StudyInstanceUID, vtkDICOMVR::UI, study.study_uid);
    set.text(DC::SeriesInstanceUID, vtkDICOMVR::UI, uid_of("series" + of + name.id));
    set.text(DC::PatientName, vtkDICOMVR::PN, study.patient_name);
    set.text(DC::PatientID, vtkDICOMVR::LO, study.patient_id);
    set.text(DC::PatientBirthDate, vtkDICOMVR::DA, study.birth_date);
    set.text(DC::PatientSex, vtkDICOMVR::CS, study.sex);
    set.text(DC::StudyDate, vtkDICOMVR::DA, study.study_date);
    set.text(DC::StudyTime, vtkDICOMVR::TM, study.study_time);
    set.text(DC::StudyID, vtkDICOMVR::SH, study.study_id);
    set.text(DC::AccessionNumber, vtkDICOMVR::SH, study.accession_number);
    set.text(DC::ReferringPhysicianName, vtkDICOMVR::PN, study.referring_physician);
    if (!study.study_description.empty()) set.name(DC::StudyDescription, study.study_description);
    set.text(DC::Modality, vtkDICOMVR::CS, modality);
    set.text(DC::BodyPartExamined, vtkDICOMVR::CS, "HEAD");
    set.text(DC::SeriesNumber, vtkDICOMVR::IS, std::to_string(name.series_number));
    set.name(DC::SeriesDescription, name.description);
    set.text(DC::InstanceNumber, vtkDICOMVR::IS, std::to_string(name.number));
    set.text(DC::ContentDate, vtkDICOMVR::DA, date);
    set.text(DC::ContentTime, vtkDICOMVR::TM, time);
    set.text(DC::Manufacturer, vtkDICOMVR::LO, "Planlight");
    set.text(DC::ManufacturerModelName, vtkDICOMVR::LO, "Planlight");
    set.text(DC::DeviceSerialNumber, vtkDICOMVR::LO, "none");
    set.text(DC::SoftwareVersions, vtkDICOMVR::LO, name.program);
    return set;
}

/// One frame of reference with the way from it to the registered one.
vtkDICOMItem frame_item(const std::string& uid, const RigidTransform& registered_from_frame, const vtkDICOMItem& how,
                        const std::string& comment) {
    std::vector<std::string> numbers;
    for (Eigen::Index i = 0; i < 16; ++i)
        numbers.push_back(decimal_string(registered_from_frame.matrix()(i / 4, i % 4)));
    vtkDICOMItem matrix;
    matrix.Set(DC::FrameOfReferenceTransformationMatrixType, vtkDICOMValue(vtkDICOMVR::CS, std::string("RIGID")));
    matrix.Set(DC::FrameOfReferenceTransformationMatrix,
               vtkDICOMValue(vtkDICOMVR::DS, fmt::format("{}", fmt::join(numbers, "\\"))));
    vtkDICOMItem registration;
    registration.Set(DC::MatrixSequence, vtkDICOMValue(sequence_of(matrix)));
    registration.Set(DC::RegistrationTypeCodeSequence, vtkDICOMValue(sequence_of(how)));
    registration.Set(DC::FrameOfReferenceTransformationComment, name_value(comment));
    vtkDICOMItem frame;
    frame.Set(DC::FrameOfReferenceUID, vtkDICOMValue(vtkDICOMVR::UI, uid));
    frame.Set(DC::MatrixRegistrationSequence, vtkDICOMValue(sequence_of(registration)));
    return frame;
}

/// The planning images: what an object of their study refers to.
vtkDICOMSequence images_of(const DicomStudy& study) {
    vtkDICOMSequence images;
    for (const std::string& uid : study.image_uids) {
        vtkDICOMItem image;
        image.Set(DC::ReferencedSOPClassUID, vtkDICOMValue(vtkDICOMVR::UI, study.image_class));
        image.Set(DC::ReferencedSOPInstanceUID, vtkDICOMValue(vtkDICOMVR::UI, uid));
        images.AddItem(image);
    }
    return images;
}

}  // namespace

std::string dicom_uid_of(const std::string& content) {
    return uid_of(content);
}

void write_spatial_registration(const DicomStudy& study, const DicomObjectName& name, const RigidTransform& ct_from_rig,
                                const std::string& frame_uid_of_rig, const fs::path& file) {
    vtkNew<vtkDICOMMetaData> meta;
    std::string content = frame_uid_of_rig;
    for (Eigen::Index i = 0; i < 16; ++i) content += fmt::format(" {}", ct_from_rig.matrix()(i));
    Elements set = set_head(meta, study, name, kSpatialRegistration, "REG", content);
    set.text(DC::FrameOfReferenceUID, vtkDICOMVR::UI, study.frame_of_reference_uid);
    set.text(DC::PositionReferenceIndicator, vtkDICOMVR::LO, "");
    set.text(DC::ContentLabel, vtkDICOMVR::CS, "PATIENT_MATCH");
    set.name(DC::ContentDescription, name.description);
    set.text(DC::ContentCreatorName, vtkDICOMVR::PN, "");
    vtkDICOMItem ct = frame_item(study.frame_of_reference_uid, RigidTransform::Identity(),
                                 code_item("125021", "DCM", "Frame of Reference Identity"), "the planning series");
    ct.Set(DC::ReferencedImageSequence, vtkDICOMValue(images_of(study)));
    vtkDICOMSequence frames;
    frames.AddItem(ct);
    frames.AddItem(frame_item(frame_uid_of_rig, ct_from_rig,
                              code_item("125024", "DCM", "Image Content-based Alignment"),
                              "the rig at the moment of the scan, to the planning series"));
    set.items(DC::RegistrationSequence, frames);
    vtkDICOMItem series;
    series.Set(DC::SeriesInstanceUID, vtkDICOMValue(vtkDICOMVR::UI, study.series_uid));
    series.Set(DC::ReferencedInstanceSequence, vtkDICOMValue(images_of(study)));
    set.items(DC::ReferencedSeriesSequence, sequence_of(series));
    write_safely(file, compile(meta, kExplicitLittleEndian, file), ReadableBy::owner);
}

void write_encapsulated_pdf(const DicomStudy& study, const DicomObjectName& name, const std::string& title,
                            const std::string& pdf, const fs::path& file) {
    vtkNew<vtkDICOMMetaData> meta;
    Elements set = set_head(meta, study, name, kEncapsulatedPdf, "DOC", title + '\n' + pdf);
    set.text(DC::ConversionType, vtkDICOMVR::CS, "WSD");
    set.text(DC::AcquisitionDateTime, vtkDICOMVR::DT, on_the_wall(name.made));
    set.text(DC::BurnedInAnnotation, vtkDICOMVR::CS, "YES");
    set.text(DC::RecognizableVisualFeatures, vtkDICOMVR::CS, "YES");
    set.text(DC::DocumentTitle, vtkDICOMVR::ST, title);
    set.items(DC::ConceptNameCodeSequence, vtkDICOMSequence());
    set.text(DC::MIMETypeOfEncapsulatedDocument, vtkDICOMVR::LO, "application/pdf");
    // An even number of bytes; a reader of PDF passes over what follows its last line.
    set.bytes(DC::EncapsulatedDocument, pdf.size() % 2 == 0 ? pdf : pdf + '\n');
    write_safely(file, compile(meta, kExplicitLittleEndian, file), ReadableBy::owner);
}

void write_secondary_capture(const DicomStudy& study, const DicomObjectName& name, const std::string& comment,
                             const RgbImage& picture, const PictureShows& shows, const fs::path& file) {
    std::string pixels(3 * picture.pixels.size(), '\0');
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) pixels[3 * i + k] = static_cast<char>(picture.pixels[i][k]);
    vtkNew<vtkDICOMMetaData> meta;
    Elements set = set_head(
        meta, study, name, kSecondaryCapture, "OT",
        fmt::format("{}\n{} {} {} {}\n", comment, picture.width, picture.height, shows.face, shows.words) + pixels);
    set.text(DC::ConversionType, vtkDICOMVR::CS, "WSD");
    set.text(DC::ImageType, vtkDICOMVR::CS, "DERIVED\\SECONDARY");
    set.text(DC::PatientOrientation, vtkDICOMVR::CS, "");
    set.text(DC::ImageComments, vtkDICOMVR::LT, comment);
    set.text(DC::BurnedInAnnotation, vtkDICOMVR::CS, shows.words ? "YES" : "NO");
    set.text(DC::RecognizableVisualFeatures, vtkDICOMVR::CS, shows.face ? "YES" : "NO");
    set.text(DC::LossyImageCompression, vtkDICOMVR::CS, "00");
    set.number(DC::SamplesPerPixel, 3);
    set.text(DC::PhotometricInterpretation, vtkDICOMVR::CS, "RGB");
    set.number(DC::PlanarConfiguration, 0);
    set.number(DC::Rows, static_cast<unsigned short>(picture.height));
    set.number(DC::Columns, static_cast<unsigned short>(picture.width));
    set.number(DC::BitsAllocated, 8);
    set.number(DC::BitsStored, 8);
    set.number(DC::HighBit, 7);
    set.number(DC::PixelRepresentation, 0);
    set.bytes(DC::PixelData, pixels.size() % 2 == 0 ? pixels : pixels + '\0');
    write_safely(file, compile(meta, kExplicitLittleEndian, file), ReadableBy::owner);
}

}  // namespace planlight
