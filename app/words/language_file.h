#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace planlight {

/// A language as its file holds it (README.md).
struct Language {
    std::string code;  ///< "de"
    std::string name;  ///< as its speakers call it: "Deutsch"
    /// English, and the same in this language; in the order of the sections' names. Both have the same places.
    std::vector<std::pair<std::string, std::string>> words;
};

/// Throws DamagedFileError for what is no such file, InputError that names the entry whose places are not those of its
/// English.
Language read_language(const std::string& text, const std::filesystem::path& file);

/// By its code: the site's own file where there is one, else what comes with the program. Throws InputError that names
/// the languages there are.
Language language_of(const std::string& code);

/// Codes of all languages there are, English among them; sorted.
std::vector<std::string> language_codes();

/// Where a site's own files lie, CODE.json each: planlight/words under $XDG_CONFIG_HOME (~/.config where that is not
/// set); empty without a home.
std::filesystem::path site_words_folder();

/// The file of that language as it comes with the program; empty where there is none.
std::string shipped_words(const std::string& code);

}  // namespace planlight
