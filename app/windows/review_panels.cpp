#include "app/windows/review_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

constexpr ImU32 kNoPicture = IM_COL32(8, 9, 12, 255), kPlan = IM_COL32(41, 197, 255, 190),
                kRing = IM_COL32(0, 0, 0, 170);
constexpr double kMost_mm = 3;  // of the plot; what is above stands at its edge

/// The part of the time line's panel in which time is drawn.
Box plot_of(const Box& box, const Pen& pen) {
    const float s = pen.scale, left = 64 * s, right = 20 * s;
    return {box.x + left, box.y, box.width - left - right, box.height};
}

double length_of(const ReviewModel& model) {
    return model.line ? std::max(1.0, model.line->lasted_s) : 1;
}

float x_of(const Box& plot, const ReviewModel& model, double at_s) {
    return plot.x + plot.width * static_cast<float>(std::clamp(at_s / length_of(model), 0.0, 1.0));
}

ImU32 colour_of(const Pen& pen, LightTrust trust) {
    return trust == LightTrust::aligned ? pen.theme->green
           : trust == LightTrust::look  ? pen.theme->amber
                                        : pen.theme->quiet;
}

/// Bars of the gate's word: high and green, middle and amber, low and grey. What lasts shorter than a pixel is drawn a
/// pixel wide, the worse over the better, so that a moment of darkness is seen in an hour.
void draw_bands(const Pen& pen, const Box& box, const ReviewModel& model) {
    for (const LightTrust trust : {LightTrust::aligned, LightTrust::look, LightTrust::dark})
        for (const TimeLine::Stretch& stretch : model.line->stretches) {
            if (stretch.trust != trust) continue;
            const float from = x_of(box, model, stretch.from_s);
            const float to = std::max(x_of(box, model, stretch.to_s), from + 1);
            const float share = trust == LightTrust::aligned ? 1.0F : trust == LightTrust::look ? 0.66F : 0.33F;
            pen.list->AddRectFilled({from, box.y}, {to, box.bottom()}, pen.theme->panel);
            pen.list->AddRectFilled({from, box.bottom() - share * box.height}, {to, box.bottom()},
                                    colour_of(pen, trust));
        }
}

/// The worst figure of each column of pixels.
void draw_figure(const Pen& pen, const Box& box, const ReviewModel& model, double TimeLine::Stretch::*figure,
                 ImU32 colour) {
    std::vector<double> worst(static_cast<std::size_t>(std::max(1.0F, box.width)) + 1, -1);
    for (const TimeLine::Stretch& stretch : model.line->stretches) {
        const auto column = static_cast<std::size_t>(x_of(box, model, stretch.from_s) - box.x);
        worst[std::min(column, worst.size() - 1)] =
            std::max(worst[std::min(column, worst.size() - 1)], stretch.*figure);
    }
    const float radius = std::max(1.5F, 2 * pen.scale);
    for (std::size_t i = 0; i < worst.size(); ++i) {
        if (worst[i] < 0) continue;
        const float share = static_cast<float>(std::min(worst[i], kMost_mm) / kMost_mm);
        pen.list->AddCircleFilled({box.x + static_cast<float>(i), box.bottom() - share * box.height}, radius, colour,
                                  8);
    }
}

void draw_millimetres(const Pen& pen, const Box& box, const ReviewModel& model) {
    for (int mm = 0; mm <= static_cast<int>(kMost_mm); ++mm) {
        const float y = box.bottom() - box.height * static_cast<float>(mm / kMost_mm);
        const ImU32 colour = mm == static_cast<int>(model.stop_above_mm)   ? pen.theme->red
                             : mm == static_cast<int>(model.warn_above_mm) ? pen.theme->amber
                                                                           : pen.theme->edge;
        pen.list->AddLine({box.x, y}, {box.right(), y}, colour);
        pen.line(pen.fonts.small, fmt::format("{} mm", mm), box.x - 62 * pen.scale, y, 56 * pen.scale, pen.theme->quiet,
                 Pen::Side::right);
    }
}

void draw_clock(const Pen& pen, const Box& box, const ReviewModel& model) {
    constexpr double kSteps_s[] = {1, 2, 5, 10, 30, 60, 120, 300, 600, 1800, 3600, 7200};
    const double length = length_of(model);
    const float label = 110 * pen.scale;
    double step = kSteps_s[std::size(kSteps_s) - 1];
    for (const double one : kSteps_s)
        if (box.width * one / length >= label) {
            step = one;
            break;
        }
    for (double at_s = 0; at_s <= length; at_s += step) {
        const float x = x_of(box, model, at_s);
        pen.list->AddLine({x, box.y - 6 * pen.scale}, {x, box.y}, pen.theme->quiet);
        const std::string text = time_text(at_s).substr(0, 7);
        const float width = text_width(pen.fonts.small, text);
        if (x + width < box.right())
            pen.line(pen.fonts.small, text, x + 3 * pen.scale, box.y + box.height / 2, 0, pen.theme->quiet);
    }
}

void draw_events(const Pen& pen, const Box& box, const ReviewModel& model) {
    for (const TimeLine::Event& event : model.line->events) {
        const bool by_gate =
            event.what.starts_with("Green: ") || event.what.starts_with("Amber: ") || event.what.starts_with("Dark: ");
        const ImU32 colour = by_gate                               ? pen.theme->quiet
                             : event.what.starts_with("Refused, ") ? pen.theme->red
                                                                   : pen.theme->blue;
        const float x = x_of(box, model, event.at_s);
        pen.list->AddLine({x, box.y}, {x, box.bottom()}, colour, std::max(1.0F, 2 * pen.scale));
    }
}

ImU32 colour_of(const ReviewModel& model, const ReviewModel::Place& place) {
    if (!place.off_mm) return on_pictures().quiet;
    return *place.off_mm > model.stop_above_mm   ? on_pictures().red
           : *place.off_mm > model.warn_above_mm ? on_pictures().amber
                                                 : on_pictures().green;
}

void draw_caption(const Pen& pen, const Box& box, const std::string& words) {
    const float s = pen.scale, height = line_height(pen.fonts.small) + 8 * s;
    const float width = std::min(text_width(pen.fonts.small, words) + 20 * s, box.width - 2);
    pen.list->AddRectFilled({box.x + 1, box.y + 1}, {box.x + 1 + width, box.y + height}, IM_COL32(10, 12, 16, 225),
                            10 * s);
    pen.line(pen.fonts.small, words, box.x + 11 * s, box.y + height / 2, box.width - 22 * s, on_pictures().text);
}

/// How a part of a picture stands in its place.
struct Shown {
    ImVec2 low{}, size{};  ///< window pixels
    double zoom = 1, x = 0, y = 0;
    ImVec2 at(const Eigen::Vector2d& pixel) const {  // pixel (0, 0) is the middle of the first one
        return {low.x + static_cast<float>(zoom * (pixel.x() + 0.5 - x)),
                low.y + static_cast<float>(zoom * (pixel.y() + 0.5 - y))};
    }
};

Shown shown_in(const Box& box, const std::array<double, 4>& part) {
    Shown shown;
    shown.zoom = std::min((box.width - 6) / part[2], (box.height - 6) / part[3]);
    shown.x = part[0], shown.y = part[1];
    shown.size = {static_cast<float>(shown.zoom * part[2]), static_cast<float>(shown.zoom * part[3])};
    shown.low = {box.x + (box.width - shown.size.x) / 2, box.y + (box.height - shown.size.y) / 2};
    return shown;
}

}  // namespace

ReviewLayout review_layout(float w, float h) {
    ReviewLayout place;
    const bool on_end = h > w;
    place.scale = on_end ? std::min(w / 1080, h / 1920) : std::min(w / 1920, h / 1080);
    const float s = place.scale, gap = 16 * s, inside = w - 2 * gap;
    place.title = {gap, gap, inside, 60 * s};
    const std::size_t rows = on_end ? 2 : 1, across = place.buttons.size() / rows;
    const float high = button_height(s, 84), between = 12 * s;
    const float wide = (inside - static_cast<float>(across - 1) * between) / static_cast<float>(across);
    for (std::size_t i = 0; i < place.buttons.size(); ++i)
        place.buttons[i] = {gap + static_cast<float>(i % across) * (wide + between),
                            h - gap - high - static_cast<float>(rows - 1 - i / across) * (high + between), wide, high};
    const float time = (on_end ? 300 : 230) * s;
    place.time_line = {gap, place.buttons[0].y - gap - time, inside, time};
    const float words = (on_end ? 260 : 150) * s;
    place.words = {gap, place.time_line.y - gap - words, inside, words};
    const float top = place.title.bottom() + gap, height = place.words.y - gap - top;
    if (on_end) {
        const float width = (inside - gap) / 2, upper = std::min(0.75F * width, 0.45F * height);
        place.left = {gap, top, width, upper};
        place.right = {2 * gap + width, top, width, upper};
        place.head = {gap, top + upper + gap, inside, height - upper - gap};
    } else {
        const float width = (inside - 2 * gap) / 3;
        place.left = {gap, top, width, height};
        place.right = {2 * gap + width, top, width, height};
        place.head = {3 * gap + 2 * width, top, width, height};
    }
    return place;
}

std::optional<Eigen::Vector2d> draw_review_camera(const Pen& pen, const Box& box, const ReviewModel& model,
                                                  std::size_t camera, bool whole, ImTextureID texture,
                                                  const std::optional<ImVec2>& press) {
    const ReviewModel::Camera& shown = model.cameras[camera];
    const std::string title = pen.say(camera == 0 ? "Left camera" : "Right camera");
    pen.panel(box, kNoPicture);
    std::optional<Eigen::Vector2d> pressed;
    if (shown.picture && !shown.picture->empty() && texture != nullptr) {
        const double width = shown.picture->width, height = shown.picture->height;
        const bool all = whole || shown.round_plan[2] <= 0;
        const std::array<double, 4> part = all ? std::array<double, 4>{0, 0, width, height} : shown.round_plan;
        const Shown place = shown_in(box, part);
        const auto share = [](double a, double b) { return static_cast<float>(a / b); };
        pen.list->AddImage(texture, place.low, {place.low.x + place.size.x, place.low.y + place.size.y},
                           {share(part[0], width), share(part[1], height)},
                           {share(part[0] + part[2], width), share(part[1] + part[3], height)});
        pen.list->PushClipRect({box.x + 2, box.y + 2}, {box.right() - 2, box.bottom() - 2}, true);
        for (const auto& line : shown.plan)
            for (std::size_t i = 1; i < line.size(); ++i)
                pen.list->AddLine(place.at(line[i - 1]), place.at(line[i]), kPlan, std::max(1.0F, 1.5F * pen.scale));
        for (std::size_t i = 0; i < model.places.size(); ++i) {
            const auto& pixel = model.places[i].pixel[camera];
            if (!pixel) continue;
            const bool picked = model.picked == i;
            const float radius = (picked ? 12.0F : 5.0F) * std::max(pen.scale, 0.8F);
            pen.list->AddCircle(place.at(*pixel), radius, kRing, 24, 4);
            pen.list->AddCircle(place.at(*pixel), radius, colour_of(model, model.places[i]), 24, picked ? 3.0F : 2.0F);
        }
        pen.list->PopClipRect();
        if (press && place.zoom > 0)
            pressed = Eigen::Vector2d((press->x - place.low.x) / place.zoom + part[0] - 0.5,
                                      (press->y - place.low.y) / place.zoom + part[1] - 0.5);
    }
    draw_caption(pen, box, title);
    return pressed;
}

void draw_review_light(const Pen& pen, const Box& box, const ReviewModel& model, ImTextureID texture) {
    pen.panel(box, kNoPicture);
    if (model.light && !model.light->empty() && texture != nullptr) {
        const Shown place =
            shown_in(box, {0, 0, static_cast<double>(model.light->width), static_cast<double>(model.light->height)});
        pen.list->AddImage(texture, place.low, {place.low.x + place.size.x, place.low.y + place.size.y});
    } else {
        pen.paragraph(
            pen.fonts.small, pen.say("No picture of the projector was kept at this moment."),
            {box.x + 16 * pen.scale, box.y + 0.4F * box.height, box.width - 32 * pen.scale, 0.5F * box.height},
            on_pictures().quiet, Pen::Side::centre);
    }
    draw_caption(pen, box, pen.say("The projector's picture"));
}

void draw_review_words(const Pen& pen, const Box& box, const ReviewModel& model) {
    pen.panel(box);
    if (!model.line) return;
    const float s = pen.scale, pad = 20 * s, line = line_height(pen.fonts.body) + 6 * s;
    const bool wide = box.width > 1.6F * 900 * s;
    const Box what{box.x + pad, box.y + pad / 2, wide ? 0.5F * box.width - 1.5F * pad : box.width - 2 * pad,
                   wide ? box.height - pad : 0.55F * box.height};
    const Box where{wide ? box.x + 0.5F * box.width + pad / 2 : what.x, wide ? what.y : what.bottom(), what.width,
                    wide ? what.height : box.bottom() - what.bottom() - pad / 2};
    const TimeLine::Stretch* const stretch = stretch_at(*model.line, model.now_s);
    const LightTrust trust = stretch ? stretch->trust : LightTrust::dark;
    std::string gate = pen.say(!stretch                       ? "The plan was not followed"
                               : trust == LightTrust::aligned ? "The light was aligned"
                               : trust == LightTrust::look    ? "The light was to be looked at"
                                                              : "There was no light");
    if (stretch && stretch->off_mm >= 0) gate += " · " + pen.say(fmt::format("measured {:.1f} mm", stretch->off_mm));
    if (stretch && stretch->predicted_mm >= 0)
        gate += " · " + pen.say(fmt::format("predicted {:.1f} mm", stretch->predicted_mm));
    pen.line(pen.fonts.strong, gate, what.x, what.y + line / 2, what.width, colour_of(pen, trust));
    float y = what.y + line;
    if (const auto event = event_at(*model.line, model.now_s)) {
        const TimeLine::Event& last = model.line->events[*event];
        y += pen.paragraph(pen.fonts.body, time_text(last.at_s) + "  " + pen.say(last.what),
                           {what.x, y, what.width, std::min(2 * line, what.bottom() - y)}, pen.theme->text);
    }
    if (const auto next = next_event_s(*model.line, model.now_s); next && y + line <= what.bottom() + 1)
        pen.line(pen.fonts.small,
                 pen.say("Next event:") + " " + time_text(*next) + "  " +
                     pen.say(model.line->events[*event_at(*model.line, *next)].what),
                 what.x, y + line / 2, what.width, pen.theme->quiet);
    const bool known = model.picked && *model.picked < model.places.size();
    y = where.y;
    if (known)
        y += pen.paragraph(pen.fonts.strong, pen.say(model.places[*model.picked].words),
                           {where.x, y, where.width, 2 * line}, pen.theme->text);
    if (!model.sum.empty())
        y += pen.paragraph(pen.fonts.body, pen.say(model.sum), {where.x, y, where.width, where.bottom() - y},
                           pen.theme->text);
    if (!model.note.empty())
        y += pen.paragraph(pen.fonts.body, pen.say(model.note), {where.x, y, where.width, where.bottom() - y},
                           pen.theme->amber);
    if (!known && !model.places.empty())
        pen.paragraph(pen.fonts.small, pen.say("Press on the plan: how far off its light is there is said here."),
                      {where.x, y, where.width, where.bottom() - y}, pen.theme->quiet);
}

void draw_time_line(const Pen& pen, const Box& box, const ReviewModel& model) {
    pen.panel(box);
    if (!model.line) {
        pen.line(pen.fonts.body, pen.say("The recording is being read ..."), box.x, box.y + box.height / 2, box.width,
                 pen.theme->quiet, Pen::Side::centre);
        return;
    }
    const float s = pen.scale, word = line_height(pen.fonts.small) + 4 * s;
    const Box plot = plot_of(box, pen);
    const Box legend{plot.x, box.y + 6 * s, plot.width, word}, events{plot.x, legend.bottom(), plot.width, 16 * s},
        bands{plot.x, events.bottom() + 2 * s, plot.width, 44 * s},
        clock{plot.x, box.bottom() - word, plot.width, word - 2 * s},
        errors{plot.x, bands.bottom() + 12 * s, plot.width, clock.y - 8 * s - bands.bottom() - 12 * s};
    float x = legend.x;
    for (const auto& [colour, words] :
         {std::pair{pen.theme->blue, "measured (95 %)"}, std::pair{pen.theme->text, "predicted (95 %)"}}) {
        pen.list->AddCircleFilled({x + 5 * s, legend.y + word / 2}, 4 * s, colour, 12);
        const std::string text = pen.say(words);
        pen.line(pen.fonts.small, text, x + 14 * s, legend.y + word / 2, 0, pen.theme->quiet);
        x += text_width(pen.fonts.small, text) + 40 * s;
    }
    draw_bands(pen, bands, model);
    draw_events(pen, events, model);
    draw_millimetres(pen, errors, model);
    draw_figure(pen, errors, model, &TimeLine::Stretch::predicted_mm, pen.theme->text);
    draw_figure(pen, errors, model, &TimeLine::Stretch::off_mm, pen.theme->blue);
    draw_clock(pen, clock, model);
    const float now = x_of(plot, model, model.now_s);
    pen.list->AddLine({now, events.y}, {now, clock.y}, pen.theme->text, std::max(2.0F, 2 * s));
    pen.list->AddTriangleFilled({now - 7 * s, events.y - 2 * s}, {now + 7 * s, events.y - 2 * s},
                                {now, events.y + 8 * s}, pen.theme->text);
}

double time_at(const Box& box, const Pen& pen, const ReviewModel& model, float x) {
    const Box plot = plot_of(box, pen);
    return std::clamp((x - plot.x) / plot.width, 0.0F, 1.0F) * length_of(model);
}

std::optional<std::size_t> place_near(const ReviewModel& model, std::size_t camera, const Eigen::Vector2d& pixel) {
    double least = 20;
    std::optional<std::size_t> nearest;
    for (std::size_t i = 0; i < model.places.size(); ++i) {
        const auto& at = model.places[i].pixel[camera];
        if (!at || (*at - pixel).norm() > least) continue;
        least = (*at - pixel).norm();
        nearest = i;
    }
    return nearest;
}

std::string time_text(double s) {
    const long long hundredths = std::llround(std::max(0.0, s) * 100), whole = hundredths / 100;
    return fmt::format("{}:{:02}:{:02}.{:02}", whole / 3600, whole / 60 % 60, whole % 60, hundredths % 100);
}

}  // namespace planlight
