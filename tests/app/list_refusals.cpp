// Writes the page of all refusals (app/guide/refusals.md): list_refusals SOURCE_FOLDER > app/guide/refusals.md
#include <fmt/format.h>

#include <map>
#include <set>

#include "tests/app/source_refusals.h"

namespace {

using planlight::test::SourceRefusal;

/// The part of the program that a file belongs to, in the words of the guide.
std::string topic_of(const std::string& file) {
    static const std::pair<const char*, const char*> kTopics[] = {
        {"planning_io/dicom/", "2. DICOM"},
        {"planning_io/volume/", "1. Volumes"},
        {"planning_io/plan/", "3. Plans and landmarks"},
        {"projection/check_plan", "3. Plans and landmarks"},
        {"planning_io/surface/", "4. Surfaces, meshes and scans"},
        {"planning_io/case/", "5. Our own files"},
        {"planning_io/files/", "6. Any file"},
        {"segmentation/", "7. Finding the skin"},
        {"registration/calibration/", "8. Calibration"},
        {"registration/projector_measurement/", "9. Measuring a projector"},
        {"registration/", "10. Scan and tracking"},
        {"projection/", "11. Projector and windows"},
        {"app/windows/", "11. Projector and windows"},
        {"app/live/", "12. Session"},
        {"app/session", "12. Session"},
        {"app/", "13. Commands"},
    };
    for (const auto& [beginning, topic] : kTopics)
        if (file.starts_with(beginning)) return topic;
    return "13. Commands";
}

std::string cell(std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos; at += 2) text.insert(at, "\\");
    return text;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        fmt::print(stderr, "list_refusals SOURCE_FOLDER\n");
        return 2;
    }
    std::map<int, std::pair<std::string, std::set<std::pair<std::string, std::string>>>> topics;
    for (const SourceRefusal& refusal : planlight::test::refusals_in_sources(argv[1])) {
        const std::string topic = topic_of(refusal.file);
        if (refusal.problem == "…") continue;  // made of what another place says
        auto& [name, rows] = topics[std::stoi(topic)];
        name = topic;
        rows.emplace(refusal.problem, refusal.remedy);
    }
    fmt::print(
        "# Every refusal, with its remedy\n\nMade from the sources by `build/tests/app/list_refusals . > "
        "app/guide/refusals.md`. "
        "\"…\" stands for what is only known when it happens: a\nfile, a name, a number. [When it says "
        "no](6-when-it-says-no.md) explains "
        "the common ones; what a check words by itself (calibration, the state of the rig, the sequence of frames, the "
        "skin, a projector) stands "
        "on the page of its room.\n");
    for (const auto& [number, topic] : topics) {
        fmt::print("\n## {}\n| it says | do |\n|---|---|\n", topic.first);
        for (const auto& [problem, remedy] : topic.second) fmt::print("| {} | {} |\n", cell(problem), cell(remedy));
    }
    return 0;
}
