#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/report/recorded_moments.h"
#include "app/session.h"
#include "app/windows/operator_model.h"
#include "planning_io/case/case_folder.h"
#include "projection/check_light.h"

namespace planlight {

inline constexpr const char* kAnonymousKeepsNoPlan = "An anonymous recording does not keep where the plan lies.";

/// A line in a camera's picture, pixels.
using LineInPicture = std::vector<Eigen::Vector2d>;

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
    std::array<std::vector<LineInPicture>, 2> plan;  ///< its strokes where they are seen; none of what was hidden
    std::vector<Place> places;                       ///< of what was lit, that a camera should see
    LightCheck light;
    std::shared_ptr<const PlanDrawing> drawn;  ///< without what was hidden; the same as long as match and hiding are
    std::shared_ptr<const std::vector<LightLine>> light_lines;  ///< the light where it was seen, ct
    SceneView by_projector;                                     ///< the head as the light fell on it
};

/// Throws InputError where the recording is of another case, or of this one with another skin or plan.
void check_case(const RecordingHead& head, const Case& the_case, const std::filesystem::path& recording);

/// Compares plan and light at frames of one recording. What it made for a match it keeps for the next frame.
class MomentComparer {
public:
    /// Keeps a reference to the case. Throws InputError when the recording is of another.
    MomentComparer(const Case& the_case, const RecordingTimeLine& line, const std::filesystem::path& recording);
    ~MomentComparer();

    /// `pictures` are those of that frame. Throws DamagedFileError.
    MomentComparison compare(RecordedMoments& moments, std::size_t frame, const RecordedMoment& pictures);

private:
    struct Drawn;
    Drawn* drawn_at(RecordedMoments& moments, std::size_t frame);

    const Case& case_;
    bool anonymous_ = false;
    DrawingSettings how_;
    std::unique_ptr<CaseDrawing> planned_;
    std::unique_ptr<Drawn> drawn_;
};

/// The head with the plan in its colours and the light where it was seen in white; and the view that shows the plan as
/// the projector sees it.
SceneModel scene_of(const MomentComparison& moment, std::shared_ptr<const TriangleMesh> skin);
SceneView view_of(const MomentComparison& moment);

/// How far off its light is, and what of the whole plan's light was found; a sentence each.
std::string words_of(const MomentComparison::Place& place);
std::string sum_of(const MomentComparison& moment);

/// x, y, width, height of the part of a picture that the plan is in, with some skin round it; of all of it where there
/// is none.
std::array<double, 4> round_the_plan(const std::vector<LineInPicture>& plan, const GrayImage& picture);

/// For the page of a review: both pictures with the plan over them; pointing at a place, or pressing on it, says how
/// far off its light is. `left`, `right`, `scene`: the pictures beside the page.
std::string comparison_section(const MomentComparison& moment, const StereoFrame& pictures, const std::string& left,
                               const std::string& right, const std::string& scene);

/// The same as a table: item, place in ct (LPS, mm), mm off, one standard deviation.
std::string comparison_csv(const MomentComparison& moment);

}  // namespace planlight
