#include "tests/planning_io/dicom_net/scripted_archive.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmnet/scp.h>
#include <dcmtk/dcmtls/tlslayer.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "planning_io/dicom_net/dicom_tls.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/dicom_net/archive_process.h"

namespace planlight::test {

class ScriptedArchive::Server final : public DcmSCP {
public:
    explicit Server(Script script) : script_(std::move(script)), port_(free_port()) {
        constexpr int kPatience = 20;
        setPort(static_cast<Uint16>(port_));
        setAETitle("ARCHIVE");
        setConnectionBlockingMode(DUL_NOBLOCK);
        setConnectionTimeout(1);
        setDIMSEBlockingMode(DIMSE_NONBLOCKING);
        setDIMSETimeout(kPatience);
        setACSETimeout(kPatience);
        setHostLookupEnabled(OFFalse);
        setEnableVerification();
        OFList<OFString> syntaxes;
        syntaxes.push_back(UID_LittleEndianExplicitTransferSyntax);
        syntaxes.push_back(UID_LittleEndianImplicitTransferSyntax);
        addPresentationContext(UID_FINDStudyRootQueryRetrieveInformationModel, syntaxes);
        addPresentationContext(UID_MOVEStudyRootQueryRetrieveInformationModel, syntaxes);
        if (script_.tls.wanted) {
            DicomPeer itself;
            itself.tls = script_.tls;
            tls_ = tls_layer(itself, TlsRole::is_asked);
            if (!script_.asks_who_we_are) tls_->setCertificateVerification(DCV_ignoreCertificate);
            getConfig().setTransportLayer(tls_.get());
        }
        if (openListenPort().bad()) throw std::runtime_error("no free port");
        thread_ = std::thread([this] { acceptAssociations(); });
    }
    ~Server() override {
        done_ = true;
        thread_.join();
    }
    int port() const { return port_; }
    const DicomTls& tls() const { return script_.tls; }

protected:
    OFCondition handleIncomingCommand(T_DIMSE_Message* message, const DcmPresentationContextInfo& context) override {
        if (message->CommandField == DIMSE_C_FIND_RQ) return find(message->msg.CFindRQ, context.presentationContextID);
        if (message->CommandField == DIMSE_C_MOVE_RQ) return move(message->msg.CMoveRQ, context.presentationContextID);
        return DcmSCP::handleIncomingCommand(message, context);
    }
    OFBool stopAfterCurrentAssociation() override { return done_ ? OFTrue : OFFalse; }
    OFBool stopAfterConnectionTimeout() override { return done_ ? OFTrue : OFFalse; }

private:
    OFCondition find(T_DIMSE_C_FindRQ& request, T_ASC_PresentationContextID context) {
        DcmDataset* asked = nullptr;
        OFCondition done = receiveFINDRequest(request, context, asked);
        delete asked;
        do {
            for (const Answer& answer : script_.answers)
                if (done.good()) done = say(answer, request, context);
        } while (script_.without_end && done.good());
        if (done.bad()) return done;
        return sendFINDResponse(context, request.MessageID, request.AffectedSOPClassUID, nullptr, STATUS_Success);
    }
    OFCondition say(const Answer& answer, const T_DIMSE_C_FindRQ& request, T_ASC_PresentationContextID context) {
        DcmDataset said;
        for (const auto& [keyword, value] : answer) {
            DcmTag tag;
            DcmTag::findTagFromName(keyword.c_str(), tag);
            said.putAndInsertString(tag, value.c_str());
        }
        return sendFINDResponse(context, request.MessageID, request.AffectedSOPClassUID, &said,
                                STATUS_FIND_Pending_MatchesAreContinuing);
    }
    OFCondition move(T_DIMSE_C_MoveRQ& request, T_ASC_PresentationContextID context) {
        DcmDataset* asked = nullptr;
        OFString destination;
        const OFCondition received = receiveMOVERequest(request, context, asked, destination);
        delete asked;
        if (received.bad()) return received;
        unsigned status = 0xA702;
        try {
            status = script_.moves();
        } catch (const Error&) {  // it was not let send: what the asker makes of that is the test's
        }
        return sendMOVEResponse(context, request.MessageID, request.AffectedSOPClassUID, nullptr,
                                static_cast<Uint16>(status));
    }

    const Script script_;
    const int port_;
    std::unique_ptr<DcmTLSTransportLayer> tls_;
    std::atomic<bool> done_{false};
    std::thread thread_;
};

ScriptedArchive::ScriptedArchive(Script script) : server_(std::make_unique<Server>(std::move(script))) {}

ScriptedArchive::~ScriptedArchive() = default;

DicomPeer ScriptedArchive::peer() const {
    DicomPeer peer;
    peer.host = "127.0.0.1";
    peer.port = server_->port();
    peer.title = "ARCHIVE";
    peer.patience = std::chrono::seconds(10);
    return peer;
}

std::vector<Answer> answers_of(const std::vector<std::filesystem::path>& files) {
    std::vector<Answer> answers;
    for (const auto& file : files) {
        DcmFileFormat object;
        if (object.loadFile(file.c_str()).bad()) throw std::runtime_error(file.string() + " is no DICOM object");
        Answer& answer = answers.emplace_back();
        for (const DcmTagKey& key :
             {DCM_SOPInstanceUID, DCM_SOPClassUID, DCM_StudyInstanceUID, DCM_SeriesInstanceUID}) {
            OFString value;
            object.getDataset()->findAndGetOFString(key, value);
            answer[DcmTag(key).getTagName()] = value.c_str();
        }
    }
    return answers;
}

FoundSeries series_of(const std::vector<Answer>& answers) {
    FoundSeries series;
    series.study_uid = answers.at(0).at("StudyInstanceUID");
    series.series_uid = answers.at(0).at("SeriesInstanceUID");
    return series;
}

}  // namespace planlight::test
