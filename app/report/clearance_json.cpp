#include "app/report/clearance_json.h"

#include <nlohmann/json.hpp>

namespace planlight {

nlohmann::json clearances_json(const Clearances& clearances) {
    nlohmann::json all = nlohmann::json::array();
    for (const Clearance& clearance : clearances)
        all.push_back(
            {{"structure", clearance.structure}, {"distance_mm", clearance.mm}, {"through", clearance.through}});
    return all;
}

Clearances clearances_from(const nlohmann::json& json) {
    Clearances clearances;
    if (!json.is_array()) return clearances;
    for (const auto& one : json)
        if (one.is_object() && one.contains("distance_mm") && one["distance_mm"].is_number())
            clearances.push_back(
                {one.value("structure", ""), one["distance_mm"].get<double>(), one.value("through", false)});
    return clearances;
}

nlohmann::json risk_structures_json(const Plan& plan) {
    nlohmann::json all = nlohmann::json::array();
    for (const RiskStructure& structure : plan.risk_structures)
        all.push_back({{"name", structure.name}, {"triangles", structure.surface.triangles.size()}});
    return all;
}

}  // namespace planlight
