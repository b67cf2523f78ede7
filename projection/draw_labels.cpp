#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "projection/place_labels.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Point = SkinSurface::Point;

constexpr double kField_mm = 3;

/// The frame at (x, y) mm of another's plane, carried there along a straight way.
std::optional<TextFrame> carried(const SkinSurface& skin, const TextFrame& from, const Vector2d& xy) {
    const auto way = skin.walk_way(from.at, xy.x() * from.right_in_ct + xy.y() * from.up_in_ct, 1e9);
    if (!way) return std::nullopt;
    TextFrame f{way->points.back(), from.right_in_ct, from.up_in_ct};
    if (xy.norm() > 1e-9) {  // its angle to the way stays the same
        const Vector3d ahead = way->direction_at_end_in_ct, aside = f.at.normal_in_ct.cross(ahead);
        const Vector2d along = xy.normalized();
        f.right_in_ct = along.x() * ahead - along.y() * aside;
        f.up_in_ct = along.y() * ahead + along.x() * aside;
    }
    return f;
}

/// One sign on its own little map round its middle. False where the skin ends.
bool draw_sign(const SkinSurface& skin, const TextFrame& text, const Sign& sign, const Vector2d& begins_mm,
               double height_mm, Label& label) {
    Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (const auto& outline : sign.outlines)
        for (const Vector2d& p : outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Vector2d middle = (low + high) / 2;
    const auto frame = carried(skin, text, begins_mm + height_mm * middle);
    if (!frame) return false;
    label.signs_in_ct.emplace_back();
    for (const auto& outline : sign.outlines) {
        auto& on_skin = label.signs_in_ct.back().emplace_back();
        for (const Vector2d& p : outline) {
            const Vector2d xy = height_mm * (p - middle);
            const auto at = skin.walk(frame->at, xy.x() * frame->right_in_ct + xy.y() * frame->up_in_ct);
            if (!at) return false;
            on_skin.push_back(at->p_in_ct);
        }
    }
    return true;
}

bool draw_field(const SkinSurface& skin, const TextFrame& frame, const TextBlock& block, Label& label) {
    constexpr double kMargin_mm = 0.5;
    const double width_mm = block.width_mm + 2 * kMargin_mm, height_mm = block.height_mm + 2 * kMargin_mm;
    const int nx = std::max(1, static_cast<int>(std::ceil(width_mm / kField_mm)));
    const int ny = std::max(1, static_cast<int>(std::ceil(height_mm / kField_mm)));
    for (int ix = 0; ix <= nx; ++ix)
        for (int iy = 0; iy <= ny; ++iy) {
            const double x = width_mm * (static_cast<double>(ix) / nx - 0.5),
                         y = height_mm * (static_cast<double>(iy) / ny - 0.5);
            const auto p = skin.walk(frame.at, x * frame.right_in_ct + y * frame.up_in_ct);
            if (!p) return false;
            label.field_in_ct.push_back(p->p_in_ct);
            label.field_normals_in_ct.push_back(p->normal_in_ct);
        }
    return true;
}

}  // namespace

std::optional<Label> draw_label(const SkinSurface& skin, const TextFrame& frame, const TextBlock& block, int item,
                                double text_height_mm) {
    Label label;
    label.item = item;
    label.words = block.words;
    label.text_height_mm = text_height_mm;
    label.leader.kind = StrokeKind::label;
    label.leader.item = item;
    label.leader.colour = label.colour;
    label.leader.width_mm = 0.4;
    for (const auto& line : block.lines)
        for (const Sign& sign : line.text.signs)
            if (!draw_sign(skin, frame, sign, line.begins_mm, text_height_mm, label)) return std::nullopt;
    if (!draw_field(skin, frame, block, label)) return std::nullopt;
    return label;
}

TextFrame text_frame(const Point& at, const Vector3d& up_in_ct) {
    const auto tangent = [&](const Vector3d& v) { return Vector3d(v - v.dot(at.normal_in_ct) * at.normal_in_ct); };
    if (!(up_in_ct.norm() > 0)) return text_frame(at, Vector3d(0, 0, 1));
    Vector3d up = tangent(up_in_ct.normalized());
    if (up.norm() <
        0.25) {  // on top of the head: read by someone who stands before the face (ct is LPS: +y is posterior)
        const Vector3d back = std::abs(up_in_ct.normalized().y()) > 0.9 ? Vector3d(0, 0, -1) : Vector3d(0, 1, 0);
        up = tangent(at.normal_in_ct.dot(up_in_ct) > 0 ? back : Vector3d(-back));
    }
    up.normalize();
    return {at, up.cross(at.normal_in_ct), up};
}

}  // namespace planlight
