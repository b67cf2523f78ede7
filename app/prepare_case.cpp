#include "app/prepare_case.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <ctime>

#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "projection/check_plan.h"

namespace planlight {
namespace {

/// Runs one step, with its name in the progress, and gives its time.
double timed(const std::string& name, const std::function<void(const std::string&, double)>& progress,
             const std::function<void(const std::function<void(double)>&)>& step) {
    const auto began = std::chrono::steady_clock::now();
    step([&](double share) {
        if (progress) progress(name, share);
    });
    if (progress) progress(name, 1);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

/// Refuses a plan that does not fit. What is doubtful about the skin comes first: it may be the one to be mistrusted.
void refuse_misfit(const PlanVerdict& of_plan, const SkinJudgement& skin) {
    try {
        refuse_stopped_plan(of_plan);
    } catch (const InputError& error) {
        if (skin.doubts.empty()) throw;
        std::string doubts;
        for (const SkinDoubt& doubt : skin.doubts) doubts += (doubts.empty() ? "" : "; ") + doubt.finding;
        throw InputError({}, "The skin itself is doubtful, mistrust it first (" + doubts + "). " + error.what(),
                         skin.doubts.front().remedy + " " + error.remedy);
    }
}

/// The LUT, what belongs to the volume, and the plan checked: of a case that has its skin.
void finish(Preparation& done, const Volume& volume, const Plan& plan, const LutSettings& lut,
            const std::string& created, const std::function<void(const std::string&, double)>& progress) {
    Case& the_case = done.prepared;
    done.lut_s =
        timed("table", progress, [&](const auto& share) { the_case.lut = build_skin_lut(the_case.skin, lut, share); });
    the_case.volume_hash = hash_of(volume);
    the_case.frame_of_reference_uid = volume.frame_of_reference_uid;
    the_case.lut.volume_hash = the_case.volume_hash;
    the_case.lut.mesh_hash = hash_of(the_case.skin);
    the_case.code = the_case.volume_hash.substr(0, 8);
    the_case.created = created;
    the_case.source = volume.source;
    the_case.plan = plan;
    const PlanVerdict of_plan = check_plan(plan, SkinSurface(the_case.skin), box_of(volume));
    refuse_misfit(of_plan, done.judgement);
    the_case.warnings.insert(the_case.warnings.end(), of_plan.warnings.begin(), of_plan.warnings.end());
}

}  // namespace

std::string iso_date_now() {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

Preparation prepare_case(const Volume& volume, const Plan& plan, const SkinSettings& skin, const LutSettings& lut,
                         const std::string& created, const std::function<void(const std::string&, double)>& progress) {
    Preparation done;
    Case& the_case = done.prepared;
    SkinMask mask;
    done.segment_s = timed("skin", progress, [&](const auto& share) { mask = segment_skin(volume, skin, share); });
    done.triangulate_s = timed("surface", progress,
                               [&](const auto& share) { the_case.skin = triangulate_skin(volume, mask, skin, share); });
    if (skin.phantom) {
        the_case.skin_edge_sigma_mm = skin_edge_sigma_mm(volume, mask, the_case.skin);
    } else {
        done.judgement = judge_skin(volume, mask, the_case.skin);
        refuse_implausible(done.judgement);
        the_case.skin_edge_sigma_mm = done.judgement.sigma_mm;
    }
    done.threshold = mask.threshold_said;
    done.brightness_ratio = mask.brightness_ratio;
    done.body_ml = mask.volume_ml;
    done.removed_ml = mask.removed_ml;
    done.pieces_removed = mask.pieces_removed;
    the_case.skin_threshold = mask.threshold_said;
    the_case.warnings = volume.notes;
    the_case.warnings.insert(the_case.warnings.end(), mask.warnings.begin(), mask.warnings.end());
    for (const SkinDoubt& doubt : done.judgement.doubts)
        the_case.warnings.push_back(doubt.finding + ". " + doubt.remedy);
    if (skin.phantom)
        the_case.warnings.push_back("taken as a phantom: it was not asked whether this is the skin of a head");
    if (volume.modality == "CT" && !volume.is_hu)
        the_case.warnings.push_back(fmt::format(
            "the values of this CT are not HU; the skin threshold {:.0f} was {}: look at the skin before you use it",
            mask.threshold_said, skin.threshold == 0 ? "found from their histogram" : "given"));
    finish(done, volume, plan, lut, created, progress);
    return done;
}

Preparation prepare_case_on(const Volume& volume, const SurfaceFile& surface, const Plan& plan, const LutSettings& lut,
                            const std::string& created,
                            const std::function<void(const std::string&, double)>& progress) {
    Preparation done;
    done.on_given_surface = true;
    done.prepared.skin = surface.mesh;
    done.prepared.warnings = surface.notes;
    finish(done, volume, plan, lut, created, progress);
    return done;
}

}  // namespace planlight
