#pragma once

#include <vector>

#include "app/evaluation/chain_report.h"

namespace planlight {

/// Collects the pictures of one run for the report: patterns, clouds (Fig. 2), before and after the fine match (Fig.
/// 3), cameras with projected plan and markers (Fig. 4), the projector's picture, the light on the skin.
class ChainPictures {
public:
    ChainPictures(const Case& the_case, const CaseDrawing& drawing);

    /// The callbacks that take the pictures; `progress` is left as it is.
    void watch(ChainWatcher& watcher);

    const std::vector<ReportPicture>& pictures() const { return pictures_; }

private:
    void take_scan(const Session& session);
    void take_match(const Session& session);
    void take_light(const Session& session, const simulation::SimulatedRig& rig, const Session::Update& update,
                    const std::string& stage);
    void add(const std::string& title, const std::string& caption, RgbImage picture);

    const Case& case_;
    const CaseDrawing& drawing_;
    std::vector<ReportPicture> pictures_;
    int rest_updates_ = 0, moving_updates_ = 0;
};

}  // namespace planlight
