#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/time.h"

namespace planlight {

struct SkinCheckScheduleSettings {
    std::optional<Instant> every;                     ///< empty: nothing is checked unless a person asks
    Instant announced_for = std::chrono::seconds(5);  ///< before the light makes way for stripes
    Instant still_for = std::chrono::seconds(2);      ///< and so long the patient has lain still by then
    double still_mm = 0.3;                            ///< no marker moved more meanwhile
    /// From a check without an answer to the next; twice as long after each more, at most `every`.
    Instant again_after = std::chrono::seconds(20);
    Instant waits_at_most = std::chrono::seconds(60);  ///< for rest; then that was a check without an answer
    Instant gap = std::chrono::seconds(1);             ///< between two updates; after more it begins anew
};

/// When a session checks the skin by itself, where the operator wished for it: markers that slid all together are what
/// neither tracking nor the light's own check can see. Announced first, and only while the patient lies still. Time is
/// handed in.
class SkinCheckSchedule {
public:
    explicit SkinCheckSchedule(const SkinCheckScheduleSettings& settings = {}) : settings_(settings) {}

    bool wished_for() const { return settings_.every.has_value(); }

    struct Turn {
        bool check = false;  ///< now
        std::string notice;  ///< a sentence for the operator while a check is announced; else empty
    };
    /// One update of a plan that is followed. `known_at`: since when it is known where the skin lies (match, or check
    /// with an answer). `lit`: the plan is lit, and was verified by a person: else nothing is due. `markers`: those of
    /// the reference, rig; empty where the pose is not known.
    Turn step(Instant at, Instant known_at, bool lit, const std::vector<Eigen::Vector3d>& markers);
    void began(Instant at);  ///< a check, whoever asked for it
    void restart();          ///< the plan is lit anew: what is due is announced anew

private:
    bool still(Instant at, const std::vector<Eigen::Vector3d>& markers);
    bool due(Instant at, Instant known_at);

    SkinCheckScheduleSettings settings_;
    struct Seen {
        Instant at{};
        std::vector<Eigen::Vector3d> markers;
    };
    std::deque<Seen> seen_;  ///< of the last `still_for`
    std::optional<Instant> announced_at_, began_at_, last_at_;
    int unanswered_ = 0;  ///< checks that began since it was known
};

}  // namespace planlight
