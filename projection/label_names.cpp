#include "projection/label_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "projection/label_codes.h"
#include "projection/lay_out_label.h"
#include "projection/stroke_font.h"
#include "projection/text_signs.h"
#include "projection/visual_order.h"

namespace planlight {
namespace {

std::string signs_in_words(std::vector<char32_t> codes) {
    constexpr std::size_t kMost = 3;
    std::vector<char32_t> different;
    for (const char32_t code : codes)
        if (std::find(different.begin(), different.end(), code) == different.end()) different.push_back(code);
    std::string words;
    for (std::size_t i = 0; i < std::min(kMost, different.size()); ++i)
        words += fmt::format("{}\"{}\" (U+{:04X})", i == 0 ? "" : ", ", utf8_of(different[i]),
                             static_cast<unsigned>(different[i]));
    if (different.size() > kMost) words += " and others";
    return words;
}

/// The Latin letter that a Cyrillic or Greek one looks like in light; itself where there is none.
char32_t looks_like(char32_t code) {
    static const std::map<char32_t, char32_t> kAlike{
        {U'А', U'A'}, {U'В', U'B'}, {U'Е', U'E'}, {U'Ё', U'E'}, {U'З', U'3'}, {U'І', U'I'}, {U'Ї', U'I'}, {U'Ј', U'J'},
        {U'К', U'K'}, {U'М', U'M'}, {U'Н', U'H'}, {U'О', U'O'}, {U'Р', U'P'}, {U'С', U'C'}, {U'Ѕ', U'S'}, {U'Т', U'T'},
        {U'У', U'Y'}, {U'Х', U'X'}, {U'а', U'a'}, {U'е', U'e'}, {U'і', U'i'}, {U'ј', U'j'}, {U'о', U'o'}, {U'р', U'p'},
        {U'с', U'c'}, {U'ѕ', U's'}, {U'у', U'y'}, {U'х', U'x'}, {U'Α', U'A'}, {U'Β', U'B'}, {U'Ε', U'E'}, {U'Ζ', U'Z'},
        {U'Η', U'H'}, {U'Ι', U'I'}, {U'Κ', U'K'}, {U'Μ', U'M'}, {U'Ν', U'N'}, {U'Ο', U'O'}, {U'Ρ', U'P'}, {U'Τ', U'T'},
        {U'Υ', U'Y'}, {U'Χ', U'X'}, {U'ο', U'o'}, {U'ν', U'v'}};
    const auto other = kAlike.find(code);
    return other == kAlike.end() ? code : other->second;
}

/// What a reader sees of a name: two that differ in less look the same as light.
std::string seen_of(const std::string& name) {
    std::string seen;
    for (const char32_t code : code_points(visual_order(name))) {
        if (is_control(code) || has_no_ink(code) || (code == U' ' && (seen.empty() || seen.back() == ' '))) continue;
        seen += utf8_of(looks_like(code));
    }
    while (!seen.empty() && seen.back() == ' ') seen.pop_back();
    return seen;
}

/// "the light has #3 in its place"
std::string in_its_place(const std::string& code) {
    return code.empty() ? "the light has no label there" : "the light has " + code + " in its place";
}

std::string cannot_be_drawn(const std::string& name, const std::vector<char32_t>& lacks, const std::string& code) {
    if (lacks.front() == 0xFFFD)
        return fmt::format("{}: its name holds bytes that are no UTF-8 text; {}. Write the name anew in the plan.",
                           name, in_its_place(code));
    return fmt::format(
        "{}: no font of this computer has {}; {}. Install a font for it (fonts-noto-core or fonts-noto-cjk) or rename "
        "the item.",
        name, signs_in_words(lacks), in_its_place(code));
}

/// `twice`: another has this very name.
std::string same_as_another(const std::string& name, const std::string& lit, const std::string& code, bool twice) {
    if (lit == name && !twice)
        return fmt::format(
            "{}: another item's name looks the same; {}. Give each item a name that cannot be taken for another.", name,
            in_its_place(code));
    if (lit == name)
        return fmt::format("{}: another item has the same name; {}. Give each item a name of its own.", name,
                           in_its_place(code));
    return fmt::format(
        "{}: shortened to \"{}\" its name would be the same as another's; {}. Give the items shorter names.", name, lit,
        in_its_place(code));
}

}  // namespace

std::vector<LitName> lit_names(const std::vector<std::string>& names, double text_height_mm, const Lettering& letters) {
    std::vector<std::string> shorter;
    std::vector<std::vector<char32_t>> lacks;
    std::map<std::string, int> count;
    for (const std::string& name : names) {
        lacks.push_back(letters.outline(name).lacks);
        shorter.push_back(lacks.back().empty() ? shortened(name, text_height_mm, letters) : std::string());
        ++count[seen_of(shorter.back())];
    }
    const auto codes = codes_of(names, shorter);
    std::vector<LitName> lit(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
        lit[i] = {shorter[i], {}, codes[i]};
        if (!lacks[i].empty())
            lit[i].warning = cannot_be_drawn(names[i], lacks[i], codes[i]);
        else if (names.size() > 1 && seen_of(shorter[i]).empty())
            lit[i].warning =
                fmt::format("An item of the plan has no name; {}. Give each item a name.", in_its_place(codes[i]));
        else if (!shorter[i].empty() && count[seen_of(shorter[i])] > 1)
            lit[i].warning =
                same_as_another(names[i], shorter[i], codes[i], std::count(names.begin(), names.end(), names[i]) > 1);
        if (lit[i].warning.empty()) continue;
        lit[i].name = codes[i];
        lit[i].by_code = !codes[i].empty(), lit[i].none = codes[i].empty();
    }
    return lit;
}

std::vector<LitName> lit_structures(const Plan& plan, double text_height_mm, const Lettering& letters) {
    std::vector<LitName> lit;
    std::map<std::string, std::size_t> first;  // of the plan's names: structures of one name are one to a reader
    std::map<std::string, std::set<std::string>> look;  // names of the plan that look so in the light
    for (const RiskStructure& structure : plan.risk_structures) {
        first.try_emplace(structure.name, lit.size());
        LitName name;
        if (letters.outline(structure.name).lacks.empty())
            name.name = shortened(structure.name, text_height_mm, letters);
        look[seen_of(name.name)].insert(structure.name);
        lit.push_back(std::move(name));
    }
    for (std::size_t i = 0; i < lit.size(); ++i) {
        if (!lit[i].name.empty() && look[seen_of(lit[i].name)].size() == 1) {
            lit[i].name = plan.risk_structures[i].name;  // shortened where it is laid out
            continue;
        }
        const std::string instead = fmt::format("structure {}", first[plan.risk_structures[i].name] + 1);
        lit[i].warning = fmt::format(
            "{}: {}; the light calls this risk structure \"{}\". Give it another name.", plan.risk_structures[i].name,
            lit[i].name.empty() ? "no font of this computer has all signs of its name"
                                : "the name of another structure looks the same when it is shortened",
            instead);
        lit[i].name = instead;
    }
    return lit;
}

std::vector<std::string> names_of(const Plan& plan) {
    std::vector<std::string> names;
    for (const auto& line : plan.osteotomy_lines) names.push_back(line.name.empty() ? "Osteotomy" : line.name);
    for (const auto& hole : plan.boreholes) names.push_back(hole.name);
    for (const auto& trajectory : plan.trajectories) names.push_back(trajectory.name);
    for (const auto& plane : plan.cut_planes) names.push_back(plane.name.empty() ? "Cut" : plane.name);
    return names;
}

std::string fault_of_own_font(const Lettering& letters) {
    const char* own = std::getenv("PLANLIGHT_FONT");
    if (!own || !*own) return {};
    const auto families = letters.families();  // the first is that of all letters
    if (!families.empty() && families.front() == own) return {};
    return fmt::format(
        "PLANLIGHT_FONT names {}, which is no file of a font with outlines: the light has other letters. Name the "
        "font's "
        "file (.ttf, .otf, .ttc), or take the setting away.",
        own);
}

std::vector<std::string> check_names(const Plan& plan, double text_height_mm) {
    std::vector<std::string> warnings;
    if (lettering().families().empty())
        warnings.push_back(
            "no font with outlines was found on this computer: names are written in plain lines, and only those in "
            "Western European letters. Install fonts-dejavu-core and fonts-wqy-microhei.");
    if (const auto fault = fault_of_own_font(); !fault.empty()) warnings.push_back(fault);
    for (const LitName& name : lit_names(names_of(plan), text_height_mm))
        if (!name.warning.empty()) warnings.push_back(name.warning);
    for (const LitName& name : lit_structures(plan, text_height_mm))
        if (!name.warning.empty()) warnings.push_back(name.warning);
    return warnings;
}

}  // namespace planlight
