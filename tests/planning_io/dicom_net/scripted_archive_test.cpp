// An archive that is told what to do, asked for images that it sends (C-MOVE).
#include <fstream>
#include <future>
#include <thread>

#include "planning_io/dicom_net/dicom_association.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/dicom_net/sending_archive.h"

namespace planlight {
namespace {

using test::SendingArchive;
using namespace std::chrono_literals;

TEST_F(SendingArchive, IsNotGivenUpWhileItsImagesComeThoughItSaysNothing) {
    begin([&] {
        for (const auto& file : files_) {
            store_objects(us(), {file});
            std::this_thread::sleep_for(120ms);  // 24 of them: more than our patience, and each less
        }
        return kDone;
    });
    peer_.patience = 2s;
    EXPECT_EQ(fetch(), files_.size());
    EXPECT_EQ(hash_of(read_volume(got_)), hash_of(read_volume(folder_.path() / "series")));
}

TEST_F(SendingArchive, IsGivenUpWhenNothingComesAnyMore) {
    std::promise<void> given_up;
    begin([&] {
        store_objects(us(), {files_[0]});
        given_up.get_future().wait();
        return kFailed;
    });
    peer_.patience = 1s;
    expect_refused<DeviceError>("gave no answer");
    given_up.set_value();
}

/// As some archives do, for the next one that asks.
TEST_F(SendingArchive, ThatKeepsItsLineOpenIsNotWaitedFor) {
    std::unique_ptr<DicomAssociation> kept;
    begin([&] {
        kept = std::make_unique<DicomAssociation>(us());
        kept->propose(UID_CTImageStorage, plain_transfer_syntaxes());
        kept->open();
        for (const auto& file : files_) {
            Uint16 status = 0xFFFF;
            kept->sendSTORERequest(kept->accepted(UID_CTImageStorage, ""), file.c_str(), nullptr, status);
        }
        return kDone;
    });
    peer_.patience = 600s;  // longer than the test may take
    EXPECT_EQ(fetch(), files_.size());
}

TEST_F(SendingArchive, AStrangerWhoCallsMeanwhileIsNotTaken) {
    begin([&] {
        EXPECT_THROW(store_objects(us("STRANGER"), {files_[0]}), DeviceError);
        return send(us());
    });
    EXPECT_EQ(fetch(), files_.size());
}

TEST_F(SendingArchive, ThatSendsByAnotherTitleIsSaidByIt) {
    begin([&] { return send(us("STORE_SCU")); });
    expect_refused<DeviceError>("is STORE_SCU, and ARCHIVE was asked to send");
}

TEST_F(SendingArchive, ThatHasAnotherTitleOfOursIsSaidByIt) {
    begin([&] {
        DicomPeer called = us();
        called.title = "OLD_NAME";
        return send(called);
    });
    expect_refused<DeviceError>("asked for OLD_NAME, and here is PLANLIGHT");
}

TEST_F(SendingArchive, AFullDiskIsNotItsFault) {
    begin([&] { return send(us()); });
    peer_.patience = 2s;
    for (const std::size_t bytes : {4096, 8192}) {
        const test::FullDisk disk(bytes);
        expect_refused<DiskError>("the disk did not take an image");
    }
    EXPECT_EQ(fetch(), files_.size());
}

/// The same over TLS: the archive calls us as it is called, with certificates on both sides.
class EncryptedSendingArchive : public SendingArchive {
protected:
    void SetUp() override {
        its_ = test::make_certificate(folder_.path(), "archive");
        ours_ = test::make_certificate(folder_.path(), "ours");
        elses_ = test::make_certificate(folder_.path(), "elsewhere");
        if (its_.key.empty()) GTEST_SKIP() << "the package openssl is not installed";
        it_ = showing(its_, ours_);
        we_ = showing(ours_, its_);
    }
    static DicomTls showing(const test::Certificate& shown, const test::Certificate& trusted) {
        return {true, trusted.certificate, shown.certificate, shown.key, {}};
    }
    /// The archive is asked as it should be, and calls us in that way.
    void begin_and_call_back(const DicomTls& by) {
        begin(
            [this, by] {
                DicomPeer called = us();
                called.tls = by;
                return send(called);
            },
            it_, we_);
    }
    test::Certificate its_, ours_, elses_;
    DicomTls it_, we_;
};

TEST_F(EncryptedSendingArchive, GivesASeriesBitForBit) {
    begin_and_call_back(it_);
    EXPECT_EQ(fetch(), files_.size());
    EXPECT_EQ(hash_of(read_volume(got_)), hash_of(read_volume(folder_.path() / "series")));
}

TEST_F(EncryptedSendingArchive, ToWhomWeHaveNoCertificateToShowIsNotAsked) {
    we_.certificate.clear();
    we_.key.clear();
    const test::ScriptedArchive::Script script{answers_, [] { return kFailed; }, it_, false};
    archive_ = std::make_unique<test::ScriptedArchive>(script);
    peer_ = archive_->peer();
    peer_.own_port = port_;
    peer_.tls = we_;
    expect_refused<InputError>("must be shown a certificate");
}

TEST_F(EncryptedSendingArchive, ThatCallsWithAnothersCertificateIsSaid) {
    begin_and_call_back(showing(elses_, ours_));
    expect_refused<DeviceError>("shows a certificate that is not taken: self-signed certificate");
}

TEST_F(EncryptedSendingArchive, ThatCallsWithoutACertificateIsSaid) {
    DicomTls without = it_;
    without.certificate.clear();
    without.key.clear();
    begin_and_call_back(without);
    expect_refused<DeviceError>("peer did not return a certificate");
}

TEST_F(EncryptedSendingArchive, ThatCallsWithoutEncryptingIsSaid) {
    begin_and_call_back({});
    expect_refused<DeviceError>("does not encrypt it");
}

TEST_F(EncryptedSendingArchive, ThatDoesNotTrustOursIsSaid) {
    begin_and_call_back(showing(its_, elses_));
    expect_refused<DeviceError>("unknown ca");
}

TEST_F(EncryptedSendingArchive, WhoseCertificateHasRunOutIsSaidToBeOfAnotherDay) {
    const test::Certificate old = test::make_certificate(folder_.path(), "old", test::Flaw::has_run_out);
    it_ = showing(old, ours_);
    we_ = showing(ours_, old);
    begin_and_call_back(it_);
    expect_refused<DeviceError>("does not hold today: certificate has expired");
    expect_refused<DeviceError>("clock");
}

TEST_F(EncryptedSendingArchive, ThatEncryptsWhereWeDoNotIsSaid) {
    begin([&] {
        DicomPeer called = us();
        called.tls = it_;
        return send(called);
    });
    expect_refused<DeviceError>("It may want the line to be encrypted (--tls).");
}

}  // namespace
}  // namespace planlight
