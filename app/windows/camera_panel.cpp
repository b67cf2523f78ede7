#include <algorithm>
#include <cmath>

#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

constexpr ImU32 kShadow = IM_COL32(0, 0, 0, 200), kGreyed = IM_COL32(105, 105, 105, 255);

/// Rings round what was found: whole where both cameras have it, amber and broken where this one alone has, grey where
/// nobody has compared them.
void draw_found(const Pen& pen, const std::vector<FoundMarker>& found, ImVec2 low, float zoom) {
    constexpr int kArcs = 6;
    constexpr float kTurn = 2 * 3.14159265F;
    const float s = pen.scale;
    for (const FoundMarker& marker : found) {
        // Pixel (0,0) is the centre of the first pixel, half a pixel inside the picture's corner.
        const ImVec2 at(low.x + zoom * (static_cast<float>(marker.pixel.x()) + 0.5F),
                        low.y + zoom * (static_cast<float>(marker.pixel.y()) + 0.5F));
        const float radius = std::max(7 * s, zoom * static_cast<float>(marker.radius_px) + 4 * s);
        pen.list->AddCircle(at, radius, kShadow, 32, 4);
        if (marker.pairing != FoundMarker::Pairing::alone) {
            const bool both = marker.pairing == FoundMarker::Pairing::both;
            pen.list->AddCircle(at, radius, both ? on_pictures().green : on_pictures().text, 32, both ? 2.0F : 1.5F);
            continue;
        }
        for (int i = 0; i < kArcs; ++i) {
            const float from = kTurn * static_cast<float>(i) / kArcs;
            pen.list->PathArcTo(at, radius, from, from + 0.55F * kTurn / kArcs, 6);
            pen.list->PathStroke(on_pictures().amber, 0, 2.5F);
        }
    }
}

std::string counted(const Pen& pen, const std::vector<FoundMarker>& found) {
    const auto alone = std::count_if(found.begin(), found.end(),
                                     [](const FoundMarker& m) { return m.pairing == FoundMarker::Pairing::alone; });
    std::string words = pen.say(std::to_string(found.size()) + (found.size() == 1 ? " marker" : " markers"));
    if (alone > 0) words += ", " + pen.say(std::to_string(alone) + " here alone");
    return words;
}

/// A strip of words at the picture's upper or lower edge.
void draw_strip(const Pen& pen, const Box& box, const std::string& words, ImU32 fill, ImU32 ink, bool at_foot) {
    const float s = pen.scale, height = line_height(pen.fonts.small) + 8 * s;
    const float width = std::min(text_width(pen.fonts.small, words) + 20 * s, box.width - 2);
    const float y = at_foot ? box.bottom() - height - 1 : box.y + 1;
    pen.list->AddRectFilled({box.x + 1, y}, {box.x + 1 + width, y + height}, fill, 10 * s);
    pen.line(pen.fonts.small, words, box.x + 11 * s, y + height / 2, box.width - 22 * s, ink);
}

}  // namespace

void draw_camera(const Pen& pen, const Box& box, const CameraPicture& camera, bool refused, ImTextureID texture) {
    const float s = pen.scale;
    const SeenPicture& seen = refused ? *camera.refused : camera.live;
    const bool old = !refused && camera.old_s > 0;
    pen.panel(box, IM_COL32(8, 9, 12, 255),
              refused ? pen.theme->red
              : old   ? pen.theme->amber
                      : pen.theme->edge,
              refused || old ? 3 : 1);
    if (!seen.picture || seen.picture->empty() || texture == nullptr) {
        pen.paragraph(pen.fonts.small, pen.say(camera.note),
                      {box.x + 16 * s, box.y + 0.4F * box.height, box.width - 32 * s, 0.6F * box.height},
                      on_pictures().quiet, Pen::Side::centre);
        draw_strip(pen, box, pen.say(camera.title), IM_COL32(10, 12, 16, 225), on_pictures().text, false);
        return;
    }
    const auto width = static_cast<float>(seen.picture->width), height = static_cast<float>(seen.picture->height);
    const float zoom = std::min((box.width - 6) / width, (box.height - 6) / height);
    const ImVec2 low(box.x + (box.width - zoom * width) / 2, box.y + (box.height - zoom * height) / 2);
    pen.list->AddImageRounded(texture, low, {low.x + zoom * width, low.y + zoom * height}, {0, 0}, {1, 1},
                              old ? kGreyed : IM_COL32_WHITE, 10 * s);
    if (!old) draw_found(pen, seen.found, low, zoom);
    std::string state = refused ? " · " + pen.say("refused") : old ? "" : " · " + pen.say("live");
    if (!old && seen.searched) state += " · " + counted(pen, seen.found);
    std::string title = pen.say(camera.title) + state;
    const std::string camera_word = " camera";  // is said by the place where it stands
    if (const auto at = camera.title.find(camera_word);
        text_width(pen.fonts.small, title) > box.width - 22 * s && at != std::string::npos)
        title = pen.say(camera.title.substr(0, at)) + state;
    draw_strip(pen, box, title, IM_COL32(10, 12, 16, 225), on_pictures().text, false);
    const std::string key = " · " + key_text(KeyMeaning::refused_picture);
    if (refused)
        draw_strip(pen, box, pen.say("Press for the live picture") + key, IM_COL32(70, 18, 20, 235), on_pictures().text,
                   true);
    if (!refused && camera.refused)
        draw_strip(pen, box, pen.say("Press for the refused picture") + key, IM_COL32(10, 12, 16, 225),
                   on_pictures().text, true);
    if (!old) return;
    const std::string age = pen.say(camera.old_s < 100 ? std::to_string(camera.old_s) + " s OLD" : "OLD");
    pen.line(pen.fonts.number, age, box.x, box.y + box.height / 2, box.width, on_pictures().amber, Pen::Side::centre);
    if (!camera.note.empty())
        pen.paragraph(pen.fonts.small, pen.say(camera.note),
                      {box.x + 12 * s, box.y + box.height / 2 + 22 * s, box.width - 24 * s, 0.4F * box.height},
                      on_pictures().text, Pen::Side::centre);
}

}  // namespace planlight
