#include "app/windows/scene_overlay.h"

#include <fmt/format.h>
#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "app/windows/distance_colours.h"
#include "app/windows/orientation.h"

namespace planlight {
namespace {

struct Text {
    vtkNew<vtkTextActor> actor;

    void set_up(vtkRenderer& renderer, const std::filesystem::path& font) {
        vtkTextProperty* const property = actor->GetTextProperty();
        property->SetFontFamily(VTK_FONT_FILE);
        property->SetFontFile(font.c_str());
        set_ink(false);
        // Readable over the skin too; a box of its own behind the text would win against it in the depth test.
        property->SetBackgroundOpacity(0.7);
        property->SetJustificationToCentered();
        property->SetVerticalJustificationToCentered();
        renderer.AddActor2D(actor);
    }
    void set_ink(bool on_paper) {
        vtkTextProperty* const property = actor->GetTextProperty();
        if (on_paper)
            property->SetColor(0.08, 0.09, 0.12), property->SetBackgroundColor(1, 1, 1);
        else
            property->SetColor(0.94, 0.95, 0.97), property->SetBackgroundColor(0.055, 0.067, 0.086);
    }
    void place(const std::string& text, double x, double y, int pixels) {
        actor->SetInput(text.c_str());
        actor->GetTextProperty()->SetFontSize(pixels);
        actor->SetPosition(x, y);
    }
};

/// Filled rectangles in pixels from the lower left corner.
struct Boxes {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkUnsignedCharArray> colours;
    vtkNew<vtkPolyData> data;
    vtkNew<vtkPolyDataMapper2D> mapper;
    vtkNew<vtkActor2D> actor;

    void set_up(vtkRenderer& renderer) {
        colours->SetNumberOfComponents(4);
        data->SetPoints(points);
        data->SetPolys(cells);
        data->GetCellData()->SetScalars(colours);
        mapper->SetInputData(data);
        actor->SetMapper(mapper);
        renderer.AddActor2D(actor);
    }
    void clear() {
        points->Reset();
        cells->Reset();
        colours->Reset();
    }
    void add(double x, double y, double width, double height, const Rgb& colour, std::uint8_t alpha) {
        const vtkIdType ids[4] = {points->InsertNextPoint(x, y, 0), points->InsertNextPoint(x + width, y, 0),
                                  points->InsertNextPoint(x + width, y + height, 0),
                                  points->InsertNextPoint(x, y + height, 0)};
        cells->InsertNextCell(4, ids);
        const std::uint8_t rgba[4] = {colour[0], colour[1], colour[2], alpha};
        colours->InsertNextTypedTuple(rgba);
    }
    void done() {
        points->Modified();
        cells->Modified();
        colours->Modified();
        data->Modified();
    }
};

constexpr double kLetter = 32, kLetterGap = 34;  // of a side's letter, from the edge to its middle; at scale 1

double readable(double scale) {
    return std::max(scale, 0.85);  // smaller letters are not
}

/// Of the legend, pixels.
int letters_px(double scale) {
    return std::max(14, static_cast<int>(17 * scale));
}

/// Letters of a UTF-8 text.
double signs_of(const std::string& text) {
    return static_cast<double>(std::count_if(text.begin(), text.end(),
                                             [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// Known by its beginning and its end.
std::string shortened_name(const std::string& name, std::size_t most) {
    std::vector<std::string> signs;
    for (const char c : name) {
        if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) signs.emplace_back();
        if (!signs.empty()) signs.back() += c;
    }
    if (signs.size() <= most) return name;
    std::string text;
    const std::size_t first = most / 2, last = signs.size() - (most - 1 - first);
    for (std::size_t i = 0; i < first; ++i) text += signs[i];
    text += "…";
    for (std::size_t i = last; i < signs.size(); ++i) text += signs[i];
    return text;
}

/// The main font has Latin, Greek and Cyrillic letters; another name would be a row of boxes.
bool has_letters(const std::string& name) {
    return std::all_of(name.begin(), name.end(),
                       [](char c) { return static_cast<unsigned char>(c) < 0xD6 || c == '\xE2'; });
}

}  // namespace

struct SceneOverlay::Parts {
    Boxes boxes;
    std::array<Text, 4> letters;  ///< left, right, top, bottom
    /// Of all that stands in the lower right corner, pixels from the lower left one.
    double legends_left = std::numeric_limits<double>::infinity(), legends_top = 0;
    Text title;
    const Words* words = nullptr;
    std::array<Text, 4> values;
    static constexpr std::size_t kMostStructures = 6;
    Text risk_title;
    std::array<Text, kMostStructures> risk_names;

    std::vector<Text*> of_risks() {
        std::vector<Text*> all{&risk_title};
        for (Text& name : risk_names) all.push_back(&name);
        return all;
    }

    std::string say(const std::string& english) const { return words ? words->say(english) : english; }

    /// After the legends: the lower letter stands above those that reach below the middle.
    void letters_at_edges(const SceneView& view, int width, int height, double scale, const LetterInsets& insets) {
        const ViewAxes axes = axes_of(view);
        const int size = static_cast<int>(kLetter * scale);
        const double gap = kLetterGap * scale;
        letters[0].place(direction_letters(-axes.right_in_ct), insets.left + gap, 0.5 * height, size);
        letters[1].place(direction_letters(axes.right_in_ct), width - insets.right - gap, 0.5 * height, size);
        letters[2].place(direction_letters(axes.up_in_ct), 0.5 * width, height - gap, size);
        const bool in_the_way = legends_left < 0.5 * width + 0.8 * size;
        letters[3].place(direction_letters(-axes.up_in_ct), 0.5 * width, in_the_way ? legends_top + 0.7 * size : gap,
                         size);
    }

    void note_legend(double left, double top) {
        legends_left = std::min(legends_left, left);
        legends_top = std::max(legends_top, top);
    }

    /// Three fields: up to the first limit, up to the second, above.
    void legend_of_errors(const SceneModel& scene, const std::string& caption, double x, double y, double w,
                          double scale) {
        const double bar = w - 48 * scale, third = bar / 3;
        const std::array<double, 3> examples{0, scene.stop_above_mm, 2 * scene.stop_above_mm};
        for (int i = 0; i < 3; ++i)
            boxes.add(x + 24 * scale + i * third, y + 36 * scale, third - 2, 14 * scale,
                      error_colour(examples[static_cast<std::size_t>(i)], scene.warn_above_mm, scene.stop_above_mm),
                      255);
        title.place(caption, x + w / 2, y + 72 * scale, letters_px(scale));
        const std::array<std::string, 3> limits{fmt::format("≤ {:.1f}", scene.warn_above_mm),
                                                fmt::format("≤ {:.1f}", scene.stop_above_mm),
                                                fmt::format("> {:.1f}", scene.stop_above_mm)};
        for (std::size_t i = 0; i < 3; ++i)
            values[i].place(limits[i], x + 24 * scale + (static_cast<double>(i) + 0.5) * third, y + 18 * scale,
                            letters_px(scale));
        values[3].actor->SetVisibility(0);
    }

    void legend(const SceneModel& scene, int width, double scale) {
        const bool errors = scene.skin_error_mm != nullptr;
        const bool shown = errors || (scene.cloud != nullptr && scene.cloud_distance_mm != nullptr);
        title.actor->SetVisibility(shown);
        for (Text& value : values) value.actor->SetVisibility(shown);
        if (!shown) return;
        const std::string caption =
            say(errors ? "The light may be off by so much, mm (95 %)" : "The scan lies so far from the skin, mm");
        const double w = std::min(std::max(360 * scale, 0.56 * letters_px(scale) * signs_of(caption) + 24 * scale),
                                  width - 32 * scale),
                     x = width - w - 16 * scale, y = 16 * scale, bar = w - 48 * scale;
        note_legend(x - 8 * scale, y + 72 * scale + 0.7 * letters_px(scale));
        if (errors) {
            legend_of_errors(scene, caption, x, y, w, scale);
            return;
        }
        constexpr int kSteps = 64;
        for (int i = 0; i < kSteps; ++i)
            boxes.add(x + 24 * scale + bar * i / kSteps, y + 36 * scale, bar / kSteps + 0.5, 14 * scale,
                      distance_colour(i + 0.5, kSteps), 255);
        title.place(caption, x + w / 2, y + 72 * scale, letters_px(scale));
        for (int i = 0; i < 4; ++i)
            values[static_cast<std::size_t>(i)].place(
                fmt::format("{}{:.1f}", i == 3 ? "≥ " : "", scene.largest_distance_mm * i / 3),
                x + 24 * scale + bar * i / 3, y + 18 * scale, letters_px(scale));
    }

    /// What is seen through the skin, above the legend of the distances: a colour and a name a line.
    void legend_of_risks(const SceneModel& scene, int width, double scale) {
        const bool small = scene.on_paper && width < 600;  // the page names them beside its pictures
        const std::size_t count = scene.risk_structures && !small ? scene.risk_structures->size() : 0,
                          lines = std::min(count, kMostStructures);
        risk_title.actor->SetVisibility(count > 0);
        for (std::size_t i = 0; i < kMostStructures; ++i) risk_names[i].actor->SetVisibility(i < lines);
        if (count == 0) return;
        constexpr std::size_t kMostSigns = 26;
        const int px = letters_px(scale);
        const double line = 1.45 * px, colour = 0.8 * px, letter = 0.56 * px;
        const std::string caption = say("Seen through the skin: risk structures");
        double longest = signs_of(caption);
        std::vector<std::string> names;
        for (std::size_t i = 0; i < lines; ++i) {
            const std::string& name = (*scene.risk_structures)[i].name;
            names.push_back(
                i + 1 == kMostStructures && count > kMostStructures
                    ? say(fmt::format("and {} more", count - i))
                    : (has_letters(name) ? shortened_name(name, kMostSigns) : say(fmt::format("structure {}", i + 1))));
            longest = std::max(longest, signs_of(names.back()) + 2);
        }
        const double x = width - 16 * scale - std::min(letter * longest, width - 32 * scale);
        double y = (title.actor->GetVisibility() ? 124 : 32) * scale + line * static_cast<double>(lines);
        risk_title.place(caption, x, y, px);
        note_legend(x, y + 0.7 * px);
        for (std::size_t i = 0; i < lines; ++i) {
            y -= line;
            if (!(i + 1 == kMostStructures && count > kMostStructures))
                boxes.add(x, y - colour / 2, colour, colour, risk_colour(i), 255);
            risk_names[i].place(names[i], x + 1.8 * colour, y, px);
        }
    }
};

double SceneOverlay::letters_reach_px(double scale) {
    return (kLetterGap + 0.6 * kLetter) * readable(scale);
}

SceneOverlay::SceneOverlay(vtkRenderer& renderer, const FontFiles& fonts) : parts_(std::make_unique<Parts>()) {
    parts_->boxes.set_up(renderer);
    for (Text& letter : parts_->letters) letter.set_up(renderer, fonts.bold);
    parts_->title.set_up(renderer, fonts.regular);
    for (Text& value : parts_->values) value.set_up(renderer, fonts.regular);
    parts_->risk_title.set_up(renderer, fonts.regular);
    for (Text& name : parts_->risk_names) name.set_up(renderer, fonts.regular);
    for (Text* text : parts_->of_risks()) text->actor->GetTextProperty()->SetJustificationToLeft();
}

SceneOverlay::~SceneOverlay() = default;

void SceneOverlay::update(const SceneModel& scene, const SceneView& view, int width, int height, double scale,
                          const Words* words, const LetterInsets& insets) {
    parts_->words = words;
    scale = readable(scale);
    if (scene.on_paper) scale *= 1.6;  // the picture is shown at half its size and less
    for (Text& value : parts_->values) value.set_ink(scene.on_paper);
    parts_->title.set_ink(scene.on_paper);
    for (Text* text : parts_->of_risks()) text->set_ink(scene.on_paper);
    parts_->boxes.clear();
    for (Text& letter : parts_->letters) {
        letter.actor->SetVisibility(!scene.of_scan);
        letter.set_ink(scene.on_paper);
    }
    parts_->legends_left = std::numeric_limits<double>::infinity(), parts_->legends_top = 0;
    parts_->legend(scene, width, scale);
    parts_->legend_of_risks(scene, width, scale);
    parts_->letters_at_edges(view, width, height, scale, insets);
    parts_->boxes.done();
}

}  // namespace planlight
