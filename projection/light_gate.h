#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/time.h"
#include "projection/check_light.h"
#include "projection/light_cause.h"

namespace planlight {

struct LightGateSettings {
    double warn_mm = 1;                ///< 95 % of the light lies within this of the plan, else amber
    double stop_mm = 2;                ///< and two thirds of it within this, else dark
    double least_seen_share = 0.5;     ///< of the stretches that the cameras should see
    double least_seen_of_item = 0.3;   ///< of the stretches of each item, over the looks of the last `fresh`
    double least_asked_of_item = 0.5;  ///< of the stretches of each item that are lit: else it is measured in part only
    double least_seen_of_asked = 0.5;  ///< and of those that the cameras should see
    double hysteresis = 0.1;    ///< of these three: so much more of an item must be seen where it was too little before
    double small_item_mm = 30;  ///< of an item no larger than this what is seen, in two directions, stands for the rest
    int least_seen = 5;         ///< stretches: fewer are no measurement
    int green_after = 3;        ///< good measurements in a row, of all the light and of each item
    int dark_after = 2;         ///< bad ones in a row
    double warn_unnoticed_mm = 3;  ///< so far a marker that slips by 1 mm may move the plan before it shows
    double least_brighter = 0.3;   ///< the fainter lines than the skin beside them; what is below is warned of
    Instant fresh = std::chrono::seconds(1);         ///< an older measurement is none
    Instant verified_for = std::chrono::minutes(5);  ///< of light that was interrupted; then a person looks again
    /// From a match, or a check of the skin, until green light says that it was long ago.
    Instant skin_checked_for = std::chrono::minutes(10);
};

/// Whether the plan on the skin may be trusted.
enum class LightTrust {
    dark,     ///< no light, or light that must go out
    look,     ///< light that a person must look at: not verified, not measured, or beside its place
    aligned,  ///< measured where it belongs, and verified by a person
};

/// The colour of the banner is a measurement: what CHECK saw and what a person said decide whether the light is
/// trusted.
///
/// Verified by a press, for one match; asked again after a new match, after a stop, and after darkness of more than
/// `verified_for`.
/// Time is handed in.
class LightGate {
public:
    explicit LightGate(const LightGateSettings& settings = {}) : settings_(settings) {}

    struct Ruling {
        LightTrust trust = LightTrust::dark;
        std::string headline;  ///< empty where it is dark for a reason of the caller's
        std::vector<std::string> details;
        bool ask_to_verify = false;
        bool found_wrong = false;  ///< the headline says what was measured wrong, or known to be
        bool stop = false;         ///< the light must go out now, and stays out until `restart`
        bool of_other = false;     ///< the figure in the headline is an item's or the skin's, not that of all light
        std::optional<double> off_mm, sigma_mm;  ///< of the light beside the plan, as last measured
    };

    /// One update: whether light is on the skin, what CHECK saw of it, if it looked, what is known to be wrong, and how
    /// far a slip that the markers do not show may move the plan (`TrackedPose::external_reliability_mm`).
    Ruling step(Instant at, bool lit, const std::optional<LightCheck>& check,
                const std::vector<LightCause>& causes = {}, double unnoticed_mm = 0);

    /// A person has looked at the light on landmarks and says that it is right.
    void verify(Instant at);
    bool verified() const { return verified_; }

    /// A short scan found the plan's skin so far off where the markers put it, mm (infinite: elsewhere, nobody can say
    /// by how much): beyond `stop_mm` the light stops, beyond `warn_mm` it is not trusted until the next check or
    /// match.
    void skin_checked(double off_mm);
    /// Since when it is known where the skin lies: the first update after the match, or after such a check.
    std::optional<Instant> skin_known_at() const { return skin_known_at_; }
    void new_match();  ///< or one that was found to hold still: nothing is verified or measured any more
    /// Light is asked for again; after a stop it must be verified anew, for what a person saw then was no longer true.
    void restart();
    /// From now on something else is lit, a landmark in place of the plan say, or the plan again after stripes: what
    /// was measured was of other light.
    void other_light();

    /// To be asked before anything is lit: why there must be no light, as `step` would rule; empty: there may be.
    std::optional<Ruling> forbids() const;

private:
    /// An item of the plan, as the checks of the last `fresh` saw it.
    struct Item {
        struct Look {
            Instant at{};
            int lit = 0, steep = 0, asked = 0, seen = 0;  ///< stretches
            double part_off_mm = 0;                       ///< `ItemLight::part_off_mm`
            double by_untold_height_mm = 0;               ///< `ItemLight::by_untold_height_mm`
            bool told_whole = false;                      ///< in two directions along the skin
        };
        std::string name;
        bool dim = false;                                            ///< `ItemLight::dim`
        double extent_mm = std::numeric_limits<double>::infinity();  ///< `ItemLight::extent_mm`
        Instant lit_at = Instant::min();
        std::vector<Look> looks;
        bool fell_short = true;  ///< too little of it was seen when it was last judged
        int good = 0;            ///< looks in a row that found it in its place
        double off_mm = 0;       ///< by the last look that saw enough of it
        std::optional<double> depth_mm;
        Look all() const;                    ///< of all looks together
        double part_off_mm() const;          ///< as two looks found it at least
        double by_untold_height_mm() const;  ///< median of the looks that saw it
        bool told_whole() const;             ///< by one of the looks
    };
    void take(Instant at, const LightCheck& check);
    bool faint(Instant at) const;
    Ruling rule(Instant at, const std::vector<LightCause>& causes) const;
    bool rule_on_measurement(Instant at, Ruling& ruling) const;
    bool rule_on_item(const Item& item, Ruling& ruling) const;
    /// How too little of an item is seen, if it is.
    enum class Shortfall { none, not_measured, visible_in_part, found_in_part };
    Shortfall shortfall_of(const Item& item) const;
    double limit_for(const Item& item, double share) const;
    bool measured(const Item& item) const;
    void take(Instant at, const ItemLight& seen, Item& item) const;
    void forget();
    std::string said(double off_mm) const;  ///< as every figure of an error here
    bool within_fresh(Instant then, Instant at) const { return then != Instant::min() && at - then <= settings_.fresh; }

    LightGateSettings settings_;
    bool verified_ = false, stopped_ = false, lit_ = false;
    int good_ = 0, bad_ = 0;
    double brighter_ = 0;                   ///< `LightCheck::fainter`, mean of the last checks; 0: not known
    bool faint_ = false;                    ///< by that
    int weak_ = 0;                          ///< poses running that a slip may move too far unnoticed
    double unnoticed_mm_ = 0;               ///< by the last of them
    double stopped_at_mm_ = 0;              ///< of the light that was last stopped
    double skin_off_mm_ = 0;                ///< by the last check of the skin; 0: none
    std::optional<Instant> skin_known_at_;  ///< the first update after that check, or the match
    std::optional<LightCheck> last_;
    std::vector<Item> items_;
    Instant measured_at_{}, lit_at_{}, told_whole_at_ = Instant::min(), weak_at_ = Instant::min(), lit_since_{};
};

}  // namespace planlight
