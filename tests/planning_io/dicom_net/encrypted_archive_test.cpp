// Debian's orthanc over TLS, with certificates that hold and such that do not.
#include <gtest/gtest.h>

#include "planning_io/dicom_net/dicom_peer.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/dicom_net/archive_process.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

class EncryptedArchive : public ::testing::Test {
protected:
    void SetUp() override {
        its_ = test::make_certificate(folder_.path(), "archive");
        elses_ = test::make_certificate(folder_.path(), "elsewhere", test::Flaw::of_another_computer);
        ours_ = test::make_certificate(folder_.path(), "ours");
        if (its_.key.empty()) GTEST_SKIP() << "the package openssl is not installed";
    }
    /// Orthanc with that certificate; `asks`: it wants to see ours.
    bool begin(const test::Certificate& its, const DicomTls& tls, bool asks = false) {
        archive_ = test::Orthanc::start(
            folder_.path(),
            R"(, "DicomTlsEnabled": true, "DicomTlsCertificate": ")" + its.certificate.string() +
                R"(", "DicomTlsPrivateKey": ")" + its.key.string() + R"(", "DicomTlsTrustedCertificates": ")" +
                ours_.certificate.string() + R"(", "DicomTlsRemoteCertificateRequired": )" + (asks ? "true" : "false"),
            tls);
        return archive_ != nullptr;
    }
    static DicomTls trusting(const test::Certificate& certificate) {
        DicomTls tls;
        tls.wanted = true;
        tls.trusted = certificate.certificate;
        return tls;
    }
    void expect_refused(const DicomTls& tls, const std::string& words) {
        DicomPeer peer = archive_->peer();
        peer.tls = tls;
        peer.patience = std::chrono::seconds(5);
        try {
            ask_whether_it_answers(peer);
            ADD_FAILURE() << "it was talked with, and should be refused: " << words;
        } catch (const DeviceError& fault) {
            const std::string said = std::string(fault.what()) + " " + fault.remedy;
            EXPECT_NE(said.find(words), std::string::npos) << said;
        }
    }
    test::TemporaryFolder folder_;
    test::Certificate its_, elses_, ours_;
    std::unique_ptr<test::Orthanc> archive_;
};

TEST_F(EncryptedArchive, WhoseCertificateIsTrustedIsTalkedWithAsAnyOther) {
    if (!begin(its_, trusting(its_))) GTEST_SKIP() << "the package orthanc is not installed, or it does not start";
    const fs::path series = folder_.path() / "series", got = folder_.path() / "got";
    store_objects(archive_->peer(), test::write_series(test::synthetic_series(test::Grid{}), series));
    const auto found = find_series(archive_->peer(), {});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(fetch_series(archive_->peer(), found[0], got), 24u);
    EXPECT_EQ(hash_of(read_volume(got)), hash_of(read_volume(series)));
    expect_refused(trusting(elses_), "shows a certificate that is not taken: self-signed certificate");
    expect_refused(trusting(elses_), "made out to \"archive\"");
    DicomTls of_the_system;
    of_the_system.wanted = true;
    expect_refused(of_the_system, "is not taken");
    DicomTls another_name = trusting(its_);
    another_name.name = "pacs.example";
    expect_refused(another_name, "ostname mismatch");
    expect_refused({}, "--tls");
}

TEST_F(EncryptedArchive, WhoseCertificateIsMadeOutToAnotherComputerIsRefusedUnlessItsNameIsGiven) {
    DicomTls tls = trusting(elses_);
    tls.name = "another.example";
    if (!begin(elses_, tls)) GTEST_SKIP() << "the package orthanc is not installed, or it does not start";
    EXPECT_NO_THROW(ask_whether_it_answers(archive_->peer()));
    expect_refused(trusting(elses_), "IP address mismatch");
}

TEST_F(EncryptedArchive, ThatAsksWhoWeAreIsShownOurCertificate) {
    DicomTls tls = trusting(its_);
    tls.certificate = ours_.certificate;
    tls.key = ours_.key;
    if (!begin(its_, tls, true)) GTEST_SKIP() << "the package orthanc is not installed, or it does not start";
    EXPECT_NO_THROW(ask_whether_it_answers(archive_->peer()));
    expect_refused(trusting(its_), "certificate of ours");
    tls.certificate = elses_.certificate;
    tls.key = elses_.key;
    expect_refused(tls, "certificate of ours");
}

TEST_F(EncryptedArchive, ALineThatIsNotEncryptedIsNotUsed) {
    archive_ = test::Orthanc::start(folder_.path());
    if (!archive_) GTEST_SKIP() << "the package orthanc is not installed, or it does not start";
    expect_refused(trusting(its_), "does not agree on an encrypted line");
}

TEST_F(EncryptedArchive, FilesThatAreNoCertificatesAreRefused) {
    DicomPeer peer;
    peer.host = "127.0.0.1";
    peer.port = test::free_port();
    peer.title = "ARCHIVE";
    const auto refused = [&](const DicomTls& tls) {
        peer.tls = tls;
        EXPECT_THROW(ask_whether_it_answers(peer), InputError);
    };
    DicomTls tls = trusting(its_);
    tls.trusted = folder_.path() / "not-there.pem";
    refused(tls);
    tls = trusting(its_);
    tls.trusted = its_.key;  // a key is no certificate
    refused(tls);
    tls = trusting(its_);
    tls.certificate = ours_.certificate;  // without its key
    refused(tls);
    tls.key = its_.key;  // another's
    refused(tls);
    tls = trusting(its_);
    tls.wanted = false;
    refused(tls);
}

}  // namespace
}  // namespace planlight
