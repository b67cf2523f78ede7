#include <fmt/format.h>

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

}  // namespace planlight
