#include "projection/light_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "planning_io/types/statistics.h"
#include "projection/error_figure.h"

namespace planlight {
namespace {

std::string sentence_of_height(double depth_mm) {
    return depth_mm > 0 ? fmt::format("The skin there stands {:.1f} mm higher than at the scan.", depth_mm)
                        : fmt::format("The skin there lies {:.1f} mm lower than at the scan.", -depth_mm);
}

}  // namespace

void LightGate::verify(Instant at) {
    verified_ = true;
    lit_at_ = at;
}

std::string LightGate::said(double off_mm) const {
    return error_figure(off_mm, {settings_.warn_mm, settings_.stop_mm});
}

void LightGate::forget() {
    good_ = bad_ = 0;
    brighter_ = 0;
    faint_ = false;
    last_.reset();
    items_.clear();
    told_whole_at_ = Instant::min();
    lit_ = false;  // what is lit next begins then
}

void LightGate::skin_checked(double off_mm) {
    skin_off_mm_ = std::isnan(off_mm) ? std::numeric_limits<double>::infinity() : off_mm;
    if (skin_off_mm_ > settings_.stop_mm) stopped_ = true;
    skin_known_at_.reset();
}

void LightGate::new_match() {
    verified_ = stopped_ = false;
    skin_off_mm_ = 0;
    skin_known_at_.reset();
    forget();
}

void LightGate::restart() {
    if (stopped_) verified_ = false;
    stopped_ = skin_off_mm_ > settings_.stop_mm;  // only a new match mends that
    forget();
}

void LightGate::other_light() {
    forget();
}

std::optional<LightGate::Ruling> LightGate::forbids() const {
    if (!stopped_) return std::nullopt;
    return rule({}, {});
}

LightGate::Item::Look LightGate::Item::all() const {
    Look sum;
    for (const Look& look : looks) {
        sum.lit += look.lit;
        sum.steep += look.steep;
        sum.asked += look.asked;
        sum.seen += look.seen;
    }
    return sum;
}

double LightGate::Item::part_off_mm() const {
    double most = 0, second = 0;
    for (const Look& look : looks) {
        second = std::max(second, std::min(most, look.part_off_mm));
        most = std::max(most, look.part_off_mm);
    }
    return second;
}

double LightGate::Item::by_untold_height_mm() const {
    std::vector<double> each;
    for (const Look& look : looks)
        if (look.seen > 0) each.push_back(look.by_untold_height_mm);
    return median(std::move(each));
}

bool LightGate::Item::told_whole() const {
    return std::ranges::any_of(looks, &Look::told_whole);
}

/// With hysteresis, lest the banner flicker where the share lies at the limit.
double LightGate::limit_for(const Item& item, double share) const {
    return share * (item.fell_short ? 1 + settings_.hysteresis : 1 - settings_.hysteresis);
}

bool LightGate::measured(const Item& item) const {
    const Item::Look all = item.all();
    return all.seen > 0 && all.seen >= limit_for(item, settings_.least_seen_of_item) * all.asked;
}

LightGate::Shortfall LightGate::shortfall_of(const Item& item) const {
    if (!measured(item)) return Shortfall::not_measured;
    if (item.dim) return Shortfall::none;
    const Item::Look all = item.all();
    const bool stands_for_all = item.extent_mm <= settings_.small_item_mm && item.told_whole();
    const double least_asked = stands_for_all ? settings_.least_seen_of_item : settings_.least_asked_of_item;
    if (all.asked < limit_for(item, least_asked) * all.lit) return Shortfall::visible_in_part;
    if (!stands_for_all && all.seen < limit_for(item, settings_.least_seen_of_asked) * all.asked)
        return Shortfall::found_in_part;
    return Shortfall::none;
}

/// A look at which it was not an item's turn tells nothing of it; one that saw little of it, nothing of its place.
void LightGate::take(Instant at, const ItemLight& seen, Item& item) const {
    item.name = seen.name;
    item.dim = seen.dim;
    item.extent_mm = seen.extent_mm;
    if (seen.lit)
        item.lit_at = at;
    else
        item.good = 0;  // what comes back into the light is measured anew
    std::erase_if(item.looks, [&](const Item::Look& look) { return !within_fresh(look.at, at); });
    if (seen.dim && !seen.told()) return;
    item.looks.push_back({at, seen.lit_segments, seen.steep_segments, seen.segments, seen.seen, seen.part_off_mm,
                          seen.by_untold_height_mm, seen.known() && !seen.one_direction_only});
    item.fell_short = shortfall_of(item) != Shortfall::none;
    if (seen.segments == 0) return;
    if (seen.seen >= settings_.least_seen_of_item * seen.segments) {
        item.off_mm = seen.off_mm;
        item.depth_mm = seen.depth_mm;
        item.good = item.off_mm <= settings_.warn_mm ? item.good + 1 : 0;
    } else if (!measured(item)) {
        item.good = 0;
    }
}

void LightGate::take(Instant at, const LightCheck& check) {
    last_ = check;
    measured_at_ = at;
    if (check.told_whole) told_whole_at_ = at;
    constexpr double kSlow = 0.1;
    if (check.seen >= settings_.least_seen) {
        brighter_ = brighter_ > 0 ? (1 - kSlow) * brighter_ + kSlow * check.fainter : check.fainter;
        constexpr double kBack = 1.2;  // what is warned of once is so until it is clearly no more
        faint_ = brighter_ > 0 && brighter_ < settings_.least_brighter * (faint_ ? kBack : 1);
    }
    items_.resize(check.items.size());
    for (std::size_t i = 0; i < items_.size(); ++i) take(at, check.items[i], items_[i]);
    const bool measured = check.seen >= settings_.least_seen && check.seen_share() >= settings_.least_seen_share;
    const bool beyond_search = check.far_mm && *check.far_mm > settings_.stop_mm;
    const bool far = beyond_search || (measured && check.most_mm > settings_.stop_mm);
    bad_ = far ? bad_ + 1 : 0;
    good_ = measured && check.light_off_mm() <= settings_.warn_mm ? good_ + 1 : 0;
    if (bad_ < settings_.dark_after) return;
    stopped_ = true;
    stopped_at_mm_ = beyond_search ? *check.far_mm : check.off_mm;
}

LightGate::Ruling LightGate::step(Instant at, bool lit, const std::optional<LightCheck>& check,
                                  const std::vector<LightCause>& causes, double unnoticed_mm) {
    weak_ = unnoticed_mm > settings_.warn_unnoticed_mm ? weak_ + 1 : 0;
    if (weak_ >= settings_.dark_after) weak_at_ = at, unnoticed_mm_ = unnoticed_mm;
    if (lit && verified_ && at - lit_at_ > settings_.verified_for) verified_ = false;
    if (lit && !lit_) lit_since_ = at;
    if (!skin_known_at_) skin_known_at_ = at;
    lit_ = lit;
    if (lit) lit_at_ = at;
    if (check && lit) take(at, *check);
    if (!lit) forget();
    Ruling ruling = rule(at, causes);
    if (!lit && !stopped_) ruling = {};
    if (lit && !stopped_ && faint(at))
        ruling.details.push_back(fmt::format(
            "The lines are less than {:.0f} % brighter than the skin beside them: turn the room's lamps down, or away "
            "from the patient.",
            10 * std::floor(10 * brighter_ + 1)));
    for (const LightCause& cause : causes) {
        ruling.details.push_back(cause.sentence());
        ruling.details.push_back(cause.remedy());
    }
    return ruling;
}

/// What lamps outshine a camera may still measure; an eye takes it for nothing.
bool LightGate::faint(Instant at) const {
    return last_ && within_fresh(measured_at_, at) && faint_;
}

bool LightGate::rule_on_item(const Item& item, Ruling& ruling) const {
    const Item::Look all = item.all();
    if (item.dim && all.asked == 0) return false;
    const Shortfall shortfall = shortfall_of(item);
    if (shortfall == Shortfall::not_measured) {
        ruling.found_wrong = false;
        ruling.headline = fmt::format("LOOK: \"{}\" is not measured.", item.name);
        ruling.details = {
            2 * all.steep > all.lit
                ? "Its light meets the skin too flat to be measured: look yourself, or turn the head."
            : 2 * all.asked >= all.lit && all.lit > 0
                ? "Its light is too faint, or ink or something else lies there: look at it yourself."
                : "The cameras do not see its light, or not apart from other light: look at it yourself."};
        return true;
    }
    if (item.off_mm > settings_.warn_mm) {
        ruling.of_other = true;
        ruling.headline = fmt::format("LOOK: \"{}\" lies {} mm beside its place.", item.name, said(item.off_mm));
        ruling.details = {"Look at it on the skin; if it stays so, scan again."};
        if (item.depth_mm) ruling.details.insert(ruling.details.begin(), sentence_of_height(*item.depth_mm));
        return true;
    }
    if (const double part_mm = item.part_off_mm(); part_mm > settings_.warn_mm) {
        ruling.of_other = true;
        ruling.headline = fmt::format("LOOK: a part of \"{}\" lies {} mm beside its place.", item.name, said(part_mm));
        ruling.details = {"Look at it on the skin; if it stays so, scan again."};
        return true;
    }
    if (shortfall == Shortfall::visible_in_part) {
        ruling.found_wrong = false;
        ruling.headline = fmt::format("LOOK: \"{}\" is measured in part only.", item.name);
        ruling.details = {fmt::format("The cameras can see about {:.0f} % of its light: look at the rest yourself.",
                                      10 * std::round(10. * all.asked / all.lit))};
        return true;
    }
    if (shortfall == Shortfall::found_in_part) {
        ruling.found_wrong = false;
        ruling.headline = fmt::format("LOOK: \"{}\" is measured in part only.", item.name);
        ruling.details = {fmt::format("About {:.0f} % of its light are not found in their place: look there yourself.",
                                      10 * std::round(10. * (all.asked - all.seen) / all.asked))};
        return true;
    }
    if (const double aside_mm = item.by_untold_height_mm(); !item.dim && aside_mm > settings_.stop_mm) {
        ruling.found_wrong = false;
        ruling.headline = fmt::format("LOOK: the height of the skin at \"{}\" is not known.", item.name);
        ruling.details = {fmt::format("If it rose or sank since the scan, the light lies up to {:.0f} mm aside: look "
                                      "yourself.",
                                      std::ceil(aside_mm)),
                          "Where both cameras see it they can tell: turn the head, or clear what is before one."};
        return true;
    }
    return false;
}

/// The light as measured, from the gravest down; false when nothing is wrong with it.
bool LightGate::rule_on_measurement(Instant at, Ruling& ruling) const {
    if (!last_ || !within_fresh(measured_at_, at)) {
        if (!last_ && at - lit_since_ <= settings_.fresh) {
            ruling.headline = "LOOK: the light is being measured.";
            return true;
        }
        ruling.headline = "LOOK: the light is not measured.";
        ruling.details = {
            "The cameras have not measured the light for a second or more: look at it on landmarks before you use it."};
        return true;
    }
    if (last_->expected < settings_.least_seen && last_->seen == last_->expected) {
        ruling.headline = "LOOK: too little of the light can be measured.";
        ruling.details = {fmt::format(
            "The cameras can see {} of its stretches only, and see them; {} are needed: look at it yourself.",
            last_->expected, settings_.least_seen)};
        return true;
    }
    ruling.found_wrong = true;
    if (last_->seen < settings_.least_seen || last_->seen_share() < settings_.least_seen_share) {
        ruling.headline = "LOOK: the cameras do not see the light.";
        ruling.details = {
            fmt::format("They see {} of {} stretches: something is before them, or the room's lamps outshine them.",
                        last_->seen, last_->expected)};
        return true;
    }
    const Item* aside = nullptr;
    bool another_right = false;
    for (const Item& item : items_) {
        if (!within_fresh(item.lit_at, at) || !measured(item)) continue;
        if (item.off_mm <= settings_.warn_mm)
            another_right = true;
        else if (!aside || item.off_mm > aside->off_mm)
            aside = &item;
    }
    if (aside && another_right) return rule_on_item(*aside, ruling);
    if (last_->light_off_mm() > settings_.warn_mm) {
        ruling.headline = fmt::format("LOOK: the light lies up to {} mm beside the plan.", said(last_->light_off_mm()));
        ruling.details = {"Wait until the patient lies still; if it stays so, scan again."};
        return true;
    }
    for (const Item& item : items_)
        if (within_fresh(item.lit_at, at) && rule_on_item(item, ruling)) return true;
    ruling.found_wrong = false;
    if (!within_fresh(told_whole_at_, at)) {
        ruling.headline = "LOOK: the light is measured in one direction only.";
        ruling.details = {"Straight lines tell nothing along themselves: look at their ends on the skin."};
        return true;
    }
    return false;
}

/// The table of GATE.md, from the gravest down.
LightGate::Ruling LightGate::rule(Instant at, const std::vector<LightCause>& causes) const {
    Ruling ruling;
    ruling.ask_to_verify = !verified_;
    if (last_ && (last_->seen >= settings_.least_seen || last_->far_mm)) {
        ruling.off_mm = last_->light_off_mm();
        if (!last_->far_mm) ruling.sigma_mm = last_->sigma_mm;
    }
    if (stopped_) {
        ruling.stop = true;
        if (skin_off_mm_ > settings_.stop_mm) {
            ruling.of_other = true;
            ruling.headline =
                std::isfinite(skin_off_mm_)
                    ? fmt::format("Dark: the skin lies {} mm off where the markers put it.", said(skin_off_mm_))
                    : "Dark: the skin does not lie where the markers put it.";
            ruling.details = {
                "The markers have moved on the patient, or the patient under them: fix them, and scan again."};
            return ruling;
        }
        ruling.headline = fmt::format("Dark: the light lay {} mm beside the plan.", said(stopped_at_mm_));
        ruling.details = {"Measured twice. Take away what lies on the lines (a swab, a drape), and press Track.",
                          "If it comes back scan again, and if that does not help run `planlight check`."};
        return ruling;
    }
    ruling.trust = LightTrust::look;
    const auto wrong = std::find_if(causes.begin(), causes.end(), [](const LightCause& c) { return c.light_is_wrong; });
    if (rule_on_measurement(at, ruling)) {
        if (wrong == causes.end()) return ruling;
        ruling.found_wrong = true;
        ruling.headline = "LOOK: " + wrong->headline();  // its sentence and remedy follow
        ruling.details.clear();
        return ruling;
    }
    if (skin_off_mm_ > settings_.warn_mm) {
        ruling.found_wrong = true;
        ruling.of_other = true;
        ruling.headline = fmt::format("LOOK: the skin lies {} mm off where the markers put it.", said(skin_off_mm_));
        ruling.details = {"Check the skin again; if it stays so, scan and match anew."};
        return ruling;
    }
    if (wrong != causes.end()) {
        ruling.found_wrong = true;
        ruling.headline = "LOOK: " + wrong->headline();
        return ruling;
    }
    if (within_fresh(weak_at_, at)) {
        ruling.headline = "LOOK: so few markers are seen that a slip would not show.";
        ruling.details = {
            fmt::format("Were one of them pushed aside by 1 mm, the plan could lie {:.0f} mm off without a sign.",
                        unnoticed_mm_),
            "Uncover more markers, or paste another and scan again."};
        return ruling;
    }
    if (!verified_) {
        ruling.headline = "LOOK at the light on two landmarks.";
        ruling.details = {
            fmt::format("The cameras measure it within {} mm of the plan.", said(std::max(0.1, last_->off_mm))),
            "Press \"Show landmarks\": they are lit one after the other for you to look at."};
        return ruling;
    }
    const bool items_good = std::ranges::all_of(items_, [&](const Item& item) {
        return item.dim || !within_fresh(item.lit_at, at) || item.good >= settings_.green_after;
    });
    if (good_ < settings_.green_after || !items_good) {
        ruling.headline = "LOOK: the light is being measured.";
        return ruling;
    }
    ruling.trust = LightTrust::aligned;
    const auto bright = std::ranges::find(items_, false, &Item::dim);
    const bool alone = bright != items_.end() && std::ranges::any_of(items_, &Item::dim);
    ruling.headline = alone ? fmt::format("\"{}\" is on the skin.", bright->name) : "The plan is on the skin.";
    ruling.details = {fmt::format("Measured by the cameras: 95 % of the light within {} mm of the plan.",
                                  said(std::max(0.1, last_->off_mm)))};
    constexpr double kMostOfIt = 0.75;
    if (last_->lit_seen < kMostOfIt * last_->lit)
        ruling.details.push_back(
            fmt::format("They see about {:.0f} % of the light.", 10 * std::round(10. * last_->lit_seen / last_->lit)));
    if (skin_known_at_ && at - *skin_known_at_ >= settings_.skin_checked_for) {
        constexpr int kStep_min = 5;  // lest the words change every minute
        const auto minutes = std::chrono::duration_cast<std::chrono::minutes>(at - *skin_known_at_).count();
        ruling.details.push_back(
            fmt::format("Skin not checked for {} minutes: markers that slid all together would not show.",
                        minutes / kStep_min * kStep_min));
    }
    return ruling;
}

}  // namespace planlight
