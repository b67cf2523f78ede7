#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

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

/// Value and the words that make a sentence of it; only what is known.
std::vector<std::pair<std::string, const char*>> figures_of(const Figures& f) {
    std::vector<std::pair<std::string, const char*>> said;
    const auto add = [&](const std::optional<double>& value, const std::string& text, const char* words) {
        if (value && std::isfinite(*value)) said.emplace_back(text, words);
    };
    add(f.overlay_error_mm, number_text(f.overlay_error_mm, "mm"), "is the light beside the plan");
    add(f.updates_per_s, number_text(f.updates_per_s, "/ s"), "pictures reach the skin");
    add(f.head_moved_mm, number_text(f.head_moved_mm, "mm") + " · " + number_text(f.head_turned_deg, "°"),
        "has the head moved since the scan");
    add(f.delay_to_light_ms, number_text(f.delay_to_light_ms, "ms"), "from camera to light, drawn ahead");
    return said;
}

/// Returns the width that was used; 0: there is nothing to show.
float draw_figures(const Pen& pen, const Box& box, const Figures& figures, const Look& look) {
    const auto rows = figures_of(figures);
    if (rows.empty()) return 0;
    const float gap = 12 * pen.scale, step = box.height / 4;
    float values = 0, words = 0;
    for (const auto& [value, sentence] : rows) {
        values = std::max(values, text_width(pen.fonts.number, value));
        words = std::max(words, text_width(pen.fonts.body, pen.say(sentence)));
    }
    words = std::min(words, box.width - values - gap);
    const float top = box.y + (box.height - step * static_cast<float>(rows.size())) / 2;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const float y = top + step * (static_cast<float>(i) + 0.5F), x = box.right() - words;
        pen.line(pen.fonts.number, rows[i].first, x - gap - values, y, values + 1, IM_COL32_WHITE, Pen::Side::right);
        pen.line(pen.fonts.body, pen.say(rows[i].second), x, y, words + 1, look.text);
    }
    return values + gap + words;
}

void draw_bar(const Pen& pen, const Box& banner, double share, const Look& look) {
    const float pad = 18 * pen.scale, height = 12 * pen.scale, y = banner.bottom() - pad / 2 - height;
    const float width = banner.width - 2 * pad;
    pen.list->AddRectFilled({banner.x + pad, y}, {banner.x + pad + width, y + height}, theme::kBackground, height / 2);
    const float done = width * static_cast<float>(std::clamp(share, 0.0, 1.0));
    pen.list->AddRectFilled({banner.x + pad, y}, {banner.x + pad + std::max(done, height), y + height}, look.shape,
                            height / 2);
}

/// In the middle of the box where there is room to spare, else from its top.
void draw_sentences(const Pen& pen, Box rest, const Status& status, const Look& look) {
    const float bottom = rest.bottom() + 9 * pen.scale;
    const auto lines = [&](const ImFont* font, const std::string& t) {
        return line_height(font) * static_cast<float>(broken(font, t, rest.width, 9).size());
    };
    const std::string headline = pen.say(status.headline);
    float all = lines(pen.fonts.strong, headline);
    for (const std::string& detail : status.details) all += lines(pen.fonts.body, pen.say(detail));
    if (all < rest.height) rest.y += (rest.height - all) / 2;
    rest.height = bottom - rest.y;
    rest.y += pen.paragraph(pen.fonts.strong, headline, rest, IM_COL32_WHITE);
    for (const std::string& detail : status.details) {
        rest.height = bottom - rest.y;
        rest.y += pen.paragraph(pen.fonts.body, pen.say(detail), rest, look.text);
    }
}

}  // namespace

const char* status_word(StatusKind kind) {
    return look_of(kind).word;
}

void draw_banner(const Pen& pen, const Box& box, const OperatorModel& model, const std::string& notice) {
    const Look& look = look_of(model.status.kind);
    const float s = pen.scale, pad = 18 * s;
    pen.panel(box, look.fill, look.edge, 3);
    const float radius = 0.30F * box.height, middle_y = box.y + box.height / 2;
    const ImVec2 middle(box.x + 1.6F * pad + radius, middle_y);
    draw_shape(pen, model.status.kind, middle, radius, look);

    const float word_x = middle.x + 1.15F * radius + 1.2F * pad, word = text_width(pen.fonts.word, pen.say(look.word));
    pen.line(pen.fonts.word, pen.say(look.word), word_x, middle_y, 0, look.text);

    const float figures_width = 600 * s;
    const Box figures{box.right() - 1.6F * pad - figures_width, box.y + 0.6F * pad, figures_width,
                      box.height - 1.2F * pad};
    const float used = draw_figures(pen, figures, model.figures, look);
    if (model.status.share) draw_bar(pen, box, *model.status.share, look);

    const float text_x = word_x + word + 2 * pad, right = box.right() - 1.6F * pad - (used > 0 ? used + pad : 0);
    Box rest{text_x, box.y + pad, right - text_x, box.height - 2 * pad};
    if (!notice.empty()) {
        const float height = line_height(pen.fonts.strong);
        pen.panel({rest.x - pad / 2, rest.y - pad / 2, rest.width + pad / 2, height + pad / 2},
                  IM_COL32(62, 46, 8, 255), theme::kAmber, 2);
        pen.line(pen.fonts.strong, pen.say(notice), rest.x, rest.y + height / 2 - pad / 4, rest.width - pad / 2,
                 IM_COL32(255, 240, 205, 255));
        rest.y += height + pad / 2;
        rest.height -= height + pad / 2;
    }
    draw_sentences(pen, rest, model.status, look);
}

}  // namespace planlight
