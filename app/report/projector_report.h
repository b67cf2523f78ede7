#pragma once

#include <optional>
#include <string>

#include "app/report/document.h"
#include "registration/projector_measurement/light_findings.h"

namespace planlight {

/// What was measured of one projector; a part that was not measured is empty.
struct ProjectorReport {
    std::string made_on;          ///< ISO 8601
    std::string source;           ///< what was measured: a folder, or a simulated room
    int width = 0, height = 0;    ///< of the projector's picture; 0: not known
    std::string monitor, serial;  ///< empty: not known
    std::optional<ResponseResult> response;
    std::optional<CycleResult> cycle;
    std::optional<LatencyResult> latency;
};

/// All findings of the parts that were measured and not refused.
std::vector<LightFinding> findings_of(const ProjectorReport& report);

/// A few lines for the terminal.
std::string projector_summary(const ProjectorReport& report);

/// projector.json (planning_io/FORMATS.md).
std::string projector_json(const ProjectorReport& report);

/// Verdict, the measured curve, the trace of each colour, the histogram of the delays.
Document projector_document(const ProjectorReport& report);

}  // namespace planlight
