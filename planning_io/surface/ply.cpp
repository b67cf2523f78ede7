#include "planning_io/surface/ply.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

enum class Encoding { ascii, little, big };
enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
    std::string name;
    Type type;
    std::optional<Type> count_type;  ///< of a list
};
struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

[[noreturn]] void damaged(const fs::path& file, const std::string& problem) {
    throw DamagedFileError(file, problem, "Write or copy the PLY file again.");
}

Type type_of(const std::string& word, const fs::path& file) {
    static const std::vector<std::vector<std::string>> names{
        {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
        {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
    for (std::size_t i = 0; i < names.size(); ++i)
        if (std::find(names[i].begin(), names[i].end(), word) != names[i].end()) return static_cast<Type>(i);
    damaged(file, "has a column of the unknown type \"" + word + "\"");
}

class Reader {
public:
    Reader(std::string_view rest, Encoding encoding, const fs::path& file)
        : rest_(rest), encoding_(encoding), file_(file) {}

    double next(Type type) { return encoding_ == Encoding::ascii ? next_word() : next_bytes(type); }
    bool only_space_left() const { return rest_.find_first_not_of(" \t\r\n") == std::string_view::npos; }
    std::size_t left() const { return rest_.size(); }

private:
    double next_word() {
        const auto begin = rest_.find_first_not_of(" \t\r\n");
        if (begin == std::string_view::npos) damaged(file_, "is cut short");
        rest_.remove_prefix(begin);
        double value = 0;
        const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
        if (error != std::errc()) damaged(file_, "has a word where a number must stand");
        rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
        return value;
    }

    template <class T>
    static double as(const unsigned char* bytes) {
        T value;
        std::memcpy(&value, bytes, sizeof value);
        return static_cast<double>(value);
    }

    double next_bytes(Type type) {
        const std::size_t size = kBytes[static_cast<std::size_t>(type)];
        if (rest_.size() < size) damaged(file_, "is cut short");
        unsigned char bytes[8];
        std::memcpy(bytes, rest_.data(), size);
        rest_.remove_prefix(size);
        static_assert(std::endian::native == std::endian::little);
        if (encoding_ == Encoding::big) std::reverse(bytes, bytes + size);
        switch (type) {
            case Type::i8:
                return as<std::int8_t>(bytes);
            case Type::u8:
                return as<std::uint8_t>(bytes);
            case Type::i16:
                return as<std::int16_t>(bytes);
            case Type::u16:
                return as<std::uint16_t>(bytes);
            case Type::i32:
                return as<std::int32_t>(bytes);
            case Type::u32:
                return as<std::uint32_t>(bytes);
            case Type::f32:
                return as<float>(bytes);
            case Type::f64:
                return as<double>(bytes);
        }
        return 0;
    }

    std::string_view rest_;
    Encoding encoding_;
    const fs::path& file_;
};

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::vector<std::string> comments;
    std::size_t bytes = 0;
};

void add_element_line(Header& header, std::istringstream& words, const fs::path& file) {
    Element element;
    if (!(words >> element.name >> element.count) || element.count > (std::size_t{1} << 30))
        damaged(file, "has a damaged header");
    for (const Element& other : header.elements)
        if (other.name == element.name) damaged(file, "says \"element " + element.name.substr(0, 40) + "\" twice");
    header.elements.push_back(std::move(element));
}

void add_property_line(Header& header, std::istringstream& words, const fs::path& file) {
    std::string type, name, count_type;
    words >> type;
    if (type == "list") words >> count_type >> type;
    words >> name;
    if (name.empty() || header.elements.empty()) damaged(file, "has a damaged header");
    Property property{name, type_of(type, file), std::nullopt};
    if (!count_type.empty()) property.count_type = type_of(count_type, file);
    header.elements.back().properties.push_back(std::move(property));
}

Header parse_header(std::string_view content, const fs::path& file) {
    if (!content.starts_with("ply\n") && !content.starts_with("ply\r\n"))
        throw InputError(file, "is not a PLY file", "Export the mesh as PLY.");
    Header header;
    bool has_format = false;
    for (std::size_t begin = 0; begin < std::min<std::size_t>(content.size(), 1 << 20);) {
        const auto end = content.find('\n', begin);
        if (end == std::string_view::npos) break;
        std::string line(content.substr(begin, end - begin));
        if (!line.empty() && line.back() == '\r') line.pop_back();
        begin = end + 1;
        std::istringstream words(line);
        std::string word, format;
        words >> word;
        if (word == "format") {
            words >> format;
            has_format = format == "ascii" || format == "binary_little_endian" || format == "binary_big_endian";
            header.encoding = format == "ascii"               ? Encoding::ascii
                              : format == "binary_big_endian" ? Encoding::big
                                                              : Encoding::little;
        } else if (word == "comment" || word == "obj_info") {
            header.comments.push_back(line.substr(std::min(line.size(), word.size() + 1)));
        } else if (word == "element") {
            add_element_line(header, words, file);
        } else if (word == "property") {
            add_property_line(header, words, file);
        } else if (word == "end_header") {
            if (!has_format) damaged(file, "has a damaged header");
            header.bytes = begin;
            return header;
        } else if (word != "ply") {
            damaged(file, "has a damaged header");
        }
    }
    damaged(file, "has no end of its header");
}

std::size_t read_count(Reader& reader, Type type, const fs::path& file) {
    const double count = reader.next(type);
    if (!(count >= 0) || count > 1000 || count != std::floor(count))
        damaged(file, "has a face with a senseless number of corners");
    return static_cast<std::size_t>(count);
}

void read_row(Reader& reader, const Element& element, Ply& ply, const fs::path& file) {
    std::size_t column = 0, ends = 0;
    std::array<std::int64_t, 2> edge{};
    for (const Property& property : element.properties) {
        if (!property.count_type) {
            const double value = reader.next(property.type);
            if (element.name == "edge" && (property.name == "vertex1" || property.name == "vertex2")) {
                if (!(value >= 0) || value >= static_cast<double>(ply.vertices) || value != std::floor(value))
                    damaged(file, "has an edge with an end that does not exist");
                edge[property.name == "vertex1" ? 0 : 1] = static_cast<std::int64_t>(value);
                ++ends;
            }
            if (element.name == "vertex") ply.columns[column++].values.push_back(value);
            continue;
        }
        std::vector<std::int64_t> list(read_count(reader, *property.count_type, file));
        const bool corners =
            element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index");
        for (auto& item : list) {
            const double value = reader.next(property.type);
            if (corners && (!(value >= 0) || value >= static_cast<double>(ply.vertices)))
                damaged(file, "has a face with a corner that does not exist");
            item = corners ? static_cast<std::int64_t>(value) : 0;
        }
        if (corners) ply.faces.push_back(std::move(list));
    }
    if (ends == edge.size()) ply.edges.push_back(edge);
}

/// Of text a digit for each number; of a list its count at least.
std::size_t least_bytes_of_row(const Element& element, Encoding encoding) {
    std::size_t bytes = 0;
    for (const Property& p : element.properties)
        bytes += encoding == Encoding::ascii ? 1 : kBytes[static_cast<std::size_t>(p.count_type.value_or(p.type))];
    return std::max<std::size_t>(bytes, 1);
}

}  // namespace

const std::vector<double>* Ply::column(std::string_view name) const {
    for (const PlyColumn& c : columns)
        if (c.name == name) return &c.values;
    return nullptr;
}

bool Ply::says(std::string_view words) const {
    return std::any_of(comments.begin(), comments.end(),
                       [&](const std::string& c) { return c.find(words) != std::string::npos; });
}

Ply parse_ply(std::string_view content, const fs::path& file) {
    Header header = parse_header(content, file);
    Ply ply;
    ply.comments = std::move(header.comments);
    Reader reader(content.substr(header.bytes), header.encoding, file);
    for (const Element& element : header.elements) {
        if (element.count > 0 && element.properties.empty()) damaged(file, "has a damaged header");
        if (element.count > 0 && element.count > reader.left() / least_bytes_of_row(element, header.encoding))
            damaged(file, "is cut short");
        if (element.name == "vertex") {
            ply.vertices = element.count;
            for (const Property& p : element.properties)
                if (!p.count_type) ply.columns.push_back({p.name, {}});
            for (auto& c : ply.columns) c.values.reserve(element.count);
        }
        for (std::size_t row = 0; row < element.count; ++row) read_row(reader, element, ply, file);
    }
    if (header.encoding == Encoding::ascii ? !reader.only_space_left() : reader.left() != 0)
        damaged(file, "goes on after its last row");
    return ply;
}

}  // namespace planlight
