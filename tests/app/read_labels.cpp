#include "tests/app/read_labels.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <utility>

#include "planning_io/files/image_file.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::string digits_of(const std::string& text) {
    std::string digits;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool point =
            text[i] == '.' && i > 0 && i + 1 < text.size() && std::isdigit(text[i - 1]) && std::isdigit(text[i + 1]);
        if (std::isdigit(static_cast<unsigned char>(text[i])) || point) digits += text[i];
    }
    return digits;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char c : text)
        if (c == '/')
            lines.emplace_back();
        else
            lines.back() += c;
    return lines;
}

/// As an eye evens out what lies in less light: against the mean and the spread of 5 mm round about; with a bright rim.
GrayImage dark_on_bright(const std::vector<double>& values, int width, int height, int round_px) {
    constexpr int kRim_px = 20;
    std::vector<double> sum(static_cast<std::size_t>((width + 1) * (height + 1)), 0), squares = sum;
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * (width + 1) + x); };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double v = values[static_cast<std::size_t>(y * width + x)];
            sum[at(x + 1, y + 1)] = v + sum[at(x, y + 1)] + sum[at(x + 1, y)] - sum[at(x, y)];
            squares[at(x + 1, y + 1)] = v * v + squares[at(x, y + 1)] + squares[at(x + 1, y)] - squares[at(x, y)];
        }
    const auto spread_in = [&](int x0, int y0, int x1, int y1, double& mean) {
        const double n = (x1 - x0) * (y1 - y0);
        const auto box = [&](const auto& t) { return t[at(x1, y1)] - t[at(x0, y1)] - t[at(x1, y0)] + t[at(x0, y0)]; };
        mean = box(sum) / n;
        return std::sqrt(std::max(0.0, box(squares) / n - mean * mean));
    };
    double mean = 0;
    const double all = spread_in(0, 0, width, height, mean);
    GrayImage picture(width + 2 * kRim_px, height + 2 * kRim_px);
    std::fill(picture.pixels.begin(), picture.pixels.end(), std::uint8_t{255});
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double spread = spread_in(std::max(0, x - round_px), std::max(0, y - round_px),
                                            std::min(width, x + round_px), std::min(height, y + round_px), mean);
            const double v =
                (values[static_cast<std::size_t>(y * width + x)] - mean) / std::max(spread, 0.6 * all + 1e-9);
            picture.at(x + kRim_px, y + kRim_px) = static_cast<std::uint8_t>(std::clamp(200 - 110 * v, 0.0, 255.0));
        }
    return picture;
}

}  // namespace

double between(const GrayImage& picture, const Vector2d& at) {
    const auto weights = [](double t) {
        return std::array{-0.5 * t + t * t - 0.5 * t * t * t, 1 - 2.5 * t * t + 1.5 * t * t * t,
                          0.5 * t + 2 * t * t - 1.5 * t * t * t, -0.5 * t * t + 0.5 * t * t * t};
    };
    const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
    const auto wx = weights(at.x() - x), wy = weights(at.y() - y);
    double sum = 0;
    for (int dy = 0; dy < 4; ++dy)
        for (int dx = 0; dx < 4; ++dx)
            sum +=
                wx[static_cast<std::size_t>(dx)] * wy[static_cast<std::size_t>(dy)] *
                picture.at(std::clamp(x + dx - 1, 0, picture.width - 1), std::clamp(y + dy - 1, 0, picture.height - 1));
    return sum;
}

bool can_read_labels() {
    return std::system("tesseract --version >/dev/null 2>&1") == 0;
}

std::string read_text(const GrayImage& picture) {
    const TemporaryFolder folder;
    write_png(picture, folder.path() / "label.png");
    const std::string command = "OMP_THREAD_LIMIT=1 tesseract '" + (folder.path() / "label.png").string() +
                                "' stdout --psm 7 --dpi 200 -l eng 2>/dev/null";
    std::string read;
    if (FILE* pipe = popen(command.c_str(), "r")) {
        std::array<char, 256> some{};
        while (std::fgets(some.data(), some.size(), pipe)) read += some.data();
        pclose(pipe);
    }
    while (!read.empty() && (read.back() == '\n' || read.back() == '\f' || read.back() == ' ')) read.pop_back();
    std::string one_line;
    for (const char c : read)
        if (c != '\n')
            one_line += c;
        else if (!one_line.empty() && one_line.back() != '/')
            one_line += '/';
    return one_line;
}

Reading compare(const std::string& written, const std::string& read) {
    const auto plain = [](const std::string& text) {
        std::string out;
        for (std::size_t i = 0; i < text.size();) {
            static const std::string kDots = "…";
            if (text.compare(i, kDots.size(), kDots) == 0) {
                out += "...";
                i += kDots.size();
                continue;
            }
            const char c = text[i++];
            if (c != ' ' && c != '/') out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        }
        return out;
    };
    if (plain(written) == plain(read)) return Reading::right;
    const auto wanted = lines_of(written), got = lines_of(read);
    for (std::size_t k = 0; k < std::max(wanted.size(), got.size()); ++k) {
        const std::string digits = k < got.size() ? digits_of(got[k]) : "";
        if (!digits.empty() && (k >= wanted.size() || digits != digits_of(wanted[k]))) return Reading::other_number;
    }
    return Reading::other;
}

namespace {

/// Where a line of a label's text stands: its middle, the way it runs and stands, half its size.
struct TextLineOnSkin {
    Vector3d middle, right, up;
    double half_width_mm = 0, half_height_mm = 0;
};

struct LabelAxes {
    Vector3d normal, right, up;
};
LabelAxes axes_of(const Label& label) {
    Vector3d normal = Vector3d::Zero();
    for (const Vector3d& n : label.field_normals_in_ct) normal += n;
    normal.normalize();
    std::size_t at = label.field_in_ct.size() / 2;  // the field goes up column by column
    while (at > 0 && (label.field_in_ct[at - 1] - label.field_in_ct[at]).norm() < 4.5) --at;
    const Vector3d along_up = label.field_in_ct[at + 1] - label.field_in_ct[at];
    const Vector3d up = (along_up - along_up.dot(normal) * normal).normalized();
    return {normal, up.cross(normal), up};
}

/// The outlines' points of each line of text, from the top: a sign far to the left of the one before begins another.
std::vector<std::vector<Vector3d>> rows_of(const Label& label, const Vector3d& right) {
    std::vector<std::vector<Vector3d>> rows(1);
    double before = -1e9;
    for (const auto& sign : label.signs_in_ct) {
        Vector3d middle = Vector3d::Zero();
        double count = 0;
        for (const auto& outline : sign)
            for (const Vector3d& p : outline) middle += p, ++count;
        const double here = middle.dot(right) / count;
        if (here < before - 1.5) rows.emplace_back();
        for (const auto& outline : sign) rows.back().insert(rows.back().end(), outline.begin(), outline.end());
        before = here;
    }
    return rows;
}

/// A line of text in a camera's picture: pixels of its middle, and of a millimetre along and up it.
struct LineSeen {
    Vector2d middle_px;
    Eigen::Matrix2d px_by_mm;
    Vector2d low_mm{1e9, 1e9}, high_mm{-1e9, -1e9};  ///< of its ink, from the middle
};

/// As straight as the line is seen: through its ink, by least squares. Empty when part of it is out of the picture.
std::optional<LineSeen> line_seen(const std::vector<Vector3d>& points, const LabelAxes& axes, const CameraModel& camera,
                                  const RigidTransform& rig_from_ct) {
    constexpr double kWide_mm = 12;
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
    Eigen::Matrix<double, 2, 3> px_by_rig;
    const auto middle = project(camera, rig_from_ct * mean, px_by_rig);
    if (!middle) return std::nullopt;
    Eigen::Matrix2d px_by_mm;
    px_by_mm << px_by_rig * (rig_from_ct.linear() * axes.right), px_by_rig * (rig_from_ct.linear() * axes.up);
    const Eigen::Matrix2d mm_by_px = px_by_mm.inverse();
    std::vector<Vector2d> seen;
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, low = 1e9, high = -1e9;
    for (const Vector3d& p : points) {
        const auto pixel = project(camera, rig_from_ct * p);
        if (!pixel || !in_picture(camera, *pixel)) return std::nullopt;
        const Vector2d xy = mm_by_px * (*pixel - *middle);
        seen.push_back(xy);
        n += 1, sx += xy.x(), sy += xy.y(), sxx += xy.x() * xy.x(), sxy += xy.x() * xy.y();
        low = std::min(low, xy.x()), high = std::max(high, xy.x());
    }
    const double slope = high - low > kWide_mm ? (n * sxy - sx * sy) / std::max(1e-9, n * sxx - sx * sx) : 0;
    Eigen::Matrix2d turned;
    turned << Vector2d(1, slope), Vector2d(0, 1);
    LineSeen line{*middle, px_by_mm * turned};
    for (const Vector2d& xy : seen) {
        const Vector2d own(xy.x(), xy.y() - slope * xy.x());
        line.low_mm = line.low_mm.cwiseMin(own), line.high_mm = line.high_mm.cwiseMax(own);
    }
    return line;
}

}  // namespace

std::vector<GrayImage> upright(const Label& label, const Seen& seen, const CameraModel& camera,
                               const RigidTransform& rig_from_ct, double pixel_mm) {
    constexpr double kMargin_mm = 1;
    std::vector<GrayImage> pictures;
    const LabelAxes axes = axes_of(label);
    for (const auto& row : rows_of(label, axes.right)) {
        const auto line = line_seen(row, axes, camera, rig_from_ct);
        if (!line) return {};
        const Vector2d size_mm = line->high_mm - line->low_mm + Vector2d::Constant(2 * kMargin_mm);
        const int width = static_cast<int>(size_mm.x() / pixel_mm), height = static_cast<int>(size_mm.y() / pixel_mm);
        std::vector<double> values;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const Vector2d xy(line->low_mm.x() - kMargin_mm + pixel_mm * x,
                                  line->high_mm.y() + kMargin_mm - pixel_mm * y);
                values.push_back(seen(line->middle_px + line->px_by_mm * xy));
            }
        pictures.push_back(dark_on_bright(values, width, height, static_cast<int>(5 / pixel_mm)));
    }
    return pictures;
}

std::optional<std::string> read_label(const Label& label, const Seen& seen, const CameraModel& camera,
                                      const RigidTransform& rig_from_ct, const std::filesystem::path& keep) {
    std::vector<std::map<std::string, int>> votes;
    for (const double pixel_mm : {0.16, 0.125, 0.2}) {
        const auto pictures = upright(label, seen, camera, rig_from_ct, pixel_mm);
        if (pictures.empty()) return std::nullopt;
        votes.resize(pictures.size());
        for (std::size_t k = 0; k < pictures.size(); ++k) {
            ++votes[k][read_text(pictures[k])];
            if (!keep.empty() && pixel_mm == 0.125) write_png(pictures[k], keep.string() + fmt::format("_{}.png", k));
        }
    }
    std::string read;
    bool first = true;
    for (const auto& line : votes) {
        const auto most = std::max_element(line.begin(), line.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        read += (std::exchange(first, false) ? "" : "/") + most->first;
    }
    return read;
}

}  // namespace planlight::test
