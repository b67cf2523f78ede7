#include "projection/text_line.h"

#include <algorithm>

#include "projection/stroke_font.h"
#include "projection/stroke_raster.h"

namespace planlight {

using Eigen::Vector2d;

void write_line(const std::string& text, const Vector2d& middle, double height, Rgb colour, RgbImage& picture) {
    StrokeRaster raster(picture.width, picture.height);
    const std::u32string codes = code_points(text);
    const double half = std::max(0.75, height / 16);
    double x = middle.x() - text_width(codes) * height / 2;
    for (const char32_t code : codes) {
        const Glyph sign = glyph(code);
        for (const auto& way : sign.lines)
            for (std::size_t i = 0; i + 1 < way.size(); ++i) {
                const auto place = [&](const Vector2d& p) {
                    return Vector2d(x + p.x() * height, middle.y() + height / 2 - p.y() * height);
                };
                Vector2d a = place(way[i]), b = place(way[i + 1]);
                if (a == b) continue;
                const Vector2d along = half * (b - a).normalized(), aside(-along.y(), along.x());
                a -= along, b += along;
                raster.add_quad({a + aside, b + aside, b - aside, a - aside});
                raster.flush(colour, picture);
            }
        x += sign.advance * height;
    }
}

}  // namespace planlight
