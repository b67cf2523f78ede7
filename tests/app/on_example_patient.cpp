#include "tests/app/on_example_patient.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace planlight::test {

namespace fs = std::filesystem;
using nlohmann::json;

std::unique_ptr<TemporaryFolder> CommandsTest::folder_;
std::unique_ptr<CommandRun> CommandsTest::prepared_, CommandsTest::simulated_;

namespace {

const CommandRun& once(std::unique_ptr<CommandRun>& run, const std::string& arguments, const fs::path& folder) {
    if (!run) run = std::make_unique<CommandRun>(run_planlight(arguments, folder));
    if (run->exit_code != 0) throw std::runtime_error("planlight " + arguments + ": " + run->err);
    return *run;
}

}  // namespace

void CommandsTest::SetUpTestSuite() {
    if (example_patient()) folder_ = std::make_unique<TemporaryFolder>();
}

void CommandsTest::TearDownTestSuite() {
    folder_.reset();
    prepared_.reset();
    simulated_.reset();
}

void CommandsTest::SetUp() {
    if (!example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
}

std::string CommandsTest::patient() {
    return example_patient()->string();
}

std::string CommandsTest::plan() {
    return std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json";
}

const CommandRun& CommandsTest::prepared() {
    return once(prepared_, "prepare " + patient() + " --plan " + plan() + " --out case --json", root());
}

const CommandRun& CommandsTest::simulated() {
    return once(simulated_,
                "simulate " + patient() + " --plan " + plan() + " --preset paper --seed 4 --frames 4 --out room --json",
                root());
}

Eigen::Matrix4d CommandsTest::true_rig_from_ct() {
    simulated();
    return matrix_of(read_json(root() / "room" / "truth.json")["scan_rig_from_ct"]);
}

json read_json(const fs::path& file) {
    return json::parse(read_text(file));
}

std::string read_text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

Eigen::Matrix4d matrix_of(const json& rows) {
    Eigen::Matrix4d m;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c)
            m(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)].get<double>();
    return m;
}

void expect_one_clear_sentence(const CommandRun& run, int exit_code, const std::string& about) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_NE(run.err.find("planlight: "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(about), std::string::npos) << run.err;
    EXPECT_EQ(run.err.find("fault of ours"), std::string::npos) << run.err;
    std::istringstream lines(run.err);
    int said = 0;
    for (std::string line; std::getline(lines, line);) said += line.starts_with("planlight: ");
    EXPECT_EQ(said, 1) << run.err;
}

}  // namespace planlight::test
