#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace planlight {

/// Whether the file begins as gzip does.
bool is_gzip(const std::filesystem::path& file);

/// A text header of "name separator value" lines, names in lower case.
struct TextHeader {
    std::filesystem::path file;
    std::map<std::string, std::string> fields;
    std::uint64_t bytes = 0;  ///< where the rest of the file begins

    bool has(const std::string& name) const { return fields.contains(name); }
    /// Throws InputError (the header does not say `name`) when it is missing.
    const std::string& at(const std::string& name) const;
    std::string get(const std::string& name, const std::string& otherwise) const;
    /// Exactly `count` numbers, separated by blanks. Throws DamagedFileError.
    std::vector<double> numbers(const std::string& name, std::size_t count) const;
};

/// Reads lines up to an empty one or, when `last` is given, through the line of that name; at most 64 KiB and 500 lines
/// of printable text, no name twice. Lines that begin with '#' are left out. Throws DamagedFileError.
TextHeader read_text_header(const std::filesystem::path& file, const std::string& separator, const std::string& last);

/// A text without the mark (U+FEFF) that Windows programs write before UTF-8.
std::string without_byte_order_mark(std::string text);

/// Numbers of a text; empty when it holds anything else.
std::vector<double> numbers_of(std::string text);

/// ASCII letters only, whatever the locale.
std::string lower_case(std::string text);

/// "1 slice", "4 slices".
std::string counted(long long count, const std::string& noun);

/// The data file that a header names, in the header's own folder or below. InputError when it is elsewhere or not
/// there.
std::filesystem::path data_file_beside(const std::filesystem::path& header, const std::string& name);

/// The first word in it, in any case of letters, that names a program or a step that takes faces or skin away
/// ("deface", "quickshear"); empty: there is none.
std::string defacing_word_in(const std::string& description);

/// InputError when a file's name or description says that its face was removed.
void check_not_defaced(const std::filesystem::path& file, const std::string& description);

}  // namespace planlight
