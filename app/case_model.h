#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "app/windows/operator_model.h"

namespace planlight {

/// The patient's side on which the plan lies on the skin: LEFT, RIGHT, BOTH SIDES or MIDDLE (within 10 mm), against the
/// plane that mirrors the head onto itself (`find_mid_plane`: a turned head lies across the middle of its box). Empty
/// without a plan, where no such plane is found, and where the volume ends within the head at the left or the right.
std::string side_of_plan(const Plan& plan, const SkinSurface& skin);

/// What stands on the skin with the first light (`DrawingSettings::card`): the patient as the site names them, or the
/// case's code where nobody is named or nobody may be (`anonymous`), and the side of the plan where it is known.
std::vector<std::string> card_of(const Case& the_case, const SkinSurface& skin, bool anonymous);

/// Calls each row of the table as the light calls its item: by its name and figures, and where the light has a code in
/// place of the name (`DrawnItem::lit_by_code`) by that first.
void name_rows(const PlanDrawing& drawing, std::vector<PlanRow>& rows);

/// What the light should say of risk structures and has no room for, a sentence each.
std::vector<std::string> unlit_warnings(const PlanDrawing& drawing);
/// How many items have neither name nor code beside their light: the plan is crowded.
long bare_items(const PlanDrawing& drawing);

/// What a person must know of the light's labels that nothing on the skin says: items without one, and those.
std::vector<std::string> evidence_of_labels(const PlanDrawing& drawing);

/// What the operator window shows of a case before anything is scanned: title, skin, plan, table of its items.
OperatorModel model_of_case(const Case& the_case, const CaseDrawing& drawing);

/// How far off each item of the plan may be by the registration, 95 %, mm: its worst point. In the order in which
/// `draw_plan` gives the items. Infinite where the scan held too little skin to tell, or saw something on the skin
/// there (`covered_by_mm`).
std::vector<double> predicted_errors_mm(const Plan& plan, const RegistrationResult& found);

/// How far off each vertex of the skin may be by the registration, 95 %, mm; infinite where it cannot be told.
std::shared_ptr<const std::vector<float>> predicted_on_skin_mm(const TriangleMesh& skin,
                                                               const RegistrationResult& found);

/// The distance of each point to the skin, mm, or to where it lies `skin_offset_mm` outside of the CT's; infinite
/// beyond the table.
std::shared_ptr<const std::vector<float>> distances_to_skin_mm(const PointCloud& cloud,
                                                               const RigidTransform& ct_from_rig, const SkinLut& lut,
                                                               double skin_offset_mm = 0);

/// What a registration was judged by, in words, one line each.
std::vector<std::string> evidence_of(const RegistrationResult& result);

/// Puts a match into the model: evidence and, unless its verdict is `no`, the predicted errors and the scan on the skin
/// before and after the fine match. `cloud` may be null: then only what the result says.
void show_match(const Case& the_case, const RegistrationResult& found, const std::shared_ptr<const PointCloud>& cloud,
                OperatorModel& model);

}  // namespace planlight
