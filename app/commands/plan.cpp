#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/plan_options.h"
#include "app/console.h"
#include "app/json_text.h"
#include "app/prepare_case.h"
#include "app/report/clearance_json.h"
#include "app/site_settings.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_rtstruct.h"
#include "planning_io/plan/plan_shapes.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "projection/check_plan.h"
#include "projection/draw_plan.h"
#include "projection/label_names.h"
#include "projection/mid_plane.h"
#include "projection/said_frame.h"

namespace planlight {
namespace {

struct PlanOptions {
    std::vector<Path> files, risk;
    Path case_folder, volume, out;
    std::string series_uid, frame, accept_frame, risk_frame;
    bool json = false;
};

/// What the plan is checked against: nothing, a volume, or a case.
struct Patient {
    std::string code, volume_hash, frame_of_reference_uid;
    SeriesIdentity identity;  ///< of the volume
    std::optional<SkinSurface> skin;
    std::optional<VolumeBox> box;
    std::vector<RiskStructure> risk_structures;  ///< of the case
    bool known = false;
    bool on_given_surface = false;  ///< its skin is one that somebody else segmented
};

Patient read_patient(const PlanOptions& options) {
    Patient patient;
    if (!options.case_folder.empty()) {
        Case prepared = read_case(options.case_folder);
        patient.known = true;
        patient.code = prepared.code;
        patient.volume_hash = prepared.volume_hash;
        patient.frame_of_reference_uid = prepared.frame_of_reference_uid;
        patient.on_given_surface = prepared.skin_threshold == 0;
        patient.skin.emplace(std::move(prepared.skin));
        patient.risk_structures = std::move(prepared.plan.risk_structures);
    }
    if (!options.volume.empty()) {
        // Of a case the hash says whether it was laid onto an even grid.
        const Volume volume = read_volume(options.volume, options.series_uid,
                                          patient.known ? SliceGaps::resampled : SliceGaps::refused, &patient.identity);
        const std::string hash = hash_of(volume);
        if (patient.known && patient.volume_hash != hash)
            throw InputError(options.volume,
                             "is not the volume of this case (" + hash.substr(0, 8) + ", that of the case is " +
                                 patient.volume_hash.substr(0, 8) + ")",
                             "Name the volume that the case was prepared from.");
        if (!patient.known) patient.code = hash.substr(0, 8);
        patient.known = true;
        patient.frame_of_reference_uid = volume.frame_of_reference_uid;
        patient.box = box_of(volume);
    }
    return patient;
}

void check_in_box(const Plan& plan, const VolumeBox& box) {
    for (const auto& p : points_of(plan)) {
        const Eigen::Vector3d v = box.ct_from_voxel.inverse() * p;
        for (int axis = 0; axis < 3; ++axis)
            if (v[axis] < -2 || v[axis] > box.size[static_cast<std::size_t>(axis)] + 1)
                throw InputError({},
                                 fmt::format("The plan's point ({:.0f}, {:.0f}, {:.0f}) lies outside the volume", p.x(),
                                             p.y(), p.z()),
                                 "Check that it was made on this CT, its coordinate system and its units.");
    }
}

/// The items as a list, with where each lies on the head when the skin is known.
class Listing {
public:
    Listing(const Patient& patient, SiteSettings units)
        : site(std::move(units)), skin_(patient.skin ? &*patient.skin : nullptr) {
        if (skin_) mid_plane_ = find_mid_plane(*skin_);
    }
    /// `points`: of the item on the skin, the first where it is said to lie; a line's side is that of its middle, and
    /// where it runs over the middle of the head, from where to where. `clearances`: to the plan's risk structures, of
    /// the item.
    void add(const char* kind, const std::string& name, const std::string& what,
             const std::vector<Eigen::Vector3d>& points, const Clearances& clearances) {
        const Eigen::Vector3d& at = points.front();
        nlohmann::json item{{"kind", kind}, {"name", name}, {"what", what}, {"at_in_ct", {at.x(), at.y(), at.z()}}};
        item["risk"] = clearances_json(clearances);
        std::string where;
        if (skin_) {
            const double far = (skin_->nearest(at).p_in_ct - at).norm();
            item["to_skin_mm"] = far;
            where = ", " + length_text(far, site) + " from the skin";
        }
        if (mid_plane_) {
            double left = 0, least = 1e9, most = -1e9;
            for (const auto& p : points) {
                const double here = mid_plane_->left_mm(p);
                left += here / static_cast<double>(points.size());
                least = std::min(least, here);
                most = std::max(most, here);
            }
            item["left_of_middle_mm"] = left;
            const auto side = [&](double mm) {
                return fmt::format("{} {}", length_text(std::abs(mm), site), mm > 0 ? "left" : "right");
            };
            constexpr double kOver_mm = 5;  // a line over the middle of the head lies on both sides of it
            if (least < -kOver_mm && most > kOver_mm)
                where += fmt::format(", from {} to {} of the middle", side(most), side(least));
            else
                where += fmt::format(", {} of the middle", side(left));
        }
        if (!clearances.empty()) where += ", " + clearance_in_words(clearances.front());
        items.push_back(std::move(item));
        lines += fmt::format("  {:<14} {:<24} {}{}\n", kind, name, what, where);
    }
    const SiteSettings site;  ///< the unit of the lines
    nlohmann::json items = nlohmann::json::array();
    std::string lines;

private:
    const SkinSurface* skin_;
    std::optional<MidPlane> mid_plane_;
};

/// `clearances`: of all items, in the order in which they are listed.
void list_plan(Listing& list, const Plan& plan, const std::vector<Clearances>& clearances) {
    std::size_t n = 0;
    for (const auto& o : plan.osteotomy_lines) {
        double way = 0;
        for (std::size_t i = 1; i < o.points_in_ct.size(); ++i)
            way += (o.points_in_ct[i] - o.points_in_ct[i - 1]).norm();
        if (o.closed) way += (o.points_in_ct.front() - o.points_in_ct.back()).norm();
        list.add("osteotomy line", o.name,
                 fmt::format("{}, {} points, {} from point to point", o.closed ? "closed" : "open",
                             o.points_in_ct.size(), length_text(way, list.site)),
                 o.points_in_ct, clearances[n++]);
    }
    for (const auto& b : plan.boreholes)
        list.add("borehole", b.name,
                 fmt::format("diameter {}, depth {}", length_text(b.diameter_mm, list.site),
                             length_text(b.depth_mm, list.site)),
                 {b.position_in_ct}, clearances[n++]);
    for (const auto& t : plan.trajectories)
        list.add("trajectory", t.name,
                 fmt::format("{}{}", length_text(t.length_mm(), list.site),
                             t.diameter_mm > 0 ? ", diameter " + length_text(t.diameter_mm, list.site) : ""),
                 {t.entry_in_ct}, clearances[n++]);
    for (const auto& c : plan.cut_planes)
        list.add("cut plane", c.name, length_text(c.width_mm, list.site) + " x " + length_text(c.height_mm, list.site),
                 {c.origin_in_ct}, clearances[n++]);
}

/// Tells of all that comes too near, and what cannot be measured or written.
std::vector<Clearances> measure_risk(const Plan& plan, const Patient& patient, const PlanOptions& options,
                                     std::vector<std::string>& warnings) {
    const auto tell = [&](const std::string& sentence) {
        warn(sentence);
        warnings.push_back(sentence);
    };
    std::vector<Clearances> clearances = clearances_of(plan, patient.skin ? &*patient.skin : nullptr);
    const std::vector<std::string> names = names_of(plan);
    for (std::size_t i = 0; i < clearances.size(); ++i)
        for (const auto& sentence : risk_warnings(names[i], clearances[i])) tell(sentence);
    if (plan.risk_structures.empty()) return clearances;
    if (!patient.skin)
        for (const auto& hole : plan.boreholes)
            if (!hole.axis_in_ct)
                tell(hole.name +
                     ": it has no axis, so that without --case its way to the risk structures is not known");
    if (!options.out.empty())
        tell("the risk structures are not written: give them to `planlight prepare --risk` beside the plan");
    return clearances;
}

void write(const PlanImport& read, const Patient& patient, const PlanOptions& options) {
    const Plan& plan = read.plan;
    const Path& out = options.out;
    const std::string name = out.filename().string();
    if (name.ends_with(".mrk.json"))
        write_plan(plan, out);
    else if (name.ends_with(".vtp"))
        write_plan_vtp(plan, out);
    else if (name.ends_with(".dcm")) {
        const std::string frame = patient.known ? patient.frame_of_reference_uid : read.frame_of_reference_uid;
        write_plan_rtstruct(plan, {patient.code, frame.empty() ? options.accept_frame : frame, iso_date_now()}, out);
    } else
        throw InputError(out, "is of no kind that a plan is written as", "End its name in .mrk.json, .vtp or .dcm.");
}

int run_plan(const PlanOptions& options) {
    const Patient patient = read_patient(options);
    const auto settings =
        plan_settings(options.frame, options.accept_frame,
                      patient.known ? std::optional(patient.frame_of_reference_uid) : std::nullopt, patient.identity);
    PlanImport read = import_plan(options.files, settings);
    add_risk_structures(read, options.risk, options.risk_frame, settings);
    if (options.risk.empty()) read.plan.risk_structures = patient.risk_structures;
    for (const auto& note : read.notes) warn(note);
    PlanVerdict verdict;
    if (patient.skin) {
        verdict = check_plan(read.plan, *patient.skin, patient.box, plan_checks_on(patient.on_given_surface));
        if (std::string doubt = doubt_of_said_frame(read.said_frame, *patient.skin); !doubt.empty())
            verdict.warnings.push_back(std::move(doubt));
        for (const auto& warning : verdict.warnings) warn(warning);
        refuse_stopped_plan(verdict);
    } else if (patient.box) {
        check_in_box(read.plan, *patient.box);
    }
    for (auto& sentence : check_names(read.plan, DrawingSettings{}.text_height_mm)) {
        warn(sentence);
        verdict.warnings.push_back(std::move(sentence));
    }
    const std::vector<Clearances> clearances = measure_risk(read.plan, patient, options, verdict.warnings);
    if (!options.out.empty()) write(read, patient, options);
    Listing list(patient, options.json ? SiteSettings{} : read_site_settings());
    list_plan(list, read.plan, clearances);
    if (options.json) {
        nlohmann::json result{{"items", list.items},
                              {"risk_structures", risk_structures_json(read.plan)},
                              {"notes", read.notes},
                              {"warnings", verdict.warnings},
                              {"frame_of_reference_uid", read.frame_of_reference_uid},
                              {"checked_against", patient.skin  ? "skin"
                                                  : patient.box ? "volume"
                                                                : "nothing"}};
        if (patient.skin) result["median_to_skin_mm"] = verdict.median_to_skin_mm;
        if (!options.out.empty()) result["written"] = options.out.string();
        std::cout << json_text(result) << '\n';
        return 0;
    }
    fmt::print("{} plan item{}{}:\n{}", read.plan.size(), read.plan.size() == 1 ? "" : "s",
               options.out.empty() ? "" : " in " + options.out.string(), list.lines);
    return 0;
}

}  // namespace

Run add_plan(CLI::App& app) {
    const auto options = std::make_shared<PlanOptions>();
    PlanOptions& o = *options;
    auto* sub = add_command(app, "plan", "Plan files -> checked, listed, converted",
                            "plan trajectories.csv --frame RAS --case case --out plan.mrk.json");
    sub->add_option("files", o.files,
                    "3D Slicer markups (.mrk.json, .fcsv), RTSTRUCT (.dcm), trajectories (.csv, .tsv), lines (.vtp, "
                    ".vtk, .ply, .obj)")
        ->required();
    risk_options(sub, o.risk, o.risk_frame);
    sub->add_option("--case", o.case_folder, "Check against this case's skin");
    sub->add_option("--volume", o.volume, "Check against this volume's box and frame of reference");
    series_option(sub, o.series_uid);
    plan_frame_options(sub, o.frame, o.accept_frame);
    sub->add_option("--out", o.out, "Write the whole plan: .mrk.json, .vtp, or .dcm (RTSTRUCT)");
    json_flag(sub, o.json);
    return [options] { return run_plan(*options); };
}

}  // namespace planlight
