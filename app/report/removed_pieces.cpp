#include "app/report/removed_pieces.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <limits>

#include "segmentation/voxel_morphology.h"

namespace planlight {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kLeastPiece_ml = 0.05;
constexpr int kNumbered = 5, kWidth = 480, kHeight = 480;
const cv::Scalar kRed(200, 30, 40), kWhite(255, 255, 255), kInk(40, 44, 52);

/// 1 where a voxel is as dense as skin and no body.
Mask dense_outside(const Volume& volume, const SkinMask& mask) {
    const Volume values = skin_values(volume, mask);
    Mask outside(volume.values.size());
    for (std::size_t v = 0; v < outside.size(); ++v)
        outside[v] = !mask.body[v] && static_cast<double>(values.values[v]) >= mask.threshold;
    return outside;
}

Vector3d place_of(const Volume& volume, std::size_t v) {
    const auto ni = static_cast<std::size_t>(volume.size[0]), nj = static_cast<std::size_t>(volume.size[1]);
    return volume.ct_from_voxel *
           Vector3d(static_cast<double>(v % ni), static_cast<double>(v / ni % nj), static_cast<double>(v / (ni * nj)));
}

RemovedPiece piece_of(const Volume& volume, const std::vector<std::size_t>& voxels, double voxel_ml) {
    RemovedPiece piece;
    piece.ml = static_cast<double>(voxels.size()) * voxel_ml;
    piece.low_in_ct = Vector3d::Constant(std::numeric_limits<double>::infinity());
    piece.high_in_ct = -piece.low_in_ct;
    for (const std::size_t v : voxels) {
        const Vector3d p = place_of(volume, v);
        piece.middle_in_ct += p / static_cast<double>(voxels.size());
        piece.low_in_ct = piece.low_in_ct.cwiseMin(p);
        piece.high_in_ct = piece.high_in_ct.cwiseMax(p);
    }
    return piece;
}

/// A shadow of the volume along a direction of ct, on pixels no smaller than a voxel.
class Shadow {
public:
    Shadow(const Volume& volume, const Vector3d& right, const Vector3d& down) : right_(right), down_(down) {
        Vector2d high = Vector2d::Constant(-std::numeric_limits<double>::infinity());
        low_ = -high;
        for (int corner = 0; corner < 8; ++corner) {
            const Vector3d voxel((corner & 1) * (volume.size[0] - 1), (corner >> 1 & 1) * (volume.size[1] - 1),
                                 (corner >> 2) * (volume.size[2] - 1));
            const Vector2d at = flat(volume.ct_from_voxel * voxel);
            low_ = low_.cwiseMin(at);
            high = high.cwiseMax(at);
        }
        mm_per_px_ = 1.1 * volume.spacing_mm().maxCoeff();
        const Vector2d pixels = (high - low_) / mm_per_px_;
        body_ = cv::Mat::zeros(static_cast<int>(pixels.y()) + 2, static_cast<int>(pixels.x()) + 2, CV_32F);
        removed_ = body_.clone();
    }
    void add_body(const Vector3d& p) { at(body_, p) += 1; }
    void add_removed(const Vector3d& p) { at(removed_, p) += 1; }

    /// The body grey, what was removed red; numbers at the pieces' middles.
    RgbImage picture(const std::vector<RemovedPiece>& pieces, const std::array<const char*, 4>& letters) const;

private:
    Vector2d flat(const Vector3d& p) const { return {p.dot(right_), p.dot(down_)}; }
    float& at(cv::Mat& shadow, const Vector3d& p) const {
        const Vector2d pixel = (flat(p) - low_) / mm_per_px_;
        return shadow.at<float>(static_cast<int>(pixel.y() + 0.5), static_cast<int>(pixel.x() + 0.5));
    }
    Vector3d right_, down_;
    Vector2d low_;
    double mm_per_px_ = 1;
    cv::Mat body_, removed_;
};

void write_in(cv::Mat& canvas, const std::string& text, const cv::Point& middle, double size, const cv::Scalar& ink) {
    const cv::Size box = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 2, nullptr);
    cv::putText(canvas, text, {middle.x - box.width / 2, middle.y + box.height / 2}, cv::FONT_HERSHEY_SIMPLEX, size,
                ink, 2, cv::LINE_AA);
}

RgbImage Shadow::picture(const std::vector<RemovedPiece>& pieces, const std::array<const char*, 4>& letters) const {
    double most = 1;
    cv::minMaxLoc(body_, nullptr, &most);
    cv::Mat small(body_.size(), CV_8UC3);
    for (int y = 0; y < small.rows; ++y)
        for (int x = 0; x < small.cols; ++x) {
            const float body = body_.at<float>(y, x);
            const auto grey = static_cast<std::uint8_t>(body > 0 ? 225 - 95 * body / std::max(most, 1.0) : 255);
            const bool red = removed_.at<float>(y, x) > 0;
            small.at<cv::Vec3b>(y, x) =
                red ? cv::Vec3b(215, body > 0 ? 90 : 60, body > 0 ? 80 : 60) : cv::Vec3b(grey, grey, grey);
        }
    const double scale = std::min(0.9 * kWidth / small.cols, 0.9 * kHeight / small.rows);
    cv::Mat large;
    cv::resize(small, large, {}, scale, scale, cv::INTER_LINEAR);
    RgbImage picture(kWidth, kHeight, {255, 255, 255});
    cv::Mat canvas(kHeight, kWidth, CV_8UC3, picture.pixels.data());
    const cv::Point corner((kWidth - large.cols) / 2, (kHeight - large.rows) / 2);
    large.copyTo(canvas(cv::Rect(corner, large.size())));
    cv::rectangle(canvas, cv::Rect(corner, large.size()), {190, 195, 205}, 1);
    for (std::size_t i = 0; i < pieces.size() && i < kNumbered; ++i) {
        const Vector2d pixel = scale * (flat(pieces[i].middle_in_ct) - low_) / mm_per_px_;
        const cv::Point middle(corner.x + static_cast<int>(pixel.x()), corner.y + static_cast<int>(pixel.y()));
        cv::circle(canvas, middle, 15, kWhite, cv::FILLED, cv::LINE_AA);
        cv::circle(canvas, middle, 15, kRed, 2, cv::LINE_AA);
        write_in(canvas, std::to_string(i + 1), middle, 0.65, kRed);
    }
    write_in(canvas, letters[0], {14, kHeight / 2}, 0.8, kInk);
    write_in(canvas, letters[1], {kWidth - 14, kHeight / 2}, 0.8, kInk);
    write_in(canvas, letters[2], {kWidth / 2, 14}, 0.8, kInk);
    write_in(canvas, letters[3], {kWidth / 2, kHeight - 14}, 0.8, kInk);
    return picture;
}

/// The head seen from the front (patient's right on the left) and from its left side.
void draw_pictures(const Volume& volume, const SkinMask& mask, const std::vector<std::vector<std::size_t>>& voxels,
                   RemovedPieces& removed) {
    Shadow front(volume, Vector3d::UnitX(), -Vector3d::UnitZ()), left(volume, Vector3d::UnitY(), -Vector3d::UnitZ());
    std::size_t v = 0;
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i, ++v) {
                if (!mask.body[v]) continue;
                const Vector3d p = volume.ct_from_voxel * Vector3d(i, j, k);
                front.add_body(p);
                left.add_body(p);
            }
    for (const auto& piece : voxels)
        for (const std::size_t at : piece) {
            front.add_removed(place_of(volume, at));
            left.add_removed(place_of(volume, at));
        }
    removed.pictures.push_back({"From the front", "", front.picture(removed.pieces, {"R", "L", "S", "I"})});
    removed.pictures.push_back({"From the left", "", left.picture(removed.pieces, {"A", "P", "S", "I"})});
}

Vector3d middle_of_body(const Volume& volume, const SkinMask& mask) {
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (std::size_t v = 0; v < mask.body.size(); v += 7)  // near enough
        if (mask.body[v]) {
            low = low.cwiseMin(place_of(volume, v));
            high = high.cwiseMax(place_of(volume, v));
        }
    return low.allFinite() ? Vector3d((low + high) / 2) : Vector3d::Zero();
}

}  // namespace

double RemovedPieces::ml() const {
    double sum = 0;
    for (const auto& piece : pieces) sum += piece.ml;
    return sum;
}

RemovedPieces find_removed_pieces(const Volume& volume, const SkinMask& mask) {
    RemovedPieces removed;
    if (mask.body.size() != volume.values.size()) return removed;
    removed.body_middle_in_ct = middle_of_body(volume, mask);
    const VoxelGrid grid = grid_of(volume);
    Mask outside = dense_outside(volume, mask);
    std::vector<std::vector<std::size_t>> voxels;
    for (std::size_t v = 0; v < outside.size(); ++v) {
        if (outside[v] != 1) continue;
        std::vector<std::size_t> reached;
        flood(outside, grid, {v}, 1, 2, &reached);
        if (static_cast<double>(reached.size()) * grid.voxel_ml() >= kLeastPiece_ml)
            voxels.push_back(std::move(reached));
    }
    std::sort(voxels.begin(), voxels.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    for (const auto& piece : voxels) removed.pieces.push_back(piece_of(volume, piece, grid.voxel_ml()));
    if (!voxels.empty()) draw_pictures(volume, mask, voxels, removed);
    return removed;
}

std::string place_in_words(const Vector3d& p_in_ct, const Vector3d& middle_in_ct) {
    const Vector3d away = p_in_ct - middle_in_ct;  // LPS
    const std::array<std::array<const char*, 2>, 3> sides{
        {{"to the right", "to the left"}, {"in front", "behind"}, {"below", "above"}}};
    std::array<Eigen::Index, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return std::abs(away[a]) > std::abs(away[b]); });
    std::string words;
    for (const Eigen::Index axis : order) {
        if (std::abs(away[axis]) < 10 || (!words.empty() && std::abs(away[axis]) < 0.3 * away.norm())) continue;
        words += fmt::format("{}{:.0f} mm {}", words.empty() ? "" : ", ", std::abs(away[axis]),
                             sides[static_cast<std::size_t>(axis)][away[axis] > 0 ? 1 : 0]);
    }
    return words.empty() ? "at the middle" : words;
}

}  // namespace planlight
