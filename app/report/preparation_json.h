#pragma once

#include <string>
#include <vector>

#include "app/prepare_case.h"
#include "app/report/plan_facts.h"
#include "app/report/removed_pieces.h"

namespace planlight {

/// The preparation in figures (JSON text): names, volume, skin, what was thrown away, table, plan items with depth,
/// angle and distance to the skin, times, warnings. [JSON.md](../JSON.md) says what the names mean.
std::string preparation_json(const Preparation& prepared, const PlanDrawing& drawing,
                             const std::vector<PlanFact>& facts, const RemovedPieces& removed);

}  // namespace planlight
