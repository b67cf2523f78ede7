#include "app/windows/doctor_page_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"
#include "app/windows/status_shape.h"

namespace planlight {
namespace {

using Verdict = DoctorPageModel::Verdict;

/// The verdict looks as the status of a session that means as much.
StatusKind kind_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::looking:
            return StatusKind::scanning;
        case Verdict::ended:
            return StatusKind::dark;
        case Verdict::good:
            return StatusKind::aligned;
        case Verdict::look:
            return StatusKind::check;
        case Verdict::stop:
            break;
    }
    return StatusKind::refused;
}

std::string headline_of(const DoctorPageModel& model) {
    switch (model.verdict) {
        case Verdict::looking:
            return model.step.empty() ? "The examination begins." : fmt::format("Looking at {}.", model.step);
        case Verdict::ended:
            return "It was ended by hand: not all was looked at.";
        case Verdict::good:
            return "Everything in this room is ready for a patient.";
        case Verdict::look:
            return "The room may be used, and somebody should look at what stands below.";
        case Verdict::stop:
            break;
    }
    return "The room must not be used like this. Do what stands below, then look again.";
}

std::string counts_of(const DoctorPageModel& model) {
    using Health = DoctorPageModel::Health;
    return fmt::format("{} good, {} to look at, {} STOP; {} s.", model.count(Health::good), model.count(Health::look),
                       model.count(Health::stop), model.took_s);
}

}  // namespace

const char* doctor_word(Verdict verdict) {
    constexpr std::array kWords{"WAIT", "ENDED", "GOOD", "LOOK", "STOP"};
    return kWords[static_cast<std::size_t>(verdict)];
}

std::vector<std::string> doctor_words() {
    std::vector<std::string> words;
    for (const Verdict verdict : {Verdict::looking, Verdict::ended, Verdict::good, Verdict::look, Verdict::stop})
        words.emplace_back(doctor_word(verdict));
    return words;
}

std::size_t DoctorPageModel::count(Health health) const {
    return static_cast<std::size_t>(
        std::count_if(lines.begin(), lines.end(), [&](const Line& line) { return line.health == health; }));
}

DoctorPageLayout doctor_page_layout(float width, float height, float scale) {
    const bool upright = height > width;  // then the panels stand one over the other
    const float s = scale, gap = 16 * s, inside = width - 2 * gap;
    DoctorPageLayout place;
    place.title = {gap + 8 * s, gap, inside - 16 * s, 64 * s};
    place.banner = {gap, place.title.bottom() + 4 * s, inside, (upright ? 350 : 190) * s};
    const float foot = height - gap - button_height(s), third = (inside - 2 * gap) / 3;
    place.dark = {gap, foot, third, button_height(s)};
    place.again = {gap + third + gap, foot, third, button_height(s)};
    place.close = {gap + 2 * (third + gap), foot, third, button_height(s)};
    const float top = place.banner.bottom() + gap, room = foot - gap - top;
    if (upright) {
        place.wanted = {gap, top, inside, 0.55F * (room - gap)};
        place.good = {gap, place.wanted.bottom() + gap, inside, 0.45F * (room - gap)};
    } else {
        place.wanted = {gap, top, 0.54F * (inside - gap), room};
        place.good = {place.wanted.right() + gap, top, 0.46F * (inside - gap), room};
    }
    return place;
}

void draw_doctor_verdict(const Pen& pen, const Box& box, const DoctorPageModel& model) {
    const StatusKind kind = kind_of(model.verdict);
    const BannerLook& look = pen.theme->banner[static_cast<std::size_t>(kind)];
    // On a screen that stands on end the word has a row of its own.
    const bool narrow = box.width < kLeastLyingBanner * pen.scale;
    const float s = pen.scale, pad = 24 * s, row = narrow ? 140 * s : box.height,
                radius = 0.34F * std::min(row, 160 * s);
    pen.panel(box, look.fill, look.edge, 3);
    const ImVec2 middle(box.x + pad + radius, box.y + row / 2);
    draw_status_shape(pen, kind, middle, radius, look);
    const std::string word = pen.say(doctor_word(model.verdict));
    const float word_x = middle.x + radius + pad;
    pen.line(pen.fonts.word, word, word_x, middle.y, 0, look.text);
    const float x = narrow ? box.x + pad : word_x + text_width(pen.fonts.word, word) + 2 * pad,
                width = box.right() - pad - x, bottom = box.bottom() - 6 * s;
    struct Sentence {
        const ImFont* font;
        std::string words;
        ImU32 colour;
    };
    std::vector<Sentence> sentences{{pen.fonts.title, pen.say(headline_of(model)), look.strong}};
    if (!model.over())
        sentences.push_back(
            {pen.fonts.body,
             pen.say("Nobody may lie under the projector. Lay anything light where the patient will be."), look.text});
    sentences.push_back({pen.fonts.body, pen.say(counts_of(model)), look.text});
    constexpr std::size_t kAnyLines = 99;
    float high = 0;
    for (const Sentence& one : sentences)
        high += line_height(one.font) * static_cast<float>(broken(one.font, one.words, width, kAnyLines).size());
    const float top = box.y + (narrow ? row : 0);
    float y = std::max(top + 4 * s, (top + bottom - high) / 2);
    for (const Sentence& one : sentences)
        y += pen.paragraph(one.font, one.words, {x, y, width, bottom - y + 1}, one.colour);
}

DoctorPageAction draw_doctor_page(const Pen& pen, const DoctorPageLayout& place, const DoctorPageModel& model,
                                  DoctorPageScroll& scroll) {
    const float s = pen.scale;
    pen.line(pen.fonts.title, pen.say(model.title), place.title.x, place.title.y + 16 * s, place.title.width,
             pen.theme->text);
    pen.line(pen.fonts.small, model.subtitle, place.title.x, place.title.y + 46 * s, place.title.width,
             pen.theme->quiet);
    draw_doctor_verdict(pen, place.banner, model);
    draw_wanted_lines(pen, place.wanted, model, scroll.wanted);
    draw_good_lines(pen, place.good, model, scroll.good);
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const bool hovered = place.dark.contains(mouse.x, mouse.y);
    draw_dark_button(pen, place.dark, hovered, hovered && ImGui::GetIO().MouseDown[0], key_text(KeyMeaning::dark));
    DoctorPageAction wanted = DoctorPageAction::none;
    if (button(pen, place.again, "Look again", {model.over(), "it is looking"},
               {false, model.over(), key_text(KeyMeaning::next)}))
        wanted = DoctorPageAction::again;
    if (button(pen, place.close, "Close", {true, {}}, {false, false, "Q"})) wanted = DoctorPageAction::quit;
    return wanted;
}

}  // namespace planlight
