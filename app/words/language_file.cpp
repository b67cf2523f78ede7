#include "app/words/language_file.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "app/words/word_pattern.h"
#include "planning_io/files/json_value.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// The pattern of an entry; what is wrong with its brackets is refused.
WordPattern pattern_of(const std::string& text, const fs::path& file) {
    try {
        return WordPattern(text);
    } catch (const std::invalid_argument& wrong) {
        throw InputError(file, "has " + std::string(wrong.what()) + " in \"" + text + "\"",
                         "Write its places as {mm}, as the English has them.");
    }
}

void check_places(const std::string& english, const std::string& own, const fs::path& file) {
    if (pattern_of(english, file).places() != pattern_of(own, file).places())
        throw InputError(file, "translates \"" + english + "\" with other places: \"" + own + "\"",
                         "Use each place in brackets of the English once, and no other.");
}

}  // namespace

fs::path site_words_folder() {
    const auto set = [](const char* variable) {
        const char* value = std::getenv(variable);
        return value && *value ? value : nullptr;
    };
    if (const char* folder = set("XDG_CONFIG_HOME")) return fs::path(folder) / "planlight" / "words";
    if (const char* home = set("HOME")) return fs::path(home) / ".config" / "planlight" / "words";
    return {};
}

Language read_language(const std::string& text, const fs::path& file) {
    const Json json = parse_json(text, file);
    const JsonValue root(json, file);
    check_format(root, "planlight words", 1, file);
    root.has_only({"format", "version", "language", "name", "words"});
    Language language{root.at("language").text(), root.at("name").text(), {}};
    root.at("words");
    for (const auto& [section, entries] : json.at("words").items()) {
        if (!entries.is_object()) root.at("words").refuse("has a section that is no object: \"" + section + "\"");
        for (const auto& [english, own] : entries.items()) {
            if (!own.is_string()) root.at("words").refuse("has no text for \"" + english + "\"");
            check_places(english, own.get<std::string>(), file);
            if (!own.get<std::string>().empty()) language.words.emplace_back(english, own.get<std::string>());
        }
    }
    return language;
}

std::vector<std::string> language_codes() {
    std::vector<std::string> codes;
    for (const char* code : {"de", "en", "ru"}) codes.emplace_back(code);
    std::error_code ignored;
    for (fs::directory_iterator entry(site_words_folder(), ignored), end; !ignored && entry != end; ++entry)
        if (entry->path().extension() == ".json") codes.push_back(entry->path().stem().string());
    std::sort(codes.begin(), codes.end());
    codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
    return codes;
}

Language language_of(const std::string& code) {
    std::error_code ignored;
    const fs::path own = site_words_folder() / (code + ".json");
    if (code.find('/') == std::string::npos && fs::exists(own, ignored)) return read_language(read_whole(own), own);
    if (const std::string text = shipped_words(code); !text.empty()) return read_language(text, code + ".json");
    std::string there;
    for (const std::string& known : language_codes()) there += (there.empty() ? "" : ", ") + known;
    throw InputError({}, "there are no words in the language \"" + code + "\"",
                     "Choose one of: " + there + "; or put " + own.string() +
                         " there (see app/words/README.md, below /usr/share/doc/planlight when installed).");
}

}  // namespace planlight
