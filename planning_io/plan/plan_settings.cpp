#include "planning_io/plan/plan_settings.h"

#include <charconv>
#include <sstream>
#include <vector>

#include "planning_io/files/nearest_word.h"

namespace planlight {

namespace {

/// "a = b" as "a=b".
std::string without_blanks_round_equals(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const bool blank = c == ' ' || c == '\t';
        if (blank && !result.empty() && result.back() == '=') continue;
        if (c == '=')
            while (!result.empty() && (result.back() == ' ' || result.back() == '\t')) result.pop_back();
        result += c;
    }
    return result;
}

/// The word of ours that a word of a person's was meant to be: a mistyped one, or one without its unit.
std::optional<std::string> word_meant(const std::string& word) {
    const std::vector<std::string> known{"diameter_mm", "depth_mm", "axis"};
    for (const std::string& ours : known)
        if (word == ours) return std::nullopt;
    for (const std::string& ours : known)
        if (letters_apart(word, ours.substr(0, ours.find('_'))) == 0) return ours;
    return nearest_word(word, known);
}

}  // namespace

PlanSettings::PlanSettings(const std::string& description, Refuse refuse) : refuse_(std::move(refuse)) {
    std::istringstream words(without_blanks_round_equals(description));
    for (std::string word; words >> word;) {
        const auto equals = word.find('=');
        if (equals == std::string::npos) continue;
        const std::string name = word.substr(0, equals);
        if (const auto meant = word_meant(name)) refuse_("describes " + name + "=, where " + *meant + "= is meant");
        const auto [at, fresh] = values_.emplace(name, word.substr(equals + 1));
        if (!fresh && at->second != word.substr(equals + 1)) refuse_("describes " + at->first + " twice, differently");
    }
}

double PlanSettings::length_mm(const std::string& key, double most_mm) const {
    const auto given = text(key);
    if (!given) return 0;
    double value = 0;
    const char *begin = given->data(), *end = begin + given->size();
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || stop != end || !(value >= 0) || value > most_mm)
        refuse_("describes " + key + "=" + *given + ", not a number from 0 to " + exact(most_mm));
    return value;
}

std::optional<std::string> PlanSettings::text(const std::string& key) const {
    const auto at = values_.find(key);
    return at == values_.end() ? std::nullopt : std::optional(at->second);
}

std::string exact(double value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
}

std::string description_of(const Trajectory& t) {
    return t.diameter_mm > 0 ? "diameter_mm=" + exact(t.diameter_mm) : "";
}

std::string description_of(const Borehole& b) {
    return "diameter_mm=" + exact(b.diameter_mm) + " depth_mm=" + exact(b.depth_mm);
}

}  // namespace planlight
