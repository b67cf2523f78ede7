#include "app/windows/guide_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/windows/operator_model.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr ImU32 kCell = IM_COL32(56, 214, 132, 34), kCellEdge = IM_COL32(56, 214, 132, 60);

void draw_cells(const Pen& pen, ImVec2 low, ImVec2 size, const GuideModel::Cells& cells) {
    if (cells.across <= 0 || cells.down <= 0) return;
    const float width = size.x / static_cast<float>(cells.across), height = size.y / static_cast<float>(cells.down);
    for (int y = 0; y < cells.down; ++y)
        for (int x = 0; x < cells.across; ++x) {
            if (cells.hits[static_cast<std::size_t>(y * cells.across + x)] == 0) continue;
            const ImVec2 a(low.x + width * static_cast<float>(x), low.y + height * static_cast<float>(y));
            pen.list->AddRectFilled(a, {a.x + width, a.y + height}, kCell);
            pen.list->AddRect(a, {a.x + width, a.y + height}, kCellEdge);
        }
}

void draw_title(const Pen& pen, const Box& box, const std::string& title) {
    pen.line(pen.fonts.small, pen.say(title), box.x + 14 * pen.scale, box.y + 20 * pen.scale,
             box.width - 28 * pen.scale, pen.theme->quiet);
}

using Look = BannerLook;

const Look& look_of(const Pen& pen, GuideModel::Mood mood) {
    const auto of = [&](StatusKind kind) -> const Look& { return pen.theme->banner[static_cast<std::size_t>(kind)]; };
    switch (mood) {
        case GuideModel::Mood::hold:
        case GuideModel::Mood::busy:
            return of(StatusKind::scanning);
        case GuideModel::Mood::done:
            return of(StatusKind::aligned);
        case GuideModel::Mood::wrong:
            break;
    }
    return of(StatusKind::check);
}

}  // namespace

std::vector<std::string> guide_words() {
    return {"HOLD STILL", "NO BOARD",  "NOT SEEN", "TOO DARK", "TOO BRIGHT", "BLURRED",
            "TILT IT",    "LESS TILT", "FARTHER",  "NEARER",   "NO LIGHT",   "WAIT",
            "CAPTURING",  "LOOKING",   "AGAIN",    "TAKEN",    "DONE",       "KEEP IT?"};
}

void draw_guide_camera(const Pen& pen, const Box& box, const GuideModel::Camera& camera, ImTextureID texture) {
    pen.panel(box, IM_COL32(8, 9, 12, 255));
    if (camera.picture && texture != nullptr) {
        const auto width = static_cast<float>(camera.picture->width),
                   height = static_cast<float>(camera.picture->height);
        const float zoom = std::min((box.width - 4) / width, (box.height - 4) / height);
        const ImVec2 low(box.x + (box.width - zoom * width) / 2, box.y + (box.height - zoom * height) / 2);
        pen.list->AddImage(texture, low, {low.x + zoom * width, low.y + zoom * height});
        draw_cells(pen, low, {zoom * width, zoom * height}, camera.cells);
        for (const Eigen::Vector2d& p : camera.corners) {
            const ImVec2 at(low.x + zoom * (static_cast<float>(p.x()) + 0.5F),
                            low.y + zoom * (static_cast<float>(p.y()) + 0.5F));
            pen.list->AddCircleFilled(at, 4.5F * pen.scale, IM_COL32(0, 0, 0, 200), 12);
            pen.list->AddCircleFilled(at, 3 * pen.scale, pen.theme->blue, 12);
        }
    }
    const std::string title =
        pen.say(camera.title +
                (camera.corners.empty() ? " · board not seen" : fmt::format(" · {} corners", camera.corners.size())));
    const float height = line_height(pen.fonts.small) + 8 * pen.scale,
                width = std::min(text_width(pen.fonts.small, title) + 20 * pen.scale, box.width);
    pen.list->AddRectFilled({box.x + 1, box.y + 1}, {box.x + width, box.y + height}, IM_COL32(10, 12, 16, 225),
                            10 * pen.scale);
    pen.line(pen.fonts.small, title, box.x + 10 * pen.scale, box.y + height / 2, box.width - 20 * pen.scale,
             camera.corners.empty() ? on_pictures().amber : on_pictures().text);
}

void draw_guide_cells(const Pen& pen, const Box& box, const std::string& title, const GuideModel::Cells& cells) {
    pen.panel(box);
    draw_title(pen, box, title);
    const float top = 38 * pen.scale, pad = 14 * pen.scale;
    const float width = std::min(box.width - 2 * pad, (box.height - top - pad) * 4 / 3), height = width * 3 / 4;
    const ImVec2 low(box.x + (box.width - width) / 2, box.y + top);
    pen.list->AddRectFilled(low, {low.x + width, low.y + height}, IM_COL32(8, 9, 12, 255));
    draw_cells(pen, low, {width, height}, cells);
    pen.list->AddRect(low, {low.x + width, low.y + height}, pen.theme->edge);
}

void draw_guide_tilts(const Pen& pen, const Box& box, const GuideModel& model) {
    constexpr double kRim = 50 / kDegrees;
    pen.panel(box);
    draw_title(pen, box, "Tilt: which edge came nearer");
    const float s = pen.scale, top = 44 * s, word = line_height(pen.fonts.small);
    const char* words[4] = {"left", "right", "upper", "lower"};
    const auto edge_text = [&](std::size_t i) { return pen.say(fmt::format("{} {}", words[i], model.by_edge[i])); };
    const float beside = std::max({90 * s, text_width(pen.fonts.small, edge_text(0)) + 14 * s,
                                   text_width(pen.fonts.small, edge_text(1)) + 14 * s});
    const float radius = std::min(box.width / 2 - beside, (box.height - top - 2 * word - 24 * s) / 2);
    const ImVec2 middle(box.x + box.width / 2, box.y + top + word + radius);
    // A face that is turned to the right has its left edge nearer: the dot goes to the edge that came nearer.
    const auto at = [&](const Eigen::Vector2d& tilt) {
        const double length = std::min(tilt.norm(), kRim), angle = std::atan2(-tilt.y(), -tilt.x());
        return ImVec2(middle.x + radius * static_cast<float>(length / kRim * std::cos(angle)),
                      middle.y + radius * static_cast<float>(length / kRim * std::sin(angle)));
    };
    constexpr float kQuarter = std::numbers::pi_v<float> / 2;
    const float turns[4] = {2, 0, 3, 1};  // left, right, upper, lower
    for (std::size_t i = 0; i < 4; ++i) {
        pen.list->PathLineTo(middle);
        pen.list->PathArcTo(middle, radius, (turns[i] - 0.5F) * kQuarter, (turns[i] + 0.5F) * kQuarter, 24);
        pen.list->PathFillConvex(
            look_of(pen, model.by_edge[i] > 0 ? GuideModel::Mood::done : GuideModel::Mood::wrong).fill);
    }
    pen.list->AddCircle(middle, radius, pen.theme->edge, 48, 2);
    pen.list->AddCircleFilled(middle, radius * static_cast<float>(model.useful_tilt / kRim), pen.theme->panel, 48);
    const ImVec2 places[4] = {{box.x + 6 * s, middle.y},
                              {middle.x + radius + 6 * s, middle.y},
                              {box.x + 6 * s, middle.y - radius - word / 2 - 2 * s},
                              {box.x + 6 * s, middle.y + radius + word / 2 + 2 * s}};
    for (std::size_t i = 0; i < 4; ++i) {
        const std::string text = edge_text(i);
        const float width = i == 0   ? middle.x - radius - box.x - 12 * s
                            : i == 1 ? box.right() - places[i].x - 6 * s
                                     : box.width - 12 * s;
        pen.line(pen.fonts.small, text, places[i].x, places[i].y, width,
                 model.by_edge[i] > 0 ? pen.theme->green : pen.theme->amber, Pen::Side::centre);
    }
    for (const Eigen::Vector2d& tilt : model.tilts) pen.list->AddCircleFilled(at(tilt), 7 * s, pen.theme->green, 20);
    if (model.tilt_now) pen.list->AddCircle(at(*model.tilt_now), 12 * s, pen.theme->text, 24, 3 * s);
}

void draw_guide_depths(const Pen& pen, const Box& box, const GuideModel& model) {
    pen.panel(box);
    draw_title(pen, box, "Distance");
    if (model.distances_mm.empty() && !model.distance_now_mm) return;
    std::vector<double> all = model.distances_mm;
    std::sort(all.begin(), all.end());
    const double usual = all.empty() ? *model.distance_now_mm : all[all.size() / 2];
    const double low = 0.8 * usual, high = 1.2 * usual;
    const float s = pen.scale, from = box.x + 88 * s, to = box.right() - 84 * s, y = box.y + box.height * 0.62F;
    const auto at = [&](double mm) {
        return from + (to - from) * static_cast<float>(std::clamp((mm - low) / (high - low), 0.0, 1.0));
    };
    pen.list->AddLine({from, y}, {to, y}, pen.theme->edge, 4 * s);
    pen.line(pen.fonts.small, pen.say("near"), box.x + 12 * s, y, 60 * s, pen.theme->quiet);
    pen.line(pen.fonts.small, pen.say("far"), to + 24 * s, y, 56 * s, pen.theme->quiet);
    for (const double mm : all) pen.list->AddCircleFilled({at(mm), y}, 7 * s, pen.theme->green, 20);
    if (model.distance_now_mm) pen.list->AddCircle({at(*model.distance_now_mm), y}, 12 * s, pen.theme->text, 24, 3 * s);
}

void draw_guide_banner(const Pen& pen, const Box& box, const GuideModel& model) {
    const Look& look = look_of(pen, model.mood);
    const float s = pen.scale, pad = 26 * s;
    pen.panel(box, look.fill, look.edge, 3);
    const std::string word = pen.say(model.word);
    // On a screen that stands on end the word has a row of its own.
    const bool narrow = box.width < kLeastLyingBanner * s;
    const float word_row = narrow ? 132 * s : box.height;
    pen.line(pen.fonts.word, word, box.x + pad, box.y + word_row / 2, 0, look.text);
    const float x =
        narrow ? box.x + pad : box.x + 2 * pad + std::max(0.36F * box.width, text_width(pen.fonts.word, word));
    const float width = box.right() - pad - x;
    float y = box.y + (narrow ? word_row : 0.16F * box.height);
    if (!model.what.empty())
        y += pen.paragraph(pen.fonts.title, pen.say(model.what), {x, y, width, 0.5F * box.height}, pen.theme->text);
    if (!model.why.empty())
        pen.paragraph(pen.fonts.body, pen.say(model.why), {x, y + 4 * s, width, box.bottom() - y - 34 * s}, look.text);
    if (model.share > 0) {
        const float bar = box.bottom() - 22 * s;
        pen.list->AddRectFilled({x, bar}, {x + width, bar + 10 * s}, pen.theme->background, 5 * s);
        pen.list->AddRectFilled({x, bar},
                                {x + width * static_cast<float>(std::clamp(model.share, 0.0, 1.0)), bar + 10 * s},
                                look.edge, 5 * s);
    }
}

void draw_guide_progress(const Pen& pen, const Box& box, const GuideModel& model) {
    pen.panel(box);
    const float s = pen.scale, x = box.x + 20 * s, width = box.width - 40 * s;
    float y = box.y + 14 * s;
    const auto paragraph = [&](const ImFont* font, const std::string& text, ImU32 colour) {
        y +=
            pen.paragraph(font, pen.say(text), {x, y, width, std::max(0.0F, box.bottom() - y - 8 * s)}, colour) + 4 * s;
    };
    if (!model.result.empty()) {
        for (const std::string& sentence : model.result) paragraph(pen.fonts.small, sentence, pen.theme->text);
        return;
    }
    paragraph(pen.fonts.number, fmt::format("{} {}", model.poses, model.poses == 1 ? "pose" : "poses"),
              pen.theme->text);
    paragraph(pen.fonts.small, fmt::format("{} at least, {} at most", model.least_poses, model.most_poses),
              pen.theme->quiet);
    if (model.predicted_mm)
        paragraph(pen.fonts.body,
                  fmt::format("Predicted error {:.3f} mm (to reach: {:g})", *model.predicted_mm, model.good_enough_mm),
                  *model.predicted_mm <= model.good_enough_mm ? pen.theme->green : pen.theme->amber);
    else
        paragraph(pen.fonts.body, "Predicted error: after three poses", pen.theme->quiet);
    if (model.wanted.empty()) return;
    std::string wanted;
    for (const std::string& one : model.wanted) wanted += (wanted.empty() ? ": " : "; ") + pen.say(one);
    pen.paragraph(pen.fonts.body, pen.say("Still wanted") + wanted + ".",
                  {x, y, width, std::max(0.0F, box.bottom() - y - 8 * s)}, pen.theme->amber);
}

namespace {

GuideAction draw_buttons(const Pen& pen, const Box& box, const GuideModel& model) {
    const float gap = 16 * pen.scale, width = (box.width - gap) / 2;
    const ButtonState free{!model.result.empty(), "when it is finished"};
    GuideAction wanted = GuideAction::none;
    if (button(pen, {box.x, box.y, width, box.height}, "Keep", free)) wanted = GuideAction::keep;
    if (button(pen, {box.x + width + gap, box.y, width, box.height}, "Discard", free)) wanted = GuideAction::discard;
    return wanted;
}

}  // namespace

GuideAction draw_guide(const Pen& pen, const GuideLayout& place, const GuideModel& model,
                       const std::array<ImTextureID, 2>& textures) {
    const float s = pen.scale, x = 24 * s, width = place.banner.width - 16 * s;
    pen.line(pen.fonts.title, pen.say(model.title), x, 30 * s, width, pen.theme->text);
    pen.line(pen.fonts.small, model.subtitle, x, 58 * s, width, pen.theme->quiet);
    draw_guide_camera(pen, place.left, model.left, textures[0]);
    draw_guide_camera(pen, place.right, model.right, textures[1]);
    draw_guide_cells(pen, place.projector, "In the projector's light", model.projector);
    draw_guide_progress(pen, place.progress, model);
    draw_guide_tilts(pen, place.tilts, model);
    draw_guide_depths(pen, place.depths, model);
    const GuideAction wanted = draw_buttons(pen, place.buttons, model);
    draw_guide_banner(pen, place.banner, model);
    return wanted;
}

}  // namespace planlight
