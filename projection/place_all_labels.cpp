#include "projection/place_all_labels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "projection/label_forms.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Point = SkinSurface::Point;

LabelWish in_height(LabelWish wish, double height_mm) {
    wish.text_height_mm = height_mm;
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
        // What warns chooses first, the worst before all; points can be labelled in fewer places than lines, and choose
        // before them.
        std::stable_sort(wishes_.begin(), wishes_.end(), [](const auto& a, const auto& b) {
            if (warns(a) || warns(b)) return warns(a) && (!warns(b) || a.text.risk->mm < b.text.risk->mm);
            return a.anchors.size() < b.anchors.size();
        });
    }
    void place();

private:
    /// A label that has its place, and what was wished for there.
    struct Put {
        Label label;
        LabelWish wish;
    };

    void occupy_plan();
    void face_the_light();
    void tell_of_others();
    static constexpr int kAllTold = 12;  // of one label
    bool put(const LabelWish& wish);
    void put_whole_first();
    int told() const;
    void put_codes_first();
    double lines_mm2() const;
    static double counted_mm2(const Put& put);
    void keep_to_share();
    std::vector<double> larger_heights_mm() const;
    /// In larger letters a line may be too long: then it would be shortened, or parted.
    bool says_the_same(const LabelWish& wish, double height_mm) const {
        const double now_mm = wish.text_height_mm > 0 ? wish.text_height_mm : settings_.text_height_mm;
        return lay_out(wish.text, height_mm).words == lay_out(wish.text, now_mm).words;
    }
    void enlarge();
    /// In larger letters than the least; empty where there is no room for them.
    std::optional<Label> place_large(const LabelWish& wish, const OccupiedSkin& occupied) const;
    void put_of_moment();
    LabelWish card_wish() const;
    void put_card();

    std::vector<LabelWish> wishes_;
    const SkinSurface& skin_;
    const DrawingSettings& settings_;
    PlanDrawing& drawing_;
    OccupiedSkin plan_, occupied_;
    std::map<int, Put> put_;
};

void AllLabels::occupy_plan() {
    for (const Stroke& stroke : drawing_.strokes)
        for (const Vector3d& p : stroke.points_in_ct) plan_.add(p);
    occupy_kept_clear(skin_, settings_, plan_);
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
    if (const auto former = put_.find(wish.item); former != put_.end()) vacate(former->second.label, occupied_);
    label->by_code = !wish.code.empty() && wish.text.name == wish.code;
    occupy(*label, occupied_);
    put_.insert_or_assign(wish.item, Put{std::move(*label), wish});
    return true;
}

/// Whole labels, and shorter ones where there is no room.
void AllLabels::put_whole_first() {
    occupied_ = plan_;
    put_.clear();
    for (const LabelWish& wish : wishes_)
        for (const LabelForm form : forms_of(wish))
            if (put(in_form(wish, form))) break;
}

/// How much the labels tell: a warning that is not there costs more than the others' names.
int AllLabels::told() const {
    int told = 0;
    for (const LabelWish& wish : wishes_) {
        const auto now = put_.find(wish.item);
        if (now == put_.end()) continue;
        const LabelText& text = now->second.wish.text;
        const bool code = wish.text.name != wish.code && now->second.label.by_code,
                   name = now->second.label.words.size() <= wish.text.name.size() + 2,
                   spare = wish.text.risk && (!text.risk || text.figures.size() < wish.text.figures.size());
        told += code ? 8 : name ? 10 : spare ? 11 : kAllTold;
        if (warns(wish) && !text.risk) told -= 2 * kAllTold;
    }
    return told;
}

/// A crowded plan: warnings, and a code for as many as can have one; then names and figures where room is
/// left.
void AllLabels::put_codes_first() {
    occupied_ = plan_;
    put_.clear();
    const auto lengthen = [&](const LabelWish& wish, LabelForm form) {
        LabelWish longer = in_form(wish, form);
        longer.but_of = wish.item;  // its own shorter one makes room
        put(longer);
    };
    for (const LabelWish& wish : wishes_)
        if (!warns(wish) || !(put(in_form(wish, LabelForm::spare)) || put(in_form(wish, LabelForm::brief))))
            put(in_form(wish, LabelForm::code));
    for (const LabelWish& wish : wishes_)
        if (const auto now = put_.find(wish.item); now == put_.end() || !now->second.wish.text.risk)
            lengthen(wish, LabelForm::name);
    for (const LabelWish& wish : wishes_)
        if (wish.text.risk && !warns(wish)) lengthen(wish, LabelForm::spare);
    for (const LabelWish& wish : wishes_) lengthen(wish, LabelForm::whole);
}

/// What a label's text counts for its share of the light: what it says of risk structures does not.
double AllLabels::counted_mm2(const Put& put) {
    const double all_mm2 = area_mm2(put.label);
    if (!put.wish.text.risk) return all_mm2;
    const RiskText& risk = *put.wish.text.risk;
    const auto signs = [](const std::string& text) {
        return static_cast<double>(std::count_if(text.begin(), text.end(),
                                                 [](char c) { return c != ' ' && c != '\n' && (c & 0xC0) != 0x80; }));
    };
    const double of_risk = signs(risk.figure) + signs(risk.structure) + signs(risk.more), all = signs(put.label.words);
    return all > of_risk ? all_mm2 * (1 - of_risk / all) : 0;
}

double AllLabels::lines_mm2() const {
    double area = 0;
    for (const Stroke& stroke : drawing_.strokes) area += length_mm(stroke) * stroke.width_mm;
    return area;
}

/// Shorter labels until no more of the light is text than may be; the last of the plan first. A warning stays.
void AllLabels::keep_to_share() {
    const double lines = lines_mm2();
    double text_mm2 = 0;
    for (const auto& [item, put] : put_) text_mm2 += counted_mm2(put);
    const auto too_much = [&] { return text_mm2 > settings_.most_text * (text_mm2 + lines); };
    for (const LabelForm form : {LabelForm::name, LabelForm::code})
        for (auto wish = wishes_.rbegin(); wish != wishes_.rend() && too_much(); ++wish) {
            const auto label = put_.find(wish->item);
            LabelWish shorter = in_form(*wish, warns(*wish) ? LabelForm::spare : form);
            if (label == put_.end() || wish->text.name.empty()) continue;
            if (warns(*wish) && label->second.wish.text.figures.empty()) continue;  // it says no more than that now
            const double before_mm2 = counted_mm2(label->second);
            shorter.but_of = wish->item;
            if (put(shorter)) text_mm2 += counted_mm2(put_.at(wish->item)) - before_mm2;
        }
    for (auto wish = wishes_.rbegin(); wish != wishes_.rend() && too_much(); ++wish) {
        const auto label = put_.find(wish->item);
        if (label == put_.end() || warns(*wish)) continue;
        text_mm2 -= counted_mm2(label->second);
        put_.erase(label);
    }
}

/// None where the light is not known: what is larger is sooner beyond its reach, and then nothing of it is lit.
std::vector<double> AllLabels::larger_heights_mm() const {
    const double least_mm = settings_.text_height_mm, most_mm = settings_.largest_text_mm;
    if (!(most_mm > least_mm) || !settings_.light) return {};
    return {(least_mm + most_mm) / 2, most_mm};
}

/// The same words in larger letters where there is room beside all else: a step for every label before the next step.
/// None goes farther from its item for it.
void AllLabels::enlarge() {
    const double lines = lines_mm2();
    double text_mm2 = 0;
    for (const auto& [item, put] : put_) text_mm2 += counted_mm2(put);
    for (const double height_mm : larger_heights_mm())
        for (const LabelWish& wish : wishes_) {
            const auto now = put_.find(wish.item);
            if (now == put_.end() || !says_the_same(now->second.wish, height_mm)) continue;
            LabelWish larger = in_height(now->second.wish, height_mm);
            larger.but_of = wish.item;
            std::erase_if(larger.gaps_mm, [&](double gap_mm) { return gap_mm > now->second.label.gap_mm; });
            const double before_mm2 = counted_mm2(now->second), by = height_mm / now->second.label.text_height_mm;
            const double after_mm2 = text_mm2 + (by * by - 1) * before_mm2;
            if (after_mm2 > settings_.most_text * (after_mm2 + lines)) continue;
            if (put(larger)) text_mm2 += counted_mm2(put_.at(wish.item)) - before_mm2;
        }
}

std::optional<Label> AllLabels::place_large(const LabelWish& wish, const OccupiedSkin& occupied) const {
    auto heights_mm = larger_heights_mm();
    for (auto height_mm = heights_mm.rbegin(); height_mm != heights_mm.rend(); ++height_mm)
        if (says_the_same(wish, *height_mm))
            if (auto label = place_label(in_height(wish, *height_mm), skin_, settings_, occupied)) return label;
    return std::nullopt;
}

void AllLabels::put_of_moment() {
    for (LabelWish wish : wishes_) {
        wish.but_of = OccupiedSkin::kAllLabels;
        wish.others.clear();  // they are dim
        LabelWish near = wish;
        near.gaps_mm = {0};
        auto label = place_large(near, plan_);
        if (!label) label = place_label(wish, skin_, settings_, plan_);
        for (const LabelForm form : {LabelForm::spare, LabelForm::brief, LabelForm::name})
            if (!label && (form != LabelForm::brief || warns(wish)))
                label = place_label(in_form(wish, form), skin_, settings_, plan_);
        if (!label) continue;
        label->of_moment = true;
        label->by_code = !wish.code.empty() && wish.text.name == wish.code;
        drawing_.labels.push_back(std::move(*label));
    }
}

/// Far enough from every item that it is not taken for one's name.
LabelWish AllLabels::card_wish() const {
    LabelWish wish;
    wish.text.name = settings_.card.front();
    wish.text.figures.assign(settings_.card.begin() + 1, settings_.card.end());
    wish.text_height_mm = settings_.text_height_mm;
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
    return wish;
}

void AllLabels::put_card() {
    if (settings_.card.empty() || wishes_.empty()) return;
    const LabelWish wish = card_wish();
    drawing_.card = place_large(wish, occupied_);
    if (!drawing_.card) drawing_.card = place_label(wish, skin_, settings_, occupied_);
    if (!drawing_.card && settings_.light) {
        constexpr double kSteepest = 1.05;  // radians (60 degrees): rather aslant than not at all
        DrawingSettings steeper = settings_;
        steeper.light->steepest = std::max(kSteepest, steeper.light->steepest);
        drawing_.card = place_label(wish, skin_, steeper, occupied_);
    }
    if (!drawing_.card) return;
    Label taken = *drawing_.card;  // labels that are made larger keep off it as off each other
    taken.item = OccupiedSkin::kCard;
    occupy(taken, occupied_);
}

void AllLabels::place() {
    put_whole_first();
    if (const int first = told(); first < kAllTold * static_cast<int>(wishes_.size())) {
        const auto whole_first = put_;
        put_codes_first();
        if (told() <= first) put_ = whole_first;
        occupied_ = plan_;
        for (const auto& [item, put] : put_) occupy(put.label, occupied_);
    }
    keep_to_share();
    occupied_ = plan_;
    for (const auto& [item, put] : put_) occupy(put.label, occupied_);
    put_card();
    enlarge();
    for (const LabelWish& wish : wishes_) {
        const auto put = put_.find(wish.item);
        DrawnItem& item = drawing_.items[static_cast<std::size_t>(wish.item)];
        item.labelled = put != put_.end();
        if (warns(wish) && (put == put_.end() || !put->second.wish.text.risk))
            item.unlit_warning = wish.text.risk->figure + " " + wish.text.risk->structure;
        if (put == put_.end()) continue;
        if (put->second.label.by_code) item.lit_by_code = true, item.lit_name = item.code;
        drawing_.labels.push_back(put->second.label);
    }
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
