#include "tests/app/read_labels.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <random>

#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/files/image_file.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/volume/read_volume.h"
#include "projection/place_all_labels.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;
using Eigen::Vector3d;

std::filesystem::path pictures_folder() {
    const char* folder = std::getenv("PLANLIGHT_PICTURES");
    return folder ? folder : "";
}

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

/// Of a grey picture, between its pixels (Catmull-Rom).
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

void LabelsRead::append(const LabelsRead& more) {
    items += more.items, lit += more.lit, left_out += more.left_out, name_alone += more.name_alone;
    unseen += more.unseen, right += more.right;
    wrong.insert(wrong.end(), more.wrong.begin(), more.wrong.end());
    other_number.insert(other_number.end(), more.other_number.begin(), more.other_number.end());
    share_of_text = more.share_of_text;
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

std::string read_label(const Label& label, const Seen& seen, const CameraModel& camera,
                       const RigidTransform& rig_from_ct, const std::filesystem::path& keep) {
    std::vector<std::map<std::string, int>> votes;
    for (const double pixel_mm : {0.16, 0.125, 0.2}) {
        const auto pictures = upright(label, seen, camera, rig_from_ct, pixel_mm);
        votes.resize(pictures.size());
        for (std::size_t k = 0; k < pictures.size(); ++k) {
            ++votes[k][read_text(pictures[k])];
            if (!keep.empty() && pixel_mm == 0.125) write_png(pictures[k], keep.string() + fmt::format("_{}.png", k));
        }
    }
    std::string read;
    for (const auto& line : votes) {
        const auto most = std::max_element(line.begin(), line.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        read += (read.empty() ? "" : "/") + most->first;
    }
    return read;
}

struct LabelledHead::Parts {
    Volume volume = read_volume(*example_patient());
    Preparation prepared = prepare_case(volume, {}, {}, {}, "2001-10-14");
    SkinSurface skin{prepared.prepared.skin};

    std::optional<SkinSurface::Point> from_side(const Vector3d& out, double across_mm, double up_mm) const;
    Plan plan(unsigned seed) const;
};

std::optional<SkinSurface::Point> LabelledHead::Parts::from_side(const Vector3d& out, double across_mm,
                                                                 double up_mm) const {
    Vector3d low = skin.mesh().vertices_in_ct.front(), high = low;
    for (const Vector3d& v : skin.mesh().vertices_in_ct) low = low.cwiseMin(v), high = high.cwiseMax(v);
    const Vector3d middle = (low + high) / 2 + Vector3d(0, 0, 0.15 * (high - low).z());
    const Vector3d across = Vector3d(0, 0, 1).cross(out).normalized(), up = out.cross(across);
    const auto hit = skin.first_hit({middle + 400 * out + across_mm * across + up_mm * up, -out});
    if (!hit || !skin.real_skin(*hit) || hit->normal_in_ct.dot(out) < 0.55) return std::nullopt;
    return hit;
}

/// A closed cut, holes, ways in and a plane on one side of the head, with names and figures of that seed.
Plan LabelledHead::Parts::plan(unsigned seed) const {
    static const std::array<Vector3d, 5> kSides{Vector3d(0, -1, 0.2), Vector3d(1, -0.6, 0.2), Vector3d(0, -1, 0.6),
                                                Vector3d(-1, -0.6, 0.2), Vector3d(1, -1, 0.3)};
    static const std::array<const char*, 12> kNames{"B",    "Hole ", "K",       "Drill ",     "Entry ", "T",
                                                    "EVD ", "P",     "Biopsy ", "Burr hole ", "Screw ", "Target "};
    static const std::array<const char*, 6> kLines{
        "Osteotomy", "Craniotomy", "Skin flap", "Incision left", "Resection margin frontal", "Midline"};
    std::mt19937 random(seed);
    const auto within = [&](double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(random);
    };
    const auto any = [&](const auto& list) { return std::string(list[random() % list.size()]); };
    const Vector3d out = kSides[seed % kSides.size()].normalized();
    Plan plan;
    OsteotomyLine line{any(kLines), {}, true, {}};
    const double wide_mm = within(22, 32), high_mm = within(18, 26);
    for (int k = 0; k < 10; ++k) {
        const double angle = 2 * std::numbers::pi * k / 10;
        if (const auto p = from_side(out, wide_mm * std::cos(angle), high_mm * std::sin(angle)))
            line.points_in_ct.push_back(p->p_in_ct);
    }
    if (line.points_in_ct.size() > 4) plan.osteotomy_lines.push_back(line);
    const std::array<Vector2d, 7> places{Vector2d(-48, 28), Vector2d(46, 30), Vector2d(-46, -26), Vector2d(44, -28),
                                         Vector2d(0, 0),    Vector2d(-4, 42), Vector2d(6, -46)};
    int number = 1;
    for (const Vector2d& place : places) {
        const auto p = from_side(out, place.x() + within(-5, 5), place.y() + within(-5, 5));
        const std::string name = any(kNames) + std::to_string(number++ + 10 * static_cast<int>(random() % 3));
        if (!p) continue;
        const Vector3d leaning = (-p->normal_in_ct + 0.3 * out.unitOrthogonal()).normalized();
        if (number % 3 == 0)
            plan.trajectories.push_back(
                {name, p->p_in_ct, Vector3d(p->p_in_ct + within(25, 79) * leaning), std::round(within(0, 4)), {}});
        else
            plan.boreholes.push_back(
                {name, p->p_in_ct, {}, std::round(2 * within(3, 14)) / 2, std::round(2 * within(3, 14)) / 2, {}});
    }
    return plan;
}

namespace {

/// What an eye where that camera stands sees: the true skin under the light that truly falls there, and 20 % of room
/// light, without the camera's blur, pixels and noise.
Seen seen_by_eye(const simulation::SimulatedRig& rig, const RgbImage& light, const CameraModel& camera, Instant at) {
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(at), ct_from_rig = rig_from_ct.inverse();
    const CameraModel projector = rig.true_rig().projector;
    GrayImage green(light.width, light.height);
    std::transform(light.pixels.begin(), light.pixels.end(), green.pixels.begin(), [](const Rgb& p) { return p[1]; });
    return [&rig, camera, projector, rig_from_ct, ct_from_rig, green, at](const Vector2d& pixel) {
        constexpr double kRoomLight = 0.2, kShadow_mm = 1;
        const auto ray = ray_through(camera, pixel);
        if (!ray) return 0.0;
        const auto skin = rig.true_skin_along(ct_from_rig * ray->origin, ct_from_rig.linear() * ray->direction);
        if (!skin) return 0.0;
        const auto by = project(projector, rig_from_ct * skin->p_in_ct);
        double lit = 0;
        if (by && in_picture(projector, *by)) {
            const auto falls = rig.true_light(*by, at);
            if (falls && (falls->p_in_ct - skin->p_in_ct).norm() < kShadow_mm) lit = between(green, *by);
        }
        const Vector3d to_light = (ct_from_rig * projector.centre_in_rig() - skin->p_in_ct).normalized();
        return kRoomLight * 255 + lit * std::max(0.0, to_light.dot(skin->normal_in_ct));
    };
}

}  // namespace

LabelledHead::LabelledHead() : parts_(std::make_unique<Parts>()) {}
LabelledHead::~LabelledHead() = default;

LabelsRead LabelledHead::read(simulation::Preset preset, unsigned seed, bool eye) const {
    LabelsRead result;
    const Plan plan = parts_->plan(seed);
    simulation::RoomSettings settings;
    settings.preset = preset;
    settings.seed = seed;
    settings.skin_threshold_hu = parts_->prepared.threshold;
    simulation::SimulatedRig rig(parts_->volume, points_of(plan), settings);
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(rig.clock().now());
    DrawingSettings how;
    if (seed % 2 == 0) how.up_in_ct.setZero();  // upright as the camera sees it; else in ct
    how = lit_by(rig.calibration(), rig_from_ct, how);
    how.keep_clear_in_ct = rig.true_markers_in_ct();
    const PlanDrawing drawing = draw_plan(plan, parts_->skin, how);
    RenderSettings render;
    for (const Vector3d& marker : rig.true_markers_in_ct()) render.keep_dark_in_patient.push_back(rig_from_ct * marker);
    const DrawingRenderer renderer(parts_->skin, rig.calibration().projector);
    RgbImage light;
    const RenderCounts counts = renderer.render_into(light, drawing, rig_from_ct, RigidTransform::Identity(), render);
    const Instant lit = rig.projector().show(light, rig.clock().now() + 10s);
    const StereoFrame frame = rig.cameras().grab(lit, 2s);
    const auto folder = pictures_folder();
    const std::string name = fmt::format("{}_{}", preset == simulation::Preset::paper ? "paper" : "modern", seed);
    if (!folder.empty()) {
        write_png(light, folder / (name + "_light.png"));
        write_png(frame.left, folder / (name + "_left.png"));
    }
    result.items = static_cast<int>(drawing.items.size());
    result.left_out = static_cast<int>(counts.labels_left_out.size());
    result.share_of_text = share_of_text(drawing);
    const RigCalibration truth = rig.true_rig();
    for (const Label& label : drawing.labels) {
        const bool is_lit = !label.of_moment && std::find(counts.labels_lit.begin(), counts.labels_lit.end(),
                                                          label.item) != counts.labels_lit.end();
        if (!is_lit) continue;
        ++result.lit;
        result.name_alone += label.words == drawing.items[static_cast<std::size_t>(label.item)].lit_name;
        const auto sees = [&](simulation::SimulatedRig::Camera camera) {
            for (std::size_t i = 0; i < label.field_in_ct.size(); ++i)
                if (!rig.truly_seen(camera, {label.field_in_ct[i], label.field_normals_in_ct[i]}, lit)) return false;
            return true;
        };
        // From where it is seen best, as a person would look.
        const bool by_left = sees(simulation::SimulatedRig::Camera::left),
                   by_right = sees(simulation::SimulatedRig::Camera::right);
        if (!by_left && !by_right) {
            ++result.unseen;
            continue;
        }
        const auto facing = [&](const CameraModel& one) {
            const std::size_t k = label.field_in_ct.size() / 2;
            const Vector3d way = rig_from_ct.inverse() * one.centre_in_rig() - label.field_in_ct[k];
            return way.normalized().dot(label.field_normals_in_ct[k]);
        };
        const bool left = by_left && (!by_right || facing(truth.left_camera) > facing(truth.right_camera));
        const CameraModel& camera = left ? truth.left_camera : truth.right_camera;
        const GrayImage& picture = left ? frame.left : frame.right;
        const Seen seen = eye ? seen_by_eye(rig, light, camera, lit)
                              : Seen([&](const Vector2d& pixel) { return between(picture, pixel); });
        const auto read = read_label(label, seen, camera, rig_from_ct,
                                     folder.empty() ? folder : folder / fmt::format("{}_label{}", name, label.item));
        if (read.empty()) {
            ++result.unseen;
            continue;
        }
        std::string written = label.words;
        std::replace(written.begin(), written.end(), '\n', '/');
        const Reading reading = compare(written, read);
        result.right += reading == Reading::right;
        if (reading != Reading::right) result.wrong.push_back(written + " | " + read);
        if (reading == Reading::other_number) result.other_number.push_back(written + " | " + read);
    }
    return result;
}

}  // namespace planlight::test
