#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "projection/render_drawing.h"

namespace planlight {

std::string sentence_of_labels(const RenderCounts& counts, const PlanDrawing& drawing) {
    std::string names;
    for (const int item : counts.labels_left_out)
        names += (names.empty() ? "" : ", ") + drawing.items.at(static_cast<std::size_t>(item)).name;
    if (names.empty()) return {};
    return fmt::format(
        "Left out because not all of it can be lit from here: the label of {}. Turn the patient or the "
        "projector, or read it in the operator's window.",
        names);
}

std::vector<std::string> sentences(const std::vector<PartlyLitRing>& rings, const PlanDrawing& drawing) {
    std::vector<std::string> said;
    for (const PartlyLitRing& ring : rings) {
        const bool named = ring.item >= 0 && static_cast<std::size_t>(ring.item) < drawing.items.size();
        const std::string name = named ? drawing.items[static_cast<std::size_t>(ring.item)].name : "a circle";
        said.push_back(
            ring.lit_share > 0
                ? fmt::format("{}: only {:.0f} % of its rim can be lit from here; it is drawn broken. Turn the "
                              "patient or the projector.",
                              name, 100 * ring.lit_share)
                : fmt::format("{}: nothing of its rim can be lit from here. Turn the patient or the projector.", name));
    }
    return said;
}

std::vector<std::string> sentences_of_unlit(const RenderCounts& counts, const PlanDrawing& drawing) {
    constexpr double kSaid = 0.05;
    std::vector<std::string> said;
    for (std::size_t i = 0; i < counts.items.size() && i < drawing.items.size(); ++i) {
        const PointCounts& light = counts.items[i];
        const std::string& name = drawing.items[i].name;
        const auto is_this = [&](const PartlyLitRing& ring) { return ring.item == static_cast<int>(i); };
        const double dark = 1 - light.lit_share();
        if (light.points == 0 || dark < kSaid || std::ranges::any_of(counts.partly_lit, is_this)) continue;
        if (light.lit == 0) {
            said.push_back(fmt::format("{}: no light reaches it from here.", name));
            continue;
        }
        const std::array<std::pair<std::size_t, const char*>, 4> reasons{
            {{light.outside, "out of the projector's picture"},
             {light.hidden, "behind other skin"},
             {light.too_steep, "where the skin turns away"},
             {light.on_marker, "a marker lies there"}}};
        const char* const where = std::ranges::max_element(reasons, {}, [](const auto& r) { return r.first; })->second;
        said.push_back(fmt::format("{}: about {:.0f} % of it has no light ({}); it goes on where the light ends.", name,
                                   5 * std::round(20 * dark), where));
    }
    if (!said.empty()) said.push_back("Turn the patient or the projector to light the rest.");
    return said;
}

}  // namespace planlight
