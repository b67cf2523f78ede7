#include "registration/calibration/observe_pose.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "registration/devices/colour_mosaic.h"
#include "registration/scan/check/camera_gamma.h"
#include "registration/scan/check/check_sequence.h"
#include "registration/scan/check/panel_ends.h"
#include "registration/scan/decode/gray_code.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// The picture plane as seen on the board, roughly (no lens distortion): says which pixels lie on the board, nothing
/// else.
Matrix3d board_from_pixel(const BoardCorners& corners, const BoardSpec& board) {
    Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(corners.size()), 9);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3d b = board.corner_in_board(corners.ids[i]) / board.width_mm();
        const Vector3d p(corners.pixels[i].x() / 1000, corners.pixels[i].y() / 1000, 1);
        const auto r = 2 * static_cast<Eigen::Index>(i);
        rows.row(r) << p.transpose(), 0, 0, 0, -b.x() * p.transpose();
        rows.row(r + 1) << 0, 0, 0, p.transpose(), -b.y() * p.transpose();
    }
    const Eigen::VectorXd h = rows.jacobiSvd(Eigen::ComputeFullV).matrixV().col(8);
    Matrix3d board_from_thousandths;
    board_from_thousandths << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
    return Vector3d(board.width_mm(), board.width_mm(), 1).asDiagonal() * board_from_thousandths *
           Vector3d(1e-3, 1e-3, 1).asDiagonal();
}

bool even_around(const GrayImage& picture, int x, int y, double contrast) {
    if (x < 2 || y < 2 || x >= picture.width - 2 || y >= picture.height - 2) return false;
    int low = 255, high = 0, sum = 0;
    for (int j = y - 2; j <= y + 2; ++j)
        for (int i = x - 2; i <= x + 2; ++i) {
            low = std::min<int>(low, picture.at(i, j));
            high = std::max<int>(high, picture.at(i, j));
            sum += picture.at(i, j);
        }
    return high - low < 6 + contrast * sum / 25;  // 6: noise of 25 pixels
}

struct BoardPixel {
    int x, y;
};

/// Pixels of a lattice that lie on the board, a tenth of a square away from its rim.
std::vector<BoardPixel> pixels_on_board(const CameraObservation& seen, const BoardSpec& board, int wanted) {
    const Matrix3d to_board = board_from_pixel(seen.corners, board);
    Vector2d least(1e9, 1e9), most(-1e9, -1e9);
    for (const Vector2d& p : seen.corners.pixels) {
        least = least.cwiseMin(p);
        most = most.cwiseMax(p);
    }
    const Vector2d size = most - least,
                   square = size / std::max(2.0, std::sqrt(static_cast<double>(seen.corners.size())) - 1);
    const int stride = std::max(1, static_cast<int>(std::sqrt(size.prod() / wanted)));
    const int x0 = std::max(0, static_cast<int>(least.x() - square.x())),
              x1 = std::min(seen.width - 1, static_cast<int>(most.x() + square.x()));
    const int y0 = std::max(0, static_cast<int>(least.y() - square.y())),
              y1 = std::min(seen.height - 1, static_cast<int>(most.y() + square.y()));
    const double rim = 0.1 * board.square_mm;
    std::vector<BoardPixel> pixels;
    for (int y = y0; y <= y1; y += stride)
        for (int x = x0; x <= x1; x += stride) {
            const Vector2d b = (to_board * Vector3d(x, y, 1)).hnormalized();
            if (b.x() > rim && b.y() > rim && b.x() < board.width_mm() - rim && b.y() < board.height_mm() - rim)
                pixels.push_back({x, y});
        }
    return pixels;
}

/// The sum of pictures that together are even light (a bit and its inverse, all fringes of a direction), as bright as
/// can be shown: far less noise than one white picture.
GrayImage even_light(std::span<const GrayImage> frames) {
    std::vector<int> sum(frames[0].pixels.size(), 0);
    for (const GrayImage& frame : frames)
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += frame.pixels[i];
    const int top = std::max(1, *std::max_element(sum.begin(), sum.end()));
    GrayImage even(frames[0].width, frames[0].height);
    for (std::size_t i = 0; i < sum.size(); ++i)
        even.pixels[i] = static_cast<std::uint8_t>((sum[i] * 255 + top / 2) / top);
    return even;
}

/// The last pictures of the sequence that together are even light: a direction's fringes, or a bit and its inverse.
std::span<const GrayImage> last_even(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    const int last = steps_of(stripes, static_cast<int>(stripes.order_periods_px.size()));
    return frames.last(std::min<std::size_t>(frames.size(), last > 0 ? static_cast<std::size_t>(last) : 2));
}

/// All of the sequence but the black picture, where every bit has its inverse; else the last fringes.
std::span<const GrayImage> all_even(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    return stripes.inverse ? frames.subspan(2) : last_even(frames, stripes);
}

double moved_between(const BoardCorners& first, const BoardCorners& last) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < first.size(); ++i) {
        x.push_back(last.pixels[i].x() - first.pixels[i].x());
        y.push_back(last.pixels[i].y() - first.pixels[i].y());
    }
    return std::hypot(median(x), median(y));
}

void judge_white(const GrayImage& white, const std::vector<BoardPixel>& pixels, CameraObservation& seen) {
    std::vector<double> grey;
    std::size_t saturated = 0;
    for (const auto& [x, y] : pixels) {
        grey.push_back(white.at(x, y));
        saturated += white.at(x, y) >= 254;
    }
    seen.white_grey = median(grey);
    seen.saturated_share = pixels.empty() ? 0 : static_cast<double>(saturated) / static_cast<double>(pixels.size());
}

void keep_light(std::span<const GrayImage> frames, const StripeSettings& stripes, const std::vector<BoardPixel>& pixels,
                const ObserveSettings& settings, CameraObservation& seen) {
    const DecodedView code = decode_calibration_light(frames, stripes);
    if (settings.check_sequence && seen.wrong_sequence.empty() && stripes.phase_steps > 0)
        if (const auto problem = check_panel_ends(code, frames[0], frames[1], stripes))
            seen.wrong_sequence = problem->what;
    std::vector<LightSample> all;
    std::vector<double> contrast;
    std::size_t decoded = 0, lit = 0;
    for (const auto& [x, y] : pixels) {
        const std::size_t i = frames[0].index(x, y);
        const int difference = frames[0].pixels[i] - frames[1].pixels[i];
        contrast.push_back(difference);
        if (difference < 8) continue;  // the projector does not reach here
        ++lit;
        if (std::isnan(code.column[i]) || std::isnan(code.row[i])) continue;
        ++decoded;
        if (even_around(frames[0], x, y, settings.edge_contrast))
            all.push_back({{x, y}, {code.column[i], code.row[i]}});
    }
    std::erase_if(contrast, [](double c) { return c < 8; });
    seen.contrast_grey = median(contrast);
    seen.decoded_share = lit == 0 ? 0 : static_cast<double>(decoded) / static_cast<double>(lit);
    const std::size_t wanted = static_cast<std::size_t>(settings.light_samples), count = std::min(wanted, all.size());
    for (std::size_t i = 0; i < count; ++i) seen.light.push_back(all[i * all.size() / count]);
}

BoardCorners mirrored_corners(const GrayImage& picture, const BoardSpec& board) {
    GrayImage mirrored = picture;
    for (int y = 0; y < picture.height; ++y)
        std::reverse(mirrored.pixels.begin() + y * picture.width, mirrored.pixels.begin() + (y + 1) * picture.width);
    return find_board(mirrored, board);
}

void judge_sequence(std::span<const GrayImage> frames, const StripeSettings& stripes, CameraObservation& seen) {
    const auto patterns = stripes.phase_steps == 0 ? gray_code_patterns(stripes) : stripe_sequence(stripes);
    const SequenceCheck check = check_sequence(frames, stripes, patterns, true);
    if (check.problems.empty()) return;
    const SequenceProblem& problem = check.problems[0];
    ScanCapture capture;
    capture.stripes = stripes;
    if (stripes.phase_steps == 0) capture.partial = patterns;
    const double gamma = camera_gamma({frames.begin(), frames.end()}, uniform_light_frames(capture));
    seen.wrong_sequence =
        fmt::format("{} ({:.0f} % of the lit pixels){}", problem.what, 100 * problem.share, said_of_gamma(gamma));
    if (problem.cause == SequenceProblem::Cause::flicker) seen.sequence_remedy = remedy_of(problem);
}

}  // namespace

DecodedView decode_calibration_light(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    return stripes.phase_steps == 0 ? decode_gray_code(frames, stripes) : decode_stripes(frames, stripes);
}

CameraObservation observe_board(std::span<const GrayImage> frames, const std::optional<StripeSettings>& stripes,
                                const BoardSpec& board, const ObserveSettings& settings) {
    CameraObservation seen;
    if (frames.empty()) return seen;
    seen.width = frames[0].width;
    seen.height = frames[0].height;
    seen.coded_light = stripes.has_value() && frames.size() > 1;
    seen.colour_mosaic = is_colour_mosaic(frames[0]);
    seen.corners = find_board(frames[0], board);
    if (!spans_a_plane(seen.corners, board)) {
        if (board.kind == BoardSpec::Kind::charuco)
            seen.found_mirrored = spans_a_plane(mirrored_corners(frames[0], board), board);
        seen.corners = {};
        return seen;
    }
    const auto pixels = pixels_on_board(seen, board, 12 * settings.light_samples);
    judge_white(frames[0], pixels, seen);
    if (!seen.coded_light) return seen;
    if (settings.check_sequence) judge_sequence(frames, *stripes, seen);
    keep_light(frames, *stripes, pixels, settings, seen);
    seen.moved_px =
        moved_between(seen.corners, follow_board(even_light(last_even(frames, *stripes)), seen.corners, board));
    if (seen.moved_px < settings.moved_px)
        seen.corners = follow_board(even_light(all_even(frames, *stripes)), seen.corners, board);
    return seen;
}

}  // namespace planlight
