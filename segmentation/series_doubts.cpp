#include "segmentation/series_doubts.h"

#include <fmt/format.h>

#include "segmentation/cut_greys.h"
#include "segmentation/series_echo.h"

namespace planlight {
namespace {

void doubt_greys(const Volume& volume, const SkinMask& mask, SkinJudgement& r) {
    const CutGreys cut = cut_greys(volume, mask);
    r.cut_air_share = cut.air_share;
    r.cut_body_share = cut.body_share;
    if (!cut.dark_end()) return;
    r.doubts.push_back(
        {fmt::format("Of the air round the head {:.0f} % and of its inside {:.0f} % show exactly the least value: the "
                     "dark end of the greys was cut off, as a window for pictures does, and skin that is as dark with "
                     "it; the surface may lie too deep there",
                     100 * cut.air_share, 100 * cut.body_share),
         "Give the series as the scanner made it, or convert it without a window; look at the skin in the report."});
}

void doubt_movement(const Volume& volume, SkinJudgement& r) {
    const auto echo = strongest_echo(volume);
    if (!echo) return;
    r.echo = echo->strength;
    if (!echo->is_movement()) return;
    r.doubts.push_back(
        {fmt::format("The series shows the head twice, {:.0f} mm apart along {}: the patient seems to have moved while "
                     "it was taken, and the surface is the outermost of both outlines",
                     echo->shift_in_ct.norm(), way_in_words(echo->shift_in_ct)),
         "Give a series in which the patient lay still; look at the skin in the report."});
}

}  // namespace

std::string way_in_words(const Eigen::Vector3d& along_in_ct) {
    Eigen::Index axis = 0;
    along_in_ct.cwiseAbs().maxCoeff(&axis);
    constexpr const char* kWays[] = {"left and right", "front and back", "head and feet"};
    return kWays[axis];
}

void doubt_series(const Volume& volume, const SkinMask& mask, SkinJudgement& judgement) {
    doubt_greys(volume, mask, judgement);
    if (volume.modality == "MR") doubt_movement(volume, judgement);
}

}  // namespace planlight
