#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace planlight {

/// How the line to an archive is encrypted (TLS). Files are in PEM, keys without a password.
struct DicomTls {
    bool wanted = false;
    /// The archive's certificate, or that of who signed it; empty: those that this computer's system trusts.
    std::filesystem::path trusted;
    std::filesystem::path certificate, key;  ///< ours, for archives that ask who we are; both or none
    std::string name;                        ///< whom its certificate is made out to; empty: the host
};

/// A DICOM archive (PACS) and who we are to it.
struct DicomPeer {
    std::string host;                     ///< name or number
    int port = 104;                       ///< DICOM's own; Orthanc listens on 4242
    std::string title;                    ///< its application entity title (AE title)
    std::string own_title = "PLANLIGHT";  ///< ours; many archives answer only to titles that they know
    std::chrono::seconds patience{30};    ///< for each answer
    std::size_t most_answers = 50000;     ///< to one question (C-FIND): each is kept in memory
    DicomTls tls;
    /// Of this computer, for an archive that lets nothing be fetched (C-GET) and sends it instead (C-MOVE), to our
    /// title as it knows it. Open only meanwhile. 0: never.
    int own_port = 0;

    std::string name() const;  ///< "ORTHANC at pacs.example:4242"
};

/// Throws InputError where a title is empty, longer than 16 characters or not plain, host or port are none, or files of
/// certificates are named without the line being encrypted, or a certificate without its key.
void check_peer(const DicomPeer& peer);

// What follows throws DeviceError when the peer cannot be reached, refuses us, or is gone in the middle.

/// C-ECHO: whether it answers.
void ask_whether_it_answers(const DicomPeer& peer);

/// What a series is looked for by; empty: not by that. DICOM's wildcards * and ? hold in all but the UIDs.
struct SeriesQuery {
    std::string patient_id, patient_name, accession_number, modality;
    std::string study_date;  ///< YYYYMMDD, or a range of them with a hyphen
    std::string study_uid, series_uid;
};

/// A series as the peer says it.
struct FoundSeries {
    std::string patient_id, patient_name, study_uid, study_date, study_description;
    std::string series_uid, modality, number, description;
    std::string images;  ///< how many; empty where the peer does not say
};

/// C-FIND, first the studies and then the series of each; of a series UID alone, at once. In the order of dates and
/// numbers. Throws CheckFailedError
/// where the peer does not search.
std::vector<FoundSeries> find_series(const DicomPeer& peer, const SeriesQuery& query);

/// C-GET of a series into a new folder, a file each, as the peer has them (bits unchanged); C-MOVE to ourselves where
/// it does not let itself be asked so and `own_port` is given. Whole or not at all: the peer is asked first which
/// images there are, and each must have arrived. Gives their number. `progress`: images so far, and of how many, from
/// any thread; may be empty.
///
/// Throws CheckFailedError when some did not come, the peer gives none, or lists others after than before (the series
/// is still being sent to it); InputError when the series holds none or the folder is there and not empty, DeviceError
/// when our own port is another program's, DiskError.
std::size_t fetch_series(const DicomPeer& peer, const FoundSeries& series, const std::filesystem::path& folder,
                         const std::function<void(std::size_t, std::size_t)>& progress = {});

/// C-STORE of files, each as it is. Gives what the peer said of some though it took them, a sentence each. Throws
/// InputError for a file that is no DICOM, before anything is sent; CheckFailedError when the peer did not take all of
/// them, and says which: they can be sent again, since each is the same object to it.
std::vector<std::string> store_objects(const DicomPeer& peer, const std::vector<std::filesystem::path>& files,
                                       const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace planlight
