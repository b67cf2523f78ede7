#pragma once

#include "app/commands/command_line.h"
#include "planning_io/dicom_net/dicom_peer.h"

namespace planlight {

/// Which archive a command talks with, where it is another than the site's settings say.
struct ArchiveOptions {
    std::string host, title, own_title, tls_name;
    int port = 0, own_port = 0;
    bool tls = false;
    Path tls_trusted, tls_certificate, tls_key;
};

/// --host, --port, --title, --own-title, and how the line is encrypted; `fetches`: --own-port too.
void archive_options(CLI::App* command, ArchiveOptions& options, bool fetches = false);

/// The archive of the site's settings (config.json), as far as the options do not say otherwise.
DicomPeer archive_of(const ArchiveOptions& options);

}  // namespace planlight
