#include "segmentation/skin_judgement.h"

#include <algorithm>

#include "planning_io/types/error.h"
#include "segmentation/beside_head.h"
#include "segmentation/boneless_ends.h"
#include "segmentation/doubt_head.h"
#include "segmentation/doubt_series.h"
#include "segmentation/doubt_surface.h"
#include "segmentation/skin_layers.h"
#include "segmentation/skin_shape.h"
#include "segmentation/things_on_skin.h"

namespace planlight {

SkinJudgement judge_skin(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin) {
    SkinJudgement result;
    if (skin.vertices_in_ct.empty()) return result;
    const HeadBall ball = largest_ball(volume, mask, skin);
    result.ball_radius_mm = ball.radius_mm;
    result.ball_centre_in_ct = ball.centre_in_ct;
    const CtGreys greys = ct_greys(volume, mask);
    result.cut_sides = cut_sides_of(skin, ball, boneless_ends(volume, mask, skin, ball, greys));
    const ThingsOnSkin things = things_on_skin(volume, mask, skin, ball);
    const SkinLayers layers = layers_under(volume, mask, skin, result.ball_centre_in_ct, things.plane, greys);
    result.layered_share = layers.layered_share;
    result.scalp_mm = layers.scalp_mm;
    result.edge_blur_mm = layers.edge_blur_mm;
    result.gap_cm2 = layers.gap_cm2;
    result.boneless_cm2 = layers.boneless_cm2;
    result.light_cm2 = layers.light_cm2;
    result.light_at = where_on_head(layers.light_in_ct, ball);
    result.beside_mm = ball_beside_head_mm(volume, mask);
    if (!mask.levels.empty()) result.strand_mm = strand_length_mm(volume, mask, skin);
    result.nose_mm = nose_length_mm(skin, ball, things.plane);
    result.one_sided_cm2 = things.one_sided_cm2;
    result.bumps_cm2 = things.bumps_cm2;
    result.width = things.width;
    result.shelf_cm2 = things.shelf_cm2;
    result.bright_bone = layers.bright_bone;
    result.noise_sigma_mm = skin_edge_sigma_mm(volume, mask, skin);
    result.sigma_mm = std::max(result.noise_sigma_mm, 0.25 * std::max(0.0, result.edge_blur_mm - 1.5));
    doubt_head(volume, mask, skin, ball, things.plane, layers, result);
    doubt_surface(mask, result);
    doubt_series(volume, mask, ball, greys, result);
    doubt_ends(result);
    return result;
}

void refuse_implausible(const SkinJudgement& judgement) {
    if (judgement.refusals.empty()) return;
    throw InputError({}, judgement.refusals.front().finding, judgement.refusals.front().remedy);
}

}  // namespace planlight
