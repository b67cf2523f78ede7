#pragma once

#include "app/commands/command_line.h"
#include "planning_io/dicom_net/dicom_peer.h"

namespace planlight {

/// Which archive a command talks with, where it is another than the site's settings say.
struct ArchiveOptions {
    std::string host, title, own_title;
    int port = 0;
};

/// --host, --port, --title, --own-title.
void archive_options(CLI::App* command, ArchiveOptions& options);

/// The archive of the site's settings (config.json), as far as the options do not say otherwise.
DicomPeer archive_of(const ArchiveOptions& options);

}  // namespace planlight
