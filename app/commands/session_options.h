#pragma once

#include <optional>
#include <string>

#include "app/commands/command_line.h"
#include "app/igtl/message_server.h"
#include "planning_io/case/light_file.h"

namespace planlight {

/// Of the command `session`.
struct SessionOptions {
    Path case_folder, volume;
    Path room;  ///< room.json of real devices; empty: the simulated room
    Path keep;  ///< folder for every match; empty: CASE/registrations
    std::string record = "events";
    bool anonymous = false;  ///< the recording
    bool no_report = false;  ///< at the end, beside the recording
    Path recordings;         ///< folder; empty: CASE/recordings
    Path resume;             ///< recording of the session to go on with; empty: the last one is offered
    std::string series_uid;
    std::string language;  ///< of the window; empty: as the site says
    std::string theme;     ///< empty: the site's
    std::string surgeon;   ///< where he stands; empty: as the site says
    std::string preset = "paper", projector_monitor, operator_monitor;
    unsigned seed = 1;
    double speed_mm_s = 20;
    std::string fault;
    int igtl_port = 0;  ///< 0: no other system is told
    std::string igtl_address = MessageServerSettings{}.address;
    bool autoplay = false, json = false;
    double end_after_s = 0;  ///< wall time; 0 = until the window is closed
    double idle_first_s = 0;
    Path screenshots;
    std::string operator_name;  ///< who operates; empty: as the site says, else the account
    /// So often the skin is checked by the session itself; 0: when it is asked for; empty: as the site says.
    std::optional<double> check_skin_every_min;
    double light_delay_ms = -1;  ///< of the projector window; below 0: the default, or what `projector_file` says
    Path projector_file;         ///< projector.json of the monitor; empty: none
};

Path recordings_folder(const SessionOptions& options);
Path matches_folder(const SessionOptions& options);

/// What is known of the projector by the options.
ProjectorFacts projector_facts(const SessionOptions& options);

}  // namespace planlight
