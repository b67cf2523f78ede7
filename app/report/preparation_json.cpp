#include "app/report/preparation_json.h"

#include "app/json_text.h"
#include "app/report/clearance_json.h"

#include <nlohmann/json.hpp>

#include <numbers>

namespace planlight {
namespace {

using Json = nlohmann::json;

Json or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

Json numbers_of(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

Json items_json(const PlanDrawing& drawing, const std::vector<PlanFact>& facts) {
    Json items = Json::array();
    for (std::size_t i = 0; i < drawing.items.size() && i < facts.size(); ++i) {
        const DrawnItem& item = drawing.items[i];
        const PlanFact& fact = facts[i];
        items.push_back({{"name", item.name},
                         {"lit_name", item.lit_name},
                         {"code", item.code},
                         {"kind", fact.kind},
                         {"label", item.label},
                         {"left_of_middle_mm", or_null(fact.left_of_middle_mm)},
                         {"depth_mm", or_null(fact.depth_mm)},
                         {"length_mm", or_null(fact.length_mm)},
                         {"diameter_mm", or_null(fact.diameter_mm)},
                         {"tilt_deg", fact.tilt ? Json(*fact.tilt * 180 / std::numbers::pi) : Json()},
                         {"inwards_in_ct", fact.inwards_in_ct ? numbers_of(*fact.inwards_in_ct) : Json()},
                         {"soft_tissue_mm", or_null(fact.over_bone_mm)},
                         {"distance_to_skin_mm", item.distance_to_skin_mm},
                         {"distance_in_words", fact.distance},
                         {"risk", clearances_json(item.clearances)},
                         {"warnings", item.warnings}});
    }
    return items;
}

Json removed_json(const RemovedPieces& removed) {
    Json pieces = Json::array();
    for (const RemovedPiece& piece : removed.pieces)
        pieces.push_back({{"ml", piece.ml},
                          {"middle_in_ct", numbers_of(piece.middle_in_ct)},
                          {"low_in_ct", numbers_of(piece.low_in_ct)},
                          {"high_in_ct", numbers_of(piece.high_in_ct)},
                          {"place", place_in_words(piece.middle_in_ct, removed.body_middle_in_ct)}});
    return pieces;
}

}  // namespace

std::string preparation_json(const Preparation& done, const PlanDrawing& drawing, const std::vector<PlanFact>& facts,
                             const RemovedPieces& removed) {
    const Case& c = done.prepared;
    Json result = {{"case", c.code},
                   {"title", title_of(c)},
                   {"names",
                    {{"title", c.names.title},
                     {"patient", c.names.patient},
                     {"plan", c.names.plan},
                     {"plan_version", c.names.plan_version},
                     {"series", c.names.series},
                     {"series_date", c.names.series_date}}},
                   {"created", c.created},
                   {"source", c.source},
                   {"modality", done.volume.modality},
                   {"volume", {{"size", done.volume.size}, {"voxel_mm", numbers_of(done.volume.voxel_mm)}}},
                   {"surface_given", done.on_given_surface},
                   {"skin", {{"vertices", c.skin.vertices_in_ct.size()}, {"triangles", c.skin.triangles.size()}}},
                   {"lut", {{"size", c.lut.size}, {"voxel_mm", c.lut.voxel_mm}, {"skin_voxels", c.lut.skin.size()}}},
                   {"plan_items", c.plan.size()},
                   {"risk_structures", risk_structures_json(c.plan)},
                   {"items", items_json(drawing, facts)},
                   {"seconds", {{"skin", done.segment_s}, {"surface", done.triangulate_s}, {"lut", done.lut_s}}},
                   {"warnings", c.warnings}};
    if (!done.on_given_surface)
        result.update({{"threshold", done.threshold},
                       {"threshold_unit", done.volume.is_hu ? "HU" : "stored"},
                       {"threshold_automatic", !done.threshold_given},
                       {"body_ml", done.body_ml},
                       {"removed_pieces", done.pieces_removed},
                       {"removed_ml", done.removed_ml},
                       {"removed", removed_json(removed)},
                       {"brightness_ratio", done.brightness_ratio},
                       {"edge_sigma_mm", c.skin_edge_sigma_mm},
                       {"fat_shift_mm", done.judgement.fat_shift_mm}});
    return json_text(result) + "\n";
}

}  // namespace planlight
