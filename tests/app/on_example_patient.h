#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tests/app/run_command.h"
#include "tests/support/test_data.h"

namespace planlight::test {

/// Tests of commands on the example patient, in one folder of their own; skipped where its package is not installed.
class CommandsTest : public ::testing::Test {
protected:
    static void SetUpTestSuite();
    static void TearDownTestSuite();
    void SetUp() override;

    static const std::filesystem::path& root() { return folder_->path(); }
    /// `planlight prepare` of the example patient and plan, run by the first test that asks: the folder "case" and what
    /// it printed as JSON. Throws when it failed.
    static const CommandRun& prepared();
    /// The same of `planlight simulate`: the folder "room", paper's preset, four frames.
    static const CommandRun& simulated();
    /// The room's true pose at the scan.
    static Eigen::Matrix4d true_rig_from_ct();

    static std::string patient();  ///< the example patient's file
    static std::string plan();     ///< the example plan's

private:
    static std::unique_ptr<TemporaryFolder> folder_;
    static std::unique_ptr<CommandRun> prepared_, simulated_;
};

nlohmann::json read_json(const std::filesystem::path& file);
std::string read_text(const std::filesystem::path& file);

/// Four rows of four numbers.
Eigen::Matrix4d matrix_of(const nlohmann::json& rows);

/// One sentence that says the problem and the remedy, and nothing else: no stack, no second line.
void expect_one_clear_sentence(const CommandRun& run, int exit_code, const std::string& about);

}  // namespace planlight::test
