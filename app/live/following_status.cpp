#include "app/live/following_status.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/case_model.h"

namespace planlight {
namespace {

std::vector<std::string> why_dark(const Session& session, const std::vector<LightCause>& causes) {
    if (session.all_hidden()) return {"Show an item on the page of the plan, or the whole plan (key 0)."};
    if (causes.empty()) return {"The light comes back by itself when the pose is good."};
    return {causes.front().sentence(), causes.front().remedy()};
}

/// Empty where nothing is hidden.
std::string sentence_of_hidden(const Session& session) {
    const auto& hidden = session.hidden_items();
    if (hidden.empty()) return {};
    if (hidden.size() == 1)
        return fmt::format("\"{}\" is hidden: it is not lit.", session.drawing().items[*hidden.begin()].name);
    return fmt::format("{} of {} items are hidden: they are not lit.", hidden.size(), session.drawing().items.size());
}

/// Empty where each item has its name, or its code, beside its light.
std::string sentence_of_bare(const Session& session) {
    const long bare = bare_items(session.drawing());
    return bare == 0
               ? std::string()
               : fmt::format("{} of {} items have no name beside their light.", bare, session.drawing().items.size());
}

}  // namespace

Status status_of(const Session& session, const Session::Update& update, const LightGate::Ruling& ruling,
                 bool card_asked) {
    if (!update.overlay.lit)
        return {StatusKind::dark, "Dark: " + update.overlay.reason + ".", why_dark(session, update.causes)};
    std::vector<std::string> details = sentences(update.overlay.counts.partly_lit, session.lit_drawing());
    const std::vector<std::string> unlit = sentences_of_unlit(update.overlay.counts, session.lit_drawing());
    details.insert(details.end(), unlit.begin(), unlit.end());
    const bool partly_lit = !details.empty();
    details.insert(details.end(), ruling.details.begin(), ruling.details.end());
    if (!update.camera_doubt.empty()) details.push_back(update.camera_doubt + ".");
    if (card_asked && ruling.ask_to_verify && !session.item_of_moment() &&
        (session.card_wanted() || !session.drawing().card))
        details.push_back(update.overlay.counts.card_lit
                              ? "Read the card on the skin: is it this patient, and this side?"
                              : "The card with the patient's name cannot be lit whole: ask who the patient is.");
    if (const auto item = session.item_of_moment(); item && *item < session.drawing().items.size())
        details.push_back(fmt::format("Only \"{}\" is bright and checked; the rest of the plan is dim or dark.",
                                      session.drawing().items[*item].name));
    const bool aligned = ruling.trust == LightTrust::aligned;
    Status status{aligned ? StatusKind::aligned : StatusKind::check, ruling.headline, details};
    const std::string hidden = sentence_of_hidden(session);
    if (!hidden.empty()) status.details.push_back(hidden);
    const auto item = session.item_of_moment();
    if (aligned && !item && (partly_lit || !hidden.empty()))
        status.headline = "What is shown of the plan is on the skin.";
    if (aligned && item && *item < session.drawing().items.size() && partly_lit)
        status.headline = fmt::format("What is shown of \"{}\" is on the skin.", session.drawing().items[*item].name);
    if (const std::string bare = sentence_of_bare(session); aligned && !session.item_of_moment() && !bare.empty())
        status.details.push_back(bare);
    return status;
}

std::optional<double> item_off_mm(const LightCheck& light, std::size_t i) {
    const ItemLight& item = light.items.at(i);
    return item.told() ? std::optional(std::max({item.off_mm, item.part_off_mm, light.far_mm.value_or(0)}))
                       : std::nullopt;
}

}  // namespace planlight
