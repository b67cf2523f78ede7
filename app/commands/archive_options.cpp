#include "app/commands/archive_options.h"

#include "app/site_settings.h"

namespace planlight {

void archive_options(CLI::App* command, ArchiveOptions& options, bool fetches) {
    command->add_option("--host", options.host,
                        "Name or number of the archive (default: as config.json says, `dicom`)");
    command->add_option("--port", options.port, "Its port")->check(CLI::Range(1, 65535));
    command->add_option("--title", options.title, "Its AE title");
    command->add_option("--own-title", options.own_title, "This computer's AE title, as the archive knows it");
    command->add_flag("--tls", options.tls, "Over an encrypted line (TLS); what is not encrypted is then refused");
    command->add_option("--tls-trusted", options.tls_trusted,
                        "Its certificate, or that of who signed it (PEM; default: those that this computer trusts)");
    command->add_option("--tls-certificate", options.tls_certificate,
                        "Our certificate (PEM), for an archive that asks who we are");
    command->add_option("--tls-key", options.tls_key, "The key of our certificate (PEM, without a password)");
    command->add_option("--tls-name", options.tls_name,
                        "Whom its certificate is made out to, where that is not the host");
    if (fetches)
        command
            ->add_option("--own-port", options.own_port,
                         "Of this computer, for an archive that does not let images be fetched (C-GET) but sends them "
                         "(C-MOVE); open only meanwhile")
            ->check(CLI::Range(1, 65535));
    for (CLI::Option* option : command->get_options())
        for (const char* name : {"--host", "--port", "--title", "--own-title", "--own-port", "--tls", "--tls-trusted",
                                 "--tls-certificate", "--tls-key", "--tls-name"})
            if (option->check_name(name)) option->group("DICOM archive");
}

DicomPeer archive_of(const ArchiveOptions& options) {
    DicomPeer archive = read_site_settings().archive;
    if (!options.host.empty()) archive.host = options.host;
    if (options.port > 0) archive.port = options.port;
    if (!options.title.empty()) archive.title = options.title;
    if (!options.own_title.empty()) archive.own_title = options.own_title;
    if (options.own_port > 0) archive.own_port = options.own_port;
    DicomTls& tls = archive.tls;
    tls.wanted |= options.tls;
    if (!options.tls_trusted.empty()) tls.trusted = options.tls_trusted;
    if (!options.tls_certificate.empty()) tls.certificate = options.tls_certificate;
    if (!options.tls_key.empty()) tls.key = options.tls_key;
    if (!options.tls_name.empty()) tls.name = options.tls_name;
    check_peer(archive);
    return archive;
}

}  // namespace planlight
