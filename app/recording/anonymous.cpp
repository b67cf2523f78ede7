#include "app/recording/anonymous.h"

#include <fmt/format.h>
#include <glib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>

#include "projection/label_names.h"

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

/// By code points, so that a letter and its small form take one place each in any script.
std::u32string code_points(const std::string& text) {
    std::u32string points;
    for (std::size_t i = 0; i < text.size();) {
        const char* at = text.data() + i;
        const gunichar point = g_utf8_get_char_validated(at, static_cast<gssize>(text.size() - i));
        const bool valid = static_cast<gint>(point) >= 0;
        points += valid ? static_cast<char32_t>(point) : U'\xFFFD';
        i += valid ? static_cast<std::size_t>(g_utf8_next_char(at) - at) : 1;
    }
    return points;
}

std::string utf8(const std::u32string& points) {
    std::string text;
    for (const char32_t point : points) {
        std::array<char, 6> bytes{};
        text.append(bytes.data(), static_cast<std::size_t>(g_unichar_to_utf8(point, bytes.data())));
    }
    return text;
}

/// A letter's one small form; the sigma that ends a Greek word is the other one.
char32_t small_letter(char32_t c) {
    constexpr char32_t kEndingSigma = U'\u03C2', kSigma = U'\u03C3';
    const char32_t small = g_unichar_tolower(c);
    return small == kEndingSigma ? kSigma : small;
}

std::u32string in_small_letters(std::u32string text) {
    for (char32_t& c : text) c = small_letter(c);
    return text;
}

bool is_of_a_word(char32_t c) {
    return g_unichar_isalnum(c) != 0 || g_unichar_ismark(c) != 0;
}

/// What the program itself calls things: it says nothing of whoever may be called so.
bool is_our_word(const std::u32string& small) {
    constexpr std::array<std::u32string_view, 12> kOurs{U"planlight", U"operator", U"surgeon", U"patient",
                                                        U"localhost", U"light",    U"dark",    U"head",
                                                        U"skin",      U"plan",     U"user",    U"root"};
    return std::find(kOurs.begin(), kOurs.end(), small) != kOurs.end();
}

/// A part of a person's name is one as a word of its own, or with the s of "Meiers", that begins with a large letter
/// (or is of a script that has none) or stands in a path or in quotes: "light" is none of Mr Light's.
bool is_meant_part(const std::u32string& text, std::size_t at, std::size_t size) {
    constexpr std::u32string_view kOfPaths = U"/\\@_~";
    const auto is = [&](std::size_t i, auto what) { return i < text.size() && what(text[i]); };
    const auto of_word = [](char32_t c) { return is_of_a_word(c); };
    const auto of_path = [&](char32_t c) { return kOfPaths.find(c) != std::u32string_view::npos; };
    const auto quote = [](char32_t c) { return c == U'"'; };
    const std::size_t before = at - 1, after = at + size;  // before the first: none
    const std::size_t after_s = is(after, [](char32_t c) { return c == U's'; }) ? after + 1 : after;
    if (is(before, of_word) || (is(after, of_word) && is(after_s, of_word))) return false;
    const bool large = g_unichar_islower(text[at]) == 0;
    return large || is(before, of_path) || is(after, of_path) || (is(before, quote) && is(after, quote));
}

/// A part of a name is searched in small letters: MEIER is Meier's.
std::string without_part(std::string text, const std::string& name, const std::string& instead) {
    std::u32string points = code_points(text), small = in_small_letters(points);
    const std::u32string part = code_points(name), other = code_points(instead);
    bool changed = false;
    for (std::size_t at = small.find(part); at != std::u32string::npos; at = small.find(part, at)) {
        const bool meant = is_meant_part(points, at, part.size());
        if (meant) points.replace(at, part.size(), other), small.replace(at, part.size(), other), changed = true;
        at += meant ? other.size() : 1;
    }
    return changed ? utf8(points) : std::move(text);
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
    add_person(the_case.names.patient);
    const std::vector<std::string> items = names_of(the_case.plan);
    for (std::size_t i = 0; i < items.size(); ++i) add(items[i], fmt::format("item {}", i + 1));
    const auto& structures = the_case.plan.risk_structures;
    for (std::size_t i = 0; i < structures.size(); ++i) add(structures[i].name, fmt::format("structure {}", i + 1));
}

void NamesLeftOut::add_items(const PlanDrawing& drawing) {
    for (std::size_t i = 0; i < drawing.items.size(); ++i) add(drawing.items[i].name, fmt::format("item {}", i + 1));
}

/// Each word of "MEIER^HANS" or "Dr. Hans Meier" for itself; of two letters and less it is found in too much, but one
/// sign of Chinese is a name.
void NamesLeftOut::add_person(const std::string& name) {
    constexpr std::size_t kLeast = 3, kLeastOfWideSigns = 1;
    std::u32string part;
    for (const char32_t c : code_points(name) + U' ') {
        if (is_of_a_word(c)) {
            part += small_letter(c);
            continue;
        }
        const bool letters =
            std::any_of(part.begin(), part.end(), [](char32_t p) { return g_unichar_isalpha(p) != 0; });
        const bool wide = std::any_of(part.begin(), part.end(), [](char32_t p) { return g_unichar_iswide(p) != 0; });
        if (part.size() >= (wide ? kLeastOfWideSigns : kLeast) && letters && !is_our_word(part))
            add(utf8(part), "…", true);
        part.clear();
    }
}

void NamesLeftOut::add_place(const std::filesystem::path& folder) {
    const std::string path = folder.has_filename() ? folder.string() : folder.parent_path().string();
    if (path.find('/') != std::string::npos && has_letters(path)) add(path, "…");
}

void NamesLeftOut::add(const std::string& name, const std::string& instead, bool part) {
    if (name.empty()) return;
    const auto known = [&](const LeftOut& one) { return one.name == name && one.part == part; };
    if (std::none_of(names_.begin(), names_.end(), known)) names_.push_back({name, instead, part});
    // The longest first, so that no part of a name is left of it; of two the one that stands for more.
    std::stable_sort(names_.begin(), names_.end(), [](const LeftOut& a, const LeftOut& b) {
        return std::pair(a.name.size(), b.part) > std::pair(b.name.size(), a.part);
    });
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

std::string NamesLeftOut::out_of_room(const std::string& json) const {
    auto room = nlohmann::ordered_json::parse(json, nullptr, false);
    if (!room.is_object()) return {};
    room["name"] = "";
    room["notes"] = nlohmann::ordered_json::array();
    return out_of(room.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

std::string NamesLeftOut::text_without(std::string text) const {
    for (const LeftOut& one : names_)
        if (!one.part && text == one.name) return one.instead;
    for (const auto& [name, instead, part] : names_) {
        if (part) {
            text = without_part(std::move(text), name, instead);
            continue;
        }
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at)) {
            const bool meant = is_meant(text, at, name);
            if (meant) text.replace(at, name.size(), instead);
            at += meant ? instead.size() : 1;
        }
    }
    return text;
}

}  // namespace planlight
