#include "app/report/pdf_words.h"

#include <algorithm>

namespace planlight {
namespace {

/// Where the next letter of UTF-8 begins.
std::size_t after_letter(const std::string& text, std::size_t at) {
    do ++at;
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80);
    return at;
}

/// Without the soft hyphens that a browser may break a word at.
std::string without_soft_hyphens(std::string text) {
    static const std::string kSoftHyphen = "\u00ad";
    for (std::size_t at = text.find(kSoftHyphen); at != std::string::npos; at = text.find(kSoftHyphen, at))
        text.erase(at, kSoftHyphen.size());
    return text;
}

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words(1);
    for (const char c : without_soft_hyphens(text))
        if (c == ' ' || c == '\n')
            words.emplace_back();
        else
            words.back() += c;
    std::erase(words, std::string());
    return words;
}

/// Fills lines with words, each as wide as it is.
class Lines {
public:
    Lines(const PdfSheets& sheets, double size, double room) : sheets_(sheets), size_(size), room_(room) {}

    void add(const std::string& text, PdfSheets::Face face, Rgb ink) {
        for (const std::string& word : words_of(text)) add_word(word, face, ink);
    }
    void end_line() {
        if (!now_.empty()) lines.push_back(std::exchange(now_, {}));
        used_ = 0;
    }
    std::vector<PdfLine> lines;

private:
    void add_word(std::string word, PdfSheets::Face face, Rgb ink) {
        const double blank = now_.empty() ? 0 : sheets_.width_of(face, size_, " ");
        double wide = sheets_.width_of(face, size_, word);
        if (!now_.empty() && used_ + blank + wide > room_) end_line();
        while (now_.empty() && wide > room_ && after_letter(word, 0) < word.size()) {
            std::size_t end = after_letter(word, 0);
            while (sheets_.width_of(face, size_, word.substr(0, after_letter(word, end))) <= room_)
                end = after_letter(word, end);
            lines.push_back({{word.substr(0, end), face, ink}});
            word.erase(0, end);
            wide = sheets_.width_of(face, size_, word);
        }
        const bool begins = now_.empty();
        if (!begins && now_.back().face == face && now_.back().ink == ink)
            now_.back().text += " " + word;
        else
            now_.push_back({(begins ? "" : " ") + word, face, ink});
        used_ += (begins ? 0 : blank) + wide;
    }
    const PdfSheets& sheets_;
    double size_, room_, used_ = 0;
    PdfLine now_;
};

}  // namespace

Rgb ink_of(Tone tone) {
    constexpr Rgb kInks[] = {
        {0x15, 0x18, 0x1d}, {0x5b, 0x64, 0x70}, {0x14, 0x66, 0x3a}, {0x8a, 0x53, 0x00}, {0xa3, 0x12, 0x1f}};
    return kInks[static_cast<std::size_t>(tone)];
}

std::vector<PdfLine> lines_of(const PdfSheets& sheets, const DocumentText& text, double size, double width, bool bold) {
    using Face = PdfSheets::Face;
    Lines lines(sheets, size, width);
    lines.add(text.lead, Face::bold, ink_of(Tone::plain));
    lines.add(text.text, bold ? Face::bold : Face::regular, ink_of(text.tone));
    lines.end_line();
    lines.add(text.below, Face::regular, ink_of(Tone::quiet));
    lines.end_line();
    return lines.lines;
}

PdfWidths widths_of(const PdfSheets& sheets, const DocumentText& text, double size) {
    using Face = PdfSheets::Face;
    const auto of = [&](const std::string& words, Face face) {
        PdfWidths widths;
        for (const std::string& word : words_of(words)) {
            const double wide = sheets.width_of(face, size, word);
            widths.whole += wide + (widths.whole > 0 ? sheets.width_of(face, size, " ") : 0);
            widths.longest_word = std::max(widths.longest_word, wide);
        }
        return widths;
    };
    const PdfWidths lead = of(text.lead, Face::bold), words = of(text.text, Face::regular),
                    below = of(text.below, Face::regular);
    return {std::max(lead.whole + words.whole + (lead.whole > 0 ? size / 3 : 0), below.whole),
            std::max({lead.longest_word, words.longest_word, below.longest_word})};
}

double leading_of(double size) {
    return 1.35 * size;
}

void draw_lines(PdfSheets& sheets, const std::vector<PdfLine>& lines, double size, double x, double y) {
    for (const PdfLine& line : lines) {
        y -= leading_of(size);
        double at = x;
        for (const PdfRun& run : line) {
            sheets.words(run.face, size, run.ink, at, y + 0.22 * size, run.text);
            at += sheets.width_of(run.face, size, run.text);
        }
    }
}

}  // namespace planlight
