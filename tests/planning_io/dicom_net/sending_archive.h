#pragma once

#include <gtest/gtest.h>

#include "planning_io/types/error.h"
#include "tests/planning_io/dicom_net/archive_process.h"
#include "tests/planning_io/dicom_net/scripted_archive.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight::test {

/// A series of 24 images and an archive that is to send it (C-MOVE), as each test tells it.
class SendingArchive : public ::testing::Test {
protected:
    static constexpr unsigned kDone = 0, kFailed = 0xA702;

    /// Us, as the archive calls us by its title.
    DicomPeer us(const std::string& its_title = "ARCHIVE") const {
        DicomPeer called;
        called.host = "127.0.0.1";
        called.port = port_;
        called.title = "PLANLIGHT";
        called.own_title = its_title;
        return called;
    }
    /// Sends all of them to that one. Gives the status of the end.
    unsigned send(const DicomPeer& called) const {
        try {
            store_objects(called, files_);
            return kDone;
        } catch (const Error&) {
            return kFailed;
        }
    }
    void begin(const std::function<unsigned()>& moves, const DicomTls& its_tls = {}, const DicomTls& our_tls = {}) {
        archive_ = std::make_unique<ScriptedArchive>(ScriptedArchive::Script{answers_, moves, its_tls});
        peer_ = archive_->peer();
        peer_.own_port = port_;
        peer_.tls = our_tls;
    }
    std::size_t fetch(const std::function<void(std::size_t, std::size_t)>& progress = {}) {
        return fetch_series(peer_, series_, got_, progress);
    }
    /// What it was refused for, as an Error of that kind; nothing is left of it.
    template <typename Kind>
    void expect_refused(const std::string& words) {
        try {
            fetch();
            ADD_FAILURE() << "it was fetched, and should be refused: " << words;
        } catch (const Kind& fault) {
            const std::string said = std::string(fault.what()) + " " + fault.remedy;
            EXPECT_NE(said.find(words), std::string::npos) << said;
        }
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
            EXPECT_FALSE(entry.path().filename().string().starts_with("got")) << entry.path();
    }
    std::size_t files_that_came() const {
        return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(got_), {}));
    }

    TemporaryFolder folder_;
    const std::filesystem::path got_ = folder_.path() / "got";
    const std::vector<std::filesystem::path> files_ = write_series(synthetic_series(Grid{}), folder_.path() / "series");
    std::vector<Answer> answers_ = answers_of(files_);
    const FoundSeries series_ = series_of(answers_);
    const int port_ = free_port();
    DicomPeer peer_;
    std::unique_ptr<ScriptedArchive> archive_;
};

}  // namespace planlight::test
