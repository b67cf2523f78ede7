// A series from an archive to a case, and what came of the operation back into it, by the program as it is called.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "app/export/export_study.h"
#include "app/prepare_case.h"
#include "planning_io/volume/read_volume.h"
#include "tests/app/run_command.h"
#include "tests/planning_io/dicom_net/archive_process.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::run_planlight;

/// A place on the phantom's front.
Vector3d place() {
    Vector3d at{20, -96, 0};
    while (at.y() < 0 && test::phantom_hu(at) < -300) at.y() += 0.5;
    return at;
}

ExportedOperation invented_match(const Case& the_case) {
    ExportedOperation operation;
    operation.match.verdict = Verdict::yes;
    operation.match.patient_from_ct = Eigen::Translation3d(12, -340, 901) * RigidTransform::Identity();
    operation.match.of_case = name_of(the_case);
    operation.match.covariance.of_turn_and_shift.setIdentity();
    operation.made = "2026-01-02T09:30:00Z";
    return operation;
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
    const auto stored = run("store series --json");
    ASSERT_EQ(stored.exit_code, 0) << stored.err;
    EXPECT_EQ(nlohmann::json::parse(stored.out)["stored"], 24);

    const auto listed = run("fetch --patient-id 'PHANTOM*' --json");
    ASSERT_EQ(listed.exit_code, 0) << listed.err;
    const auto series = nlohmann::json::parse(listed.out);
    ASSERT_EQ(series.size(), 1u);
    const auto fetched = run("fetch --series " + series[0]["series_uid"].get<std::string>() + " --out got");
    ASSERT_EQ(fetched.exit_code, 0) << fetched.err;

    Plan plan;
    plan.boreholes.push_back({"hole", place(), Vector3d(0, 1, 0), 7, 5, {}});
    const Volume volume = read_volume(folder_.path() / "got");
    EXPECT_EQ(hash_of(volume), hash_of(read_volume(folder_.path() / "series")));
    const Case prepared = prepare_case(volume, plan, {}, {}, "2026-01-02").prepared;
    export_into_study(prepared, invented_match(prepared), folder_.path() / "got", {}, folder_.path() / "for-pacs");
    const auto sent = run("store for-pacs");
    ASSERT_EQ(sent.exit_code, 0) << sent.err;

    const auto study = run("fetch --study " + series[0]["study_uid"].get<std::string>() + " --json");
    std::set<std::string> modalities;
    for (const auto& one : nlohmann::json::parse(study.out)) {
        modalities.insert(one["modality"].get<std::string>());
        EXPECT_EQ(one["patient_id"], "PHANTOM-1");
    }
    EXPECT_TRUE(modalities.contains("CT"));
    EXPECT_TRUE(modalities.contains("REG"));
}

TEST_F(ArchiveCommands, RefusalsHaveTheirExitCodes) {
    expect_refused(run("fetch --patient-id NOBODY --out got"), 3, "finds no such series");
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
