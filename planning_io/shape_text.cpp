// STL and OBJ.
#include <charconv>
#include <cstring>
#include <sstream>

#include "planning_io/shape_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

[[noreturn]] void damaged(const fs::path& file, const std::string& problem) {
    throw DamagedFileError(file, problem, "Export or copy the file again.");
}

double number(std::string_view word, const fs::path& file) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size())
        damaged(file, "has \"" + std::string(word.substr(0, 20)) + "\" where a number must stand");
    return value;
}

Vector3d three_numbers(std::istringstream& words, const fs::path& file) {
    Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
        std::string word;
        words >> word;
        p[axis] = number(word, file);
    }
    return p;
}

void add_triangle(Shape& shape, const std::array<Vector3d, 3>& corners) {
    const auto first = static_cast<std::int32_t>(shape.points.size());
    shape.points.insert(shape.points.end(), corners.begin(), corners.end());
    shape.triangles.push_back({first, first + 1, first + 2});
}

constexpr std::size_t kHeaderBytes = 80, kTriangleBytes = 50;

std::size_t binary_triangles(const std::string& content) {
    std::uint32_t count = 0;
    if (content.size() >= kHeaderBytes + 4) std::memcpy(&count, content.data() + kHeaderBytes, 4);
    return count;
}

Shape parse_binary_stl(const std::string& content, const fs::path& file) {
    const std::size_t count = binary_triangles(content);
    if (content.size() != kHeaderBytes + 4 + kTriangleBytes * count)
        damaged(file,
                "announces " + std::to_string(count) + " triangles and is " + std::to_string(content.size()) + " bytes long");
    Shape shape;
    shape.space = space_marked(std::string_view(content).substr(0, kHeaderBytes), file);
    for (std::size_t t = 0; t < count; ++t) {
        std::array<float, 12> values{};
        std::memcpy(values.data(), content.data() + kHeaderBytes + 4 + kTriangleBytes * t, sizeof values);
        std::array<Vector3d, 3> corners;
        for (std::size_t c = 0; c < 3; ++c)
            corners[c] = Eigen::Vector3f(values[3 + 3 * c], values[4 + 3 * c], values[5 + 3 * c]).cast<double>();
        add_triangle(shape, corners);
    }
    return shape;
}

Shape parse_ascii_stl(const std::string& content, const fs::path& file) {
    Shape shape;
    std::vector<Vector3d> corners;
    bool ended = false;
    std::istringstream lines(content);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "solid") {
            if (const auto said = space_marked(line, file)) shape.space = said;
            ended = false;
        } else if (word == "vertex") {
            corners.push_back(three_numbers(words, file));
        } else if (word == "endloop") {
            if (corners.size() != 3) damaged(file, "has a facet of " + std::to_string(corners.size()) + " corners");
            add_triangle(shape, {corners[0], corners[1], corners[2]});
            corners.clear();
        } else if (word == "endsolid") {
            ended = true;
        }
    }
    if (!ended || !corners.empty()) damaged(file, "is cut short");
    return shape;
}

/// "7", "7/2/3" or "-1": a point, counted from 1 or from the last backwards.
std::int32_t obj_index(const std::string& word, std::size_t points, const fs::path& file) {
    const double given = number(std::string_view(word).substr(0, word.find('/')), file);
    const double index = given < 0 ? static_cast<double>(points) + given : given - 1;
    if (!(index >= 0) || index >= static_cast<double>(points) || index != static_cast<double>(static_cast<std::int32_t>(index)))
        damaged(file, "names the point " + word.substr(0, 20) + ", which does not exist");
    return static_cast<std::int32_t>(index);
}

}  // namespace

Shape parse_stl(const std::string& content, const fs::path& file) {
    const bool fits_binary = content.size() == kHeaderBytes + 4 + kTriangleBytes * binary_triangles(content);
    const bool ascii = !fits_binary && content.starts_with("solid") && content.find("facet") != std::string::npos;
    return ascii ? parse_ascii_stl(content, file) : parse_binary_stl(content, file);
}

Shape parse_obj(const std::string& content, const fs::path& file) {
    Shape shape;
    std::string comments, name;
    std::istringstream lines(content);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind.starts_with('#')) comments += line + '\n';
        if (kind == "o" || kind == "g") std::getline(words >> std::ws, name);
        if (!name.empty() && name.back() == '\r') name.pop_back();
        if (kind == "v") shape.points.push_back(three_numbers(words, file));
        if (kind != "l" && kind != "f") continue;
        std::vector<std::int32_t> points;
        for (std::string word; words >> word;) points.push_back(obj_index(word, shape.points.size(), file));
        if (kind == "l") shape.lines.push_back({std::move(points), {}, name, {}, {}, {}});
        else
            for (std::size_t c = 2; c < points.size(); ++c) shape.triangles.push_back({points[0], points[c - 1], points[c]});
    }
    shape.space = space_marked(comments, file);
    return shape;
}

}  // namespace planlight
