#include "app/recording/recording_head.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "app/console.h"
#include "app/report/html_page.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/files/json_value.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "planlight recording";
constexpr std::array kModes{"none", "events", "all"};

std::string computer_name() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string hash_of_program() {
    try {
        return content_hash_of("/proc/self/exe");
    } catch (const std::exception&) {
        return {};
    }
}

}  // namespace

const char* word_of(RecordMode mode) {
    return kModes[static_cast<std::size_t>(mode)];
}

RecordMode record_mode_of(const std::string& word) {
    const auto found = std::find(kModes.begin(), kModes.end(), word);
    return static_cast<RecordMode>(found == kModes.end() ? 0 : found - kModes.begin());
}

RecordingHead recording_head(const Case& the_case, const fs::path& case_folder, RecordMode mode,
                             const DrawingSettings& drawing) {
    RecordingHead head;
    head.mode = mode;
    head.program = PLANLIGHT_VERSION;
    head.program_hash = hash_of_program();
    const CaseName name = name_of(the_case);
    head.case_code = name.code, head.volume_hash = name.volume_hash, head.mesh_hash = name.mesh_hash;
    head.case_title = title_of(the_case);
    head.plan_hash = the_case.plan_hash;
    head.plan_name = the_case.names.plan, head.plan_version = the_case.names.plan_version;
    std::error_code ignored;
    head.case_folder = fs::absolute(case_folder, ignored);
    head.up_in_ct = drawing.up_in_ct;
    head.card = drawing.card;
    head.began_utc = today();
    head.operator_name = operator_name();
    head.computer = computer_name();
    return head;
}

RecordingHead without_names(RecordingHead head) {
    head.anonymous = true;
    head.case_title = head.case_code;
    head.plan_name.clear(), head.plan_version.clear();
    head.operator_name.clear(), head.computer.clear();
    head.operator_named = false;
    head.case_folder.clear();
    head.card.clear();
    return head;
}

std::string text_of(const RecordingHead& head) {
    Json json{{"format", kFormat},
              {"version", 1},
              {"record", word_of(head.mode)},
              {"anonymous", head.anonymous},
              {"program", head.program},
              {"program_hash", head.program_hash},
              {"case",
               {{"code", head.case_code},
                {"title", head.case_title},
                {"volume_hash", head.volume_hash},
                {"mesh_hash", head.mesh_hash},
                {"plan_hash", head.plan_hash},
                {"plan", head.plan_name},
                {"plan_version", head.plan_version},
                {"folder", head.case_folder.string()}}},
              {"up_in_ct", to_json(head.up_in_ct)},
              {"card", head.card},
              {"began", head.began_utc},
              {"operator", head.operator_name},
              {"operator_named", head.operator_named},
              {"computer", head.computer}};
    if (!head.settings.empty()) json["settings"] = Json::parse(head.settings);
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

RecordingHead head_of(const std::string& text, const fs::path& file) {
    const Json json = parse_json(text, file);
    const JsonValue root(json, file);
    check_format(root, kFormat, 1, file);
    RecordingHead head;
    const JsonValue record = root.at("record");
    head.mode = record_mode_of(record.text());
    if (record.text() != word_of(head.mode)) record.refuse("is none of \"none\", \"events\" and \"all\"");
    if (const auto anonymous = root.find("anonymous")) head.anonymous = anonymous->flag();
    head.program = root.at("program").text();
    head.program_hash = root.at("program_hash").text();
    const JsonValue of_case = root.at("case");
    head.case_code = of_case.at("code").text();
    head.case_title = of_case.at("title").text();
    head.volume_hash = of_case.at("volume_hash").text();
    head.mesh_hash = of_case.at("mesh_hash").text();
    head.plan_hash = of_case.at("plan_hash").text();
    head.plan_name = of_case.at("plan").text();
    head.plan_version = of_case.at("plan_version").text();
    head.case_folder = of_case.at("folder").text();
    head.up_in_ct = root.at("up_in_ct").vector3();
    if (const auto card = root.find("card"))
        for (std::size_t i = 0; i < card->size(); ++i) head.card.push_back((*card)[i].text());
    head.began_utc = root.at("began").text();
    head.operator_name = root.at("operator").text();
    head.computer = root.at("computer").text();
    if (const auto named = root.find("operator_named")) head.operator_named = named->flag();
    if (const auto settings = root.find("settings")) {
        if (!json["settings"].is_object()) settings->refuse("is no object");
        head.settings = json["settings"].dump();
    }
    return head;
}

fs::path new_recording_name(const fs::path& folder) {
    std::string name = today();
    std::replace(name.begin(), name.end(), ':', '-');
    for (int i = 1;; ++i) {
        const fs::path file = folder / (i == 1 ? name + ".plrec" : fmt::format("{}-{}.plrec", name, i));
        std::error_code ignored;
        if (!fs::exists(file, ignored)) return file;
    }
}

}  // namespace planlight
