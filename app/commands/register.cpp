#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/belonging.h"
#include "app/case_model.h"
#include "app/commands/cloud_unit.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/pdf_option.h"
#include "app/commands/rig_words.h"
#include "app/console.h"
#include "app/json_text.h"
#include "app/report/registration_certificate.h"
#include "app/site_settings.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/case/cloud_rig.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/case/slicer_transform.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/point_pairs_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "registration/matching/cloud_normals.h"
#include "registration/matching/cloud_region.h"
#include "registration/matching/register_with_landmarks.h"

namespace planlight {
namespace {

struct RegisterOptions {
    Path case_folder, cloud, out;
    Path pairs;             ///< landmarks: a check of the cloud's match, or, without a cloud, the match
    Path slicer_transform;  ///< to write; empty: not wanted
    Path certificate, pdf;  ///< page to write, and as PDF; empty: not wanted
    std::string unit = "mm";
    bool in_rig = false;
    std::vector<double> viewpoint_in_rig;  ///< 3 numbers, mm; empty: not said
    std::vector<double> region_px;         ///< x y of the corners, left camera; empty: all of the scan
    Path rig;                              ///< whose left camera saw the region
    std::string icp = "signed-distance";
    unsigned seed = 1;
    bool json = false;
};

const char* name_of(Verdict verdict) {
    return verdict == Verdict::yes ? "yes" : verdict == Verdict::ask ? "ask" : "no";
}

void say_left_out(const PointsLeftOut& left_out, const Path& file) {
    if (left_out.all() == 0) return;
    warn(fmt::format(
        "{}: {} points were left out as not measured: {} at the origin, {} where another one is, {} without "
        "a normal.",
        file.string(), left_out.all(), left_out.at_origin, left_out.repeated, left_out.without_normal));
}

/// The cloud as the matching wants it: mm, with normals towards the devices.
PointCloud cloud_of(const RegisterOptions& options, std::optional<RigState>& rig) {
    std::vector<std::string> comments;
    PointsLeftOut left_out;
    PointCloud cloud = read_cloud(options.cloud, {unit_in_mm(options.unit), options.in_rig}, &comments, &left_out);
    say_left_out(left_out, options.cloud);
    check_unit(cloud, options.unit, options.cloud);
    rig = rig_state_in(comments, options.cloud);
    check_points(cloud, rig, options.cloud);
    if (!cloud.normals_in_rig.empty()) return cloud;
    if (options.viewpoint_in_rig.empty())
        throw InputError(
            options.cloud, "has no normals, and nothing says from where it was seen",
            "Say --viewpoint X Y Z: where the scanner stood, in the rig's frame, mm (0 0 0 for most scanners).");
    return with_normals(cloud, Eigen::Vector3d(options.viewpoint_in_rig.data()));
}

/// What lies within the outline that the operator drew on the left camera's picture.
PointCloud in_region(const PointCloud& cloud, const RegisterOptions& options, const std::optional<RigState>& rig) {
    if (options.region_px.size() < 4 || options.region_px.size() % 2 != 0)
        throw Error(ExitCode::usage, fmt::format("--region has {} numbers", options.region_px.size()),
                    "Give x and y of two opposite corners, or of three and more corners of an outline.");
    std::vector<Eigen::Vector2d> outline;
    for (std::size_t i = 0; i + 1 < options.region_px.size(); i += 2)
        outline.emplace_back(options.region_px[i], options.region_px[i + 1]);
    if (!rig && options.rig.empty())
        throw Error(ExitCode::usage, "--region is given, and the cloud does not say which rig saw it",
                    "Name the rig of the scan with --rig rig.json.");
    if (rig && !options.rig.empty() && rig->calibrated.known() &&
        rig->calibrated.hash != name_of(read_rig(options.rig)).hash)
        throw InputError(options.rig, "is another rig than the one that the cloud was made with",
                         "Leave --rig out: the cloud says where its cameras stood.");
    const CameraModel camera = rig && rig->rig.whole() ? rig->rig.left_camera : read_rig(options.rig).left_camera;
    PointCloud part = within_outline(cloud, camera, std::move(outline));
    if (part.empty())
        throw InputError(options.cloud, "has no point within the region",
                         "Give pixels of the left camera, as in the pictures of the capture, and the rig of the scan.");
    return part;
}

double median_to_skin_mm(const std::vector<PointPair>& pairs, const TriangleMesh& skin, const Eigen::Vector3d& signs) {
    std::vector<double> off_mm;
    for (const PointPair& pair : pairs) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& vertex : skin.vertices_in_ct)
            nearest = std::min(nearest, (vertex - pair.in_ct.cwiseProduct(signs)).squaredNorm());
        off_mm.push_back(std::sqrt(nearest));
    }
    return median(off_mm);
}

/// Landmarks are pointed at on the skin. Of those in another frame (a half turn lies between LPS and RAS) the rms says
/// nothing.
void check_near_skin(const std::vector<PointPair>& pairs, const TriangleMesh& skin, const Path& file) {
    constexpr double kFar_mm = 150, kOff_mm = 15, kClearly = 1 / 3.;  // no place within a head is 150 mm off its skin
    if (pairs.empty()) return;
    const double off_mm = median_to_skin_mm(pairs, skin, {1, 1, 1}),
                 turned_mm = median_to_skin_mm(pairs, skin, {-1, -1, 1});
    if (off_mm <= kFar_mm && (off_mm <= kOff_mm || turned_mm > kClearly * off_mm)) return;
    throw InputError(
        file, fmt::format("has landmarks that lie {:.0f} mm off the skin of the case (median)", off_mm),
        "Give ct_x, ct_y, ct_z in the frame of the CT, mm, and say in its first line whether that is LPS or RAS.");
}

RegistrationResult match(const RegisterOptions& options, const Case& the_case, std::shared_ptr<const PointCloud>& cloud,
                         std::optional<RigState>& rig) {
    if (options.cloud.empty() && options.pairs.empty())
        throw Error(ExitCode::usage, "neither --cloud nor --pairs is given", "Give the scan, landmarks, or both.");
    const std::vector<PointPair> pairs =
        options.pairs.empty() ? std::vector<PointPair>{} : read_point_pairs(options.pairs);
    check_near_skin(pairs, the_case.skin, options.pairs);
    if (options.cloud.empty()) return register_point_pairs(pairs);
    RegistrationSettings settings;
    settings.initial.seed = options.seed;
    if (options.icp == "closest-point") settings.icp.mode = IcpSettings::Mode::closest_point;
    if (!options.viewpoint_in_rig.empty()) settings.viewpoint_in_rig = Eigen::Vector3d(options.viewpoint_in_rig.data());
    cloud = std::make_shared<PointCloud>(cloud_of(options, rig));
    if (!options.region_px.empty()) cloud = std::make_shared<PointCloud>(in_region(*cloud, options, rig));
    if (rig && !settings.viewpoint_in_rig && rig->rig.projector.width > 0)
        settings.viewpoint_in_rig = rig->rig.projector.centre_in_rig();  // it lit all points
    return register_with_landmarks(*cloud, the_case.lut, pairs, settings);
}

void write_certificate(const RegisterOptions& options, const Case& the_case, const CaseDrawing& drawing,
                       const RegistrationResult& result, const std::shared_ptr<const PointCloud>& cloud) {
    if (options.certificate.empty() && options.pdf.empty()) return;
    const Document document = certificate_of(the_case, drawing, result, cloud);
    // The face is on it.
    if (!options.certificate.empty()) write_safely(options.certificate, html_of(document), ReadableBy::owner);
    write_pdf(document, options.pdf, ReadableBy::owner);
}

/// A refusal does not take the place of a match that may be used, nor of a file that is none of ours.
bool keeps_what_was_there(const RegistrationResult& result, const Path& file) {
    if (result.verdict != Verdict::no || !std::filesystem::exists(file)) return false;
    try {
        return read_registration(file).verdict != Verdict::no;
    } catch (const Error&) {
        return true;
    }
}

/// 100 % of what was judged may be little of the scan.
std::string fit_in_words(const RegistrationResult& result) {
    if (!result.skin_fraction)
        return fmt::format("{:.0f} % of {} points on the skin", 100 * result.inlier_fraction, result.judged_points);
    return fmt::format("{:.0f} % of the {} points taken for skin ({:.0f} % of the scan's surface) on it",
                       100 * result.inlier_fraction, result.judged_points, 100 * *result.skin_fraction);
}

std::string scan_in_words(const RegistrationResult& result) {
    if (result.judged_points == 0) return fmt::format("{} points, of which none could be judged", result.points);
    std::string words = fmt::format("residual {:.2f} mm rms, {}", result.residual_rms_mm, fit_in_words(result));
    if (result.runner_up_ratio > 0) words += fmt::format(", runner-up {:.2f} times worse", result.runner_up_ratio);
    return words;
}

nlohmann::json json_of(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

/// How far off each item may be; none of a match that was refused.
nlohmann::json items_json(const Case& the_case, const CaseDrawing& drawing, const RegistrationResult& result) {
    nlohmann::json items = nlohmann::json::array();
    if (result.verdict == Verdict::no) return items;
    const std::vector<double> predicted = predicted_errors_mm(the_case.plan, result);
    for (std::size_t i = 0; i < predicted.size() && i < drawing.drawing.items.size(); ++i)
        items.push_back({{"name", drawing.drawing.items[i].name}, {"predicted_95_mm", json_of(predicted[i])}});
    return items;
}

/// Null where it is not known.
nlohmann::json result_json(const Case& the_case, const RegistrationResult& result, const nlohmann::json& items,
                           bool of_scan) {
    const bool scanned = result.judged_points > 0, landmarks = !of_scan && result.residual_rms_mm > 0;
    const auto where = [](bool known, double value) { return known ? json_of(value) : nlohmann::json(); };
    const Eigen::Matrix4d m = result.patient_from_ct.matrix();
    nlohmann::json matrix = nlohmann::json::array();
    for (int r = 0; r < 4; ++r) matrix.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
    return {{"case", the_case.code},
            {"title", title_of(the_case)},
            {"verdict", name_of(result.verdict)},
            {"reasons", result.reasons},
            {"patient_from_ct", result.verdict == Verdict::no ? nlohmann::json() : matrix},
            {"points", result.points},
            {"judged_points", result.judged_points},
            {"residual_rms_mm", where(scanned || landmarks, result.residual_rms_mm)},
            {"residual_median_mm", where(scanned, result.residual_median_mm)},
            {"inlier_fraction", where(scanned, result.inlier_fraction)},
            {"runner_up_ratio", where(result.runner_up_ratio > 0, result.runner_up_ratio)},
            {"agreeing_bases", result.agreeing_bases},
            {"weakest_sigma_mm", json_of(result.weakest_sigma_mm)},
            {"mirror_ratio", where(result.mirror_ratio > 0, result.mirror_ratio)},
            {"blocked_fraction", json_of(result.blocked_fraction)},
            {"skin_fraction", json_of(result.skin_fraction)},
            {"landmarks_off_mm", json_of(result.landmarks_off_mm)},
            {"scale", where(result.scale_sigma > 0, result.scale)},
            {"scale_sigma", where(result.scale_sigma > 0, result.scale_sigma)},
            {"skin_movement_mm", json_of(result.skin_movement_mm)},
            {"skin_offset_mm", json_of(result.skin_offset_mm)},
            {"shape_change_mm", json_of(result.shape_change_mm)},
            {"rig", result.rig ? nlohmann::json(rig_state_json(*result.rig)) : nlohmann::json()},
            {"items", items},
            {"seconds", {{"initial", result.initial_match_s}, {"fine", result.refine_s}}}};
}

void print(const Case& the_case, const RegistrationResult& result, const nlohmann::json& items, bool of_scan) {
    fmt::print("{}\n", title_of(the_case));
    if (!of_scan)
        fmt::print("{}: {} landmarks, {:.2f} mm rms.\n", name_of(result.verdict), result.points,
                   result.residual_rms_mm);
    else
        fmt::print("{}: {}.\n", name_of(result.verdict), scan_in_words(result));
    const SiteSettings site = read_site_settings();
    for (const auto& item : items)
        if (const auto& mm = item["predicted_95_mm"]; mm.is_number())
            fmt::print("  {}: within {} (95 %)\n", item["name"].get<std::string>(),
                       length_text(mm.get<double>(), site));
        else
            fmt::print("  {}: how far it may be off is not known\n", item["name"].get<std::string>());
    for (const auto& reason : result.reasons) fmt::print("  {}\n", reason);
}

int run_register(const RegisterOptions& options) {
    check_pdf(options.pdf);
    for (const Path& file : {options.out, options.certificate, options.slicer_transform})
        if (!file.empty()) check_can_write(file);  // of all, before one is written
    const Case the_case = read_case(options.case_folder);
    std::shared_ptr<const PointCloud> cloud;
    std::optional<RigState> rig;
    RegistrationResult result = match(options, the_case, cloud, rig);
    take_case_and_rig(the_case, rig, result);
    const CaseDrawing drawing(the_case);
    judge_items(drawing.drawing, result);
    const bool keeps = keeps_what_was_there(result, options.out);
    if (!keeps) write_registration(result, options.out);
    if (!options.slicer_transform.empty() && result.verdict != Verdict::no)
        write_slicer_transform(result.patient_from_ct, options.slicer_transform);
    if (!keeps) write_certificate(options, the_case, drawing, result, cloud);
    const nlohmann::json items = items_json(the_case, drawing, result);
    if (options.json)
        std::cout << json_text(result_json(the_case, result, items, !options.cloud.empty())) << '\n';
    else
        print(the_case, result, items, !options.cloud.empty());
    const bool bad_rig = result.rig && result.rig->verdict == RigState::Verdict::not_trusted;
    if (result.verdict == Verdict::no)
        throw CheckFailedError(
            fmt::format("{}: {}", bad_rig ? "the match may not be used" : "the patient was not found",
                        fmt::join(result.reasons, "; ")),
            (bad_rig ? result.rig->remedy
                     : std::string("Take cloth and hands away from the head, scan again from a side that shows more of "
                                   "it, and check that this is the patient of the case.") +
                           (cloud ? hint_of_unit(*cloud, options.unit) : std::string())) +
                (keeps ? fmt::format(" {} is as it was before, and not of this scan.", options.out.string())
                       : std::string()));
    return 0;
}

}  // namespace

Run add_register(CLI::App& app) {
    const auto options = std::make_shared<RegisterOptions>();
    RegisterOptions& o = *options;
    auto* sub =
        add_command(app, "register", "Cloud and case -> where the patient lies (T_ini), or a refusal (exit 6)",
                    "register case --cloud cloud.ply --out registration.json\n"
                    "  planlight register case --cloud cloud.ply --out registration.json --pdf certificate.pdf");
    sub->add_option("case", o.case_folder, "Case folder")->required();
    auto* cloud = sub->add_option("--cloud", o.cloud, "Clean cloud (.ply), of `scan` or of any scanner");
    sub->add_option("--unit", o.unit, "Unit of the cloud's numbers")
        ->check(CLI::IsMember({"mm", "cm", "m", "um", "inch"}))
        ->capture_default_str()
        ->needs(cloud);
    sub->add_flag("--in-rig", o.in_rig, "The cloud is in the rig's frame though it does not say so")->needs(cloud);
    sub->add_option(
           "--viewpoint", o.viewpoint_in_rig,
           "Where the scanner stood (rig, mm): then the space it looked through must be free in the CT too; a cloud "
           "without normals needs it")
        ->expected(3)
        ->needs(cloud);
    auto* region =
        sub->add_option("--region", o.region_px,
                        "Only what lies within this outline on the left camera's picture, pixels: x y of two opposite "
                        "corners, or of three and more corners (a lasso): where cloth and hands hide too much")
            ->expected(4, 10000)
            ->needs(cloud);
    sub->add_option("--rig", o.rig, "rig.json of the scan, for --region where the cloud does not carry its rig")
        ->needs(region);
    sub->add_option(
        "--pairs", o.pairs,
        "Landmarks (.csv: name, ct and rig coordinates; `review --landmarks` clicks them): they check the cloud's "
        "match, help where it is refused, or, without a cloud, are the match");
    sub->add_option("--certificate", o.certificate,
                    "Write a page (.html) with what the match is worth, in words and pictures");
    pdf_option(sub, o.pdf);
    sub->add_option("--out", o.out, "registration.json to write")->required();
    sub->add_option("--slicer", o.slicer_transform,
                    "Transform for 3D Slicer to write (.tfm): it lays the cloud on the CT");
    sub->add_option("--icp", o.icp, "Fine match: signed-distance, or closest-point as in the paper")
        ->check(CLI::IsMember({"signed-distance", "closest-point"}))
        ->capture_default_str();
    sub->add_option("--seed", o.seed, "Of the search")->capture_default_str();
    json_flag(sub, o.json);
    return [options] { return run_register(*options); };
}

}  // namespace planlight
