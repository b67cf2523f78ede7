#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "app/windows/number_text.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

struct Look {
    const char* word;
    ImU32 fill, edge, shape, text;
};

const Look& look_of(StatusKind kind) {
    static const std::array<Look, 8> looks{{
        {"READY", IM_COL32(26, 31, 40, 255), IM_COL32(120, 134, 158, 255), IM_COL32(160, 172, 192, 255), theme::kText},
        {"SCANNING", IM_COL32(14, 36, 66, 255), theme::kBlue, theme::kBlue, IM_COL32(220, 236, 255, 255)},
        {"MATCHING", IM_COL32(14, 36, 66, 255), theme::kBlue, theme::kBlue, IM_COL32(220, 236, 255, 255)},
        {"ALIGNED", IM_COL32(16, 58, 38, 255), IM_COL32(47, 190, 116, 255), theme::kGreen,
         IM_COL32(222, 255, 236, 255)},
        {"CHECK", IM_COL32(62, 46, 8, 255), theme::kAmber, theme::kAmber, IM_COL32(255, 240, 205, 255)},
        {"REFUSED", IM_COL32(70, 18, 20, 255), theme::kRed, theme::kRed, IM_COL32(255, 225, 225, 255)},
        {"DARK", IM_COL32(38, 28, 31, 255), IM_COL32(158, 104, 110, 255), IM_COL32(168, 112, 118, 255),
         IM_COL32(240, 222, 224, 255)},
        {"WAIT", IM_COL32(26, 31, 40, 255), IM_COL32(120, 134, 158, 255), IM_COL32(160, 172, 192, 255), theme::kText},
    }};
    return looks[static_cast<std::size_t>(kind)];
}

/// Each status has a shape of its own, so that it is known without colour.
void draw_shape(const Pen& pen, StatusKind kind, ImVec2 middle, float radius, const Look& look) {
    constexpr float kEighth = std::numbers::pi_v<float> / 8;
    ImDrawList& list = *pen.list;
    switch (kind) {
        case StatusKind::aligned:
            list.AddCircleFilled(middle, radius, look.shape, 64);
            pen.tick(middle, radius * 0.85F, look.fill);
            break;
        case StatusKind::check:
            pen.triangle({middle.x, middle.y + 0.1F * radius}, 1.1F * radius, look.shape);
            list.AddRectFilled({middle.x - 0.09F * radius, middle.y - 0.42F * radius},
                               {middle.x + 0.09F * radius, middle.y + 0.4F * radius}, look.fill, 0.09F * radius);
            list.AddCircleFilled({middle.x, middle.y + 0.65F * radius}, 0.12F * radius, look.fill, 24);
            break;
        case StatusKind::refused:
            pen.polygon(middle, 1.05F * radius, 8, kEighth, look.shape);
            list.AddRectFilled({middle.x - 0.6F * radius, middle.y - 0.16F * radius},
                               {middle.x + 0.6F * radius, middle.y + 0.16F * radius}, look.fill);
            break;
        case StatusKind::dark:
            pen.polygon(middle, 1.05F * radius, 8, kEighth, look.shape);
            pen.polygon(middle, 0.78F * radius, 8, kEighth, IM_COL32(16, 12, 13, 255));
            break;
        case StatusKind::scanning:
            for (int i = 0; i < 4; ++i) {
                const float x = middle.x - radius + 0.571F * radius * static_cast<float>(i);
                list.AddRectFilled({x, middle.y - radius}, {x + 0.29F * radius, middle.y + radius}, look.shape);
            }
            break;
        case StatusKind::matching:
            pen.polygon(middle, 1.1F * radius, 4, 0, look.shape);
            pen.polygon(middle, 0.5F * radius, 4, 0, look.fill);
            break;
        case StatusKind::waiting:
            for (int i = -1; i <= 1; ++i)
                list.AddCircleFilled({middle.x + 0.7F * radius * static_cast<float>(i), middle.y}, 0.22F * radius,
                                     look.shape, 24);
            break;
        case StatusKind::ready:
            list.AddCircle(middle, 0.88F * radius, look.shape, 64, 0.2F * radius);
            break;
    }
}

std::array<std::pair<const char*, std::string>, 4> figures_of(const Figures& f) {
    const bool moved = f.head_moved_mm || f.head_turned_deg;
    return {{{"Overlay error now", number_text(f.overlay_error_mm, "mm")},
             {"Updates", number_text(f.updates_per_s, "/ s")},
             {"Head moved since scan",
              moved ? number_text(f.head_moved_mm, "mm") + " · " + number_text(f.head_turned_deg, "°") : "–"},
             {"Delay to light, predicted", number_text(f.delay_to_light_ms, "ms")}}};
}

void draw_figures(const Pen& pen, const Box& box, const Figures& figures, const Look& look) {
    const auto rows = figures_of(figures);
    const float step = box.height / static_cast<float>(rows.size());
    float widest = 150 * pen.scale;
    for (const auto& [label, value] : rows) widest = std::max(widest, text_width(pen.fonts.number, value));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const float y = box.y + step * (static_cast<float>(i) + 0.5F);
        pen.line(pen.fonts.number, rows[i].second, box.right() - widest, y, widest + 1, IM_COL32_WHITE);
        pen.line(pen.fonts.body, rows[i].first, box.x, y, box.width - widest - 16 * pen.scale, look.text,
                 Pen::Side::right);
    }
}

}  // namespace

const char* status_word(StatusKind kind) {
    return look_of(kind).word;
}

void draw_banner(const Pen& pen, const Box& box, const OperatorModel& model) {
    const Look& look = look_of(model.status.kind);
    const float s = pen.scale, pad = 18 * s;
    pen.panel(box, look.fill, look.edge, 3);
    const float radius = 0.30F * box.height, middle_y = box.y + box.height / 2;
    const ImVec2 middle(box.x + 1.6F * pad + radius, middle_y);
    draw_shape(pen, model.status.kind, middle, radius, look);

    const float word_x = middle.x + 1.15F * radius + 1.2F * pad, word = text_width(pen.fonts.word, look.word);
    pen.line(pen.fonts.word, look.word, word_x, middle_y, 0, look.text);

    const float figures_width = 570 * s;
    const Box figures{box.right() - 1.6F * pad - figures_width, box.y + 0.6F * pad, figures_width,
                      box.height - 1.2F * pad};
    draw_figures(pen, figures, model.figures, look);

    const float text_x = word_x + word + 2 * pad;
    Box rest{text_x, box.y + pad, figures.x - pad - text_x, box.height - 2 * pad};
    const auto lines = [&](const ImFont* font, const std::string& t) {
        return line_height(font) * static_cast<float>(broken(font, t, rest.width, 9).size());
    };
    float all = lines(pen.fonts.strong, model.status.headline);
    for (const std::string& detail : model.status.details) all += lines(pen.fonts.body, detail);
    if (all < rest.height) rest.y += (rest.height - all) / 2;
    const float bottom = box.bottom() - pad / 2;
    rest.height = bottom - rest.y;
    rest.y += pen.paragraph(pen.fonts.strong, model.status.headline, rest, IM_COL32_WHITE);
    for (const std::string& detail : model.status.details) {
        rest.height = bottom - rest.y;
        rest.y += pen.paragraph(pen.fonts.body, detail, rest, look.text);
    }
}

}  // namespace planlight
