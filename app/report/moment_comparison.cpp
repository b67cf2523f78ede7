#include "app/report/moment_comparison.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/kept_match.h"
#include "app/live/scene_of_session.h"
#include "app/recording/recording_head.h"
#include "app/report/html_page.h"
#include "app/report/operation_report.h"
#include "app/windows/camera_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// What was lit, by what the session was asked for.
struct WhatIsLit {
    LitPart part;
    int landmark = -1;  ///< that alone is lit; -1: the plan is
    bool light = false;

    void take_match(const KeptMatch& match) { *this = {match.lit}; }

    /// An event that begins as `asked` does.
    void take_call(const Json& event) {
        const std::string call = event.value("call", "");
        const int which = event.value("which", -1);
        const auto item = which < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(which));
        if (call == "light_landmark") landmark = which;
        if (call == "light_item") {
            part.item_of_moment = item;
            if (item) part.hidden.erase(*item);
        }
        if (call == "hide_item" && item) {
            part.hidden.insert(*item);
            if (part.item_of_moment == item) part.item_of_moment.reset();
        }
        if (call == "show_item" && item) part.hidden.erase(*item);
        if (call == "show_item" && !item) part = {};
        if (call == "go_dark" || call == "check_skin") light = false;
    }
};

/// What the recording has of one frame.
struct Recorded {
    RecordingHead head;
    std::optional<KeptMatch> match;  ///< the last one before it
    std::optional<StereoFrame> frame;
    std::optional<RigidTransform> rig_from_patient;
    WhatIsLit lit;  ///< by the update before it: what was drawn by its own came later
};

std::optional<RigidTransform> pose_in(const Json& event) {
    const auto pose = event.find("pose");
    if (pose == event.end() || !pose->is_object()) return std::nullopt;
    const auto rows = pose->find("rig_from_patient");
    if (rows == pose->end() || !rows->is_array() || rows->size() != 16) return std::nullopt;
    RigidTransform transform;
    for (Eigen::Index i = 0; i < 16; ++i)
        transform.matrix()(i / 4, i % 4) = rows->at(static_cast<std::size_t>(i)).get<double>();
    return transform;
}

/// The update of that frame comes some time after it.
Recorded recorded_at(const fs::path& recording, double at_s) {
    constexpr double kSame_s = 1e-6, kUpdateWithin_s = 10;
    constexpr std::string_view kAsked = R"({"what":"asked")", kAskedUpdate = R"({"what":"asked","call":"update")";
    Recorded found;
    RecordingReader reader(recording);
    std::optional<Instant> origin;
    WhatIsLit asked;  // for the next update to light
    const auto since_s = [&](Instant at) { return origin ? seconds(at - *origin) : -1; };
    reader.want_only([&](const ChunkType& type, Instant at) {
        if (type == chunk_types::kHead || type == chunk_types::kRoom) return true;
        if (type == chunk_types::kMatch) return since_s(at) <= at_s;
        if (type == chunk_types::kFrame) return std::abs(since_s(at) - at_s) < kSame_s;
        return type == chunk_types::kEvent && since_s(at) < at_s + kUpdateWithin_s;
    });
    while (const auto chunk = reader.next()) {
        if (chunk->type == chunk_types::kHead) found.head = head_of(chunk->payload, recording);
        if (chunk->type == chunk_types::kRoom) origin = chunk->at;
        if (chunk->type == chunk_types::kMatch) {
            found.match = kept_match_of(chunk->payload, recording);
            asked.take_match(*found.match);
        }
        if (chunk->type == chunk_types::kFrame) found.frame = unpack_frame(chunk->payload, recording);
        if (chunk->type != chunk_types::kEvent) continue;
        const std::string& text = chunk->payload;
        if (text.starts_with(kAsked) && !text.starts_with(kAskedUpdate)) {
            const Json event = Json::parse(text, nullptr, false);
            if (event.is_object()) asked.take_call(event);
            if (!asked.light) found.lit.light = false;
        }
        if (!text.starts_with(R"({"what":"updated")")) continue;
        if (since_s(chunk->at) > at_s - kUpdateWithin_s) {
            const Json event = Json::parse(text, nullptr, false);
            if (!event.is_object()) continue;
            if (std::abs(since_s(Instant(event.value("at_ns", std::int64_t{0}))) - at_s) < kSame_s) {
                found.rig_from_patient = pose_in(event);
                return found;
            }
        }
        asked.light = text.find(R"("lit":true)") != std::string::npos;
        found.lit = asked;
    }
    return found;
}

void check_case(const RecordingHead& head, const Case& the_case, const fs::path& recording) {
    const CaseName name = name_of(the_case);
    if (head.volume_hash == name.volume_hash && head.mesh_hash == name.mesh_hash &&
        head.plan_hash == the_case.plan_hash)
        return;
    throw InputError(recording, fmt::format("is of the case {}, and this is the case {}", head.case_code, name.code),
                     "Name the case that was used with --case.");
}

std::string why_not(const Recorded& found) {
    if (found.head.anonymous) return kAnonymousKeepsNoPlan;
    if (!found.frame) return "No frame was kept at that moment.";
    if (!found.match || !found.match->registration.rig) return "No patient had been found by then.";
    if (!found.rig_from_patient) return "Where the head was at that moment is not known: the plan was not followed.";
    return {};
}

/// In a sentence, why none of the plan, or not all of it, was lit; empty: all of it was.
std::string why_unlit(const WhatIsLit& lit, const PlanDrawing& drawing) {
    const std::size_t count = drawing.items.size();
    if (!lit.light) return "It was dark.";
    if (lit.landmark >= 0) return fmt::format("Landmark {} alone was lit.", lit.landmark + 1);
    if (lit.part.item_of_moment && *lit.part.item_of_moment < count)
        return fmt::format("Only \"{}\" was bright, and that alone is looked for.",
                           drawing.items[*lit.part.item_of_moment].name);
    if (lit.part.hidden.empty()) return {};
    return fmt::format("{} of {} items were hidden, and are not looked for.", lit.part.hidden.size(), count);
}

void keep_strokes(PlanDrawing& drawing, const std::function<bool(std::size_t)>& keep) {
    std::erase_if(drawing.strokes,
                  [&](const Stroke& s) { return s.item >= 0 && !keep(static_cast<std::size_t>(s.item)); });
    std::erase_if(drawing.labels,
                  [&](const Label& l) { return l.item >= 0 && !keep(static_cast<std::size_t>(l.item)); });
}

/// Every place of what was lit.
LightCheck look_at(const WhatIsLit& lit, PlanDrawing drawing, const SkinSurface& skin, const RigCalibration& rig,
                   const RigidTransform& rig_from_ct, const StereoFrame& frame) {
    if (!lit.light || lit.landmark >= 0) return {};
    if (const auto alone = lit.part.item_of_moment) keep_strokes(drawing, [&](std::size_t i) { return i == *alone; });
    CheckLightSettings settings;
    settings.most_segments = std::numeric_limits<int>::max();  // there is time
    return check_light(drawing, skin, rig, rig_from_ct, frame, settings);
}

/// The strokes as this camera sees them: what faces it.
std::vector<std::vector<Eigen::Vector2d>> seen_by(const CameraModel& camera, const PlanDrawing& drawing,
                                                  const RigidTransform& rig_from_ct) {
    std::vector<std::vector<Eigen::Vector2d>> lines(1);
    const Eigen::Vector3d eye_in_ct = rig_from_ct.inverse() * camera.centre_in_rig();
    for (const Stroke& stroke : drawing.strokes) {
        for (std::size_t i = 0; i < stroke.points_in_ct.size() + (stroke.closed ? 1 : 0); ++i) {
            const std::size_t at = i % stroke.points_in_ct.size();
            const Eigen::Vector3d& p_in_ct = stroke.points_in_ct[at];
            const auto pixel = project(camera, rig_from_ct * p_in_ct);
            const bool faces = stroke.normals_in_ct[at].dot(eye_in_ct - p_in_ct) > 0;
            if (pixel && faces)
                lines.back().push_back(*pixel);
            else if (!lines.back().empty())
                lines.emplace_back();
        }
        if (!lines.back().empty()) lines.emplace_back();
    }
    lines.pop_back();
    return lines;
}

/// Each place as a short line along the stroke, where its light was seen.
std::shared_ptr<const std::vector<LightLine>> light_as_seen(const LightCheck& light) {
    constexpr double kHalf_mm = 1.5, kAbove_mm = 1.2;
    auto lines = std::make_shared<std::vector<LightLine>>();
    for (const SeenSegment& s : light.segments) {
        if (!s.seen) continue;
        const Eigen::Vector3d along = s.normal_in_ct.cross(s.sideways_in_ct);
        const Eigen::Vector3d p = s.p_in_ct + s.off_mm * s.sideways_in_ct + kAbove_mm * s.normal_in_ct;
        lines->push_back({{p - kHalf_mm * along, p + kHalf_mm * along}, false});
    }
    return lines;
}

RgbImage scene_of(const Case& the_case, const CaseDrawing& drawing, const MomentComparison& moment,
                  const RigCalibration& rig, const RigidTransform& rig_from_ct) {
    SceneModel scene;
    scene.skin = std::make_shared<TriangleMesh>(the_case.skin);
    scene.plan = std::make_shared<PlanDrawing>(drawing.drawing);
    scene.light = light_as_seen(moment.light);
    SceneView view = view_of_plan(drawing.drawing);
    const SceneView light = projector_view(rig, rig_from_ct.inverse());
    view.azimuth = light.azimuth, view.elevation = light.elevation;
    return render_scene(scene, view);
}

const char* colour_of(const SeenSegment& place) {
    if (!place.seen) return "#8a8f98";
    const double off = std::abs(place.off_mm);
    return off > kOperationStop_mm ? "#e0303a" : off > kOperationLook_mm ? "#ffab1a" : "#35c46f";
}

std::string words_of(const MomentComparison::Place& place) {
    if (!place.seen.seen) return place.item + ": no light was found here";
    return fmt::format("{}: {:.2f} mm beside the plan (± {:.2f} mm, one standard deviation)", place.item,
                       std::abs(place.seen.off_mm), place.seen.sigma_mm);
}

/// x, y, width, height of the part of a picture that the plan is in, with some skin round it; of all of it where there
/// is none.
std::array<double, 4> round_the_plan(const std::vector<std::vector<Eigen::Vector2d>>& plan, const GrayImage& picture) {
    constexpr double kMargin_px = 25;
    Eigen::AlignedBox2d box;
    for (const auto& line : plan)
        for (const Eigen::Vector2d& p : line) box.extend(p);
    const Eigen::AlignedBox2d all(Eigen::Vector2d(0, 0), Eigen::Vector2d(picture.width, picture.height));
    if (!box.isEmpty())
        box = all.intersection(Eigen::AlignedBox2d(box.min().array() - kMargin_px, box.max().array() + kMargin_px));
    if (box.isEmpty()) box = all;
    return {box.min().x(), box.min().y(), box.sizes().x(), box.sizes().y()};
}

std::string overlay(const MomentComparison& moment, std::size_t camera, const std::string& file,
                    const std::string& title) {
    const GrayImage& picture = moment.pictures[camera];
    const std::array<double, 4> box = round_the_plan(moment.plan[camera], picture);
    std::string svg = fmt::format(
        "<figure><svg class=\"compared\" viewBox=\"{:.1f} {:.1f} {:.1f} {:.1f}\" style=\"width:100%\"><image "
        "href=\"{}\" width=\"{}\" height=\"{}\"/>",
        box[0], box[1], box[2], box[3], xml_escaped(file), picture.width, picture.height);
    // Pixel (0, 0) is the middle of the first one; in the page it begins there.
    for (const auto& line : moment.plan[camera]) {
        svg += "<polyline fill=\"none\" stroke=\"#29c5ff\" stroke-opacity=\"0.75\" stroke-width=\"0.3\" points=\"";
        for (const Eigen::Vector2d& p : line) svg += fmt::format("{:.2f},{:.2f} ", p.x() + 0.5, p.y() + 0.5);
        svg += "\"/>";
    }
    for (const auto& place : moment.places)
        if (const auto& p = place.pixel[camera])
            svg += fmt::format(
                "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2.2\" fill=\"{}\" fill-opacity=\"0.35\" stroke=\"{}\" "
                "stroke-width=\"0.4\"><title>{}</title></circle>",
                p->x() + 0.5, p->y() + 0.5, colour_of(place.seen), colour_of(place.seen), xml_escaped(words_of(place)));
    return svg + "</svg><figcaption>" + title + "</figcaption></figure>";
}

/// The place nearest to a press is named under the pictures.
constexpr const char* kScript =
    R"(<p id="picked"><b>Press on a picture: the place of the plan nearest to it is named here.</b></p>
<script>
for (const svg of document.querySelectorAll("svg.compared")) svg.addEventListener("click", press => {
  const at = new DOMPoint(press.clientX, press.clientY).matrixTransform(svg.getScreenCTM().inverse());
  let best = null, least = Infinity;
  for (const place of svg.querySelectorAll("circle")) {
    const d = Math.hypot(place.cx.baseVal.value - at.x, place.cy.baseVal.value - at.y);
    place.setAttribute("r", 2.2);
    if (d < least) least = d, best = place;
  }
  if (!best) return;
  best.setAttribute("r", 4);
  document.getElementById("picked").textContent = best.querySelector("title").textContent;
});
</script>)";

}  // namespace

MomentComparison compare_moment(const fs::path& recording, double at_s, const Case& the_case) {
    MomentComparison moment;
    moment.at_s = at_s;
    const Recorded found = recorded_at(recording, at_s);
    check_case(found.head, the_case, recording);
    moment.why_not = why_not(found);
    if (!moment.why_not.empty()) return moment;
    const RegistrationResult& match = found.match->registration;
    const RigCalibration& rig = match.rig->rig;
    const RigidTransform rig_from_ct = *found.rig_from_patient * match.patient_from_ct;  // T_global = T_cur T_ini
    DrawingSettings how;
    how.up_in_ct = found.head.up_in_ct;
    const CaseDrawing planned(the_case, how);
    CaseDrawing drawing(the_case, planned, match.skin, lit_by(rig, match.patient_from_ct, how));
    moment.unlit = why_unlit(found.lit, drawing.drawing);
    keep_strokes(drawing.drawing, [&](std::size_t item) { return !found.lit.part.hidden.contains(item); });
    moment.light = look_at(found.lit, drawing.drawing, drawing.skin, rig, rig_from_ct, *found.frame);
    moment.pictures = {found.frame->left, found.frame->right};
    const std::array cameras{&rig.left_camera, &rig.right_camera};
    for (std::size_t i = 0; i < cameras.size(); ++i)
        moment.plan[i] = seen_by(*cameras[i], drawing.drawing, rig_from_ct);
    for (const SeenSegment& segment : moment.light.segments) {
        const auto item = static_cast<std::size_t>(std::max(0, segment.item));
        MomentComparison::Place place{
            item < drawing.drawing.items.size() ? drawing.drawing.items[item].name : "", segment, {}};
        for (std::size_t i = 0; i < cameras.size(); ++i)
            place.pixel[i] = project(*cameras[i], rig_from_ct * segment.p_in_ct);
        moment.places.push_back(std::move(place));
    }
    moment.scene = scene_of(the_case, drawing, moment, rig, rig_from_ct);
    return moment;
}

std::string comparison_section(const MomentComparison& moment, const std::string& left, const std::string& right,
                               const std::string& scene) {
    if (!moment.why_not.empty()) return "<h2>Plan and light</h2><p>" + xml_escaped(moment.why_not) + "</p>";
    const LightCheck& light = moment.light;
    const std::string sum =
        light.expected == 0 ? std::string("There is no light of the plan to look for.")
        : light.seen == 0
            ? fmt::format(
                  "None of the plan's light was found in this frame, at {} places where it should be seen: it had only "
                  "just been asked for, or something was before it.",
                  light.expected)
            : fmt::format(
                  "Light was found at {} of {} places; half of them lie within {:.2f} mm of the plan, 95 % "
                  "within {:.2f} mm.",
                  light.seen, light.expected, light.median_mm, light.off_mm);
    return fmt::format("<h2>Plan and light, at {:.3f} s</h2><p>{}</p>", moment.at_s,
                       xml_escaped(moment.unlit.empty() ? sum : moment.unlit + " " + sum)) +
           overlay(moment, 0, left, "Left camera. Blue: where the plan belongs on the skin as the scan found it.") +
           overlay(moment, 1, right, "Right camera.") +
           "<p>Circles: green within 1 mm, amber within 2 mm, red beyond; grey: no light was found there.</p>" +
           kScript +
           fmt::format(
               "<figure><img style=\"width:100%\" src=\"{}\"><figcaption>The head as the projector sees it: the "
               "plan in its colours, the light where the cameras saw it in white.</figcaption></figure>",
               xml_escaped(scene));
}

std::string comparison_csv(const MomentComparison& moment) {
    std::string table = "item,l_mm,p_mm,s_mm,seen,off_mm,sigma_mm\n";
    for (const auto& place : moment.places) {
        std::string name = place.item;
        for (std::size_t i = 0; (i = name.find('"', i)) != std::string::npos; i += 2) name.insert(i, 1, '"');
        table += fmt::format("\"{}\",{:.3f},{:.3f},{:.3f},{}", name, place.seen.p_in_ct.x(), place.seen.p_in_ct.y(),
                             place.seen.p_in_ct.z(), place.seen.seen ? 1 : 0);
        table += place.seen.seen ? fmt::format(",{:.3f},{:.3f}\n", place.seen.off_mm, place.seen.sigma_mm) : ",,\n";
    }
    return table;
}

}  // namespace planlight
