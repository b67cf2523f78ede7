// A series from an archive to a case, and what came of the operation back into it, by the program as it is called.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "app/export/export_study.h"
#include "app/report/operation_pdf.h"
#include "planning_io/volume/read_volume.h"
#include "tests/app/exported_phantom.h"
#include "tests/app/run_command.h"
#include "tests/planning_io/dicom_net/archive_process.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using test::run_planlight;

/// How many objects lie there; none of them lacks what the standard asks of its kind.
int look_at_all(const fs::path& folder) {
    int objects = 0;
    for (const auto& file : fs::directory_iterator(folder)) {
        ++objects;
        const fs::path said = folder.parent_path() / "said";
        const std::string command = "dciodvfy '" + file.path().string() + "' > '" + said.string() + "' 2>&1";
        EXPECT_NE(std::system(command.c_str()), -1);
        EXPECT_EQ(test::whole(said).find("Error"), std::string::npos) << test::whole(said);
    }
    return objects;
}

class ArchiveCommands : public ::testing::Test {
protected:
    void SetUp() override {
        archive_ = test::Orthanc::start(folder_.path());
        if (!archive_) GTEST_SKIP() << "the package orthanc is not installed, or it does not start";
        test::write_series(test::synthetic_series(test::Grid{}), folder_.path() / "series");
        fs::create_directories(folder_.path() / "planlight");
        say_in_settings("ARCHIVE");
    }
    void say_in_settings(const std::string& title) {
        std::ofstream(folder_.path() / "planlight" / "config.json")
            << R"({"format": "planlight config", "version": 1, "dicom": {"host": "127.0.0.1", "title": ")" << title
            << R"(", "port": )" << archive_->peer().port << "}}";
    }
    test::CommandRun run(const std::string& arguments) {
        return run_planlight(arguments, folder_.path(), "export XDG_CONFIG_HOME=$PWD && ");
    }
    test::TemporaryFolder folder_;
    std::unique_ptr<test::Orthanc> archive_;
};

TEST_F(ArchiveCommands, ASeriesBecomesACaseAndWhatCameOfItIsFoundBesideIt) {
    EXPECT_EQ(run("fetch --check").exit_code, 0);
    const auto checked = run("fetch --check --json");
    ASSERT_EQ(checked.exit_code, 0) << checked.err;
    EXPECT_EQ(nlohmann::json::parse(checked.out)["answers"], true);
    const auto stored = run("store series --json");
    ASSERT_EQ(stored.exit_code, 0) << stored.err;
    EXPECT_EQ(nlohmann::json::parse(stored.out)["stored"], 24);

    const auto listed = run("fetch --patient-id 'PHANTOM*' --json");
    ASSERT_EQ(listed.exit_code, 0) << listed.err;
    const auto series = nlohmann::json::parse(listed.out);
    ASSERT_EQ(series.size(), 1u);
    const auto fetched = run("fetch --series " + series[0]["series_uid"].get<std::string>() + " --out got");
    ASSERT_EQ(fetched.exit_code, 0) << fetched.err;

    const test::ExportedPhantom& phantom = test::exported_phantom();
    EXPECT_EQ(hash_of(read_volume(folder_.path() / "got")), hash_of(read_volume(folder_.path() / "series")));
    export_into_study(phantom.prepared, phantom.operation, folder_.path() / "got", {}, folder_.path() / "for-pacs");
    const auto sent = run("store for-pacs");
    ASSERT_EQ(sent.exit_code, 0) << sent.err;

    const auto study = run("fetch --study " + series[0]["study_uid"].get<std::string>() + " --json");
    std::map<std::string, std::string> series_of;
    for (const auto& one : nlohmann::json::parse(study.out)) {
        series_of[one["modality"]] = one["series_uid"];
        EXPECT_EQ(one["patient_id"], "PHANTOM-1");
    }
    for (const auto& [modality, objects] : {std::pair{"REG", 1}, {"DOC", 1}, {"OT", 5}}) {
        ASSERT_TRUE(series_of.contains(modality)) << study.out;
        const auto back = run("fetch --series " + series_of[modality] + " --out back-" + modality);
        ASSERT_EQ(back.exit_code, 0) << back.err;
        EXPECT_EQ(look_at_all(folder_.path() / (std::string("back-") + modality)), objects) << modality;
    }
    const fs::path document = fs::directory_iterator(folder_.path() / "back-DOC")->path(),
                   pdf = folder_.path() / "back.pdf";
    if (std::system(("dcm2pdf '" + document.string() + "' '" + pdf.string() + "'").c_str()) != 0)
        GTEST_SKIP() << "dcmtk is not installed";
    const std::string wanted = operation_pdf(*phantom.operation.facts, PaperSize::a4);
    EXPECT_EQ(test::whole(pdf).substr(0, wanted.size()), wanted) << "the report as it was written";
}

TEST_F(ArchiveCommands, RefusalsHaveTheirExitCodes) {
    expect_refused(run("fetch --patient-id NOBODY --out got"), 3, "finds no such series");
    expect_refused(run("fetch --date 2026-01-01"), 2, "is no day");
    expect_refused(run("fetch --date 20261399"), 2, "is no day");
    EXPECT_FALSE(fs::exists(folder_.path() / "got"));
    expect_refused(run("fetch --check --title ANOTHER"), 5, "refuses to talk");
    expect_refused(run("fetch --check --port " + std::to_string(test::free_port())), 5, "cannot be reached");
    expect_refused(run("store nothing-here"), 3, "nothing-here");
    say_in_settings("");
    expect_refused(run("fetch --check"), 3, "AE title");
    ASSERT_EQ(run("store series --title ARCHIVE").exit_code, 0);
    test::SeriesLook other;
    other.uid = "1.2.826.0.1.3680043.9.9999.7.2";
    test::write_series(test::synthetic_series(test::Grid{}, other), folder_.path() / "other");
    ASSERT_EQ(run("store other --title ARCHIVE").exit_code, 0);
    expect_refused(run("fetch --title ARCHIVE"), 2, "nothing says");
    expect_refused(run("fetch --patient-id PHANTOM-1 --title ARCHIVE --out got"), 3, "2 series are found");
}

}  // namespace
}  // namespace planlight
