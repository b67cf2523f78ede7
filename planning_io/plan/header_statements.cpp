#include "planning_io/plan/header_statements.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <vector>

#include "planning_io/files/header_text.h"
#include "planning_io/files/one_line.h"
#include "planning_io/types/error.h"
#include "planning_io/types/utf8_prefix.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

bool is_alphanumeric(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || (static_cast<unsigned char>(c) & 0x80) != 0;
}

/// "Coordinate System" and "coordinate_system" are "coordinatesystem".
std::string bare(std::string_view text) {
    std::string letters;
    for (const char c : text)
        if (is_alphanumeric(c)) letters += c;
    return lower_case(letters);
}

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    for (std::size_t begin = 0; begin <= text.size();) {
        const auto end = std::min(text.find_first_of(std::string_view("\n\r\0", 3), begin), text.size());
        if (end > begin) lines.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return lines;
}

/// A name, `=` or `:`, and what follows up to the end of the line.
struct Statement {
    std::string_view name, rest;
    char sign = 0;

    std::string_view word() const { return rest.substr(0, word_end(0)); }
    /// Whether nothing more belongs to the value.
    bool one_word() const {
        const auto next = rest.find_first_not_of(" \t\"')]}>", word_end(0));
        return next == std::string_view::npos || rest[next] == ',' || rest[next] == ';' || rest[next] == '#';
    }

private:
    std::size_t word_end(std::size_t from) const {
        while (from < rest.size() && is_alphanumeric(rest[from])) ++from;
        return from;
    }
};

std::vector<Statement> statements_in(std::string_view words) {
    std::vector<Statement> found;
    for (const std::string_view line : lines_of(words))
        for (auto at = line.find_first_of("=:"); at != std::string_view::npos; at = line.find_first_of("=:", at + 1)) {
            const auto value = line.find_first_not_of(" \t=:\"'([{<", at);
            if (value != std::string_view::npos) found.push_back({line.substr(0, at), line.substr(value), line[at]});
        }
    return found;
}

bool is_orientation(std::string_view code) {
    if (code.size() != 3) return false;
    std::array<int, 3> seen{};
    for (const char c : code)
        for (std::size_t axis = 0; axis < 3; ++axis)
            seen[axis] += std::array{"LR", "AP", "IS"}[axis][0] == c || std::array{"LR", "AP", "IS"}[axis][1] == c;
    return seen == std::array{1, 1, 1};
}

std::string upper_case(std::string_view text) {
    std::string upper(text);
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return upper;
}

/// "LPS" of "lps", "LPS+" and "left-posterior-superior"; empty when the value is no frame that is known.
std::string frame_code(const Statement& said) {
    if (std::string word = upper_case(said.word()); is_orientation(word)) return word;
    std::string spelled = bare(said.rest), code;
    for (int axis = 0; axis < 3; ++axis)
        for (const std::string_view way : {"left", "right", "anterior", "posterior", "superior", "inferior"})
            if (spelled.starts_with(way)) {
                code += way.front();
                spelled.erase(0, way.size());
                break;
            }
    code = upper_case(code);
    return is_orientation(code) ? code : std::string();
}

bool is_no_patient_frame(std::string_view word) {
    const std::string lower = bare(word);
    return lower == "ijk" || lower == "voxel" || lower == "voxels" || lower == "pixels" || lower == "talairach" ||
           lower.starts_with("mni");
}

/// Written by themselves, these are hardly ever anything else.
bool is_mentioned_frame(std::string_view word) {
    constexpr std::array kCodes{"LPS", "RAS", "LAS", "RPS", "LPI", "RPI", "RAI", "LAI", "SPL"};
    return std::find(kCodes.begin(), kCodes.end(), word) != kCodes.end();
}

std::vector<std::string> words_of(std::string_view line) {
    std::vector<std::string> words(1);
    for (const char c : line)
        if (is_alphanumeric(c))
            words.back() += c;
        else if (!words.back().empty())
            words.emplace_back();
    if (words.back().empty()) words.pop_back();
    return words;
}

constexpr double kNoUnit = 0, kOther = -1;

/// mm per unit; `kOther` of a length that is not taken, `kNoUnit` of any other word.
double mm_per(std::string_view word) {
    static const std::map<std::string, double, std::less<>> units{{"mm", 1},
                                                                  {"millimeter", 1},
                                                                  {"millimeters", 1},
                                                                  {"millimetre", 1},
                                                                  {"millimetres", 1},
                                                                  {"um", 1e-3},
                                                                  {"µm", 1e-3},
                                                                  {"μm", 1e-3},
                                                                  {"micron", 1e-3},
                                                                  {"microns", 1e-3},
                                                                  {"micrometer", 1e-3},
                                                                  {"micrometers", 1e-3},
                                                                  {"micrometre", 1e-3},
                                                                  {"micrometres", 1e-3},
                                                                  {"cm", kOther},
                                                                  {"centimeter", kOther},
                                                                  {"centimeters", kOther},
                                                                  {"centimetre", kOther},
                                                                  {"centimetres", kOther},
                                                                  {"dm", kOther},
                                                                  {"m", kOther},
                                                                  {"meter", kOther},
                                                                  {"meters", kOther},
                                                                  {"metre", kOther},
                                                                  {"metres", kOther},
                                                                  {"nm", kOther},
                                                                  {"in", kOther},
                                                                  {"inch", kOther},
                                                                  {"inches", kOther},
                                                                  {"ft", kOther},
                                                                  {"feet", kOther},
                                                                  {"voxel", kOther},
                                                                  {"voxels", kOther},
                                                                  {"pixel", kOther},
                                                                  {"pixels", kOther}};
    if (word == "M" || word == "IN" || word == "In") return kNoUnit;  // initials, and words
    const auto at = units.find(lower_case(std::string(word)));
    return at == units.end() ? kNoUnit : at->second;
}

/// "coordinates in cm", "all values (inches)"; empty when the line is about something else.
std::string unit_mentioned(std::string_view line) {
    const std::vector<std::string> words = words_of(line);
    bool of_the_numbers = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string word = lower_case(words[i]);
        for (const std::string_view begins : {"coord", "koord", "value", "number", "position", "point", "unit", "xyz"})
            of_the_numbers = of_the_numbers || word.starts_with(begins);
        if (!of_the_numbers || mm_per(words[i]) != kOther || word == "in") continue;
        const bool bracketed = line.find("(" + words[i] + ")") != std::string_view::npos ||
                               line.find("[" + words[i] + "]") != std::string_view::npos;
        if (bracketed || (i > 0 && lower_case(words[i - 1]) == "in")) return words[i];
    }
    return {};
}

bool ends_as_one_of(std::string_view name, std::initializer_list<std::string_view> endings) {
    const std::string letters = bare(name);
    return std::any_of(endings.begin(), endings.end(), [&](std::string_view e) { return letters.ends_with(e); });
}

std::string quoted(std::string_view line, std::size_t most = 60) {
    return on_one_line(std::string(utf8_prefix(line, most)));
}

}  // namespace

bool names_the_space(std::string_view name) {
    return ends_as_one_of(
        name, {"space", "frame", "frameofreference", "system", "orientation", "convention", "coordinates", "axes"});
}

bool names_the_unit(std::string_view name) {
    return ends_as_one_of(name, {"unit", "units", "einheit", "einheiten"});
}

SpaceSaid space_said(std::string_view words, const fs::path& file) {
    SpaceSaid said;
    for (const Statement& statement : statements_in(words)) {
        const bool exact = statement.name.ends_with("SPACE") && statement.sign == '=';
        if (!names_the_space(statement.name)) continue;
        const std::string code = frame_code(statement);
        const auto space = space_named(code);
        if (!space && (exact || !code.empty() || is_no_patient_frame(statement.word())))
            throw InputError(
                file,
                fmt::format("says that its coordinate system is {}, neither LPS nor RAS", quoted(statement.word(), 20)),
                "Export it again in LPS or RAS.");
        if (!space) continue;
        if (said.space && *said.space != *space)
            throw InputError(file, "says both that it is in LPS and that it is in RAS",
                             "Export it again in one coordinate system.");
        said.space = space;
    }
    for (const std::string_view line : lines_of(words))
        for (const std::string& word : words_of(line))
            if (is_mentioned_frame(word)) said.mentions.push_back({word, quoted(line)});
    return said;
}

std::optional<double> unit_said(std::string_view words, const fs::path& file, std::string_view how_to_say) {
    std::optional<double> said;
    for (const Statement& statement : statements_in(words)) {
        if (!names_the_unit(statement.name)) continue;
        const std::string word(statement.word());
        double unit_mm = mm_per(word);
        if ((word == "m" || word == "in") && !statement.one_word()) unit_mm = kNoUnit;
        if (unit_mm == kNoUnit) continue;
        if (unit_mm == kOther)
            throw InputError(file, "says units=" + quoted(word, 20) + ", neither mm nor um", "Export it again in mm.");
        if (said && *said != unit_mm)
            throw InputError(file, "says both units=mm and units=um", "Export it again in one unit.");
        said = unit_mm;
    }
    if (said) return said;
    for (const std::string_view line : lines_of(words))
        if (const std::string unit = unit_mentioned(line); !unit.empty())
            throw InputError(file,
                             fmt::format("seems to be in {} (\"{}\"), and millimetres are read", unit, quoted(line)),
                             fmt::format("Export it again in mm; if its numbers are mm, {}.", how_to_say));
    return std::nullopt;
}

}  // namespace planlight
