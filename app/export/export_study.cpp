#include "app/export/export_study.h"

#include <fmt/format.h>

#include "app/case_model.h"
#include "app/console.h"
#include "app/report/operation_pdf.h"
#include "app/report/site_paper.h"
#include "app/session.h"
#include "app/site_settings.h"
#include "app/windows/camera_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/case/slicer_scene.h"
#include "planning_io/dicom/dicom_objects.h"
#include "planning_io/dicom/dicom_study.h"
#include "planning_io/files/keep_to_owner.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

DicomStudy study_of_case(const Case& the_case, const fs::path& series_folder, const std::string& series) {
    // A case that was prepared without names has no frame of reference either: then the voxels say whose it is.
    if (the_case.frame_of_reference_uid.empty() && !the_case.source.starts_with("DICOM"))
        throw InputError({},
                         fmt::format("the case {} was made from {}, which names no DICOM frame of reference: there is "
                                     "no study to put anything into",
                                     the_case.code, the_case.source.empty() ? "a volume" : the_case.source),
                         "Prepare the case from the DICOM series itself, or export for 3D Slicer with --slicer.");
    DicomStudy study = read_dicom_study(series_folder, series);
    const auto other = [&](const std::string& what) {
        throw InputError(series_folder, "is not the series that the case was made from: " + what,
                         "Name the folder of the planning series.");
    };
    if (!the_case.frame_of_reference_uid.empty() && study.frame_of_reference_uid != the_case.frame_of_reference_uid)
        other("its frame of reference is another");
    if (hash_of(read_volume(series_folder, series, SliceGaps::resampled)) != the_case.volume_hash)
        other("its voxels are others");
    return study;
}

/// All of them may show a name: of items where the head is drawn, labels and the card in the light.
struct KeyPicture {
    std::string what;
    RgbImage picture;
};

std::vector<KeyPicture> key_pictures(const Case& the_case, const CaseDrawing& drawing,
                                     const ExportedOperation& operation) {
    constexpr int kWidth = 960, kHeight = 720;
    std::vector<KeyPicture> pictures;
    OperatorModel model = model_of_case(the_case, drawing);
    show_match(the_case, operation.match, operation.cloud ? std::make_shared<PointCloud>(*operation.cloud) : nullptr,
               model);
    model.scene.on_paper = true;
    const SceneView view = view_of_plan(drawing.drawing);
    pictures.push_back(
        {operation.cloud ? "The scan on the skin after the match, coloured by its distance" : "The plan on the skin",
         render_scene(scene_of_fit(model, FitView::after), view, kWidth, kHeight)});
    pictures.push_back({"How far off the match may be: 95 % bound at every point of the skin",
                        render_scene(scene_of_fit(model, FitView::predicted_error), view, kWidth, kHeight)});
    if (!operation.facts || !operation.facts->moment) return pictures;
    const OperationMoment& moment = *operation.facts->moment;
    const std::string at = fmt::format(" {:.0f} s after the room was entered", moment.at_s);
    pictures.push_back({"Left camera" + at, rgb_of(brightened(moment.left))});
    pictures.push_back({"Right camera" + at, rgb_of(brightened(moment.right))});
    if (!moment.light.empty()) pictures.push_back({"What the projector was given" + at, moment.light});
    if (!moment.compared[0].empty()) {
        const std::string what = ", round the plan: how far off the light is (green within 1 mm, amber 2 mm)";
        pictures.push_back({"Left camera" + at + what, moment.compared[0]});
        pictures.push_back({"Right camera" + at + what, moment.compared[1]});
    }
    return pictures;
}

/// A stroke as it is lit: without its gaps, in as many lines as they leave.
std::vector<SlicerLine> lit_lines(const Stroke& stroke) {
    if (!(stroke.gap_mm > 0)) return {{stroke.points_in_ct, stroke.closed, stroke.colour}};
    std::vector<Eigen::Vector3d> way = stroke.points_in_ct;
    if (stroke.closed && !way.empty()) way.push_back(way.front());
    std::vector<SlicerLine> lines;
    bool going_on = false;
    double way_mm = 0;
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
        const double step_mm = (way[i + 1] - way[i]).norm();
        const bool lit = !stroke.in_gap(way_mm + step_mm / 2);  // as `DrawingRenderer` has it
        way_mm += step_mm;
        if (lit && !going_on) lines.push_back({{way[i]}, false, stroke.colour});
        if (lit) lines.back().points_in_ct.push_back(way[i + 1]);
        going_on = lit;
    }
    return lines;
}

/// As it was drawn in that session; of a match alone, as this site draws.
CaseDrawing drawing_of(const Case& the_case, const ExportedOperation& operation) {
    DrawingSettings how = drawing_settings(read_site_settings());
    if (operation.facts) how.up_in_ct = operation.facts->head.up_in_ct;
    return CaseDrawing(the_case, how);
}

}  // namespace

std::vector<std::string> export_into_study(const Case& the_case, const ExportedOperation& operation,
                                           const fs::path& series_folder, const std::string& series,
                                           const fs::path& folder) {
    const DicomStudy study = study_of_case(the_case, series_folder, series);
    const CaseDrawing drawing = drawing_of(the_case, operation);
    const RigidTransform& patient_from_ct = operation.match.patient_from_ct;
    DicomObjectName name;
    name.made = operation.made.empty() ? today() : operation.made;
    name.program = PLANLIGHT_VERSION;
    const std::string capture = operation.match.rig ? operation.match.rig->capture_hash : "";
    name.id = the_case.plan_hash + capture + (operation.facts ? operation.facts->recording_hash : "");
    for (Eigen::Index i = 0; i < 16; ++i) name.id += fmt::format("{:.9g} ", patient_from_ct.matrix()(i));
    std::vector<std::string> written;
    write_folder_safely(folder, false, [&](const fs::path& into) {
        keep_to_owner(into);  // name and face
        const auto next = [&](const std::string& file) {
            written.push_back(file);
            return into / file;
        };
        name.series = "registration", name.series_number = 9101;
        name.description =
            operation.confirmed ? "Planlight: match of patient" : "Planlight: match of patient, NOT CONFIRMED";
        if (study.frame_of_reference_uid.empty())
            warn("the planning series names no frame of reference: the match is not written as Spatial Registration");
        else
            write_spatial_registration(study, name, patient_from_ct.inverse(), dicom_uid_of("planlight rig" + name.id),
                                       next("registration.dcm"));
        if (operation.facts) {
            name.series = "report", name.series_number = 9102, name.description = "Planlight: report of operation";
            write_encapsulated_pdf(study, name, "Operation: " + operation.facts->head.case_title,
                                   operation_pdf(*operation.facts, paper_of_site()), next("report.dcm"));
        }
        name.series = "pictures", name.series_number = 9103, name.description = "Planlight: key pictures";
        name.number = 0;
        for (const KeyPicture& key : key_pictures(the_case, drawing, operation)) {
            ++name.number;
            write_secondary_capture(study, name, key.what, key.picture, {true, true},
                                    next(fmt::format("picture-{}.dcm", name.number)));
        }
    });
    return written;
}

void export_for_slicer(const Case& the_case, const ExportedOperation& operation, const fs::path& folder) {
    const CaseDrawing planned = drawing_of(the_case, operation);
    const CaseDrawing drawing(the_case, planned, operation.match.skin);
    SlicerScene scene;
    scene.skin = the_case.skin;
    scene.plan = the_case.plan;
    if (operation.cloud) scene.cloud = *operation.cloud;
    scene.ct_from_rig = operation.match.patient_from_ct.inverse();
    scene.confirmed = operation.confirmed;
    for (const Stroke& stroke : drawing.drawing.strokes) {
        const auto lines = lit_lines(stroke);
        scene.light.insert(scene.light.end(), lines.begin(), lines.end());
    }
    write_slicer_scene(scene, folder);
}

}  // namespace planlight
