#include <fmt/format.h>

#include <algorithm>

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
                : fmt::format("{}: no light reaches it from here. Turn the patient or the projector.", name));
    }
    return said;
}

std::vector<std::string> sentences_of_unlit(const RenderCounts& counts, const PlanDrawing& drawing) {
    constexpr double kSaid = 0.03;
    std::vector<std::string> said;
    for (std::size_t i = 0; i < counts.items.size() && i < drawing.items.size(); ++i) {
        const LinePoints& light = counts.items[i];
        const auto is_this = [&](const PartlyLitRing& ring) { return ring.item == static_cast<int>(i); };
        if (light.points == 0 || std::any_of(counts.partly_lit.begin(), counts.partly_lit.end(), is_this)) continue;
        const auto share = [&](std::size_t of) { return static_cast<double>(of) / static_cast<double>(light.points); };
        const double dark = 1 - share(light.lit);
        if (dark < kSaid) continue;
        std::string causes;
        const auto add = [&](std::size_t of, const char* cause) {
            if (share(of) >= 0.005)
                causes += fmt::format("{}{:.0f} % {}", causes.empty() ? "" : ", ", 100 * share(of), cause);
        };
        add(light.outside, "out of the projector's picture");
        add(light.hidden, "behind other skin");
        add(light.too_steep, "where the light would graze the skin or the skin faces away");
        said.push_back(
            light.lit == 0
                ? fmt::format("{}: no light reaches it from here ({}). Turn the patient or the projector.",
                              drawing.items[i].name, causes)
                : fmt::format(
                      "{}: {:.0f} % of it has no light ({}): it goes on where the light ends, and its label gives the "
                      "whole length. Turn the patient or the projector.",
                      drawing.items[i].name, 100 * dark, causes));
    }
    return said;
}

}  // namespace planlight
