#include "app/live/projector_watch.h"

namespace planlight {

void ProjectorWatch::put_into(OperatorModel& model) const {
    if (model.light_stays) {
        if (!problem_.empty()) model.status.details.push_back("No projector: " + problem_.what + ".");
    } else if (problem_.may_be_lit) {
        model.status = {StatusKind::refused, "The projector's light may still be on.", {problem_.remedy}, {}};
        model.light_on = true;
    } else if (!problem_.empty()) {
        model.status = {StatusKind::dark,
                        "No projector: " + problem_.what + ".",
                        {problem_.remedy, model.may_light_item ? "It is looked for every second. The match is kept."
                                                               : "It is looked for every second."},
                        {}};
        model.light_on = false;
    } else if (was_away_) {
        std::vector<std::string> why{"The projector was away and was started again."};
        if (model.track.enabled) why.emplace_back("Track looks first whether all is as it was.");
        model.status.details.insert(model.status.details.begin(), why.begin(), why.end());
    }
}

}  // namespace planlight
