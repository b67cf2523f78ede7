#include "app/report/pdf_sheets.h"

#include <fmt/format.h>
#include <hpdf.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>

#include "app/report/pdf_letters.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr const char* kFonts = "/usr/share/fonts/truetype/dejavu/";
constexpr double kTop = 36, kBottom = 48, kFoot = 30;  ///< margins, and where the foot's line stands
constexpr float kCapital = 0.729F;                     ///< of the font's size: how high its capital letters are
constexpr double kFootLetters = 7.5;
constexpr Rgb kQuiet{0x5b, 0x64, 0x70};

void fail(HPDF_STATUS error, HPDF_STATUS detail, void*) {
    throw std::runtime_error(fmt::format("the PDF could not be made (libharu {:#x}, {})", error, detail));
}

float in_points(double length) {
    return static_cast<float>(length);
}

std::array<float, 3> in_shares(Rgb ink) {
    return {static_cast<float>(ink[0]) / 255, static_cast<float>(ink[1]) / 255, static_cast<float>(ink[2]) / 255};
}

}  // namespace

struct PdfSheets::Parts {
    HPDF_Doc doc = HPDF_New(fail, nullptr);
    std::array<HPDF_Font, 2> fonts{};
    HPDF_Page page = nullptr;
    std::vector<HPDF_Page> pages;
    std::string foot;
    double paper_width, paper_height;

    Parts(const std::string& title, std::string at_foot, PaperSize paper)
        : foot(std::move(at_foot)),
          paper_width(paper == PaperSize::a4 ? 595.276 : 612),
          paper_height(paper == PaperSize::a4 ? 841.89 : 792) {
        if (!doc) throw std::bad_alloc();
        try {
            HPDF_UseUTFEncodings(doc);
            HPDF_SetCurrentEncoder(doc, "UTF-8");
            HPDF_SetCompressionMode(doc, HPDF_COMP_ALL);
            HPDF_SetInfoAttr(doc, HPDF_INFO_TITLE, title.c_str());
            fonts = {font("DejaVuSans.ttf"), font("DejaVuSans-Bold.ttf")};
        } catch (...) {
            HPDF_Free(doc);
            throw;
        }
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    ~Parts() { HPDF_Free(doc); }

    HPDF_Font font(const std::string& name) {
        const std::string file = kFonts + name;
        if (!std::filesystem::exists(file))
            throw DeviceError("Font " + name, "it is not installed", "Install the package fonts-dejavu-core.");
        return HPDF_GetFont(doc, HPDF_LoadTTFontFromFile(doc, file.c_str(), HPDF_TRUE), "UTF-8");
    }
    void fill_with(Rgb ink) {
        const auto [r, g, b] = in_shares(ink);
        HPDF_Page_SetRGBFill(page, r, g, b);
    }
    void stroke_with(Rgb ink, double thickness) {
        const auto [r, g, b] = in_shares(ink);
        HPDF_Page_SetRGBStroke(page, r, g, b);
        HPDF_Page_SetLineWidth(page, in_points(thickness));
    }
    /// Letters that the font lacks: filled, with an edge where they are bold. Of capitals that high.
    void outline(const TextOutline& letters, float x, float y, float capital, bool bold) {
        if (letters.signs.empty()) return;
        for (const Sign& sign : letters.signs)
            for (const auto& points : sign.outlines) {
                bool begun = false;
                for (const Eigen::Vector2d& p : points) {
                    const float at_x = x + capital * in_points(p.x()), at_y = y + capital * in_points(p.y());
                    if (std::exchange(begun, true))
                        HPDF_Page_LineTo(page, at_x, at_y);
                    else
                        HPDF_Page_MoveTo(page, at_x, at_y);
                }
                if (begun) HPDF_Page_ClosePath(page);
            }
        if (bold)
            HPDF_Page_FillStroke(page);
        else
            HPDF_Page_Fill(page);
    }
    double width_of(Face face, double size, const std::string& words) {
        HPDF_Page_SetFontAndSize(page, fonts[static_cast<std::size_t>(face)], in_points(size));
        float all = 0;
        for (const PdfLetters& part : letters_of(words))
            all += part.outline ? in_points(size) * kCapital * in_points(part.outline->width)
                                : HPDF_Page_TextWidth(page, part.text.c_str());
        return static_cast<double>(all);
    }
    void words(Face face, double size, Rgb ink, double from_x, double from_y, const std::string& words) {
        float x = in_points(from_x);
        const float y = in_points(from_y), capital = in_points(size) * kCapital;
        const bool bold = face == Face::bold;
        fill_with(ink);
        HPDF_Page_SetFontAndSize(page, fonts[static_cast<std::size_t>(face)], in_points(size));
        for (const PdfLetters& part : letters_of(words)) {
            if (part.outline) {
                if (bold) stroke_with(ink, 0.06 * static_cast<double>(capital));
                outline(*part.outline, x, y, capital, bold);
                x += capital * in_points(part.outline->width);
                continue;
            }
            HPDF_Page_BeginText(page);
            HPDF_Page_TextOut(page, x, y, part.text.c_str());
            HPDF_Page_EndText(page);
            x += HPDF_Page_TextWidth(page, part.text.c_str());
        }
    }
    HPDF_Image image_of(const RgbImage& picture, bool exact) {
        if (const std::string jpeg = exact ? std::string() : smaller_jpeg(picture); !jpeg.empty())
            return HPDF_LoadJpegImageFromMem(doc, reinterpret_cast<const HPDF_BYTE*>(jpeg.data()),
                                             static_cast<HPDF_UINT>(jpeg.size()));
        return HPDF_LoadRawImageFromMem(doc, reinterpret_cast<const HPDF_BYTE*>(picture.pixels.data()),
                                        static_cast<HPDF_UINT>(picture.width), static_cast<HPDF_UINT>(picture.height),
                                        HPDF_CS_DEVICE_RGB, 8);
    }
};

PdfSheets::PdfSheets(const std::string& title, const std::string& foot, PaperSize paper)
    : parts_(std::make_unique<Parts>(title, foot, paper)) {
    begin_sheet();
}
PdfSheets::~PdfSheets() = default;

double PdfSheets::left() const {
    return (parts_->paper_width - width()) / 2;
}
double PdfSheets::room() const {
    return y - kBottom;
}
double PdfSheets::whole_room() const {
    return parts_->paper_height - kTop - kBottom;
}

void PdfSheets::begin_sheet() {
    parts_->page = HPDF_AddPage(parts_->doc);
    parts_->pages.push_back(parts_->page);
    HPDF_Page_SetWidth(parts_->page, in_points(parts_->paper_width));
    HPDF_Page_SetHeight(parts_->page, in_points(parts_->paper_height));
    y = parts_->paper_height - kTop;
}

std::size_t PdfSheets::count() const {
    return parts_->pages.size();
}

void PdfSheets::need(double height) {
    if (room() < height && room() < whole_room()) begin_sheet();
}

double PdfSheets::width_of(Face face, double size, const std::string& words) const {
    return parts_->width_of(face, size, words);
}

void PdfSheets::words(Face face, double size, Rgb ink, double x, double at_y, const std::string& words, bool upwards) {
    if (!upwards) return parts_->words(face, size, ink, x, at_y, words);
    HPDF_Page_GSave(parts_->page);
    HPDF_Page_Concat(parts_->page, 0, 1, -1, 0, in_points(x), in_points(at_y));
    parts_->words(face, size, ink, 0, 0, words);
    HPDF_Page_GRestore(parts_->page);
}

void PdfSheets::line(const Points& points, Rgb ink, double thickness, bool dashed) {
    if (points.size() < 2) return;
    const HPDF_Page page = parts_->page;
    const HPDF_UINT16 dashes[] = {3, 3};
    parts_->stroke_with(ink, thickness);
    if (dashed) HPDF_Page_SetDash(page, dashes, 2, 0);
    HPDF_Page_MoveTo(page, in_points(points.front().first), in_points(points.front().second));
    for (std::size_t i = 1; i < points.size(); ++i)
        HPDF_Page_LineTo(page, in_points(points[i].first), in_points(points[i].second));
    HPDF_Page_Stroke(page);
    if (dashed) HPDF_Page_SetDash(page, nullptr, 0, 0);
}

void PdfSheets::fill(double x, double from_y, double width, double height, Rgb ink) {
    parts_->fill_with(ink);
    HPDF_Page_Rectangle(parts_->page, in_points(x), in_points(from_y), in_points(width), in_points(height));
    HPDF_Page_Fill(parts_->page);
}

void PdfSheets::frame(double x, double from_y, double width, double height, Rgb ink, double thickness) {
    parts_->stroke_with(ink, thickness);
    HPDF_Page_Rectangle(parts_->page, in_points(x), in_points(from_y), in_points(width), in_points(height));
    HPDF_Page_Stroke(parts_->page);
}

void PdfSheets::dot(double x, double at_y, double radius, Rgb ink) {
    parts_->fill_with(ink);
    HPDF_Page_Circle(parts_->page, in_points(x), in_points(at_y), in_points(radius));
    HPDF_Page_Fill(parts_->page);
}

void PdfSheets::picture(const RgbImage& picture, double x, double from_y, double width, double height, bool exact) {
    if (picture.empty()) return;
    HPDF_Page_DrawImage(parts_->page, parts_->image_of(picture, exact), in_points(x), in_points(from_y),
                        in_points(width), in_points(height));
}

std::string PdfSheets::bytes() {
    Parts& p = *parts_;
    for (std::size_t i = 0; i < p.pages.size(); ++i) {
        p.page = p.pages[i];
        const std::string number = fmt::format("Sheet {} of {}", i + 1, p.pages.size());
        p.words(Face::regular, kFootLetters, kQuiet, left(), kFoot, p.foot);
        p.words(Face::regular, kFootLetters, kQuiet, left() + width() - p.width_of(Face::regular, kFootLetters, number),
                kFoot, number);
    }
    HPDF_SaveToStream(p.doc);
    HPDF_ResetStream(p.doc);
    std::string all(HPDF_GetStreamSize(p.doc), '\0');
    HPDF_UINT32 size = static_cast<HPDF_UINT32>(all.size());
    HPDF_ReadFromStream(p.doc, reinterpret_cast<HPDF_BYTE*>(all.data()), &size);
    all.resize(size);
    return all;
}

}  // namespace planlight
