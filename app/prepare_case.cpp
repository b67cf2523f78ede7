#include "app/prepare_case.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "app/case_model.h"
#include "planning_io/files/memory_need.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/spare_memory.h"
#include "planning_io/volume/read_volume.h"
#include "projection/check_plan.h"
#include "projection/label_names.h"
#include "projection/said_frame.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

// What a preparation has at its fullest, at least: measured, rounded down, so that what would do is never refused.
constexpr double kBytesOfVoxel = 15, kBytesOfTableVoxel = 4, kBytesAnyway = 150e6;

/// Runs one step, with its name in the progress, and gives its time.
double timed(const std::string& name, const PreparationWatcher& watcher,
             const std::function<void(const std::function<void(double)>&)>& step) {
    const auto began = std::chrono::steady_clock::now();
    step([&](double share) {
        if (watcher.progress) watcher.progress(name, share);
    });
    if (watcher.progress) watcher.progress(name, 1);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

/// Refuses a plan that does not fit. What is doubtful about the skin comes first, as it may be the one to be
/// mistrusted; not where the plan lies outside the volume, and not that the volume ends.
void refuse_misfit(const PlanVerdict& of_plan, const SkinJudgement& skin) {
    try {
        refuse_stopped_plan(of_plan);
    } catch (const InputError& error) {
        std::string doubts, remedy;
        for (const SkinDoubt& doubt : skin.doubts) {
            if (doubt.of_the_end) continue;
            if (doubts.empty()) remedy = doubt.remedy;
            doubts += (doubts.empty() ? "" : "; ") + doubt.finding;
        }
        if (doubts.empty() || of_plan.outside_volume) throw;
        throw InputError({}, "The skin itself is doubtful, mistrust it first (" + doubts + "). " + error.what(),
                         remedy + " " + error.remedy);
    }
}

/// Keeps a warning and tells it at once: a later step may fail.
void add_warnings(const std::vector<std::string>& more, const PreparationWatcher& watcher, Case& the_case) {
    for (const auto& warning : more) {
        the_case.warnings.push_back(warning);
        if (watcher.warned) watcher.warned(warning);
    }
}

void tell_of_volume(const Volume& volume, const Plan& plan, const std::string& created, const CaseNames& names,
                    Preparation& done) {
    Case& the_case = done.prepared;
    done.volume = {volume.modality, volume.is_hu, volume.size, volume.spacing_mm()};
    the_case.volume_hash = hash_of(volume);
    the_case.plan_hash = hash_of(plan);
    the_case.code = code_of(the_case.volume_hash, the_case.plan_hash);
    the_case.names = names;
    the_case.names.series = fit_to_be_a_name(volume.series_description);
    the_case.names.series_date = volume.series_date;
    the_case.frame_of_reference_uid = volume.frame_of_reference_uid;
    the_case.created = created;
    the_case.source = volume.source;
    the_case.plan = plan;
}

/// Is this the skin of a head? A phantom is not asked. Refuses what is not, warns of what is doubtful.
void judge(const Volume& volume, const SkinSettings& skin, const PreparationWatcher& watcher, Preparation& done) {
    Case& the_case = done.prepared;
    if (skin.phantom) {
        the_case.skin_edge_sigma_mm = skin_edge_sigma_mm(volume, done.mask, the_case.skin);
        add_warnings({"taken as a phantom: it was not asked whether this is the skin of a head"}, watcher, the_case);
        return;
    }
    done.judgement = judge_skin(volume, done.mask, the_case.skin);
    if (done.judgement.unsure && watcher.unsure) watcher.unsure(volume, done.threshold);
    refuse_implausible(done.judgement);
    the_case.skin_edge_sigma_mm = done.judgement.sigma_mm;
    for (const SkinDoubt& doubt : done.judgement.doubts)
        add_warnings({doubt.finding + ". " + doubt.remedy}, watcher, the_case);
}

/// Items that come too near to what must not be hurt, and what of that the light has no room for.
void warn_of_risk(const PlanDrawing& drawing, const PreparationWatcher& watcher, Case& the_case) {
    for (const DrawnItem& item : drawing.items)
        add_warnings(risk_warnings(item.name, item.clearances), watcher, the_case);
    add_warnings(unlit_warnings(drawing), watcher, the_case);
}

/// Items that have no skin for their name, or for nothing at all.
void warn_of_labels(const PlanDrawing& drawing, const PreparationWatcher& watcher, Case& the_case) {
    const long bare = bare_items(drawing);
    std::string by_code;
    for (const DrawnItem& item : drawing.items)
        if (item.lit_by_code) by_code += fmt::format("{}{} is {}", by_code.empty() ? "" : ", ", item.code, item.name);
    if (!by_code.empty())
        add_warnings({fmt::format("not every name has room in the light, or can be lit. In its place stands: {}. Each "
                                  "item's code stands beside its name in the window, too",
                                  by_code)},
                     watcher, the_case);
    if (bare > 0)
        add_warnings({fmt::format("the plan is crowded: the names of {} of {} items find no free skin, and are not "
                                  "written there",
                                  bare, drawing.items.size())},
                     watcher, the_case);
}

/// The LUT, and the plan checked: of a case that has its skin.
void finish(Preparation& done, const Volume& volume, const LutSettings& lut, const SaidFrame& said_frame,
            const PreparationWatcher& watcher) {
    Case& the_case = done.prepared;
    {
        const SkinSurface surface(the_case.skin);
        const PlanVerdict of_plan =
            check_plan(the_case.plan, surface, box_of(volume), plan_checks_on(done.on_given_surface));
        add_warnings(of_plan.warnings, watcher, the_case);
        if (const std::string doubt = doubt_of_said_frame(said_frame, surface); !doubt.empty())
            add_warnings({doubt}, watcher, the_case);
        refuse_misfit(of_plan, done.judgement);
        done.drawing = draw_plan(the_case.plan, surface);
        add_warnings(check_names(the_case.plan, DrawingSettings{}.text_height_mm), watcher, the_case);
    }
    warn_of_risk(done.drawing, watcher, the_case);
    warn_of_labels(done.drawing, watcher, the_case);
    done.lut_s =
        timed("table", watcher, [&](const auto& share) { the_case.lut = build_skin_lut(the_case.skin, lut, share); });
    the_case.lut.volume_hash = the_case.volume_hash;
    the_case.lut.mesh_hash = hash_of(the_case.skin);
    release_spare_memory();
}

}  // namespace

std::string iso_date_now() {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

void check_memory_to_prepare(const Volume& volume, const LutSettings& lut) {
    double body_mm3 = 1;  // the table reaches over the volume at most, with its margin
    for (std::size_t axis = 0; axis < 3; ++axis)
        body_mm3 *= volume.size[axis] * volume.spacing_mm()[static_cast<Eigen::Index>(axis)];
    const double table = body_mm3 / std::pow(lut.voxel_mm, 3) * kBytesOfTableVoxel;
    const double need = kBytesOfVoxel * static_cast<double>(volume.values.size()) + table + kBytesAnyway;
    check_memory("Preparing this volume", static_cast<std::uint64_t>(need),
                 "Close other programs, give a larger --voxel-mm, or resample the volume to larger voxels.");
}

Preparation prepare_case(const Volume& volume, const Plan& plan, const SkinSettings& skin, const LutSettings& lut,
                         const std::string& created, const PreparationWatcher& watcher, const CaseNames& names,
                         const SaidFrame& said_frame) {
    Preparation done;
    Case& the_case = done.prepared;
    tell_of_volume(volume, plan, created, names, done);
    add_warnings(volume.notes, watcher, the_case);
    done.segment_s = timed("skin", watcher, [&](const auto& share) { done.mask = segment_skin(volume, skin, share); });
    const SkinMask& mask = done.mask;
    done.threshold_given = skin.threshold != 0;
    done.threshold = the_case.skin_threshold = mask.threshold_said;
    done.brightness_ratio = mask.brightness_ratio;
    done.body_ml = mask.volume_ml;
    done.removed_ml = mask.removed_ml;
    done.pieces_removed = mask.pieces_removed;
    add_warnings(mask.warnings, watcher, the_case);
    if (volume.modality == "CT" && !volume.is_hu)
        add_warnings({fmt::format("the values of this CT are not HU; the skin threshold {} was {}: look at the "
                                  "skin before you use it",
                                  threshold_text(done.threshold),
                                  done.threshold_given ? "given" : "found from their histogram")},
                     watcher, the_case);
    done.triangulate_s = timed("surface", watcher,
                               [&](const auto& share) { the_case.skin = triangulate_skin(volume, mask, skin, share); });
    judge(volume, skin, watcher, done);
    finish(done, volume, lut, said_frame, watcher);
    return done;
}

Preparation prepare_case_on(const Volume& volume, const SurfaceFile& surface, const Plan& plan, const LutSettings& lut,
                            const std::string& created, const PreparationWatcher& watcher, const CaseNames& names,
                            const SaidFrame& said_frame) {
    Preparation done;
    done.on_given_surface = true;
    done.prepared.skin = surface.mesh;
    tell_of_volume(volume, plan, created, names, done);
    add_warnings(volume.notes, watcher, done.prepared);
    add_warnings(surface.notes, watcher, done.prepared);
    finish(done, volume, lut, said_frame, watcher);
    return done;
}

}  // namespace planlight
