#include <algorithm>
#include <cmath>

#include "app/windows/panels.h"

namespace planlight {

void draw_camera(const Pen& pen, const Box& box, const CameraPicture& camera, ImTextureID texture) {
    const float s = pen.scale;
    pen.panel(box, IM_COL32(8, 9, 12, 255));
    if (camera.picture && !camera.picture->empty() && texture != nullptr) {
        const auto width = static_cast<float>(camera.picture->width),
                   height = static_cast<float>(camera.picture->height);
        const float zoom = std::min((box.width - 4) / width, (box.height - 4) / height);
        const ImVec2 low(box.x + (box.width - zoom * width) / 2, box.y + (box.height - zoom * height) / 2);
        const ImVec2 high(low.x + zoom * width, low.y + zoom * height);
        pen.list->AddImageRounded(texture, low, high, {0, 0}, {1, 1}, IM_COL32_WHITE, 10 * s);
        for (const FoundMarker& found : camera.found) {
            // Pixel (0,0) is the centre of the first pixel, half a pixel inside the picture's corner.
            const ImVec2 at(low.x + zoom * (static_cast<float>(found.pixel.x()) + 0.5F),
                            low.y + zoom * (static_cast<float>(found.pixel.y()) + 0.5F));
            const float radius = std::max(7 * s, zoom * static_cast<float>(found.radius_px) + 4 * s);
            pen.list->AddCircle(at, radius, IM_COL32(0, 0, 0, 200), 32, 4);
            pen.list->AddCircle(at, radius, theme::kGreen, 32, 2);
        }
    } else {
        pen.paragraph(pen.fonts.small, camera.note,
                      {box.x + 16 * s, box.y + box.height / 2, box.width - 32 * s, box.height / 2}, theme::kQuiet,
                      Pen::Side::centre);
    }
    const std::string markers =
        " · " + std::to_string(camera.found.size()) + (camera.found.size() == 1 ? " marker" : " markers");
    const std::string title = camera.picture ? camera.title + markers : camera.title;
    const float height = line_height(pen.fonts.small) + 8 * s,
                width = std::min(text_width(pen.fonts.small, title) + 20 * s, box.width);
    pen.list->AddRectFilled({box.x + 1, box.y + 1}, {box.x + width, box.y + height}, IM_COL32(10, 12, 16, 225), 10 * s);
    pen.line(pen.fonts.small, title, box.x + 10 * s, box.y + height / 2, box.width - 20 * s, theme::kText);
}

}  // namespace planlight
