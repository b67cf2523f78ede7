#include "app/commands/session_options.h"

#include "planning_io/case/case_folder.h"

namespace planlight {

Path recordings_folder(const SessionOptions& options) {
    return options.recordings.empty() ? options.case_folder / kRecordingsFolder : options.recordings;
}

Path matches_folder(const SessionOptions& options) {
    return options.keep.empty() ? options.case_folder / kRegistrationsFolder : options.keep;
}

ProjectorFacts projector_facts(const SessionOptions& options) {
    ProjectorFacts projector;
    if (!options.projector_file.empty()) projector = read_projector_file(options.projector_file);
    if (options.light_delay_ms >= 0) projector.light_delay = from_seconds(options.light_delay_ms / 1e3);
    return projector;
}

}  // namespace planlight
