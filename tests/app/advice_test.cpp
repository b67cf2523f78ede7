#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <regex>

#include "tests/app/run_command.h"
#include "tests/app/source_refusals.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

/// Which commands a refusal of a file may end, where it names an option: the longest beginning of its path counts. A
/// file of app/commands/ is of the command of its name.
const std::map<std::string, std::vector<std::string>> kServes{
    {"app/commands/example_plan.cpp", {"demo"}},
    {"app/belonging.cpp", {"project"}},
    {"app/commands/review_recording.cpp", {"review"}},
    {"app/commands/session_recording.cpp", {"session"}},
    {"app/export/", {"export"}},
    {"app/prepare_case.cpp", {"prepare"}},
    {"planning_io/case/case_folder.cpp", {"prepare"}},
    {"app/commands/cloud_unit.cpp", {"register"}},
    {"app/commands/simulate_served.cpp", {"simulate"}},
    {"app/live/show_light.cpp", {"projector"}},
    {"app/console.cpp", {"demo", "merge", "register"}},
    {"planning_io/dicom/choose_series.cpp", {"prepare", "plan", "demo", "simulate", "session"}},
    {"app/live/shown_replay.cpp", {"replay"}},
    {"app/report/moment_comparison.cpp", {"review"}},
    {"app/commands/pdf_option.cpp", {"prepare", "register", "calibrate", "projector", "demo", "report"}},
    {"planning_io/dicom_net/", {"fetch", "store"}},
    {"planning_io/dicom_net/move_series.cpp", {"fetch"}},
    {"planning_io/plan/", {"prepare", "plan", "demo", "simulate"}},
    {"planning_io/surface/dicom_seg.cpp", {"prepare"}},
    {"planning_io/surface/risk_structure_file.cpp", {"prepare", "plan"}},
    {"planning_io/surface/roi_surface.cpp", {"prepare"}},
    {"planning_io/surface/surface_file.cpp", {"prepare"}},
    {"planning_io/surface/mesh_file.cpp", {"register"}},
};

std::vector<std::string> commands_of(const std::string& file) {
    std::vector<std::string> commands;
    std::size_t longest = 0;
    for (const auto& [beginning, served] : kServes)
        if (file.starts_with(beginning) && beginning.size() > longest) longest = beginning.size(), commands = served;
    if (commands.empty() && file.starts_with("app/commands/")) commands = {fs::path(file).stem().string()};
    return commands;
}

const std::string& help_of(const std::string& command) {
    static std::map<std::string, std::string> helps;
    auto& help = helps[command];
    if (help.empty()) help = run_planlight(command + " --help", fs::temp_directory_path()).out;
    return help;
}

bool has_option(const std::string& command, const std::string& option) {
    return std::regex_search(help_of(command), std::regex("(^|\\n|,) *" + option + "[ \\n]"));
}

/// The command that stands before the option in the text ("`session --light-delay-ms 30`"); empty: none does.
std::string command_named_with(const std::string& option, const std::string& text) {
    std::smatch found;
    return std::regex_search(text, found, std::regex("([a-z]+) " + option)) && !help_of(found[1]).empty() &&
                   help_of(found[1]).find("Example:") != std::string::npos
               ? found[1].str()
               : std::string();
}

TEST(Advice, NamesOnlyOptionsThatTheCommandHas) {
    int checked = 0;
    for (const SourceRefusal& refusal : refusals_in_sources(PLANLIGHT_SOURCE_FOLDER))
        for (const std::string& option : options_named(refusal.problem + " " + refusal.remedy)) {
            const std::string named = command_named_with(option, refusal.problem + " " + refusal.remedy);
            const auto commands = named.empty() ? commands_of(refusal.file) : std::vector{named};
            EXPECT_FALSE(commands.empty()) << refusal.file << ":" << refusal.line << " advises " << option
                                           << "; say in kServes which commands it may end, or name the command";
            for (const std::string& command : commands)
                EXPECT_TRUE(has_option(command, option))
                    << refusal.file << ":" << refusal.line << " advises " << option << ", which " << command
                    << " does not have: " << refusal.remedy;
            ++checked;
        }
    EXPECT_GT(checked, 15);  // else the walk over the sources found nothing
}

TEST(Advice, IsASentence) {
    const auto refusals = refusals_in_sources(PLANLIGHT_SOURCE_FOLDER);
    EXPECT_GT(refusals.size(), 250u);
    for (const SourceRefusal& refusal : refusals) {
        const std::string& remedy = refusal.remedy;
        if (remedy.starts_with("…")) continue;  // made elsewhere
        EXPECT_TRUE(std::isupper(static_cast<unsigned char>(remedy[0])) || remedy[0] == '"' || remedy[0] == '`')
            << refusal.file << ":" << refusal.line << ": " << remedy;
        EXPECT_TRUE(remedy.ends_with(".") || remedy.ends_with("…"))
            << refusal.file << ":" << refusal.line << ": " << remedy;
    }
}

TEST(Advice, OfDevicesBeginsWithTheDeviceAndACapital) {
    for (const SourceRefusal& refusal : refusals_in_sources(PLANLIGHT_SOURCE_FOLDER)) {
        if (refusal.kind != "DeviceError" || refusal.problem.starts_with("…")) continue;
        EXPECT_TRUE(std::isdigit(static_cast<unsigned char>(refusal.problem[0])) ||
                    std::isupper(static_cast<unsigned char>(refusal.problem[0])))
            << refusal.file << ":" << refusal.line << ": " << refusal.problem;
    }
}

}  // namespace
}  // namespace planlight::test
