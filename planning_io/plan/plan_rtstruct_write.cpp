#include <fmt/format.h>
#include <vtkDICOMDictionary.h>
#include <vtkDICOMItem.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMSequence.h>
#include <vtkDICOMValue.h>
#include <vtkNew.h>

#include <Eigen/Geometry>
#include <cmath>

#include "planning_io/dicom/dicom_write.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_rtstruct.h"
#include "planning_io/plan/plan_settings.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using namespace dicom_write;

constexpr const char* kRtStructClass = "1.2.840.10008.5.1.4.1.1.481.3";

struct RoiItems {
    vtkDICOMSequence names, contours, observations;
};

class RoiWriter {
public:
    explicit RoiWriter(const RtStructIdentity& identity) : identity_(identity) {}

    void add(const std::string& name, const std::string& description, const char* type,
             const std::vector<Vector3d>& points, const std::optional<Colour>& colour) {
        const std::string number = std::to_string(++count_);
        vtkDICOMItem named;
        named.Set(DC::ROINumber, vtkDICOMValue(vtkDICOMVR::IS, number));
        named.Set(DC::ReferencedFrameOfReferenceUID, vtkDICOMValue(vtkDICOMVR::UI, identity_.frame_of_reference_uid));
        named.Set(DC::ROIName, name_value(name));
        if (!description.empty()) named.Set(DC::ROIDescription, vtkDICOMValue(vtkDICOMVR::ST, description));
        named.Set(DC::ROIGenerationAlgorithm, vtkDICOMValue(vtkDICOMVR::CS, "MANUAL"));
        items_.names.AddItem(named);

        vtkDICOMItem contour;
        contour.Set(DC::ContourGeometricType, vtkDICOMValue(vtkDICOMVR::CS, type));
        contour.Set(DC::NumberOfContourPoints, vtkDICOMValue(vtkDICOMVR::IS, std::to_string(points.size())));
        std::vector<std::string> numbers;
        for (const auto& p : points)
            for (int axis = 0; axis < 3; ++axis) numbers.push_back(decimal_string(p[axis]));
        contour.Set(DC::ContourData, vtkDICOMValue(vtkDICOMVR::DS, fmt::format("{}", fmt::join(numbers, "\\"))));
        vtkDICOMItem drawn;
        if (colour) drawn.Set(DC::ROIDisplayColor, vtkDICOMValue(vtkDICOMVR::IS, bytes_of(*colour)));
        drawn.Set(DC::ContourSequence, sequence_of(contour));
        drawn.Set(DC::ReferencedROINumber, vtkDICOMValue(vtkDICOMVR::IS, number));
        items_.contours.AddItem(drawn);

        vtkDICOMItem observed;
        observed.Set(DC::ObservationNumber, vtkDICOMValue(vtkDICOMVR::IS, number));
        observed.Set(DC::ReferencedROINumber, vtkDICOMValue(vtkDICOMVR::IS, number));
        observed.Set(DC::RTROIInterpretedType, vtkDICOMValue(vtkDICOMVR::CS, std::string()));
        observed.Set(DC::ROIInterpreter, vtkDICOMValue(vtkDICOMVR::PN, std::string()));
        items_.observations.AddItem(observed);
    }
    const RoiItems& items() const { return items_; }

private:
    static std::string bytes_of(const Colour& colour) {
        const auto byte = [](float share) { return std::lround(255 * static_cast<double>(share)); };
        return fmt::format("{}\\{}\\{}", byte(colour[0]), byte(colour[1]), byte(colour[2]));
    }
    const RtStructIdentity& identity_;
    int count_ = 0;
    RoiItems items_;
};

/// Lines on skin lie in no plane: OPEN_NONPLANAR, a closed one with its first point again at its end.
void add_line(RoiWriter& writer, const OsteotomyLine& o) {
    std::vector<Vector3d> points = o.points_in_ct;
    if (o.closed) points.push_back(points.front());
    writer.add(o.name, "kind=osteotomy_line", "OPEN_NONPLANAR", points, o.colour);
}

void add_items(RoiWriter& writer, const Plan& plan) {
    for (const auto& o : plan.osteotomy_lines) add_line(writer, o);
    for (const auto& b : plan.boreholes) {
        std::string description = description_of(b);
        if (b.axis_in_ct)
            description += fmt::format(" axis={},{},{}", exact(b.axis_in_ct->x()), exact(b.axis_in_ct->y()),
                                       exact(b.axis_in_ct->z()));
        writer.add(b.name, description, "POINT", {b.position_in_ct}, b.colour);
    }
    for (const auto& t : plan.trajectories)
        writer.add(t.name, "kind=trajectory " + description_of(t), "OPEN_PLANAR", {t.entry_in_ct, t.target_in_ct},
                   t.colour);
    for (const auto& c : plan.cut_planes) {
        const Vector3d u = c.first_axis_in_ct * c.width_mm / 2,
                       v = c.normal_in_ct.cross(c.first_axis_in_ct) * c.height_mm / 2;
        writer.add(c.name, "kind=cut_plane", "CLOSED_PLANAR",
                   {c.origin_in_ct - u - v, c.origin_in_ct + u - v, c.origin_in_ct + u + v, c.origin_in_ct - u + v},
                   c.colour);
    }
}

void set_head(vtkDICOMMetaData* meta, const RtStructIdentity& identity, const std::string& content) {
    const auto set = [&](vtkDICOMTag tag, vtkDICOMVR vr, const std::string& value) {
        meta->Set(tag, vtkDICOMValue(vr, value));
    };
    const std::string date = digits_of(identity.created, 0, 8), time = digits_of(identity.created, 8, 6);
    set(DC::SpecificCharacterSet, vtkDICOMVR::CS, "ISO_IR 192");
    set(DC::SOPClassUID, vtkDICOMVR::UI, kRtStructClass);
    set(DC::SOPInstanceUID, vtkDICOMVR::UI, uid_of("instance" + content));
    set(DC::StudyInstanceUID, vtkDICOMVR::UI, uid_of("study" + identity.frame_of_reference_uid));
    set(DC::SeriesInstanceUID, vtkDICOMVR::UI, uid_of("series" + content));
    set(DC::FrameOfReferenceUID, vtkDICOMVR::UI, identity.frame_of_reference_uid);
    set(DC::Modality, vtkDICOMVR::CS, "RTSTRUCT");
    set(DC::Manufacturer, vtkDICOMVR::LO, "Planlight");
    set(DC::PatientID, vtkDICOMVR::LO, identity.code);
    set(DC::StructureSetLabel, vtkDICOMVR::SH, "PLAN");
    set(DC::StructureSetDate, vtkDICOMVR::DA, date);
    set(DC::StructureSetTime, vtkDICOMVR::TM, time);
    set(DC::StudyDate, vtkDICOMVR::DA, date);
    set(DC::StudyTime, vtkDICOMVR::TM, time);
    set(DC::SeriesNumber, vtkDICOMVR::IS, "1");
    // Known to the hospital only: there, and empty, as the standard asks (type 2).
    set(DC::AccessionNumber, vtkDICOMVR::SH, "");
    set(DC::PositionReferenceIndicator, vtkDICOMVR::LO, "");
    set(DC::ReferringPhysicianName, vtkDICOMVR::PN, "");
    set(DC::OperatorsName, vtkDICOMVR::PN, "");
    set(DC::PatientName, vtkDICOMVR::PN, "");
    set(DC::PatientBirthDate, vtkDICOMVR::DA, "");
    set(DC::PatientSex, vtkDICOMVR::CS, "");
    set(DC::StudyID, vtkDICOMVR::SH, "");
    vtkDICOMItem frame;
    frame.Set(DC::FrameOfReferenceUID, vtkDICOMValue(vtkDICOMVR::UI, identity.frame_of_reference_uid));
    meta->Set(DC::ReferencedFrameOfReferenceSequence, sequence_of(frame));
}

}  // namespace

void write_plan_rtstruct(const Plan& plan, const RtStructIdentity& identity, const fs::path& file) {
    check_plan_numbers(plan, file);
    if (identity.frame_of_reference_uid.empty())
        throw InputError(
            file, "would not name a frame of reference: nothing says it",
            "Write .mrk.json or .vtp, or give the DICOM series that the plan is of, or a case made from one.");
    RoiWriter writer(identity);
    add_items(writer, plan);
    std::string content = identity.code + identity.frame_of_reference_uid + identity.created;
    for (const auto& p : points_of(plan))
        content += decimal_string(p.x()) + decimal_string(p.y()) + decimal_string(p.z());
    vtkNew<vtkDICOMMetaData> meta;
    meta->Initialize();
    set_head(meta, identity, content);
    meta->Set(DC::StructureSetROISequence, writer.items().names);
    meta->Set(DC::ROIContourSequence, writer.items().contours);
    meta->Set(DC::RTROIObservationsSequence, writer.items().observations);
    // Contours may be longer than explicit value representations can say.
    write_safely(file, compile(meta, kImplicitLittleEndian, file));
}

}  // namespace planlight
