#include "app/recording/anonymous.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

namespace planlight {
namespace {

constexpr double kRound_mm = 12;  // of the plan's lines the picture is kept so far
constexpr double kApart_mm = 4;
constexpr double kLabel_mm = 4;  // round places of a label's field, which lie 3 mm apart: also while the head moves

/// Those of the points that the camera sees; the radius grows to what `round_mm` are there.
std::vector<Eigen::Vector2d> pixels_of(const CameraModel& camera, const std::vector<Eigen::Vector3d>& points_in_rig,
                                       double round_mm, double& radius_px) {
    std::vector<Eigen::Vector2d> pixels;
    for (const Eigen::Vector3d& p : points_in_rig) {
        const auto pixel = project(camera, p);
        if (!pixel || !in_picture(camera, *pixel)) continue;
        pixels.push_back(*pixel);
        radius_px = std::max(radius_px, round_mm * camera.focal_x / (camera.device_from_rig * p).z());
    }
    return pixels;
}

PlanRegion::InPicture region_in(const CameraModel& camera, const std::vector<Eigen::Vector3d>& lines_in_rig,
                                const std::vector<Eigen::Vector3d>& labels_in_rig) {
    PlanRegion::InPicture region;
    region.pixels = pixels_of(camera, lines_in_rig, kRound_mm, region.radius_px);
    region.of_labels = pixels_of(camera, labels_in_rig, kLabel_mm, region.label_radius_px);
    return region;
}

bool is_of_a_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || (static_cast<unsigned char>(c) & 0x80U) != 0;
}

bool has_letters(const std::string& name) {
    return std::any_of(name.begin(), name.end(),
                       [](char c) { return is_of_a_word(c) && std::isdigit(static_cast<unsigned char>(c)) == 0; });
}

bool stands_quoted(const std::string& text, std::size_t at, std::size_t size) {
    return at > 0 && text[at - 1] == '"' && at + size < text.size() && text[at + size] == '"';
}

/// And is no part of a longer one.
bool stands_as_a_word(const std::string& text, std::size_t at, std::size_t size) {
    const bool goes_on_before = at > 0 && is_of_a_word(text[at - 1]) && is_of_a_word(text[at]);
    const std::size_t after = at + size;
    return !goes_on_before && !(after < text.size() && is_of_a_word(text[after]) && is_of_a_word(text[after - 1]));
}

/// A single letter or a short figure ("1.0", "10") is found in every sentence: it is a name only alone or in quotes. Of
/// two or three letters it is one as a whole word, and a longer one also within words ("Meiers").
bool is_meant(const std::string& text, std::size_t at, const std::string& name) {
    if (stands_quoted(text, at, name.size())) return true;
    const bool letters = has_letters(name);
    if (name.size() < (letters ? 2U : 5U)) return false;
    return (letters && name.size() > 3) || stands_as_a_word(text, at, name.size());
}

template <class Do>
void for_each_near(const GrayImage& picture, const Eigen::Vector2d& p, double r, const Do& act) {
    for (int y = std::max(0, static_cast<int>(p.y() - r)); y <= std::min(picture.height - 1.0, p.y() + r); ++y)
        for (int x = std::max(0, static_cast<int>(p.x() - r)); x <= std::min(picture.width - 1.0, p.x() + r); ++x)
            if ((Eigen::Vector2d(x, y) - p).norm() <= r) act(x, y);
}

}  // namespace

PlanRegion plan_region(const Session& session, const TrackedPose& pose) {
    if (!pose.rig_from_patient || session.registration() == nullptr) return {};
    const RigidTransform rig_from_ct = *pose.rig_from_patient * session.registration()->patient_from_ct;
    std::vector<Eigen::Vector3d> points;
    for (const Stroke& stroke : session.drawing().strokes) {
        Eigen::Vector3d last = Eigen::Vector3d::Constant(1e9);
        for (const Eigen::Vector3d& p : stroke.points_in_ct) {
            if (stroke.kind == StrokeKind::label || (p - last).norm() < kApart_mm) continue;
            points.push_back(rig_from_ct * p);
            last = p;
        }
    }
    std::vector<Eigen::Vector3d> labels;  // also those that are lit for a moment only
    for (const Label& label : session.drawing().labels)
        for (const Eigen::Vector3d& p : label.field_in_ct) labels.push_back(rig_from_ct * p);
    return {region_in(session.rig().left_camera, points, labels),
            region_in(session.rig().right_camera, points, labels)};
}

GrayImage blurred_outside(const GrayImage& picture, const PlanRegion::InPicture& region) {
    constexpr int kCells = 24;
    GrayImage blurred = picture;
    const int cell = std::max(1, (picture.width + kCells - 1) / kCells);
    for (int top = 0; top < picture.height; top += cell)
        for (int left = 0; left < picture.width; left += cell) {
            const int bottom = std::min(top + cell, picture.height), right = std::min(left + cell, picture.width);
            long sum = 0;
            for (int y = top; y < bottom; ++y)
                for (int x = left; x < right; ++x) sum += picture.at(x, y);
            const auto mean = static_cast<std::uint8_t>(sum / ((bottom - top) * (right - left)));
            for (int y = top; y < bottom; ++y)
                for (int x = left; x < right; ++x) blurred.at(x, y) = mean;
        }
    const GrayImage mosaic = blurred;
    for (const Eigen::Vector2d& p : region.pixels)
        for_each_near(picture, p, region.radius_px, [&](int x, int y) { blurred.at(x, y) = picture.at(x, y); });
    for (const Eigen::Vector2d& p : region.of_labels)
        for_each_near(picture, p, region.label_radius_px, [&](int x, int y) { blurred.at(x, y) = mosaic.at(x, y); });
    return blurred;
}

NamesLeftOut::NamesLeftOut(const Case& the_case) {
    add(title_of(the_case), the_case.code);
    for (const std::string* name : {&the_case.names.title, &the_case.names.patient, &the_case.names.plan,
                                    &the_case.names.plan_version, &the_case.names.series})
        add(*name, "…");
    const auto& structures = the_case.plan.risk_structures;
    for (std::size_t i = 0; i < structures.size(); ++i) add(structures[i].name, fmt::format("structure {}", i + 1));
}

void NamesLeftOut::add_items(const PlanDrawing& drawing) {
    for (std::size_t i = 0; i < drawing.items.size(); ++i) add(drawing.items[i].name, fmt::format("item {}", i + 1));
}

void NamesLeftOut::add(const std::string& name, const std::string& instead) {
    if (name.empty()) return;
    const auto known = [&](const auto& pair) { return pair.first == name; };
    if (std::none_of(names_.begin(), names_.end(), known)) names_.emplace_back(name, instead);
    // The longest first, so that no part of a name is left of it.
    std::stable_sort(names_.begin(), names_.end(),
                     [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
}

std::string NamesLeftOut::out_of(const std::string& json) const {
    using Json = nlohmann::ordered_json;
    // What the program itself chooses from: a plan's item may be called so as well.
    const auto is_word = [](const std::string& key) {
        return key == "what" || key == "call" || key == "trust" || key == "verdict" || key == "kind" ||
               key == "fault" || key == "action" || key == "utc" || key == "made_on" || key == "cloud" ||
               key == "capture" || key.ends_with("hash");
    };
    const std::function<void(Json&)> walk = [&](Json& value) {
        if (value.is_string()) {
            value = text_without(value.get<std::string>());
        } else if (value.is_array()) {
            for (Json& one : value) walk(one);
        } else if (value.is_object()) {
            for (auto& [key, one] : value.items())
                if (!is_word(key)) walk(one);
        }
    };
    Json event = Json::parse(json, nullptr, false);
    if (event.is_discarded()) return {};
    walk(event);
    return event.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string NamesLeftOut::text_without(std::string text) const {
    for (const auto& [name, instead] : names_) {
        if (text == name) return instead;
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at)) {
            const bool meant = is_meant(text, at, name);
            if (meant) text.replace(at, name.size(), instead);
            at += meant ? instead.size() : 1;
        }
    }
    return text;
}

}  // namespace planlight
