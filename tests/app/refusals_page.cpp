#include "tests/app/refusals_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "tests/app/source_refusals.h"

namespace planlight::test {
namespace {

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

/// Whether a text says anything of its own: not made of what another place says alone.
bool says_something(const std::string& text) {
    return std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
}

/// What to do; where only another place knows it, the sentence of the program says it.
std::string remedy_of(const SourceRefusal& refusal) {
    return says_something(refusal.remedy) ? refusal.remedy
                                          : "What the sentence says after it: it goes by what was found.";
}

}  // namespace

std::string refusals_page(const std::filesystem::path& root) {
    std::map<int, std::pair<std::string, std::set<std::pair<std::string, std::string>>>> topics;
    for (const SourceRefusal& refusal : refusals_in_sources(root)) {
        if (!says_something(refusal.problem)) continue;
        const std::string topic = topic_of(refusal.file);
        auto& [name, rows] = topics[std::stoi(topic)];
        name = topic;
        rows.emplace(refusal.problem, remedy_of(refusal));
    }
    std::string page =
        "# Every refusal, with its remedy\n\nMade from the sources by `build/tests/app/list_refusals . > "
        "app/guide/refusals.md`. "
        "\"…\" stands for what is only known when it happens: a\nfile, a name, a number. [When it says "
        "no](6-when-it-says-no.md) explains "
        "the common ones; what a check words by itself (calibration, the state of the rig, the sequence of frames, the "
        "skin, a projector) stands "
        "on the page of its room.\n";
    for (const auto& [number, topic] : topics) {
        page += fmt::format("\n## {}\n| it says | do |\n|---|---|\n", topic.first);
        for (const auto& [problem, remedy] : topic.second)
            page += fmt::format("| {} | {} |\n", cell(problem), cell(remedy));
    }
    return page;
}

}  // namespace planlight::test
