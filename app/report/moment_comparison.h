#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/case/case_folder.h"
#include "planning_io/types/image.h"
#include "projection/check_light.h"

namespace planlight {

inline constexpr const char* kAnonymousKeepsNoPlan = "An anonymous recording does not keep where the plan lies.";

/// The plan and what was lit at one frame of a recording, measured anew from its pictures.
struct MomentComparison {
    /// A few millimetres of a stroke of the plan.
    struct Place {
        std::string item;
        SeenSegment seen;
        std::array<std::optional<Eigen::Vector2d>, 2> pixel;  ///< of the plan there, in the left and the right picture
    };
    std::string why_not;  ///< in words, why nothing can be compared; empty: it is
    std::string unlit;    ///< in words, why none of the plan, or not all of it, was lit; empty: all of it was
    double at_s = 0;      ///< since the room was entered
    std::array<GrayImage, 2> pictures;
    std::array<std::vector<std::vector<Eigen::Vector2d>>, 2>
        plan;                   ///< its strokes where they are seen, pixels; without hidden items
    std::vector<Place> places;  ///< of what was lit, that a camera should see
    LightCheck light;
    RgbImage scene;  ///< the head as the projector sees it: plan in its colours, the light where it was seen in white
};

/// Of the frame that was kept at `at_s` (as `RecordingTimeLine::frames_s` has it). Throws InputError when the case is
/// another than the recording's, DamagedFileError.
MomentComparison compare_moment(const std::filesystem::path& recording, double at_s, const Case& the_case);

/// For the page of a review: both pictures with the plan over them; pointing at a place, or pressing on it, says how
/// far off its light is. `left`, `right`, `scene`: the pictures beside the page.
std::string comparison_section(const MomentComparison& moment, const std::string& left, const std::string& right,
                               const std::string& scene);

/// The same as a table: item, place in ct (LPS, mm), mm off, one standard deviation.
std::string comparison_csv(const MomentComparison& moment);

}  // namespace planlight
