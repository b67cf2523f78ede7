#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "planning_io/dicom_net/dicom_peer.h"

namespace planlight::test {

/// What an archive says of a study, a series or an image: DICOM's keyword and its value.
using Answer = std::map<std::string, std::string>;

/// An archive that answers as it is told, right or wrong, on a free port of this computer: C-FIND and C-MOVE, and no
/// C-GET. It sends nothing by itself, and is silent on a request's line until the request is done.
class ScriptedArchive {
public:
    struct Script {
        std::vector<Answer> answers;      ///< to C-FIND, whatever is asked
        std::function<unsigned()> moves;  ///< C-MOVE: gives the status of the end
        DicomTls tls;                     ///< its own certificate, and whom it trusts
        bool asks_who_we_are = true;      ///< over TLS
        bool without_end = false;         ///< the answers again and again
    };
    explicit ScriptedArchive(Script script);
    ~ScriptedArchive();
    /// ARCHIVE, as PLANLIGHT asks it.
    DicomPeer peer() const;

private:
    class Server;
    std::unique_ptr<Server> server_;
};

/// What it would say of the images in these files, which are of one series; and that series.
std::vector<Answer> answers_of(const std::vector<std::filesystem::path>& files);
FoundSeries series_of(const std::vector<Answer>& answers);

}  // namespace planlight::test
