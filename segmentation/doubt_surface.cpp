#include "segmentation/doubt_surface.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "segmentation/skin_doubts.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

constexpr double kUnsure_doubted = 0.06, kUnsure_refused = 0.3;
constexpr double kStrand_mm = 75;  // ears, lips and fins of noise lead away by 50
constexpr double kGap_cm2 = 15, kLight_cm2 = 15;
constexpr double kBonelessEnd_cm2 = 8;  // an ear that the volume cuts off has 4
constexpr double kBumps_cm2 = 10, kShelf_cm2 = 15, kWidth = 1.35, kThickest_mm = 15;

void judge_edges(const SkinMask& mask, SkinJudgement& r) {
    if (r.edge_blur_mm > kBlurred_mm)
        add(r.doubts,
            fmt::format("The edge of the skin is blurred over {:.1f} mm: where it lies is uncertain by {:.1f} mm",
                        r.edge_blur_mm, r.sigma_mm),
            "Use a sharper series if there is one.");
    if (r.gap_cm2 > kGap_cm2)
        add(r.doubts,
            fmt::format(
                "Something thin lies on the skin or stands off it over {:.0f} square cm (a mask, a cushion, a cloth): "
                "there the surface is not the skin",
                r.gap_cm2),
            kLookAtTheSkin);
    if (r.light_cm2 > kLight_cm2)
        add(r.doubts,
            fmt::format("Over {:.0f} square cm ({}) what lies just under the surface is lighter than skin and "
                        "fat: hair, a strap, a cloth or a cover lies on the skin there",
                        r.light_cm2, r.light_at.empty() ? "all over the head" : "most at " + r.light_at),
            kLookAtTheSkin);
    if (r.strand_mm > kStrand_mm)
        add(r.doubts,
            fmt::format(
                "Something thin hangs on the head and leads {:.0f} mm away along itself (a strap, a wire, a strip "
                "beside an ear): there the surface is not the skin",
                r.strand_mm),
            kLookAtTheSkin);
    const std::string found = threshold_text(mask.threshold_said);
    const std::string unsure =
        mask.unsure_share < 1
            ? fmt::format(
                  "{:.0f} % of the outline moves by more than 3 mm when the threshold is taken at 0.7 or 1.5 "
                  "times what was found ({})",
                  100 * mask.unsure_share, found)
            : fmt::format(
                  "none of the outline stays where it is, or no air is left round it, when the threshold is "
                  "taken at 0.7 times what was found ({})",
                  found);
    const std::string tries =
        fmt::format("Try `planlight prepare --threshold {}` and {}, and compare the pictures of the report.",
                    threshold_text(0.7 * mask.threshold_said), threshold_text(1.5 * mask.threshold_said));
    r.unsure = mask.unsure_share > kUnsure_doubted;
    if (mask.unsure_share > kUnsure_refused)
        add(r.refusals, "The skin cannot be told from what surrounds it: " + unsure, tries);
    else if (mask.unsure_share > kUnsure_doubted)
        add(r.doubts, "The skin is uncertain in places: " + unsure, tries);
}

void judge_things(SkinJudgement& r) {
    std::string unasked;
    for (const auto& [figure, what] :
         {std::pair{r.one_sided_cm2, "at one side"}, {r.bumps_cm2, "small things"}, {r.width, "at both sides"}})
        if (std::isnan(figure)) unasked += (unasked.empty() ? "" : ", ") + std::string(what);
    if (!unasked.empty())
        add(r.doubts,
            fmt::format("Whether something lies on the skin ({}) could not be asked: too little of the head is in "
                        "the volume",
                        unasked),
            kLookAtTheSkin);
    if (r.one_sided_cm2 > kOneSided_cm2)
        add(r.doubts,
            fmt::format("Over {:.0f} square cm one side of the head stands out by more than 10 mm before the other: "
                        "something lies on the skin there (a cushion, a cloth), or the head itself is not symmetric",
                        r.one_sided_cm2),
            kLookAtTheSkin);
    if (r.bumps_cm2 > kBumps_cm2)
        add(r.doubts,
            fmt::format("Small things stand out from the upper head over {:.0f} square cm (electrodes, a bandage, a "
                        "strap, a mask): there the surface is not the skin",
                        r.bumps_cm2),
            kLookAtTheSkin);
    if (r.shelf_cm2 > kShelf_cm2)
        add(r.doubts,
            fmt::format(
                "Behind the neck {:.0f} square cm of the surface look up, where a head recedes: something may lie "
                "under the neck (a cushion, a roll)",
                r.shelf_cm2),
            kLookAtTheSkin);
    if (r.width > kWidth)
        add(r.doubts,
            fmt::format("At ears or jaw the head is {:.1f} times as wide as its skull (heads are 0.9 to 1.2 times): "
                        "something may lie on the skin at both sides (head phones, cushions)",
                        r.width),
            kLookAtTheSkin);
    if (r.scalp_mm > kThickest_mm)
        add(r.doubts,
            fmt::format("The soft tissue over the bone of the upper head is {:.0f} mm thick (on heads 4 to 14): "
                        "something may lie on it all over (a cap, wet hair)",
                        r.scalp_mm),
            kLookAtTheSkin);
}

}  // namespace

void doubt_surface(const SkinMask& mask, SkinJudgement& judgement) {
    judge_edges(mask, judgement);
    judge_things(judgement);
}

void doubt_ends(SkinJudgement& r) {
    std::string sides;
    int count = 0;
    for (const CutSide& side : r.cut_sides)
        if (!side.usual) {
            sides += fmt::format("{}the {} ({:.0f} square cm)", count == 0 ? "" : ", ", side.name, side.area_cm2);
            ++count;
        }
    for (const CutSide& side : r.cut_sides)
        if (side.boneless_cm2 > kBonelessEnd_cm2)
            add(r.doubts,
                fmt::format("At {} the volume ends over {:.0f} square cm within something that has no bone under it "
                            "nor round it: something lies on the head there (a cushion, wet hair, a blanket)",
                            "the " + side.name, side.boneless_cm2),
                kLookAtTheSkin);
    if (count == 0) return;
    add(r.doubts, fmt::format("The volume ends within the head: it cuts off {}; what lies there is no skin", sides),
        "Scan, match and draw elsewhere, or give a series that shows the whole head.");
    r.doubts.back().of_the_end = true;
}

}  // namespace planlight
