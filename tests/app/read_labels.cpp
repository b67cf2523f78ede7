#include "tests/app/read_labels.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
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

/// Without blanks and line ends.
std::string close_up(std::string text) {
    std::erase_if(text, [](char c) { return c == ' ' || c == '\n' || c == '/' || c == '\f'; });
    return text;
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
                                "' stdout --psm 6 --dpi 200 -l eng 2>/dev/null";
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
    static const std::string kSign = "⌀";
    static const std::array<std::string, 12> kLikeIt{"⌀", "Ø", "ø", "@", "©", "®", "°", "O", "o", "G", "&", "Q"};
    const std::string got = close_up(read);
    std::vector<std::string> wanted{close_up(written)};
    for (const std::string& like : kLikeIt) {
        std::string one = close_up(written);
        if (const auto at = one.find(kSign); at != std::string::npos) {
            wanted.push_back(one.replace(at, kSign.size(), like));
        }
    }
    if (std::find(wanted.begin(), wanted.end(), got) != wanted.end()) return Reading::right;
    return digits_of(written) == digits_of(read) ? Reading::other : Reading::other_number;
}

GrayImage upright(const Label& label, const GrayImage& seen, const CameraModel& camera,
                  const RigidTransform& rig_from_ct) {
    constexpr double kPixel_mm = 0.125, kMargin_mm = 2.5;
    Vector3d middle = Vector3d::Zero(), normal = Vector3d::Zero();
    for (std::size_t i = 0; i < label.field_in_ct.size(); ++i) {
        middle += label.field_in_ct[i] / static_cast<double>(label.field_in_ct.size());
        normal += label.field_normals_in_ct[i];
    }
    normal.normalize();
    const std::size_t half = label.field_in_ct.size() / 2;  // the field goes up column by column
    std::size_t at = half;
    while (at > 0 && (label.field_in_ct[at - 1] - label.field_in_ct[at]).norm() < 4.5) --at;
    Vector3d up = label.field_in_ct[at + 1] - label.field_in_ct[at];
    up = (up - up.dot(normal) * normal).normalized();
    const Vector3d right = up.cross(normal);
    Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (const Vector3d& p : label.field_in_ct) {
        const Vector2d xy(right.dot(p - middle), up.dot(p - middle));
        low = low.cwiseMin(xy), high = high.cwiseMax(xy);
    }
    low.array() -= kMargin_mm, high.array() += kMargin_mm;
    GrayImage picture(static_cast<int>((high.x() - low.x()) / kPixel_mm),
                      static_cast<int>((high.y() - low.y()) / kPixel_mm));
    std::vector<double> values;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const Vector3d p = middle + (low.x() + kPixel_mm * x) * right + (high.y() - kPixel_mm * y) * up;
            const auto pixel = project(camera, rig_from_ct * p);
            if (!pixel || !in_picture(camera, *pixel)) return {};
            values.push_back(between(seen, *pixel));
        }
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const double dark = sorted[sorted.size() / 4], bright = sorted[sorted.size() * 97 / 100];
    for (std::size_t i = 0; i < values.size(); ++i)
        picture.pixels[i] = static_cast<std::uint8_t>(
            std::clamp(255 - 255 * (values[i] - dark) / std::max(1.0, bright - dark), 0.0, 255.0));
    return picture;
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

LabelledHead::LabelledHead() : parts_(std::make_unique<Parts>()) {}
LabelledHead::~LabelledHead() = default;

LabelsRead LabelledHead::read(simulation::Preset preset, unsigned seed) const {
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
        const bool left = sees(simulation::SimulatedRig::Camera::left);
        if (!left && !sees(simulation::SimulatedRig::Camera::right)) {
            ++result.unseen;
            continue;
        }
        const RigCalibration truth = rig.true_rig();
        const GrayImage picture =
            upright(label, left ? frame.left : frame.right, left ? truth.left_camera : truth.right_camera, rig_from_ct);
        if (picture.width == 0) {
            ++result.unseen;
            continue;
        }
        std::string written = label.words;
        std::replace(written.begin(), written.end(), '\n', '/');
        const std::string read = read_text(picture);
        const Reading reading = compare(written, read);
        result.right += reading == Reading::right;
        if (reading != Reading::right) result.wrong.push_back(written + " | " + read);
        if (reading == Reading::other_number) result.other_number.push_back(written + " | " + read);
        if (!folder.empty()) write_png(picture, folder / fmt::format("{}_label{}.png", name, label.item));
    }
    return result;
}

}  // namespace planlight::test
