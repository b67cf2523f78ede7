#include "projection/label_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "projection/lay_out_label.h"
#include "projection/text_signs.h"

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

std::string cannot_be_drawn(const std::string& name, const std::vector<char32_t>& lacks, const std::string& number) {
    if (lacks.front() == 0xFFFD)
        return fmt::format(
            "{}: its name holds bytes that are no UTF-8 text; the light has {} in its place. Write the "
            "name anew in the plan.",
            name, number);
    return fmt::format(
        "{}: no font of this computer has {}; the light has {} in place of the name. Install a font for "
        "it (fonts-noto-core or fonts-noto-cjk) or rename the item.",
        name, signs_in_words(lacks), number);
}

}  // namespace

std::string number_of(int item) {
    return fmt::format("#{}", item + 1);
}

std::vector<LitName> lit_names(const std::vector<std::string>& names, double text_height_mm, const Lettering& letters) {
    std::vector<LitName> lit(names.size());
    std::map<std::string, std::vector<std::size_t>> same;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto lacks = letters.outline(names[i]).lacks;
        if (!lacks.empty())
            lit[i] = {number_of(static_cast<int>(i)), cannot_be_drawn(names[i], lacks, number_of(static_cast<int>(i)))};
        else
            lit[i].name = shortened(names[i], text_height_mm, letters);
        same[lit[i].name].push_back(i);
    }
    for (const auto& [name, items] : same) {
        const bool shorter = std::any_of(items.begin(), items.end(), [&](auto i) { return names[i] != name; });
        if (items.size() < 2 || !shorter) continue;
        for (const std::size_t i : items)
            if (names[i] != name && lit[i].warning.empty())
                lit[i] = {number_of(static_cast<int>(i)),
                          fmt::format("{}: shortened to \"{}\" its name would be the same as another's; the light has "
                                      "{} in its place. Give the items shorter names.",
                                      names[i], name, number_of(static_cast<int>(i)))};
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

std::vector<std::string> check_names(const Plan& plan, double text_height_mm) {
    std::vector<std::string> warnings;
    if (lettering().families().empty())
        warnings.push_back(
            "no font with outlines was found on this computer: names are written in plain lines, and only those in "
            "Western European letters. Install fonts-dejavu-core and fonts-wqy-microhei.");
    for (const LitName& name : lit_names(names_of(plan), text_height_mm))
        if (!name.warning.empty()) warnings.push_back(name.warning);
    return warnings;
}

}  // namespace planlight
