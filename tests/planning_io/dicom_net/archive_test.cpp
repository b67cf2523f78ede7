// Debian's orthanc as the archive, and programs that are worse ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "planning_io/dicom_net/dicom_peer.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/dicom_net/archive_process.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using test::CutLine;
using test::Orthanc;

constexpr std::size_t kEverything = std::size_t(1) << 40;

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    return files;
}

/// What stands at the end of each file: the pixels of a slice as they are stored.
std::set<std::string> pixels_of(const fs::path& folder, std::size_t bytes) {
    std::set<std::string> pixels;
    for (const fs::path& file : files_in(folder)) {
        const std::string whole = read_whole(file);
        pixels.insert(whole.substr(whole.size() - std::min(bytes, whole.size())));
    }
    return pixels;
}

/// An empty archive, a series of 24 slices as files, and somewhere to fetch to.
class Archive : public ::testing::Test {
protected:
    void SetUp() override {
        archive_ = Orthanc::start(folder_.path());
        if (!archive_) GTEST_SKIP() << "the package orthanc is not installed, or it does not start";
        files_ = test::write_series(test::synthetic_series(grid_), series_);
    }
    void store() { EXPECT_TRUE(store_objects(archive_->peer(), files_).empty()); }
    FoundSeries found() {
        SeriesQuery query;
        query.patient_id = "PHANTOM-1";
        const auto all = find_series(archive_->peer(), query);
        EXPECT_EQ(all.size(), 1u);
        return all.empty() ? FoundSeries{} : all.front();
    }
    /// Nothing is there, and nothing beside it.
    void expect_nothing_left() {
        EXPECT_FALSE(fs::exists(got_));
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            EXPECT_FALSE(entry.path().filename().string().starts_with("got")) << entry.path();
    }
    test::Grid grid_;
    test::TemporaryFolder folder_;
    fs::path series_ = folder_.path() / "series", got_ = folder_.path() / "got";
    std::vector<fs::path> files_;
    std::unique_ptr<Orthanc> archive_;
};

/// The rest of it comes to the archive while its first part is fetched: at one end, where no gap would show it.
TEST_F(Archive, ASeriesThatIsStillBeingSentIsNotTakenForWhole) {
    const std::vector<fs::path> first(files_.begin(), files_.end() - 4), rest(files_.end() - 4, files_.end());
    EXPECT_TRUE(store_objects(archive_->peer(), first).empty());
    bool sent = false;
    EXPECT_THROW(fetch_series(archive_->peer(), found(), got_,
                              [&](std::size_t, std::size_t) {
                                  if (!std::exchange(sent, true)) store_objects(archive_->peer(), rest);
                              }),
                 CheckFailedError);
    expect_nothing_left();
    EXPECT_EQ(fetch_series(archive_->peer(), found(), got_), files_.size());
}

/// It names the patient.
TEST_F(Archive, WhatIsFetchedIsNobodyElsesToReadFromItsFirstImageOn) {
    store();
    std::size_t looked = 0;
    const auto expect_ours_alone = [&](const fs::path& folder) {
        ++looked;
        EXPECT_EQ(fs::status(folder).permissions() & fs::perms::all, fs::perms::owner_all) << folder;
    };
    fetch_series(archive_->peer(), found(), got_, [&](std::size_t, std::size_t) {
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            if (entry.path().filename().string().starts_with("got")) expect_ours_alone(entry.path());
    });
    EXPECT_EQ(looked, files_.size());
    expect_ours_alone(got_);
}

TEST_F(Archive, ASeriesThatIsStoredIsFoundAndFetchedBitForBit) {
    store();
    const FoundSeries series = found();
    EXPECT_EQ(series.modality, "CT");
    EXPECT_EQ(series.description, "Head thin");
    EXPECT_EQ(series.patient_name, "Test^Phantom");
    EXPECT_EQ(series.images, "24");
    std::size_t last = 0;
    EXPECT_EQ(fetch_series(archive_->peer(), series, got_, [&](std::size_t done, std::size_t) { last = done; }), 24u);
    EXPECT_EQ(last, 24u);
    const std::size_t slice = 64 * 64 * 2;
    EXPECT_EQ(pixels_of(got_, slice), pixels_of(series_, slice));
    EXPECT_EQ(hash_of(read_volume(got_)), hash_of(read_volume(series_)));
}

class PackedInArchive : public Archive,
                        public ::testing::WithParamInterface<std::pair<test::DicomPacking, const char*>> {};

TEST_P(PackedInArchive, IsFetchedAsItIs) {
    for (const fs::path& file : files_) ASSERT_TRUE(test::pack_dicom(file, GetParam().first));
    store();
    EXPECT_EQ(fetch_series(archive_->peer(), found(), got_), 24u);
    EXPECT_EQ(hash_of(read_volume(got_)), hash_of(read_volume(series_)));
    for (const fs::path& file : files_in(got_))
        EXPECT_NE(read_whole(file).find(GetParam().second), std::string::npos) << "its transfer syntax is another";
}

INSTANTIATE_TEST_SUITE_P(Lossless, PackedInArchive,
                         ::testing::Values(std::pair{test::DicomPacking::jpeg_ls, "1.2.840.10008.1.2.4.80"},
                                           std::pair{test::DicomPacking::jpeg_2000, "1.2.840.10008.1.2.4.90"},
                                           std::pair{test::DicomPacking::rle, "1.2.840.10008.1.2.5"}));

TEST_F(Archive, OneOfSeveralSeriesIsFoundByWhatIsKnownOfIt) {
    store();
    test::SeriesLook other;
    other.uid = "1.2.826.0.1.3680043.9.9999.7.2";
    other.modality = "MR";
    other.description = "T1";
    store_objects(archive_->peer(), test::write_series(test::synthetic_series(grid_, other), folder_.path() / "other"));
    const auto count = [&](const auto& set) {
        SeriesQuery query;
        set(query);
        return find_series(archive_->peer(), query).size();
    };
    EXPECT_EQ(count([](SeriesQuery&) {}), 2u);
    EXPECT_EQ(count([](SeriesQuery& q) { q.modality = "MR"; }), 1u);
    EXPECT_EQ(count([](SeriesQuery& q) { q.patient_name = "Test*"; }), 2u);
    EXPECT_EQ(count([&](SeriesQuery& q) { q.series_uid = other.uid; }), 1u);
    EXPECT_EQ(count([](SeriesQuery& q) { q.patient_id = "SOMEBODY-ELSE"; }), 0u);
}

TEST_F(Archive, ATitleThatItDoesNotHaveIsRefusedByName) {
    DicomPeer wrong = archive_->peer();
    wrong.title = "ANOTHER";
    try {
        ask_whether_it_answers(wrong);
        FAIL() << "answers to a name that is not its own";
    } catch (const DeviceError& fault) {
        EXPECT_NE(std::string(fault.what()).find("refuses to talk with PLANLIGHT"), std::string::npos) << fault.what();
        EXPECT_NE(fault.remedy.find("AE titles"), std::string::npos);
    }
}

TEST_F(Archive, AStrangersTitleIsRefused) {
    DicomPeer stranger = archive_->peer();
    stranger.own_title = "STRANGER";
    EXPECT_THROW(store_objects(stranger, files_), Error);
    EXPECT_THROW(find_series(stranger, {}), Error);
}

TEST_F(Archive, ASeriesThatIsNotThereLeavesNothing) {
    FoundSeries none;
    none.study_uid = "1.2.3";
    none.series_uid = "1.2.3.4";
    EXPECT_THROW(fetch_series(archive_->peer(), none, got_), InputError);
    expect_nothing_left();
}

TEST_F(Archive, OneThatIsGoneInTheMiddleLeavesNothing) {
    store();
    const FoundSeries series = found();
    for (const std::size_t bytes : {3000, 20000, 100000, 180000}) {
        const CutLine line(archive_->peer().port, bytes, kEverything);
        DicomPeer cut = archive_->peer();
        cut.port = line.port();
        EXPECT_THROW(fetch_series(cut, series, got_), DeviceError) << bytes;
        expect_nothing_left();
    }
    EXPECT_EQ(fetch_series(archive_->peer(), series, got_), 24u);
}

TEST_F(Archive, ALineThatIsCutInTheMiddleIsNotTakenForOneThatWantsToBeEncrypted) {
    store();
    const FoundSeries series = found();
    const CutLine line(archive_->peer().port, 100000, kEverything);
    DicomPeer cut = archive_->peer();
    cut.port = line.port();
    try {
        fetch_series(cut, series, got_);
        FAIL() << "the line was cut";
    } catch (const DeviceError& fault) {
        EXPECT_NE(std::string(fault.what()).find("gone in the middle"), std::string::npos) << fault.what();
        EXPECT_EQ(fault.remedy.find("--tls"), std::string::npos) << fault.remedy;
    }
}

/// The last bytes of an image are written when its file is closed: 8192 is where only these are missing.
TEST_F(Archive, AFullDiskIsNotTheArchivesFault) {
    store();
    const FoundSeries series = found();
    for (const std::size_t bytes : {4096, 8192}) {
        const test::FullDisk disk(bytes);
        EXPECT_THROW(fetch_series(archive_->peer(), series, got_), DiskError) << bytes;
        expect_nothing_left();
    }
    EXPECT_EQ(fetch_series(archive_->peer(), series, got_), files_.size());
}

TEST_F(Archive, WhatWasCutIsStoredWholeTheNextTime) {
    {
        const CutLine line(archive_->peer().port, kEverything, 100000);
        DicomPeer cut = archive_->peer();
        cut.port = line.port();
        try {
            store_objects(cut, files_);
            FAIL() << "the line was cut";
        } catch (const DeviceError& fault) {
            EXPECT_NE(std::string(fault.what()).find("of 24 objects"), std::string::npos) << fault.what();
        }
    }
    store();
    EXPECT_EQ(found().images, "24");
}

TEST_F(Archive, AFolderWithSomethingInItIsNotTouched) {
    store();
    fs::create_directories(got_);
    std::ofstream(got_ / "mine") << "mine";
    EXPECT_THROW(fetch_series(archive_->peer(), found(), got_), InputError);
    EXPECT_EQ(files_in(got_).size(), 1u);
}

TEST_F(Archive, AFileThatIsNoDicomIsRefusedBeforeAnythingIsSent) {
    std::ofstream(series_ / "notes.txt") << "not DICOM";
    files_.push_back(series_ / "notes.txt");
    EXPECT_THROW(store_objects(archive_->peer(), files_), InputError);
    EXPECT_TRUE(find_series(archive_->peer(), {}).empty());
}

DicomPeer peer_at(int port) {
    DicomPeer peer;
    peer.host = "127.0.0.1";
    peer.port = port;
    peer.title = "ARCHIVE";
    peer.patience = std::chrono::seconds(5);
    return peer;
}

TEST(NoArchive, AClosedPortIsSaid) {
    try {
        ask_whether_it_answers(peer_at(test::free_port()));
        FAIL() << "nobody answered";
    } catch (const DeviceError& fault) {
        EXPECT_NE(std::string(fault.what()).find("cannot be reached"), std::string::npos) << fault.what();
    }
}

TEST(NoArchive, AHostThatIsNoneIsSaid) {
    DicomPeer peer = peer_at(104);
    peer.host = "no-such-host.invalid";
    EXPECT_THROW(ask_whether_it_answers(peer), DeviceError);
}

TEST(NoArchive, OneThatRefusesEverybodyIsSaid) {
    if (!fs::exists("/usr/bin/storescp")) GTEST_SKIP() << "the package dcmtk is not installed";
    const test::TemporaryFolder folder;
    const int port = test::free_port();
    const test::RunningProgram refusing({"/usr/bin/storescp", "--refuse", std::to_string(port)}, folder.path() / "log");
    std::string said;
    for (int attempt = 0; attempt < 100 && said.find("refuses") == std::string::npos; ++attempt) {
        try {
            ask_whether_it_answers(peer_at(port));
            said = "answers";
        } catch (const DeviceError& fault) {
            said = fault.what();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    EXPECT_NE(said.find("refuses"), std::string::npos) << said;
}

TEST(NoArchive, OneThatOnlyTakesIsSaidWhenItIsSearched) {
    if (!fs::exists("/usr/bin/storescp")) GTEST_SKIP() << "the package dcmtk is not installed";
    const test::TemporaryFolder folder;
    const int port = test::free_port();
    const test::RunningProgram taking(
        {"/usr/bin/storescp", "--output-directory", folder.path().string(), std::to_string(port)},
        folder.path() / "log");
    bool refused = false;
    for (int attempt = 0; attempt < 100 && !refused; ++attempt) {
        try {
            find_series(peer_at(port), {});
            FAIL() << "it searches";
        } catch (const CheckFailedError&) {
            refused = true;
        } catch (const DeviceError&) {  // it is still starting
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
    }
    EXPECT_TRUE(refused);
}

TEST(NoArchive, HalfASeriesIsRefusedAndLeavesNothing) {
    const test::TemporaryFolder folder;
    const auto archive = test::Dcmqrscp::start(folder.path(), false, 0);
    if (!archive) GTEST_SKIP() << "the package dcmtk is not installed, or dcmqrscp does not start";
    const fs::path kept = archive->storage(), got = folder.path() / "got";
    const DicomPeer& peer = archive->peer();
    store_objects(peer, test::write_series(test::synthetic_series(test::Grid{}), folder.path() / "series"));
    const auto found = find_series(peer, {});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(fetch_series(peer, found[0], folder.path() / "whole"), 24u);
    for (const fs::path& file : files_in(kept))
        if (file.filename() != "index.dat") {
            fs::remove(file);
            break;
        }
    try {
        fetch_series(peer, found[0], got);
        FAIL() << "half a series is taken";
    } catch (const CheckFailedError& fault) {
        EXPECT_NE(std::string(fault.what()).find("of the 24 images"), std::string::npos) << fault.what();
    }
    EXPECT_FALSE(fs::exists(got));
    for (const auto& entry : fs::directory_iterator(folder.path()))
        EXPECT_FALSE(entry.path().filename().string().starts_with("got")) << entry.path();
}

TEST(NoArchive, WhatIsNoTitleHostOrPortIsRefused) {
    DicomPeer peer = peer_at(104);
    EXPECT_NO_THROW(check_peer(peer));
    for (const char* title : {"", "OF MORE THAN SIXTEEN", "WITH SPACE", "BACK\\SLASH"}) {
        peer.title = title;
        EXPECT_THROW(check_peer(peer), InputError) << title;
    }
    peer = peer_at(0);
    EXPECT_THROW(check_peer(peer), InputError);
    peer = peer_at(104);
    peer.host = "";
    EXPECT_THROW(check_peer(peer), InputError);
}

}  // namespace
}  // namespace planlight
