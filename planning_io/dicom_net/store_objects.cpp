#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include <set>

#include "planning_io/dicom_net/dicom_association.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// How an object wants to be sent.
struct Outgoing {
    fs::path file;
    std::string storage_class, transfer_syntax;
};

Outgoing outgoing(const fs::path& file) {
    DcmFileFormat object;
    if (object.loadFile(file.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength, ERM_fileOnly).bad())
        throw InputError(file, "is no DICOM object", "Name files of DICOM objects, or a folder of nothing else.");
    Outgoing one{file, text_of(*object.getDataset(), DCM_SOPClassUID),
                 DcmXfer(object.getDataset()->getOriginalXfer()).getXferID()};
    if (!is_uid(one.storage_class) || !is_uid(text_of(*object.getDataset(), DCM_SOPInstanceUID)))
        throw InputError(file, "does not say which DICOM object it is", "Export it again from where it came from.");
    return one;
}

/// What is uncompressed may be sent in either byte order's plain syntax; what is packed only as it is.
std::vector<std::string> may_be_sent_as(const std::string& transfer_syntax) {
    const auto& plain = plain_transfer_syntaxes();
    if (std::find(plain.begin(), plain.end(), transfer_syntax) == plain.end()) return {transfer_syntax};
    return plain;
}

bool is_warning(Uint16 status) {
    return (status & 0xF000) == 0xB000 || status == 0x0001;
}

}  // namespace

std::vector<std::string> store_objects(const DicomPeer& peer, const std::vector<fs::path>& files,
                                       const std::function<void(std::size_t, std::size_t)>& progress) {
    DicomAssociation association(peer);
    std::vector<Outgoing> objects;
    std::set<std::pair<std::string, std::string>> proposed;
    for (const fs::path& file : files) {
        objects.push_back(outgoing(file));
        const Outgoing& one = objects.back();
        const auto syntaxes = may_be_sent_as(one.transfer_syntax);
        if (proposed.insert({one.storage_class, syntaxes.front()}).second)
            association.propose(one.storage_class, syntaxes);
    }
    association.open();
    std::vector<std::string> said, refused;
    std::size_t stored = 0;
    for (const Outgoing& one : objects) {
        Uint16 status = 0xFFFF;
        const auto context =
            association.findAnyPresentationContextID(one.storage_class.c_str(), one.transfer_syntax.c_str());
        if (context == 0) {
            refused.push_back(one.file.filename().string() + " (it does not take such objects)");
            continue;
        }
        const OFCondition sent = association.sendSTORERequest(context, one.file.c_str(), nullptr, status);
        if (sent.bad()) {
            if (stored > 0 || !refused.empty())
                throw CheckFailedError(fmt::format("The DICOM archive {} took {} of {} objects, then: {}", peer.name(),
                                                   stored, objects.size(), sent.text()),
                                       "Send all of them again: what it has already is the same object to it.");
            association.check(sent);
        }
        if (status != STATUS_Success && !is_warning(status)) {
            refused.push_back(fmt::format("{} (status {:04X})", one.file.filename().string(), status));
            continue;
        }
        if (status != STATUS_Success)
            said.push_back(fmt::format("The archive took {} with a warning (status {:04X}).",
                                       one.file.filename().string(), status));
        if (progress)
            progress(++stored, objects.size());
        else
            ++stored;
    }
    association.close();
    if (!refused.empty())
        throw CheckFailedError(fmt::format("The DICOM archive {} took {} of {} objects, and not {}", peer.name(),
                                           stored, objects.size(), fmt::join(refused, ", ")),
                               "Ask those who run it which objects it takes, then send all of them again.");
    return said;
}

}  // namespace planlight
