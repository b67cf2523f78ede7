#include "app/windows/camera_page_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

constexpr ImU32 kPictureGround = IM_COL32(8, 9, 12, 255), kShadow = IM_COL32(0, 0, 0, 200),
                kStrip = IM_COL32(10, 12, 16, 225);

/// A strip of words at the upper edge of a picture.
void draw_strip(const Pen& pen, const Box& box, const std::string& words) {
    const float s = pen.scale, height = line_height(pen.fonts.small) + 8 * s,
                width = std::min(text_width(pen.fonts.small, words) + 20 * s, box.width - 2);
    pen.list->AddRectFilled({box.x + 1, box.y + 1}, {box.x + 1 + width, box.y + 1 + height}, kStrip, 10 * s);
    pen.line(pen.fonts.small, words, box.x + 11 * s, box.y + 1 + height / 2, box.width - 22 * s, on_pictures().text);
}

/// The corners of the part that sharpness is measured in.
void draw_region(const Pen& pen, ImVec2 low, ImVec2 size) {
    const float arm = 0.04F * size.x;
    for (const float x : {0.25F, 0.75F})
        for (const float y : {0.25F, 0.75F}) {
            const ImVec2 at(low.x + x * size.x, low.y + y * size.y);
            const ImVec2 along(at.x + (x < 0.5F ? arm : -arm), at.y), down(at.x, at.y + (y < 0.5F ? arm : -arm));
            for (const auto& [colour, width] :
                 {std::pair{kShadow, 4 * pen.scale}, {on_pictures().text, 2 * pen.scale}}) {
                pen.list->AddLine(at, along, colour, width);
                pen.list->AddLine(at, down, colour, width);
            }
        }
}

void draw_markers(const Pen& pen, const std::vector<CameraPageModel::Marker>& markers, ImVec2 low, float zoom) {
    for (const CameraPageModel::Marker& marker : markers) {
        // Pixel (0,0) is the centre of the first pixel, half a pixel inside the picture's corner.
        const ImVec2 at(low.x + zoom * (static_cast<float>(marker.pixel.x()) + 0.5F),
                        low.y + zoom * (static_cast<float>(marker.pixel.y()) + 0.5F));
        const float radius = std::max(7 * pen.scale, zoom * static_cast<float>(marker.radius_px) + 4 * pen.scale);
        pen.list->AddCircle(at, radius, kShadow, 32, 4);
        pen.list->AddCircle(at, radius, on_pictures().green, 32, 2);
    }
}

std::string shown_words(TestPicture shown) {
    switch (shown) {
        case TestPicture::dark:
            return "The projector is dark.";
        case TestPicture::frame:
            return "The projector shows its frame.";
        case TestPicture::star:
            return "The projector shows the focus star.";
        case TestPicture::steps:
            return "The projector shows grey steps.";
        case TestPicture::name:
            return "The projector shows its name.";
    }
    return {};
}

/// Buttons in `rows` rows of as many, DARK first; all over `foot`.
void lay_out_buttons(const Box& foot, float gap, int rows, CameraPageLayout& place) {
    const int across = 6 / rows;
    const float width = (foot.width - gap * static_cast<float>(across - 1)) / static_cast<float>(across),
                height = (foot.height - gap * static_cast<float>(rows - 1)) / static_cast<float>(rows);
    for (int i = 0; i < 6; ++i) {
        const Box box{foot.x + static_cast<float>(i % across) * (width + gap),
                      foot.y + static_cast<float>(i / across) * (height + gap), width, height};
        (i == 0 ? place.dark : place.buttons.at(static_cast<std::size_t>(i - 1))) = box;
    }
}

}  // namespace

std::optional<TestPicture> wanted_picture(CameraPageAction action) {
    switch (action) {
        case CameraPageAction::frame:
            return TestPicture::frame;
        case CameraPageAction::star:
            return TestPicture::star;
        case CameraPageAction::steps:
            return TestPicture::steps;
        case CameraPageAction::name:
            return TestPicture::name;
        default:
            return std::nullopt;
    }
}

CameraPageLayout camera_page_layout(float width, float height, float scale) {
    const bool upright = height > width;  // then the cameras stand one over the other
    const int rows = upright ? 2 : 1;
    const float s = scale, gap = 16 * s, buttons = static_cast<float>(rows) * (button_height(s) + gap) - gap;
    CameraPageLayout place;
    place.title = {gap + 8 * s, gap, width - 2 * gap - 16 * s, 64 * s};
    const Box foot{gap, height - gap - buttons, width - 2 * gap, buttons};
    lay_out_buttons(foot, gap, rows, place);
    const float room = std::max(100 * s, 64.0F), top = place.title.bottom() + 4 * s;
    place.room = {gap, foot.y - gap - room, width - 2 * gap, room};
    const float column = upright ? width - 2 * gap : (width - 3 * gap) / 2,
                block = (place.room.y - gap - top) / (upright ? 2 : 1), figures = std::max(240 * s, 186.0F);
    for (const std::size_t i : {0U, 1U}) {
        const float x = gap + (upright ? 0 : static_cast<float>(i) * (column + gap)),
                    y = top + (upright ? static_cast<float>(i) * (block + gap / 2) : 0),
                    high = block - (upright ? gap / 2 : 0);
        place.picture.at(i) = {x, y, column, high - figures - 0.5F * gap};
        place.figures.at(i) = {x, y + high - figures, column, figures};
    }
    return place;
}

void draw_aimed_camera(const Pen& pen, const Box& box, const CameraPageModel::Camera& camera, ImTextureID texture) {
    const bool troubled = !camera.trouble.empty();
    pen.panel(box, kPictureGround, troubled ? pen.theme->red : pen.theme->edge, troubled ? 3.0F : 1.0F);
    if (camera.picture && texture != nullptr) {
        const auto width = static_cast<float>(camera.picture->width),
                   height = static_cast<float>(camera.picture->height);
        const float zoom = std::min((box.width - 4) / width, (box.height - 4) / height);
        const ImVec2 low(box.x + (box.width - zoom * width) / 2, box.y + (box.height - zoom * height) / 2);
        const ImU32 tint = troubled ? IM_COL32(110, 110, 110, 255) : IM_COL32_WHITE;
        pen.list->AddImage(texture, low, {low.x + zoom * width, low.y + zoom * height}, {0, 0}, {1, 1}, tint);
        draw_region(pen, low, {zoom * width, zoom * height});
        if (!troubled) draw_markers(pen, camera.markers, low, zoom);
    }
    draw_strip(pen, box, pen.say(camera.title) + (camera.picture ? "" : ": " + pen.say("no picture yet")));
}

void draw_page_room(const Pen& pen, const Box& box, const CameraPageModel& model) {
    pen.panel(box);
    const float s = pen.scale, x = box.x + 16 * s, width = box.width - 32 * s, half = box.height / 2;
    const bool together = model.together();
    const std::string pairs =
        !model.apart_ms ? pen.say("Whether both cameras expose together is not known yet.")
        : together      ? pen.say(fmt::format("Both cameras expose together: {:.2f} ms apart ({:.2f} allowed).",
                                              *model.apart_ms, model.allowed_ms))
                        : pen.say(fmt::format("The cameras do not expose together: {:.2f} ms apart ({:.2f} allowed).",
                                              *model.apart_ms, model.allowed_ms));
    pen.line(pen.fonts.body, pairs, x, box.y + 0.55F * half, width,
             !model.apart_ms ? pen.theme->quiet
             : together      ? pen.theme->green
                             : pen.theme->red);
    const bool troubled = !model.light_trouble.empty();
    pen.line(troubled ? pen.fonts.small : pen.fonts.body,
             troubled ? pen.say(model.light_trouble) + ". " + pen.say(model.light_trouble_remedy)
                      : pen.say(shown_words(model.shown)),
             x, box.y + 1.45F * half, width, troubled ? pen.theme->red : pen.theme->text);
}

CameraPageAction draw_camera_page(const Pen& pen, const CameraPageLayout& place, const CameraPageModel& model,
                                  const std::array<ImTextureID, 2>& textures) {
    struct PageButton {
        const char* label;
        const char* key;
        CameraPageAction action;
    };
    constexpr PageButton kButtons[] = {{"Frame", "F", CameraPageAction::frame},
                                       {"Focus star", "S", CameraPageAction::star},
                                       {"Grey steps", "G", CameraPageAction::steps},
                                       {"Its name", "N", CameraPageAction::name},
                                       {"Forget the best", "R", CameraPageAction::forget_best}};
    const float s = pen.scale;
    pen.line(pen.fonts.title, pen.say(model.title), place.title.x, place.title.y + 16 * s, place.title.width,
             pen.theme->text);
    pen.line(pen.fonts.small, model.subtitle, place.title.x, place.title.y + 46 * s, place.title.width,
             pen.theme->quiet);
    draw_aimed_camera(pen, place.picture[0], model.left, textures[0]);
    draw_aimed_camera(pen, place.picture[1], model.right, textures[1]);
    draw_camera_figures(pen, place.figures[0], model.left);
    draw_camera_figures(pen, place.figures[1], model.right);
    draw_page_room(pen, place.room, model);
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const bool hovered = place.dark.contains(mouse.x, mouse.y);
    draw_dark_button(pen, place.dark, hovered, hovered && ImGui::GetIO().MouseDown[0], key_text(KeyMeaning::dark));
    CameraPageAction wanted = CameraPageAction::none;
    for (std::size_t i = 0; i < place.buttons.size(); ++i) {
        const PageButton& one = kButtons[i];
        const auto lights = wanted_picture(one.action);
        const ButtonState state{!lights || model.no_light.empty(), model.no_light};
        const bool on = lights && model.shown == *lights;
        if (button(pen, place.buttons.at(i), one.label, state, {on, false, one.key})) wanted = one.action;
    }
    return wanted;
}

}  // namespace planlight
