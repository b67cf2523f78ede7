#pragma once

#include <nlohmann/json_fwd.hpp>

#include "projection/clearance.h"

namespace planlight {

/// [{"structure", "distance_mm" (0: through), "through"}], what is worst first; [] without risk structures.
nlohmann::json clearances_json(const Clearances& clearances);

/// The same the other way round; what is none of it is left out.
Clearances clearances_from(const nlohmann::json& json);

/// [{"name", "triangles"}] of the plan's risk structures.
nlohmann::json risk_structures_json(const Plan& plan);

}  // namespace planlight
