#include "app/commands/archive_options.h"

#include "app/site_settings.h"

namespace planlight {

void archive_options(CLI::App* command, ArchiveOptions& options) {
    command->add_option("--host", options.host,
                        "Name or number of the archive (default: as config.json says, `dicom`)");
    command->add_option("--port", options.port, "Its port")->check(CLI::Range(1, 65535));
    command->add_option("--title", options.title, "Its AE title");
    command->add_option("--own-title", options.own_title, "This computer's AE title, as the archive knows it");
    for (const char* name : {"--host", "--port", "--title", "--own-title"})
        command->get_option(name)->group("DICOM archive");
}

DicomPeer archive_of(const ArchiveOptions& options) {
    DicomPeer archive = read_site_settings().archive;
    if (!options.host.empty()) archive.host = options.host;
    if (options.port > 0) archive.port = options.port;
    if (!options.title.empty()) archive.title = options.title;
    if (!options.own_title.empty()) archive.own_title = options.own_title;
    check_peer(archive);
    return archive;
}

}  // namespace planlight
