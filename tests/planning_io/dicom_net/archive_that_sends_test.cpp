// An archive that lets nothing be fetched, and sends it instead (C-MOVE): DCMTK's dcmqrscp without C-GET.
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

class ArchiveThatSends : public ::testing::Test {
protected:
    /// `knows_us`: it has our title and `port_` in its table.
    void begin(bool knows_us) {
        archive_ = test::Dcmqrscp::start(folder_.path(), true, knows_us ? port_ : 0);
        if (!archive_) GTEST_SKIP() << "the package dcmtk is not installed, or dcmqrscp does not start";
        peer_ = archive_->peer();
        peer_.own_port = port_;
        store_objects(peer_, test::write_series(test::synthetic_series(test::Grid{}), series_));
        const auto all = find_series(peer_, {});
        ASSERT_EQ(all.size(), 1u);
        found_ = all[0];
    }
    /// What it was refused for; nothing is left of it.
    std::string refused() {
        try {
            fetch_series(peer_, found_, got_);
        } catch (const Error& fault) {
            EXPECT_FALSE(fs::exists(got_));
            for (const auto& entry : fs::directory_iterator(folder_.path()))
                EXPECT_FALSE(entry.path().filename().string().starts_with("got")) << entry.path();
            return std::string(fault.what()) + " " + fault.remedy;
        }
        return "not refused";
    }
    void expect_refused(const std::string& words) {
        const std::string why = refused();
        EXPECT_NE(why.find(words), std::string::npos) << why;
    }
    test::TemporaryFolder folder_;
    const fs::path series_ = folder_.path() / "series", got_ = folder_.path() / "got";
    const int port_ = test::free_port();
    std::unique_ptr<test::Dcmqrscp> archive_;
    DicomPeer peer_;
    FoundSeries found_;
};

TEST_F(ArchiveThatSends, GivesASeriesBitForBit) {
    begin(true);
    if (IsSkipped()) return;
    std::size_t last = 0;
    EXPECT_EQ(fetch_series(peer_, found_, got_, [&](std::size_t done, std::size_t) { last = done; }), 24u);
    EXPECT_EQ(last, 24u);
    EXPECT_EQ(hash_of(read_volume(got_)), hash_of(read_volume(series_)));
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(got_)) {
        EXPECT_EQ(entry.path().extension(), ".dcm") << entry.path();
        ++files;
    }
    EXPECT_EQ(files, 24u);
    EXPECT_EQ(fetch_series(peer_, found_, folder_.path() / "again"), 24u) << "the port is free again";
}

TEST_F(ArchiveThatSends, IsAskedForNothingWithoutAPortOfOurs) {
    begin(true);
    if (IsSkipped()) return;
    peer_.own_port = 0;
    expect_refused("--own-port");
}

TEST_F(ArchiveThatSends, ThatDoesNotKnowUsIsSaid) {
    begin(false);
    if (IsSkipped()) return;
    expect_refused("does not know where PLANLIGHT is");
}

TEST_F(ArchiveThatSends, ThatCallsElsewhereIsSaid) {
    begin(true);
    if (IsSkipped()) return;
    peer_.own_port = test::free_port();
    expect_refused("It never called");
}

TEST_F(ArchiveThatSends, ToAPortThatAnotherProgramHasIsSaid) {
    begin(true);
    if (IsSkipped()) return;
    const test::CutLine other(peer_.port, 0, 0);
    peer_.own_port = other.port();
    expect_refused("cannot be listened on");
}

TEST_F(ArchiveThatSends, HalfASeriesLeavesNothing) {
    begin(true);
    if (IsSkipped()) return;
    for (const auto& entry : fs::directory_iterator(archive_->storage()))
        if (entry.path().filename() != "index.dat") {
            fs::remove(entry.path());
            break;
        }
    expect_refused("of the 24 images");
}

}  // namespace
}  // namespace planlight
