#include "app/report/slice_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace planlight {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

const cv::Scalar kSkinLine(54, 214, 138), kSealLine(255, 176, 60), kEndLine(120, 130, 140), kPlanLine(255, 92, 160),
    kRiskLine(80, 190, 255), kLetter(235, 240, 246);

/// How the picture lies in ct: unit vectors of its right and down, and the letters at its sides.
struct Frame {
    Vector3d right, down;
    const char *left_letter, *right_letter, *up_letter, *down_letter;
    Vector3d normal() const { return right.cross(down); }
};

Frame frame_of(SliceKind kind) {
    if (kind == SliceKind::axial) return {Vector3d::UnitX(), Vector3d::UnitY(), "R", "L", "A", "P"};
    if (kind == SliceKind::coronal) return {Vector3d::UnitX(), -Vector3d::UnitZ(), "R", "L", "S", "I"};
    return {Vector3d::UnitY(), -Vector3d::UnitZ(), "A", "P", "S", "I"};
}

/// The slice's plane with its picture: the whole volume fits, with equal scale both ways.
struct Sheet {
    Frame frame;
    Vector3d middle_in_ct;
    double mm_per_px;
    SliceSettings settings;

    Sheet(const Volume& volume, SliceKind kind, const Vector3d& p_in_ct, const SliceSettings& s)
        : frame(frame_of(kind)), settings(s) {
        Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (int corner = 0; corner < 8; ++corner) {
            const Vector3d voxel((corner & 1) * (volume.size[0] - 1), (corner >> 1 & 1) * (volume.size[1] - 1),
                                 (corner >> 2) * (volume.size[2] - 1));
            const Vector3d p = volume.ct_from_voxel * voxel;
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        const Vector3d box = high - low, middle = (low + high) / 2, n = frame.normal();
        middle_in_ct = middle + n * n.dot(p_in_ct - middle);
        constexpr double kMargin = 1.06;
        mm_per_px =
            kMargin * std::max(std::abs(box.dot(frame.right)) / s.width, std::abs(box.dot(frame.down)) / s.height);
    }
    Vector3d p_in_ct(int x, int y) const {
        return middle_in_ct + mm_per_px * ((x - 0.5 * (settings.width - 1)) * frame.right +
                                           (y - 0.5 * (settings.height - 1)) * frame.down);
    }
    Vector2d pixel(const Vector3d& p) const {
        const Vector3d d = (p - middle_in_ct) / mm_per_px;
        return {d.dot(frame.right) + 0.5 * (settings.width - 1), d.dot(frame.down) + 0.5 * (settings.height - 1)};
    }
    double above_mm(const Vector3d& p) const { return frame.normal().dot(p - middle_in_ct); }
};

std::optional<float> value_at(const Volume& v, const Vector3d& voxel) {
    std::array<int, 3> low{};
    Vector3d t;
    for (int a = 0; a < 3; ++a) {
        const int last = v.size[static_cast<std::size_t>(a)] - 1;
        if (!(voxel[a] >= 0 && voxel[a] <= last)) return std::nullopt;
        low[static_cast<std::size_t>(a)] = std::clamp(static_cast<int>(voxel[a]), 0, std::max(0, last - 1));
        t[a] = voxel[a] - low[static_cast<std::size_t>(a)];
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        const double weight = (dx ? t.x() : 1 - t.x()) * (dy ? t.y() : 1 - t.y()) * (dz ? t.z() : 1 - t.z());
        if (weight > 0) sum += weight * v.at(low[0] + dx, low[1] + dy, low[2] + dz);
    }
    return static_cast<float>(sum);
}

std::pair<double, double> window_of(const Volume& volume, const SliceSettings& settings) {
    if (settings.low != 0 || settings.high != 0) return {settings.low, settings.high};
    if (volume.is_hu) return {-800, 800};
    std::vector<float> some;
    for (std::size_t i = 0; i < volume.values.size(); i += 1 + volume.values.size() / 200'000)
        some.push_back(volume.values[i]);
    if (some.empty()) return {0, 1};
    const auto rank = [&](double share) {
        const auto at = some.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(some.size() - 1));
        std::nth_element(some.begin(), at, some.end());
        return static_cast<double>(*at);
    };
    const double low = rank(0.01), high = rank(0.995);
    return {low, std::max(high, low + 1e-6)};
}

void paint_values(const Volume& volume, const Sheet& sheet, RgbImage& picture) {
    const auto [low, high] = window_of(volume, sheet.settings);
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const auto value = value_at(volume, voxel_from_ct * sheet.p_in_ct(x, y));
            if (!value) continue;
            const auto gray =
                static_cast<std::uint8_t>(std::lround(255 * std::clamp((*value - low) / (high - low), 0.0, 1.0)));
            picture.at(x, y) = {gray, gray, gray};
        }
}

void draw_line(cv::Mat& canvas, const Vector2d& a, const Vector2d& b, const cv::Scalar& colour, int thickness) {
    constexpr int kShift = 4;
    const auto fixed = [](const Vector2d& p) {
        return cv::Point(static_cast<int>(std::lround(p.x() * (1 << kShift))),
                         static_cast<int>(std::lround(p.y() * (1 << kShift))));
    };
    cv::line(canvas, fixed(a), fixed(b), colour, thickness, cv::LINE_AA, kShift);
}

/// Where the slice cuts the surface; a skin's seals and ends have colours of their own.
void draw_surface(const TriangleMesh& skin, const Sheet& sheet, cv::Mat& canvas, const cv::Scalar& usual) {
    std::vector<double> above(skin.vertices_in_ct.size());
    std::transform(skin.vertices_in_ct.begin(), skin.vertices_in_ct.end(), above.begin(),
                   [&](const auto& p) { return sheet.above_mm(p); });
    for (const auto& triangle : skin.triangles) {
        std::array<Vector2d, 2> ends;
        std::size_t found = 0;
        std::uint8_t flag = kSkin;
        for (std::size_t k = 0; k < 3 && found < 2; ++k) {
            const auto i = static_cast<std::size_t>(triangle[k]), j = static_cast<std::size_t>(triangle[(k + 1) % 3]);
            if ((above[i] < 0) == (above[j] < 0)) continue;
            const double t = above[i] / (above[i] - above[j]);
            ends[found++] = sheet.pixel((1 - t) * skin.vertices_in_ct[i] + t * skin.vertices_in_ct[j]);
            if (!skin.flags.empty()) flag = std::max(flag, std::max(skin.flags[i], skin.flags[j]));
        }
        if (found == 2)
            draw_line(canvas, ends[0], ends[1], flag == kSkin ? usual : flag == kSeal ? kSealLine : kEndLine, 2);
    }
}

/// The part of a straight line that is near the slice.
void draw_near(const Vector3d& a, const Vector3d& b, const Sheet& sheet, cv::Mat& canvas) {
    constexpr int kPieces = 64;
    for (int i = 0; i < kPieces; ++i) {
        const Vector3d p = a + (b - a) * i / kPieces, q = a + (b - a) * (i + 1) / kPieces;
        if (std::abs(sheet.above_mm((p + q) / 2)) <= sheet.settings.plan_within_mm)
            draw_line(canvas, sheet.pixel(p), sheet.pixel(q), kPlanLine, 2);
    }
}

/// A hole as deep and as wide as it is planned.
void draw_hole_near(const Borehole& hole, const Sheet& sheet, cv::Mat& canvas) {
    if (!hole.axis_in_ct) return;
    const Vector3d &along = *hole.axis_in_ct, &from = hole.position_in_ct,
                   to = from + std::max(hole.depth_mm, 1.0) * along;
    draw_near(from, to, sheet, canvas);
    const Vector3d across = along.cross(sheet.frame.normal());
    const Vector3d aside = across.norm() > 0.1 ? across.normalized() : along.unitOrthogonal();
    const Vector3d radius = 0.5 * std::max(hole.diameter_mm, 2.0) * aside;
    draw_near(from - radius, from + radius, sheet, canvas);
}

/// Where a line of a plane passes the slice: a dot.
void draw_crossing(const Vector3d& a, const Vector3d& b, const Sheet& sheet, cv::Mat& canvas) {
    const double above_a = sheet.above_mm(a), above_b = sheet.above_mm(b);
    if (above_a * above_b > 0 || above_a == above_b) return;
    const Vector2d at = sheet.pixel(a + above_a / (above_a - above_b) * (b - a));
    cv::circle(canvas, {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))}, 1, kPlanLine, -1,
               cv::LINE_AA);
}

void draw_plan_near(const Plan& plan, const Sheet& sheet, cv::Mat& canvas) {
    for (const auto& t : plan.trajectories) {
        draw_near(t.entry_in_ct, t.target_in_ct, sheet, canvas);
        if (std::abs(sheet.above_mm(t.target_in_ct)) > sheet.settings.plan_within_mm) continue;
        const Vector2d at = sheet.pixel(t.target_in_ct);
        cv::circle(canvas, {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))}, 5, kPlanLine,
                   2, cv::LINE_AA);
    }
    for (const auto& b : plan.boreholes) draw_hole_near(b, sheet, canvas);
    for (const auto& plane : plan.cut_planes) {
        const Vector3d u = 0.5 * plane.width_mm * plane.first_axis_in_ct,
                       v = 0.5 * plane.height_mm * plane.normal_in_ct.cross(plane.first_axis_in_ct);
        constexpr int kLines = 40;  // of the plane, each drawn where it comes near the slice
        for (int k = -kLines; k <= kLines; ++k) {
            const double share = static_cast<double>(k) / kLines;
            const Vector3d along = plane.origin_in_ct + share * v, across = plane.origin_in_ct + share * u;
            draw_crossing(along - u, along + u, sheet, canvas);
            draw_crossing(across - v, across + v, sheet, canvas);
        }
    }
    for (const auto& line : plan.osteotomy_lines) {
        const std::size_t n = line.points_in_ct.size();
        for (std::size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i)
            draw_near(line.points_in_ct[i], line.points_in_ct[(i + 1) % n], sheet, canvas);
    }
}

void write_letter(cv::Mat& canvas, const std::string& letter, int x, int y) {
    const cv::Size size = cv::getTextSize(letter, cv::FONT_HERSHEY_SIMPLEX, 1, 2, nullptr);
    const cv::Point at(x - size.width / 2, y + size.height / 2);
    cv::putText(canvas, letter, at, cv::FONT_HERSHEY_SIMPLEX, 1, cv::Scalar(0, 0, 0), 6, cv::LINE_AA);
    cv::putText(canvas, letter, at, cv::FONT_HERSHEY_SIMPLEX, 1, kLetter, 2, cv::LINE_AA);
}

}  // namespace

RgbImage slice_picture(const Volume& volume, const TriangleMesh& skin, const Plan& plan, SliceKind kind,
                       const Vector3d& p_in_ct, const SliceSettings& settings) {
    const Sheet sheet(volume, kind, p_in_ct, settings);
    RgbImage picture(settings.width, settings.height, {10, 14, 26});
    paint_values(volume, sheet, picture);
    cv::Mat canvas(picture.height, picture.width, CV_8UC3, picture.pixels.data());
    draw_surface(skin, sheet, canvas, kSkinLine);
    for (const auto& structure : plan.risk_structures) draw_surface(structure.surface, sheet, canvas, kRiskLine);
    draw_plan_near(plan, sheet, canvas);
    constexpr int kEdge = 22;
    write_letter(canvas, sheet.frame.left_letter, kEdge, settings.height / 2);
    write_letter(canvas, sheet.frame.right_letter, settings.width - kEdge, settings.height / 2);
    write_letter(canvas, sheet.frame.up_letter, settings.width / 2, kEdge);
    write_letter(canvas, sheet.frame.down_letter, settings.width / 2, settings.height - kEdge);
    return picture;
}

}  // namespace planlight
