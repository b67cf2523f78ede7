#include "app/report/moment_comparison.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "app/live/scene_of_session.h"
#include "app/recording/recording_head.h"
#include "app/report/html_page.h"
#include "app/report/operation_report.h"
#include "app/windows/camera_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

}  // namespace

void check_case(const RecordingHead& head, const Case& the_case, const fs::path& recording) {
    const CaseName name = name_of(the_case);
    if (head.volume_hash == name.volume_hash && head.mesh_hash == name.mesh_hash &&
        head.plan_hash == the_case.plan_hash)
        return;
    throw InputError(recording,
                     fmt::format("is of the case {}, and this is the case {}{}", head.case_code, name.code,
                                 head.case_code == name.code ? ", whose skin or plan is another" : ""),
                     "Give the folder of the case that was used.");
}

namespace {

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

/// What was lit at one frame.
struct WhatIsLit {
    LitPart part;
    int landmark = -1;  ///< that alone is lit; -1: the plan is
    bool light = false;
};

/// As a session takes what it is asked for.
WhatIsLit what_is_lit(const LitPart& at_match, const RecordingTimeLine::Lit& since) {
    WhatIsLit lit{at_match, -1, since.light};
    LitPart& part = lit.part;
    for (const auto& [call, which] : since.asked) {
        const auto item = which < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(which));
        if (call == "light_landmark") lit.landmark = which;
        if (call == "light_item") part.item_of_moment = item;
        if ((call == "light_item" || call == "show_item") && item) part.hidden.erase(*item);
        if (call == "hide_item" && item) {
            part.hidden.insert(*item);
            if (part.item_of_moment == item) part.item_of_moment.reset();
        }
        if (call == "show_item" && !item) part = {};
    }
    return lit;
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

PlanDrawing only(PlanDrawing drawing, const std::function<bool(std::size_t)>& keep) {
    const auto gone = [&](const auto& drawn) { return drawn.item >= 0 && !keep(static_cast<std::size_t>(drawn.item)); };
    std::erase_if(drawing.strokes, gone);
    std::erase_if(drawing.labels, gone);
    return drawing;
}

/// Every place of what was lit.
LightCheck look_at(const WhatIsLit& lit, const PlanDrawing& shown, const SkinSurface& skin, const RigCalibration& rig,
                   const RigidTransform& rig_from_ct, const StereoFrame& frame) {
    if (!lit.light || lit.landmark >= 0) return {};
    CheckLightSettings settings;
    settings.most_segments = std::numeric_limits<int>::max();  // there is time
    const auto alone = lit.part.item_of_moment;
    return check_light(alone ? only(shown, [&](std::size_t item) { return item == *alone; }) : shown, skin, rig,
                       rig_from_ct, frame, settings);
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

const char* colour_of(const SeenSegment& place) {
    if (!place.seen) return "#8a8f98";
    const double off = std::abs(place.off_mm);
    return off > kOperationStop_mm ? "#e0303a" : off > kOperationLook_mm ? "#ffab1a" : "#35c46f";
}

std::string overlay(const MomentComparison& moment, const GrayImage& picture, std::size_t camera,
                    const std::string& file, const std::string& title) {
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

/// The plan as it was drawn after one match.
struct MomentComparer::Drawn {
    std::uint64_t match = 0;  ///< its place in the recording
    RegistrationResult found;
    LitPart lit;  ///< when it was kept
    CaseDrawing drawing;
    std::set<std::size_t> hidden{};  ///< that `shown` is without
    std::shared_ptr<const PlanDrawing> shown = std::make_shared<PlanDrawing>(drawing.drawing);

    void hide(const std::set<std::size_t>& items) {
        if (items == hidden) return;
        hidden = items;
        shown = std::make_shared<PlanDrawing>(
            only(drawing.drawing, [&](std::size_t item) { return !items.contains(item); }));
    }
};

MomentComparer::MomentComparer(const Case& the_case, const RecordingTimeLine& line, const fs::path& recording)
    : case_(the_case), anonymous_(line.head.anonymous) {
    check_case(line.head, the_case, recording);
    how_.up_in_ct = line.head.up_in_ct;
    if (!anonymous_) planned_ = std::make_unique<CaseDrawing>(the_case, how_);
}
MomentComparer::~MomentComparer() = default;

/// Null where no patient had been found by then.
MomentComparer::Drawn* MomentComparer::drawn_at(RecordedMoments& moments, std::size_t frame) {
    const std::uint64_t place = moments.line().places.at(frame).match;
    if (drawn_ && drawn_->match == place) return drawn_.get();
    std::optional<KeptMatch> match = moments.match(frame);
    if (!match || !match->registration.rig) return nullptr;
    const RegistrationResult& found = match->registration;
    drawn_.reset(
        new Drawn{place, found, match->lit,
                  CaseDrawing(case_, *planned_, found.skin, lit_by(found.rig->rig, found.patient_from_ct, how_))});
    return drawn_.get();
}

MomentComparison MomentComparer::compare(RecordedMoments& moments, std::size_t frame, const RecordedMoment& pictures) {
    MomentComparison moment;
    moment.at_s = pictures.at_s;
    if (anonymous_) {
        moment.why_not = kAnonymousKeepsNoPlan;
        return moment;
    }
    Drawn* const drawn = drawn_at(moments, frame);
    const auto rig_from_patient = moments.rig_from_patient(frame);
    if (!drawn || !rig_from_patient) {
        moment.why_not = drawn ? "Where the head was at that moment is not known: the plan was not followed."
                               : "No patient had been found by then.";
        return moment;
    }
    const RigCalibration& rig = drawn->found.rig->rig;
    const RigidTransform rig_from_ct = *rig_from_patient * drawn->found.patient_from_ct;  // T_global = T_cur T_ini
    const RecordingTimeLine& line = moments.line();
    const WhatIsLit lit = what_is_lit(drawn->lit, line.lit.at(line.places.at(frame).lit));
    drawn->hide(lit.part.hidden);
    const PlanDrawing& plan = *drawn->shown;
    moment.drawn = drawn->shown;
    moment.unlit = why_unlit(lit, plan);
    moment.light = look_at(lit, plan, drawn->drawing.skin, rig, rig_from_ct, pictures.frame);
    moment.light_lines = light_as_seen(moment.light);
    moment.by_projector = projector_view(rig, rig_from_ct.inverse());
    const std::array cameras{&rig.left_camera, &rig.right_camera};
    for (std::size_t i = 0; i < cameras.size(); ++i) moment.plan[i] = seen_by(*cameras[i], plan, rig_from_ct);
    for (const SeenSegment& segment : moment.light.segments) {
        const auto item = static_cast<std::size_t>(std::max(0, segment.item));
        MomentComparison::Place place{item < plan.items.size() ? plan.items[item].name : "", segment, {}};
        for (std::size_t i = 0; i < cameras.size(); ++i)
            place.pixel[i] = project(*cameras[i], rig_from_ct * segment.p_in_ct);
        moment.places.push_back(std::move(place));
    }
    return moment;
}

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

SceneModel scene_of(const MomentComparison& moment, std::shared_ptr<const TriangleMesh> skin) {
    SceneModel scene;
    scene.skin = std::move(skin);
    scene.plan = moment.drawn;
    scene.light = moment.light_lines;
    return scene;
}

SceneView view_of(const MomentComparison& moment) {
    if (!moment.drawn) return {};
    SceneView view = view_of_plan(*moment.drawn);
    view.azimuth = moment.by_projector.azimuth, view.elevation = moment.by_projector.elevation;
    return view;
}

std::string words_of(const MomentComparison::Place& place) {
    if (!place.seen.seen) return place.item + ": no light was found here";
    return fmt::format("{}: {:.2f} mm beside the plan (± {:.2f} mm, one standard deviation)", place.item,
                       std::abs(place.seen.off_mm), place.seen.sigma_mm);
}

std::string sum_of(const MomentComparison& moment) {
    const LightCheck& light = moment.light;
    const std::string before = moment.unlit.empty() ? "" : moment.unlit + " ";
    if (light.expected == 0) return before + "There is no light of the plan to look for.";
    if (light.seen == 0)
        return before + fmt::format(
                            "None of the plan's light was found in this frame, at {} places where it should be seen: "
                            "it had only just been asked for, or something was before it.",
                            light.expected);
    if (light.far_mm)
        return before + fmt::format(
                            "The light as a whole was found {:.1f} mm beside the plan: what is marked near its place "
                            "is other light, or none.",
                            *light.far_mm);
    return before + fmt::format(
                        "Light was found at {} of {} places; half of them lie within {:.2f} mm of the plan, 95 % "
                        "within {:.2f} mm.",
                        light.seen, light.expected, light.median_mm, light.off_mm);
}

std::string comparison_section(const MomentComparison& moment, const StereoFrame& pictures, const std::string& left,
                               const std::string& right, const std::string& scene) {
    if (!moment.why_not.empty()) return "<h2>Plan and light</h2><p>" + xml_escaped(moment.why_not) + "</p>";
    return fmt::format("<h2>Plan and light, at {:.3f} s</h2><p>{}</p>", moment.at_s, xml_escaped(sum_of(moment))) +
           overlay(moment, pictures.left, 0, left,
                   "Left camera. Blue: where the plan belongs on the skin as the scan found it.") +
           overlay(moment, pictures.right, 1, right, "Right camera.") +
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
