#pragma once

#include <string>
#include <vector>

#include "registration/projector_measurement/measure_cycle.h"
#include "registration/projector_measurement/measure_latency.h"
#include "registration/projector_measurement/measure_response.h"

namespace planlight {

/// Something about the projector that a person should hear, and what to do.
struct LightFinding {
    std::string what, remedy;
};

/// What is wrong enough to be told; empty: nothing. Of results that were not refused.
std::vector<LightFinding> findings_of(const ResponseResult& result);

/// What to mend in the room, each with its remedy; empty when all is well.
std::vector<LightFinding> findings_of(const CycleResult& result);
std::vector<LightFinding> findings_of(const LatencyResult& result);

/// What it means for the scan and the drawing, a few sentences.
std::string meaning_of(const ResponseResult& result);

/// The result in one sentence, for a person.
std::string meaning_of(const CycleResult& result);
std::string meaning_of(const LatencyResult& result);

}  // namespace planlight
