#include "app/report/pdf_page.h"

#include <fmt/format.h>
#include <hpdf.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "app/report/pdf_letters.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr const char* kFonts = "/usr/share/fonts/truetype/dejavu/";
constexpr float kLeft = 48, kRight = 547, kTop = 800, kBottom = 56;
constexpr float kCapital = 0.729F;  // of the font's size: how high its capital letters are
constexpr float kBody = 9, kSmall = 7.5F, kHeading = 12, kTitle = 17, kLeading = 1.35F;

void fail(HPDF_STATUS error, HPDF_STATUS detail, void*) {
    throw std::runtime_error(fmt::format("the PDF could not be made (libharu {:#x}, {})", error, detail));
}

/// Where the next letter of UTF-8 begins.
std::size_t after_letter(const std::string& text, std::size_t at) {
    do ++at;
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80);
    return at;
}

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words(1);
    for (const char c : text)
        if (c == ' ' || c == '\n')
            words.emplace_back();
        else
            words.back() += c;
    std::erase(words, std::string());
    return words;
}

/// 1, 2 or 5 times a power of ten, for some eight ticks.
double round_step(double range) {
    const double raw = range / 8, power = std::pow(10, std::floor(std::log10(raw)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (raw <= factor * power * 1.001) return factor * power;
    return 10 * power;
}

}  // namespace

struct PdfPages::Parts {
    HPDF_Doc doc = HPDF_New(fail, nullptr);
    HPDF_Font regular = nullptr, bold = nullptr;
    HPDF_Page page = nullptr;
    std::string foot;
    int sheets = 0;
    float y = 0;

    Parts(const std::string& title, std::string at_foot) : foot(std::move(at_foot)) {
        if (!doc) throw std::bad_alloc();
        try {
            for (const char* name : {"DejaVuSans.ttf", "DejaVuSans-Bold.ttf"})
                if (!std::filesystem::exists(std::string(kFonts) + name))
                    throw DeviceError(std::string("Font ") + name, "it is not installed",
                                      "Install the package fonts-dejavu-core.");
            HPDF_UseUTFEncodings(doc);
            HPDF_SetCurrentEncoder(doc, "UTF-8");
            HPDF_SetCompressionMode(doc, HPDF_COMP_ALL);
            HPDF_SetInfoAttr(doc, HPDF_INFO_TITLE, title.c_str());
            regular = font("DejaVuSans.ttf");
            bold = font("DejaVuSans-Bold.ttf");
            begin_sheet();
            text(bold, kTitle, {0.08F, 0.09F, 0.11F}, kLeft, title, kRight - kLeft);
            y -= 4;
        } catch (...) {
            HPDF_Free(doc);
            throw;
        }
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    ~Parts() { HPDF_Free(doc); }

    HPDF_Font font(const char* file) {
        return HPDF_GetFont(doc, HPDF_LoadTTFontFromFile(doc, (std::string(kFonts) + file).c_str(), HPDF_TRUE),
                            "UTF-8");
    }

    void begin_sheet() {
        page = HPDF_AddPage(doc);
        HPDF_Page_SetSize(page, HPDF_PAGE_SIZE_A4, HPDF_PAGE_PORTRAIT);
        ++sheets;
        y = kTop;
        const float before = y;
        y = kBottom - 18;
        line_of(regular, kSmall, {0.36F, 0.39F, 0.44F}, kLeft, fmt::format("{}  Sheet {}.", foot, sheets));
        y = before;
    }
    void need(float height) {
        if (y - height < kBottom) begin_sheet();
    }

    struct Ink {
        float r = 0, g = 0, b = 0;
    };
    static constexpr Ink kInk{0.08F, 0.09F, 0.11F}, kQuiet{0.36F, 0.39F, 0.44F};

    float width(HPDF_Font of, float size, const std::string& words) {
        HPDF_Page_SetFontAndSize(page, of, size);
        float all = 0;
        for (const PdfLetters& part : letters_of(words))
            all += part.outline ? size * kCapital * static_cast<float>(part.outline->width)
                                : HPDF_Page_TextWidth(page, part.text.c_str());
        return all;
    }
    void line_of(HPDF_Font of, float size, Ink ink, float x, const std::string& words) {
        HPDF_Page_SetRGBFill(page, ink.r, ink.g, ink.b);
        HPDF_Page_SetFontAndSize(page, of, size);
        for (const PdfLetters& part : letters_of(words)) {
            if (part.outline) {
                fill(*part.outline, x, size * kCapital, of == bold ? ink : Ink{-1, 0, 0});
                x += size * kCapital * static_cast<float>(part.outline->width);
                continue;
            }
            HPDF_Page_BeginText(page);
            HPDF_Page_TextOut(page, x, y, part.text.c_str());
            HPDF_Page_EndText(page);
            x += HPDF_Page_TextWidth(page, part.text.c_str());
        }
    }
    /// Filled on the line; with an edge of that ink where it is bold (no ink: red below 0).
    void fill(const TextOutline& letters, float x, float capital, Ink edge) {
        if (letters.signs.empty()) return;
        if (edge.r >= 0) {
            HPDF_Page_SetRGBStroke(page, edge.r, edge.g, edge.b);
            HPDF_Page_SetLineWidth(page, 0.06F * capital);
        }
        for (const Sign& sign : letters.signs)
            for (const auto& outline : sign.outlines) {
                bool begun = false;
                for (const Eigen::Vector2d& p : outline) {
                    const float at_x = x + capital * static_cast<float>(p.x());
                    const float at_y = y + capital * static_cast<float>(p.y());
                    if (std::exchange(begun, true))
                        HPDF_Page_LineTo(page, at_x, at_y);
                    else
                        HPDF_Page_MoveTo(page, at_x, at_y);
                }
                if (begun) HPDF_Page_ClosePath(page);
            }
        if (edge.r < 0)
            HPDF_Page_Fill(page);
        else
            HPDF_Page_FillStroke(page);
    }
    /// Words into lines of that width; a word that is longer is broken.
    std::vector<std::string> broken(HPDF_Font of, float size, const std::string& words, float room) {
        std::vector<std::string> lines;
        std::string now;
        for (std::string word : words_of(words)) {
            if (!now.empty() && width(of, size, now + " " + word) > room) lines.push_back(std::exchange(now, {}));
            while (now.empty() && width(of, size, word) > room) {
                std::size_t end = after_letter(word, 0);
                while (end < word.size() && width(of, size, word.substr(0, after_letter(word, end))) <= room)
                    end = after_letter(word, end);
                lines.push_back(word.substr(0, end));
                word.erase(0, end);
                if (word.empty()) break;
            }
            now += (now.empty() || word.empty() ? "" : " ") + word;
        }
        if (!now.empty()) lines.push_back(now);
        return lines;
    }
    void text(HPDF_Font of, float size, Ink ink, float x, const std::string& words, float room) {
        for (const std::string& line : broken(of, size, words, room)) {
            need(size * kLeading);
            y -= size * kLeading;
            line_of(of, size, ink, x, line);
        }
    }
    void rule(float x0, float x1, float at, Ink ink) {
        HPDF_Page_SetRGBStroke(page, ink.r, ink.g, ink.b);
        HPDF_Page_SetLineWidth(page, 0.5F);
        HPDF_Page_MoveTo(page, x0, at);
        HPDF_Page_LineTo(page, x1, at);
        HPDF_Page_Stroke(page);
    }
};

PdfPages::PdfPages(const std::string& title, const std::string& foot) : parts_(std::make_unique<Parts>(title, foot)) {}
PdfPages::~PdfPages() = default;

void PdfPages::heading(const std::string& text, double with) {
    Parts& p = *parts_;
    p.need(kHeading * 3 + static_cast<float>(with));
    p.y -= 7;
    p.text(p.bold, kHeading, Parts::kInk, kLeft, text, kRight - kLeft);
    p.y -= 2;
}

void PdfPages::paragraph(const std::string& text) {
    parts_->text(parts_->regular, kBody, Parts::kInk, kLeft, text, kRight - kLeft);
    parts_->y -= 2;
}

void PdfPages::table(const std::vector<std::vector<std::string>>& rows, const std::vector<double>& shares) {
    constexpr float kGap = 6;
    Parts& p = *parts_;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const HPDF_Font font = p.regular;
        const float size = r == 0 ? kSmall : kBody;
        std::vector<std::vector<std::string>> cells;
        std::size_t most = 1;
        for (std::size_t c = 0; c < std::min(rows[r].size(), shares.size()); ++c) {
            const float room = static_cast<float>(shares[c]) * (kRight - kLeft) - kGap;
            cells.push_back(p.broken(font, size, rows[r][c], room));
            most = std::max(most, cells.back().size());
        }
        p.need(static_cast<float>(most) * size * kLeading + 4);
        const float top = p.y;
        float x = kLeft;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            p.y = top;
            for (const std::string& line : cells[c]) {
                p.y -= size * kLeading;
                p.line_of(font, size, r == 0 ? Parts::kQuiet : Parts::kInk, x, line);
            }
            x += static_cast<float>(shares[c]) * (kRight - kLeft);
        }
        p.y = top - static_cast<float>(most) * size * kLeading - 3;
        p.rule(kLeft, kRight, p.y, {0.83F, 0.85F, 0.87F});
    }
    p.y -= 2;
}

void PdfPages::pictures(const std::vector<std::pair<std::string, RgbImage>>& row) {
    constexpr float kGap = 8;
    if (row.empty()) return;
    Parts& p = *parts_;
    const auto count = static_cast<float>(row.size());
    const float width = (kRight - kLeft - kGap * (count - 1)) / count;
    float most = 0;
    for (const auto& [caption, picture] : row)
        most = std::max(most, width * static_cast<float>(picture.height) / static_cast<float>(picture.width));
    p.need(most + 24);
    const float top = p.y - 4;
    for (std::size_t i = 0; i < row.size(); ++i) {
        const RgbImage& picture = row[i].second;
        const float x = kLeft + static_cast<float>(i) * (width + kGap);
        const float height = width * static_cast<float>(picture.height) / static_cast<float>(picture.width);
        const HPDF_Image image = HPDF_LoadRawImageFromMem(
            p.doc, reinterpret_cast<const HPDF_BYTE*>(picture.pixels.data()), static_cast<HPDF_UINT>(picture.width),
            static_cast<HPDF_UINT>(picture.height), HPDF_CS_DEVICE_RGB, 8);
        HPDF_Page_DrawImage(p.page, image, x, top - height, width, height);
        p.y = top - most - kSmall * kLeading;
        p.line_of(p.regular, kSmall, Parts::kQuiet, x, row[i].first);
    }
    p.y -= 4;
}

void PdfPages::chart(const Chart& chart) {
    constexpr float kHeight = 130, kAxis = 30;
    Parts& p = *parts_;
    p.need(kHeight + 30);
    const float bottom = p.y - kHeight, left = kLeft + kAxis, width = kRight - left;
    const auto at_x = [&](double x) {
        return left + width * static_cast<float>((x - chart.from_x) / (chart.to_x - chart.from_x));
    };
    const auto at_y = [&](double y) { return bottom + (kHeight - 8) * static_cast<float>(y / chart.to_y); };
    const auto ink = [](const Rgb& c) {
        return Parts::Ink{static_cast<float>(c[0]) / 255, static_cast<float>(c[1]) / 255,
                          static_cast<float>(c[2]) / 255};
    };
    for (const auto& bar : chart.bars) {
        const Parts::Ink c = ink(bar.colour);
        HPDF_Page_SetRGBFill(p.page, c.r, c.g, c.b);
        HPDF_Page_Rectangle(p.page, at_x(bar.from), bottom, std::max(0.4F, at_x(bar.to) - at_x(bar.from)),
                            at_y(bar.height) - bottom);
        HPDF_Page_Fill(p.page);
    }
    for (const auto& [level, colour] : chart.levels)
        if (level <= chart.to_y) p.rule(left, kRight, at_y(level), ink(colour));
    HPDF_Page_SetRGBFill(p.page, 0.08F, 0.25F, 0.42F);
    for (const auto& [x, y] : chart.dots) {
        HPDF_Page_Circle(p.page, at_x(x), at_y(std::min(y, chart.to_y)), 1.3F);
        HPDF_Page_Fill(p.page);
    }
    p.rule(left, kRight, bottom, Parts::kQuiet);
    const double step = round_step(chart.to_x - chart.from_x);
    for (double x = std::ceil(chart.from_x / step) * step; x <= chart.to_x + 1e-9; x += step) {
        const std::string words = fmt::format("{:.3g}", x);
        p.y = bottom - 10;
        p.line_of(p.regular, kSmall, Parts::kQuiet, at_x(x) - p.width(p.regular, kSmall, words) / 2, words);
    }
    for (int i = 0; i <= static_cast<int>(chart.to_y); ++i) {
        p.y = at_y(i) - 3;
        p.line_of(p.regular, kSmall, Parts::kQuiet, kLeft + 14, fmt::format("{}", i));
    }
    p.y = bottom - 21;
    p.line_of(p.regular, kSmall, Parts::kQuiet, left, fmt::format("x: {};  y: {}", chart.x_label, chart.y_label));
    p.y -= 6;
}

std::string PdfPages::bytes() {
    HPDF_SaveToStream(parts_->doc);
    HPDF_ResetStream(parts_->doc);
    std::string all(HPDF_GetStreamSize(parts_->doc), '\0');
    HPDF_UINT32 size = static_cast<HPDF_UINT32>(all.size());
    HPDF_ReadFromStream(parts_->doc, reinterpret_cast<HPDF_BYTE*>(all.data()), &size);
    all.resize(size);
    return all;
}

}  // namespace planlight
