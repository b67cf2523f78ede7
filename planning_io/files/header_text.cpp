#include "planning_io/files/header_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostBytes = 1 << 16;
constexpr int kMostLines = 500;
constexpr const char* kCopyAgain = "Copy or export the file again.";

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

}  // namespace

bool is_gzip(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return in.get() == 0x1f && in.get() == 0x8b;
}

std::string counted(long long count, const std::string& noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c); });
    return text;
}

const std::string& TextHeader::at(const std::string& name) const {
    const auto field = fields.find(name);
    if (field == fields.end())
        throw InputError(file, "does not say \"" + name + "\" in its header",
                         "Save it again with a program that writes it, or give the DICOM series.");
    return field->second;
}

std::string TextHeader::get(const std::string& name, const std::string& otherwise) const {
    const auto field = fields.find(name);
    return field == fields.end() ? otherwise : field->second;
}

std::string without_byte_order_mark(std::string text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    return text;
}

std::vector<double> numbers_of(std::string text) {
    std::vector<double> numbers;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        double number = 0;
        const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
        const auto [end, error] = std::from_chars(begin, word.data() + word.size(), number);
        if (error != std::errc() || end != word.data() + word.size()) return {};
        numbers.push_back(number);
    }
    return numbers;
}

std::vector<double> TextHeader::numbers(const std::string& name, std::size_t count) const {
    const auto numbers = numbers_of(at(name));
    if (numbers.size() != count)
        throw DamagedFileError(file,
                               fmt::format("has \"{}\" in its header that is not {}", name,
                                           counted(static_cast<long long>(count), "number")),
                               kCopyAgain);
    return numbers;
}

TextHeader read_text_header(const fs::path& file, const std::string& separator, const std::string& last) {
    TextHeader header;
    header.file = file;
    std::error_code error;
    if (!fs::is_regular_file(file, error))
        throw InputError(file, "is not a readable file", "Check the name of the file.");
    std::ifstream in(file, std::ios::binary);
    if (!in) throw InputError(file, "cannot be opened", "Check the permissions of the file.");
    std::string text(kMostBytes, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    for (int lines = 0; header.bytes < text.size(); ++lines) {
        const auto end = text.find('\n', header.bytes);
        const std::string line =
            trimmed(text.substr(header.bytes, end == std::string::npos ? end : end - header.bytes));
        const bool text_only = std::all_of(line.begin(), line.end(),
                                           [](char c) { return static_cast<unsigned char>(c) >= ' ' || c == '\t'; });
        if (lines >= kMostLines || !text_only || (end == std::string::npos && text.size() == kMostBytes))
            throw DamagedFileError(file, "has a header that is no text or does not end", kCopyAgain);
        header.bytes = end == std::string::npos ? text.size() : end + 1;
        if (line.empty()) break;
        const auto middle = line.find(separator);
        if (line.starts_with('#') || middle == std::string::npos) continue;
        const std::string name = lower_case(trimmed(line.substr(0, middle)));
        if (!header.fields.emplace(name, trimmed(line.substr(middle + separator.size()))).second)
            throw DamagedFileError(file, "says \"" + name + "\" twice in its header", kCopyAgain);
        if (!last.empty() && name == last) break;
    }
    return header;
}

fs::path data_file_beside(const fs::path& header, const std::string& name) {
    const fs::path folder = fs::weakly_canonical(header.has_parent_path() ? header.parent_path() : fs::path("."));
    const auto refuse = [&](const std::string& why) {
        throw InputError(header, "names the data file \"" + name + "\", which " + why,
                         "Put the data file beside the header, or save both as one file.");
    };
    if (name.find_first_of("%*?") != std::string::npos || lower_case(name).starts_with("list"))
        refuse("is a list of files");
    const fs::path data = fs::weakly_canonical(folder / name);
    if (const fs::path relative = data.lexically_relative(folder);
        relative.empty() || *relative.begin() == ".." || fs::path(name).is_absolute())
        refuse("is not in the header's folder");
    std::error_code error;
    if (!fs::is_regular_file(data, error)) refuse("is not there");
    return data;
}

std::string defacing_word_in(const std::string& description) {
    const std::string said = lower_case(description);
    for (const char* word : {"deface", "defacing", "reface", "mask_face", "quickshear", "skull-strip", "skull strip",
                             "skullstrip", "skull_strip"})
        if (said.find(word) != std::string::npos) return word;
    return "";
}

void check_not_defaced(const fs::path& file, const std::string& description) {
    if (const std::string word = defacing_word_in(file.filename().string() + " " + description); !word.empty())
        throw InputError(file, "says that the face or the skin was taken away (\"" + word + "\")",
                         "Give the series as the scanner made it: the light is aligned by the skin of the face.");
}

}  // namespace planlight
