#pragma once

#include <filesystem>
#include <string>
#include <vector>

struct ImFont;
struct ImFontAtlas;

namespace planlight {

/// The font files of the windows.
struct FontFiles {
    std::filesystem::path regular, bold;
    std::filesystem::path symbols;  ///< for what the others lack (⌀); may be empty
};

/// Inter, else DejaVu Sans. Throws DeviceError that names the packages when neither is installed.
FontFiles find_fonts();

/// The sizes of text in the operator window. Pixels of a 1080-line window are for `scale` 1.
struct FontSet {
    ImFont *small, *body, *strong, *number, *title, *letter, *word;
};

/// Letters (UTF-8) besides those of European scripts that a window shows.
struct FontLetters {
    std::string text;  ///< in every size but that of the status
    std::string word;  ///< of the status
};

/// Loads all sizes into an empty atlas. Letters that the files lack come from other fonts of this computer, where one
/// has them.
FontSet load_fonts(ImFontAtlas& atlas, const FontFiles& files, float scale, const FontLetters& letters = {});

/// A letter as UTF-8.
std::string utf8_of(unsigned code);

/// The characters of `text` (UTF-8) that the font would show as a blank or as a question mark, each as UTF-8.
std::vector<std::string> missing_glyphs(const ImFont& font, const std::string& text);

}  // namespace planlight
