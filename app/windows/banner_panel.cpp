#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "app/windows/number_text.h"
#include "app/windows/panels.h"
#include "app/windows/status_shape.h"

namespace planlight {
namespace {

using Look = BannerLook;

const Look& look_of(const Pen& pen, StatusKind kind) {
    return pen.theme->banner[static_cast<std::size_t>(kind)];
}

float below_sentences(const Pen& pen) {
    return 9 * pen.scale;  // they may reach so far below their place
}

/// Value and the words that make a sentence of it; only what is known.
std::vector<std::pair<std::string, const char*>> figures_of(const OperatorModel& model) {
    const Figures& f = model.figures;
    // As the sentences beside it say it: never under a tenth, over a limit never as the limit.
    const auto light = f.overlay_error_mm ? std::optional(std::max(0.1, *f.overlay_error_mm)) : std::nullopt;
    std::vector<std::pair<std::string, const char*>> said;
    const auto add = [&](const std::optional<double>& value, const std::string& text, const char* words) {
        if (value && std::isfinite(*value)) said.emplace_back(text, words);
    };
    add(light, error_text(light, "mm", {model.warn_above_mm, model.stop_above_mm}), "from the light to the plan");
    add(f.updates_per_s, number_text(f.updates_per_s, "/ s"), "pictures reach the skin");
    add(f.head_moved_mm, number_text(f.head_moved_mm, "mm") + " · " + number_text(f.head_turned_deg, "°"),
        "movement of the head since the scan");
    add(f.delay_to_light_ms, number_text(f.delay_to_light_ms, "ms"), "from camera to light, drawn ahead");
    return said;
}

/// Rows of a figure and its words, which break where they have to.
struct FigureColumns {
    const ImFont* font;
    float gap, values = 0, words = 0;
    FigureColumns(const Pen& pen, const std::vector<std::pair<std::string, const char*>>& rows, float width,
                  bool narrow)
        : font(narrow ? pen.fonts.small : pen.fonts.body), gap(12 * pen.scale) {
        for (const auto& [value, sentence] : rows) {
            values = std::max(values, text_width(pen.fonts.number, value));
            words = std::max(words, text_width(font, pen.say(sentence)));
        }
        words = std::min(words, width - values - gap);
    }
};

/// 0: there is nothing to show.
float figures_width_of(const Pen& pen, const Box& box, const OperatorModel& model, bool narrow) {
    const auto rows = figures_of(model);
    if (rows.empty()) return 0;
    const FigureColumns columns(pen, rows, box.width, narrow);
    return columns.values + columns.gap + columns.words;
}

/// Each row as high as its words, what is to spare shared evenly; the last ones are left out where there is no room.
void draw_figures(const Pen& pen, const Box& box, const OperatorModel& model, const Look& look, bool narrow) {
    auto rows = figures_of(model);
    const auto [font, gap, values, words] = FigureColumns(pen, rows, box.width, narrow);
    constexpr std::size_t kAnyLines = 9;
    std::vector<float> lines;
    float used = 0;
    for (const auto& row : rows) {
        lines.push_back(static_cast<float>(broken(font, pen.say(row.second), words + 1, kAnyLines).size()));
        used += std::max(lines.back() * line_height(font), line_height(pen.fonts.number));
    }
    const float pad = below_sentences(pen);
    while (rows.size() > 1 && used > box.height + pad) {
        used -= std::max(lines[rows.size() - 1] * line_height(font), line_height(pen.fonts.number));
        rows.pop_back();
    }
    const float spare = std::clamp((box.height - used) / 4, 0.0F, 0.6F * line_height(pen.fonts.number));
    float top = box.y + (box.height - used - spare * static_cast<float>(rows.size())) / 2;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const float height = lines[i] * line_height(font);
        const float step = spare + std::max(height, line_height(pen.fonts.number));
        const float y = top + step / 2, x = box.right() - words;
        pen.line(pen.fonts.number, rows[i].first, x - gap - values, y, values + 1, look.strong, Pen::Side::right);
        pen.paragraph(font, pen.say(rows[i].second), {x, y - height / 2, words + 1, height + 1}, look.text);
        top += step;
    }
}

void draw_bar(const Pen& pen, const Box& banner, double share, const Look& look) {
    const float pad = 18 * pen.scale, height = 12 * pen.scale, y = banner.bottom() - pad / 2 - height;
    const float width = banner.width - 2 * pad;
    pen.list->AddRectFilled({banner.x + pad, y}, {banner.x + pad + width, y + height}, pen.theme->background,
                            height / 2);
    const float done = width * static_cast<float>(std::clamp(share, 0.0, 1.0));
    pen.list->AddRectFilled({banner.x + pad, y}, {banner.x + pad + std::max(done, height), y + height}, look.shape,
                            height / 2);
}

/// How high the sentences are in so wide a place, the details in that font.
float height_of(const Pen& pen, const Status& status, float width, const ImFont* details) {
    constexpr std::size_t kAnyLines = 99;
    const auto lines = [&](const ImFont* font, const std::string& t) {
        return line_height(font) * static_cast<float>(broken(font, pen.say(t), width, kAnyLines).size());
    };
    float all = lines(pen.fonts.strong, status.headline);
    for (const std::string& detail : status.details) all += lines(details, detail);
    return all;
}

bool has_room(const Pen& pen, const Box& rest, const Status& status, const ImFont* details) {
    return height_of(pen, status, rest.width, details) <= rest.height + below_sentences(pen);
}

/// In the middle of the box where there is room to spare, else from its top; in smaller letters before anything is cut.
void draw_sentences(const Pen& pen, Box rest, const Status& status, const Look& look) {
    const float bottom = rest.bottom() + below_sentences(pen);
    const ImFont* const font = has_room(pen, rest, status, pen.fonts.body) ? pen.fonts.body : pen.fonts.small;
    const float all = height_of(pen, status, rest.width, font);
    if (all < rest.height) rest.y += (rest.height - all) / 2;
    rest.height = bottom - rest.y;
    rest.y += pen.paragraph(pen.fonts.strong, pen.say(status.headline), rest, look.strong);
    for (const std::string& detail : status.details) {
        rest.height = bottom - rest.y;
        rest.y += pen.paragraph(font, pen.say(detail), rest, look.text);
    }
}

float notice_height(const Pen& pen, const Box& rest, const std::string& notice) {
    constexpr std::size_t kMostLines = 3;
    const float width = rest.width - 9 * pen.scale;
    return static_cast<float>(broken(pen.fonts.strong, pen.say(notice), width, kMostLines).size()) *
           line_height(pen.fonts.strong);
}

/// The place that a notice leaves to the sentences; all of it without one.
Box below_notice(const Pen& pen, Box rest, const std::string& notice) {
    if (notice.empty()) return rest;
    const float used = notice_height(pen, rest, notice) + 9 * pen.scale;
    rest.y += used;
    rest.height -= used;
    return rest;
}

/// Over the sentences, in as many lines as it takes; nothing without a notice.
void draw_notice(const Pen& pen, const Box& rest, const std::string& notice) {
    if (notice.empty()) return;
    const float pad = 18 * pen.scale, height = notice_height(pen, rest, notice);
    pen.panel({rest.x - pad / 2, rest.y - pad / 2, rest.width + pad / 2, height + pad / 2}, pen.theme->notice.fill,
              pen.theme->notice.edge, 2);
    pen.paragraph(pen.fonts.strong, pen.say(notice), {rest.x, rest.y - pad / 4, rest.width - pad / 2, height + 2},
                  pen.theme->notice.text);
}

}  // namespace

const char* status_word(StatusKind kind) {
    constexpr std::array kWords{"READY", "SCANNING", "MATCHING", "ALIGNED", "CHECK", "REFUSED", "DARK", "WAIT"};
    return kWords[static_cast<std::size_t>(kind)];
}

void draw_banner(const Pen& pen, const Box& box, const OperatorModel& model, const std::string& notice) {
    const Look& look = look_of(pen, model.status.kind);
    const float s = pen.scale, pad = 18 * s;
    // On a screen that stands on end the word has a row of its own, however wide that screen is.
    const bool narrow = box.width < kLeastLyingBanner * s;
    const float word_height = narrow ? 132 * s : box.height;
    pen.panel(box, look.fill, look.edge, 3);
    const float radius = narrow ? 50 * s : 0.30F * box.height, middle_y = box.y + word_height / 2;
    const ImVec2 middle(box.x + 1.6F * pad + radius, middle_y);
    draw_status_shape(pen, model.status.kind, middle, radius, look);

    const std::string status = pen.say(status_word(model.status.kind));
    const float word_x = middle.x + 1.15F * radius + 1.2F * pad, word = text_width(pen.fonts.word, status);
    pen.line(pen.fonts.word, status, word_x, middle_y, 0, look.text);

    const float figures_width = narrow ? 0.46F * box.width : 600 * s;
    const Box figures =
        narrow
            ? Box{box.right() - pad - figures_width, box.y + word_height, figures_width, box.height - word_height - pad}
            : Box{box.right() - 1.6F * pad - figures_width, box.y + 0.6F * pad, figures_width, box.height - 1.2F * pad};
    if (model.status.share) draw_bar(pen, box, *model.status.share, look);

    const float text_x = narrow ? box.x + 1.2F * pad : word_x + word + 2 * pad;
    const auto sentences_beside = [&](float used) {
        const float right = box.right() - (narrow ? 1.0F : 1.6F) * pad - (used > 0 ? used + pad : 0);
        return Box{text_x, box.y + (narrow ? word_height : pad), right - text_x,
                   box.height - (narrow ? word_height + pad : 2 * pad)};
    };
    // What to do comes before the figures: they give way where the sentences have no room beside them.
    Box rest = sentences_beside(figures_width_of(pen, figures, model, narrow));
    if (!has_room(pen, below_notice(pen, rest, notice), model.status, pen.fonts.small))
        rest = sentences_beside(0);
    else
        draw_figures(pen, figures, model, look, narrow);
    draw_notice(pen, rest, notice);
    draw_sentences(pen, below_notice(pen, rest, notice), model.status, look);
}

}  // namespace planlight
