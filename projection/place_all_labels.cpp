#include "projection/place_all_labels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>

namespace planlight {
namespace {

using Eigen::Vector3d;
using Point = SkinSurface::Point;

/// What a label says: all, the name alone, or the item's code where there is no room for its name.
enum class Form { whole, name, code };
constexpr std::array kShorter{Form::name, Form::code};

LabelWish in_form(LabelWish wish, Form form) {
    if (form == Form::whole || wish.text.name.empty()) return wish;
    wish.text.figures.clear();
    if (form == Form::code && !wish.code.empty()) wish.text.name = wish.code;
    return wish;
}

double length_mm(const Stroke& stroke) {
    double length = 0;
    for (std::size_t i = 0; i + 1 < stroke.points_in_ct.size(); ++i)
        length += (stroke.points_in_ct[i + 1] - stroke.points_in_ct[i]).norm();
    if (stroke.closed) length += (stroke.points_in_ct.front() - stroke.points_in_ct.back()).norm();
    return length;
}

/// Of the ink on the skin; holes count against it.
double area_mm2(const Label& label) {
    double area = 0;
    for (const auto& sign : label.signs_in_ct) {
        Vector3d twice = Vector3d::Zero();
        for (const auto& outline : sign)
            for (std::size_t i = 0; i < outline.size(); ++i)
                twice += (outline[i] - outline[0]).cross(outline[(i + 1) % outline.size()] - outline[0]);
        area += twice.norm() / 2;
    }
    return area + length_mm(label.leader) * label.leader.width_mm;
}

class AllLabels {
public:
    AllLabels(std::vector<LabelWish> wishes, const SkinSurface& skin, const DrawingSettings& settings,
              PlanDrawing& drawing)
        : wishes_(std::move(wishes)), skin_(skin), settings_(settings), drawing_(drawing) {
        occupy_plan();
        face_the_light();
        tell_of_others();
        // Points can be labelled in fewer places than lines: they choose first.
        std::stable_sort(wishes_.begin(), wishes_.end(),
                         [](const auto& a, const auto& b) { return a.anchors.size() < b.anchors.size(); });
    }
    void place();

private:
    void occupy_plan();
    void face_the_light();
    void tell_of_others();
    bool put(const LabelWish& wish);
    void put_whole_first();
    int told() const;
    void put_codes_first();
    void keep_to_share();
    void put_of_moment();
    void put_card();

    std::vector<LabelWish> wishes_;
    const SkinSurface& skin_;
    const DrawingSettings& settings_;
    PlanDrawing& drawing_;
    OccupiedSkin plan_, occupied_;
    std::map<int, Label> put_;
};

void AllLabels::occupy_plan() {
    for (const Stroke& stroke : drawing_.strokes)
        for (const Vector3d& p : stroke.points_in_ct) plan_.add(p);
    for (const Vector3d& marker : settings_.keep_clear_in_ct) {
        const Point centre = skin_.nearest(marker);
        for (double r = 1; r <= settings_.keep_clear_radius_mm; r += 1)
            for (const Point& p : circle(skin_, centre, r, 1).points) plan_.add(p.p_in_ct);
    }
}

/// The projector stands where the whole plan can be lit: labels keep to skin that faces as the plan does on average.
void AllLabels::face_the_light() {
    Vector3d facing = Vector3d::Zero();
    for (const Stroke& stroke : drawing_.strokes)
        for (const Vector3d& n : stroke.normals_in_ct) facing += n;
    if (facing.norm() > 1e-9)
        for (LabelWish& w : wishes_) w.facing_in_ct = facing.normalized();
}

void AllLabels::tell_of_others() {
    constexpr double kFar_mm = 150;
    for (LabelWish& wish : wishes_)
        for (const LabelWish& other : wishes_)
            if (other.item != wish.item && other.anchors.size() == 1 &&
                (other.anchors[0].p_in_ct - wish.anchors[0].p_in_ct).norm() < kFar_mm)
                wish.others.push_back({other.anchors[0].p_in_ct, other.keep_off_mm});
}

bool AllLabels::put(const LabelWish& wish) {
    auto label = place_label(wish, skin_, settings_, occupied_);
    if (!label) return false;
    if (const auto former = put_.find(wish.item); former != put_.end()) vacate(former->second, occupied_);
    label->by_code = !wish.code.empty() && wish.text.name == wish.code;
    occupy(*label, occupied_);
    put_.insert_or_assign(wish.item, std::move(*label));
    return true;
}

/// Whole labels, and shorter ones where there is no room.
void AllLabels::put_whole_first() {
    occupied_ = plan_;
    put_.clear();
    for (const LabelWish& wish : wishes_)
        for (const Form form : {Form::whole, Form::name, Form::code})
            if (put(in_form(wish, form))) break;
}

/// How much the labels tell: an item without any costs most.
int AllLabels::told() const {
    int told = 0;
    for (const LabelWish& wish : wishes_) {
        const auto label = put_.find(wish.item);
        if (label == put_.end()) continue;
        const bool code = wish.text.name != wish.code && label->second.by_code;
        told += code ? 4 : label->second.words.size() > wish.text.name.size() + 2 ? 6 : 5;
    }
    return told;
}

/// A crowded plan: a code for as many as can have one, then names, then figures where room is left.
void AllLabels::put_codes_first() {
    occupied_ = plan_;
    put_.clear();
    for (const LabelWish& wish : wishes_) put(in_form(wish, Form::code));
    for (const Form form : {Form::name, Form::whole})
        for (const LabelWish& wish : wishes_) {
            LabelWish longer = in_form(wish, form);
            longer.but_of = wish.item;  // its own shorter one makes room
            put(longer);
        }
}

/// Shorter labels until no more of the light is text than may be; the last of the plan first.
void AllLabels::keep_to_share() {
    double lines_mm2 = 0, text_mm2 = 0;
    for (const Stroke& stroke : drawing_.strokes) lines_mm2 += length_mm(stroke) * stroke.width_mm;
    for (const auto& [item, label] : put_) text_mm2 += area_mm2(label);
    const auto too_much = [&] { return text_mm2 > settings_.most_text * (text_mm2 + lines_mm2); };
    for (const Form form : kShorter)
        for (auto wish = wishes_.rbegin(); wish != wishes_.rend() && too_much(); ++wish) {
            const auto label = put_.find(wish->item);
            LabelWish shorter = in_form(*wish, form);
            if (label == put_.end() || wish->text.name.empty()) continue;
            const double before_mm2 = area_mm2(label->second);
            shorter.but_of = wish->item;
            if (put(shorter)) text_mm2 += area_mm2(put_.at(wish->item)) - before_mm2;
        }
    for (auto wish = wishes_.rbegin(); wish != wishes_.rend() && too_much(); ++wish) {
        const auto label = put_.find(wish->item);
        if (label == put_.end()) continue;
        text_mm2 -= area_mm2(label->second);
        put_.erase(label);
    }
}

void AllLabels::put_of_moment() {
    for (LabelWish wish : wishes_) {
        wish.but_of = OccupiedSkin::kAllLabels;
        wish.others.clear();  // they are dim
        auto label = place_label(wish, skin_, settings_, plan_);
        if (!label) label = place_label(in_form(wish, Form::name), skin_, settings_, plan_);
        if (!label) continue;
        label->of_moment = true;
        label->by_code = !wish.code.empty() && wish.text.name == wish.code;
        drawing_.labels.push_back(std::move(*label));
    }
}

/// Far enough from every item that it is not taken for one's name.
void AllLabels::put_card() {
    if (settings_.card.empty() || wishes_.empty()) return;
    LabelWish wish;
    wish.text.name = settings_.card.front();
    wish.text.figures.assign(settings_.card.begin() + 1, settings_.card.end());
    // Half a name can be another's: rather smaller letters.
    constexpr double kLeast_mm = 4.2;
    if (shortened(wish.text.name, settings_.text_height_mm) != wish.text.name)
        wish.text_height_mm = std::min(kLeast_mm, settings_.text_height_mm);
    wish.facing_in_ct = wishes_.front().facing_in_ct;
    wish.gaps_mm = {9, 14, 20, 28, 38, 50};
    wish.leader = false;
    for (const LabelWish& item : wishes_) {
        wish.anchors.insert(wish.anchors.end(), item.anchors.begin(), item.anchors.end());
        wish.keep_off_mm = std::max(wish.keep_off_mm, item.keep_off_mm);
        if (item.anchors.size() == 1) wish.others.push_back({item.anchors[0].p_in_ct, item.keep_off_mm});
    }
    drawing_.card = place_label(wish, skin_, settings_, occupied_);
    if (drawing_.card || !settings_.light) return;
    constexpr double kSteepest = 1.05;  // radians (60 degrees): rather aslant than not at all
    DrawingSettings steeper = settings_;
    steeper.light->steepest = std::max(kSteepest, steeper.light->steepest);
    drawing_.card = place_label(wish, skin_, steeper, occupied_);
}

void AllLabels::place() {
    constexpr int kAll = 6;
    put_whole_first();
    if (const int first = told(); first < kAll * static_cast<int>(wishes_.size())) {
        const auto whole_first = put_;
        put_codes_first();
        if (told() <= first) put_ = whole_first;
        occupied_ = plan_;
        for (const auto& [item, label] : put_) occupy(label, occupied_);
    }
    keep_to_share();
    occupied_ = plan_;
    for (const auto& [item, label] : put_) occupy(label, occupied_);
    for (const LabelWish& wish : wishes_) {
        const auto label = put_.find(wish.item);
        DrawnItem& item = drawing_.items[static_cast<std::size_t>(wish.item)];
        item.labelled = label != put_.end();
        if (label == put_.end()) continue;
        if (label->second.by_code) item.lit_by_code = true, item.lit_name = item.code;
        drawing_.labels.push_back(label->second);
    }
    put_card();
    put_of_moment();
}

}  // namespace

double share_of_text(const PlanDrawing& drawing) {
    double lines_mm2 = 0, text_mm2 = 0;
    for (const Stroke& stroke : drawing.strokes) lines_mm2 += length_mm(stroke) * stroke.width_mm;
    for (const Label& label : drawing.labels) text_mm2 += label.of_moment ? 0 : area_mm2(label);
    return text_mm2 > 0 ? text_mm2 / (text_mm2 + lines_mm2) : 0;
}

void place_all_labels(std::vector<LabelWish> wishes, const SkinSurface& skin, const DrawingSettings& settings,
                      PlanDrawing& drawing) {
    AllLabels(std::move(wishes), skin, settings, drawing).place();
}

}  // namespace planlight
