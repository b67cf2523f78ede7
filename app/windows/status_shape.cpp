#include "app/windows/status_shape.h"

#include <numbers>

namespace planlight {

void draw_status_shape(const Pen& pen, StatusKind kind, ImVec2 middle, float radius, const BannerLook& look) {
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

}  // namespace planlight
