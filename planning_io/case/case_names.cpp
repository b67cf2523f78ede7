#include "planning_io/case/case_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "planning_io/plan/plan_limits.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

bool is_control(char c) {
    return static_cast<unsigned char>(c) < ' ' || c == 0x7f;
}

/// How many bytes the character at `at` has; 0 where it is no UTF-8 (RFC 3629).
std::size_t character_at(const std::string& text, std::size_t at) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const unsigned first = byte(at);
    const std::size_t length = first < 0x80                    ? 1
                               : first >= 0xC2 && first < 0xE0 ? 2
                               : first >= 0xE0 && first < 0xF0 ? 3
                               : first >= 0xF0 && first < 0xF5 ? 4
                                                               : 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(at + i) & 0xC0) != 0x80) return 0;
    if ((first == 0xE0 && byte(at + 1) < 0xA0) || (first == 0xED && byte(at + 1) > 0x9F) ||
        (first == 0xF0 && byte(at + 1) < 0x90) || (first == 0xF4 && byte(at + 1) > 0x8F))
        return 0;
    return length;
}

void check(const char* what, const std::string& text) {
    const auto refuse = [&](const std::string& problem) {
        throw InputError({}, fmt::format("The {} {}", what, problem), "Give a short name of ordinary characters.");
    };
    if (const std::size_t length = characters_of(text); length > kLongestCaseName)
        refuse(fmt::format("has {} characters, more than {}", length, kLongestCaseName));
    if (std::any_of(text.begin(), text.end(), is_control)) refuse("holds control characters");
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = character_at(text, at);
        if (length == 0) refuse("is no UTF-8 text");
        at += length;
    }
}

}  // namespace

void check_case_names(const CaseNames& names) {
    check("title", names.title);
    check("patient's name or code", names.patient);
    check("plan's name", names.plan);
    check("plan's version", names.plan_version);
    check("series' description", names.series);
    check("series' date", names.series_date);
}

std::string without_control_characters(const std::string& text) {
    const auto is_c1 = [&](std::size_t at) {  // U+0080 to U+009F
        return text[at] == '\xC2' && static_cast<unsigned char>(text[at + 1]) < 0xA0;
    };
    std::string fit;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = character_at(text, at);
        const bool is_good = length > 0 && !is_control(text[at]) && !(length == 2 && is_c1(at));
        fit += is_good ? text.substr(at, length) : "?";
        at += std::max<std::size_t>(length, 1);
    }
    return fit;
}

std::string fit_to_be_a_name(const std::string& text) {
    return shortened(without_control_characters(text), kLongestCaseName - 3);
}

}  // namespace planlight
