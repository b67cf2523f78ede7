#include "app/windows/landmark_panel.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

constexpr double kHiddenMm = 3;  ///< a point so far behind the first surface on its line of sight is on the other side
constexpr std::size_t kLeastPairs = 3;
constexpr double kPoorFitMm = 5;  ///< as `PointPairSettings::max_residual_mm`: more is refused

/// A numbered dot; one that still waits for its partner is amber, one on the far side of the head dim.
void draw_dot(const Pen& pen, const ImVec2& at, std::size_t number, bool waits, bool hidden) {
    const float radius = std::max(13.0F, 15 * pen.scale);
    const ImU32 colour = waits ? on_pictures().amber : on_pictures().green;
    if (hidden) {
        pen.list->AddCircle(at, 0.6F * radius, IM_COL32(150, 160, 176, 160), 24, 1.5F);
        return;
    }
    pen.list->AddCircleFilled(at, 2.5F, colour);
    pen.list->AddCircle(at, 5, IM_COL32(10, 12, 16, 220), 16, 1.5F);
    const ImVec2 flag(at.x + 1.3F * radius, at.y - 1.3F * radius);  // beside the place, which stays visible
    pen.list->AddLine(at, flag, colour, 2);
    pen.list->AddCircleFilled(flag, radius, IM_COL32(10, 12, 16, 235));
    pen.list->AddCircle(flag, radius, colour, 32, 2.5F);
    pen.line(pen.fonts.strong, std::to_string(number), flag.x - radius, flag.y, 2 * radius, on_pictures().text,
             Pen::Side::centre);
}

template <class ToScene>
void draw_dots(const Pen& pen, const ScenePane& pane, const SkinSurface& surface,
               const std::vector<Eigen::Vector3d>& points, std::size_t complete, ToScene scene_from_point,
               const Eigen::Isometry3d& surface_from_scene) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d p = scene_from_point(points[i]);
        const ImVec2 at = pane.pixel_of(p);
        Ray sight = pane.sight(at);
        const double distance = (p - sight.origin).norm();
        sight = {surface_from_scene * sight.origin, surface_from_scene.linear() * sight.direction};
        const auto first = surface.first_hit(sight);
        draw_dot(pen, at, i + 1, i >= complete, first && distance - (first->p_in_ct - sight.origin).norm() > kHiddenMm);
    }
}

std::shared_ptr<const TriangleMesh> turned_mesh(const TriangleMesh& mesh, const Eigen::Isometry3d& turn) {
    auto result = std::make_shared<TriangleMesh>(mesh);
    for (auto& p : result->vertices_in_ct) p = turn * p;
    for (auto& n : result->normals_in_ct) n = turn.linear() * n;
    return result;
}

}  // namespace

LandmarkPanel::LandmarkPanel(const FontFiles& fonts, std::function<void()> make_current)
    : skin_pane_(fonts, make_current), scan_pane_(fonts, make_current) {
    scan_pane_.set_view({0, 0, 0, 1, Eigen::Vector2d::Zero()});
    scan_scene_.of_scan = true;
}

/// From the scan's frame `shown` to that of its picture: about the way it is looked at.
Eigen::Isometry3d LandmarkPanel::turned() const {
    return Eigen::Isometry3d(Eigen::AngleAxisd(quarter_turns_ * M_PI / 2, Eigen::Vector3d::UnitY()));
}

void LandmarkPanel::follow(const LandmarkViews& views) {
    if (!skin_scene_.skin) skin_scene_.skin = std::make_shared<TriangleMesh>(views.skin->mesh());
    if (views.scan == scan_) return;
    if (scan_) clicks_.clear();
    scan_ = views.scan;
    scan_scene_.skin = turned_mesh(scan_->surface.mesh(), turned());
}

void LandmarkPanel::take_clicks(const LandmarkViews& views) {
    if (const auto at = skin_pane_.take_mouse("landmark skin", boxes_[0])) {
        const auto hit = views.skin->first_hit(skin_pane_.sight(*at));
        const bool skin = hit && views.skin->real_skin(*hit);
        if (skin) clicks_.click_skin(hit->p_in_ct);
        notice_ = !hit || skin ? "" : "That is a lid or the CT's end, not skin.";
    }
    if (const auto at = scan_pane_.take_mouse("landmark scan", boxes_[1])) {
        const Ray sight = scan_pane_.sight(*at);
        const Eigen::Isometry3d back = turned().inverse();
        const auto hit = scan_->surface.first_hit({back * sight.origin, back.linear() * sight.direction});
        if (hit) clicks_.click_scan(scan_->shown_from_rig.inverse() * hit->p_in_ct);
        notice_ = hit ? "" : "There is no scanned skin at that place.";
    }
}

void LandmarkPanel::draw_panes(const Pen& pen, const LandmarkViews& views) {
    skin_pane_.draw(pen, boxes_[0], skin_scene_);
    scan_pane_.draw(pen, boxes_[1], scan_scene_);
    const std::size_t complete = clicks_.pairs().size();
    const auto to_scan_scene = [&](const Eigen::Vector3d& p_in_rig) {
        return Eigen::Vector3d(turned() * (scan_->shown_from_rig * p_in_rig));
    };
    for (int i = 0; i < 2; ++i) {
        const Box& box = boxes_[static_cast<std::size_t>(i)];
        pen.list->PushClipRect({box.x, box.y}, {box.right(), box.bottom()}, true);
        if (i == 0)
            draw_dots(
                pen, skin_pane_, *views.skin, clicks_.on_skin(), complete, [](const Eigen::Vector3d& p) { return p; },
                Eigen::Isometry3d::Identity());
        else
            draw_dots(pen, scan_pane_, scan_->surface, clicks_.on_scan(), complete, to_scan_scene, turned().inverse());
        pen.list->PopClipRect();
    }
}

void LandmarkPanel::draw_words(const Pen& pen, const Box& box) const {
    const std::size_t skin = clicks_.on_skin().size(), scan = clicks_.on_scan().size(), pairs = std::min(skin, scan);
    std::string words = skin == scan
                            ? fmt::format("Landmark {}: click it on the skin and on the scan. Drag turns.", pairs + 1)
                        : skin > scan ? fmt::format("Landmark {}: now the same place on the scan.", skin)
                                      : fmt::format("Landmark {}: now the same place on the skin from CT.", scan);
    ImU32 colour = skin == scan ? pen.theme->text : pen.theme->amber;
    if (!notice_.empty()) {
        words = notice_;
        colour = pen.theme->amber;
    }
    const float pad = 18 * pen.scale, line = line_height(pen.fonts.body);
    pen.paragraph(pen.fonts.body, pen.say(words),
                  {box.x + pad, box.y + 10 * pen.scale, box.width - 2 * pad, 1.2F * line}, colour);
    const double misfit_mm = clicks_.misfit_mm();
    const bool poor = misfit_mm > kPoorFitMm;
    const std::string fit =
        pairs < kLeastPairs
            ? fmt::format("{} of at least {} landmarks; better 5 or more, far apart.", pairs, kLeastPairs)
            : fmt::format("{} landmarks; they fit each other to {:.1f} mm (rms){}", pairs, misfit_mm,
                          poor ? ": is each where it should be, on the right side?" : ".");
    pen.paragraph(
        pen.fonts.small, pen.say(fit),
        {box.x + pad, box.y + 10 * pen.scale + line, box.width - 2 * pad, 1.2F * line_height(pen.fonts.small)},
        poor ? pen.theme->amber : pen.theme->quiet);
}

std::optional<LandmarkButton> LandmarkPanel::draw_buttons(const Pen& pen, const Box& strip,
                                                          const std::string& use_label) {
    struct Place {
        LandmarkButton which;
        std::string label;
        ButtonState state;
        float share;
        KeyMeaning key;
    };
    const std::array<Place, 4> row{{{LandmarkButton::undo,
                                     "Undo",
                                     {can(LandmarkButton::undo), "nothing clicked"},
                                     0.19F,
                                     KeyMeaning::landmark_undo},
                                    {LandmarkButton::turn, "Turn 90°", {true, {}}, 0.24F, KeyMeaning::landmark_turn},
                                    {LandmarkButton::use,
                                     use_label,
                                     {can(LandmarkButton::use), fmt::format("{} landmarks needed", kLeastPairs)},
                                     0.36F,
                                     KeyMeaning::landmark_use},
                                    {LandmarkButton::close, "Close", {true, {}}, 0.21F, KeyMeaning::landmarks}}};
    const float gap = 8 * pen.scale, room = strip.width - 3 * gap;
    std::optional<LandmarkButton> pressed;
    Box box = strip;
    for (const auto& [which, label, state, share, key] : row) {
        box.width = share * room;
        buttons_[static_cast<std::size_t>(which)] = box;
        if (button(pen, box, label, state, {false, false, key_text(key)})) pressed = which;
        box.x = box.right() + gap;
    }
    return pressed;
}

std::optional<LandmarkButton> LandmarkPanel::draw(const Pen& pen, const Box& box, const LandmarkViews& views,
                                                  const std::string& use_label) {
    const float edge = 12 * pen.scale, high = button_height(pen.scale);
    const float top = 18 * pen.scale + line_height(pen.fonts.body) + 1.2F * line_height(pen.fonts.small);
    const float pane_height = box.height - top - high - 2 * edge, pane_width = (box.width - 3 * edge) / 2;
    boxes_[0] = {box.x + edge, box.y + top, pane_width, pane_height};
    boxes_[1] = {boxes_[0].right() + edge, box.y + top, pane_width, pane_height};
    take_clicks(views);
    pen.panel(box);
    draw_words(pen, box);
    draw_panes(pen, views);
    pen.line(pen.fonts.small, pen.say("Skin from CT"), boxes_[0].x + edge, boxes_[0].y + 16 * pen.scale, pane_width / 2,
             on_pictures().text);
    pen.line(pen.fonts.small, pen.say("Scan"), boxes_[1].x + edge, boxes_[1].y + 16 * pen.scale, pane_width - edge,
             on_pictures().text);
    const auto pressed =
        draw_buttons(pen, {box.x + edge, box.bottom() - edge - high, box.width - 2 * edge, high}, use_label);
    if (pressed) press(*pressed);
    return pressed;
}

void LandmarkPanel::press(LandmarkButton which) {
    if (which == LandmarkButton::undo) clicks_.undo();
    if (which == LandmarkButton::turn && scan_) {
        quarter_turns_ = (quarter_turns_ + 1) % 4;
        scan_scene_.skin = turned_mesh(scan_->surface.mesh(), turned());
    }
}

bool LandmarkPanel::can(LandmarkButton which) const {
    if (which == LandmarkButton::undo) return clicks_.on_skin().size() + clicks_.on_scan().size() > 0;
    return which != LandmarkButton::use || clicks_.pairs().size() >= kLeastPairs;
}

std::string LandmarkPanel::why_not(LandmarkButton which) const {
    if (can(which)) return {};
    return which == LandmarkButton::undo ? "No landmark has been clicked yet."
                                         : fmt::format("At least {} landmarks are needed.", kLeastPairs);
}

std::map<std::string, Box> LandmarkPanel::places() const {
    return {{"undo", buttons_[0]},  {"turn", buttons_[1]},    {"use", buttons_[2]},
            {"close", buttons_[3]}, {"skin-view", boxes_[0]}, {"scan-view", boxes_[1]}};
}

}  // namespace planlight
