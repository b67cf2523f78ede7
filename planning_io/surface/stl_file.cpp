#include <cstring>
#include <sstream>

#include "planning_io/surface/mesh_text.h"
#include "planning_io/surface/shape_file.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

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
        refuse_damaged(file, "announces " + std::to_string(count) + " triangles and is " +
                                 std::to_string(content.size()) + " bytes long");
    Shape shape;
    shape.space = space_of_mesh(content.substr(0, kHeaderBytes), file);
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
    std::string titles;
    bool ended = false;
    std::istringstream lines(content);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "solid") {
            titles += line + '\n';
            ended = false;
        } else if (word == "vertex") {
            corners.push_back(parse_point(words, file));
        } else if (word == "endloop") {
            if (corners.size() != 3)
                refuse_damaged(file, "has a facet of " + std::to_string(corners.size()) + " corners");
            add_triangle(shape, {corners[0], corners[1], corners[2]});
            corners.clear();
        } else if (word == "endsolid") {
            ended = true;
        }
    }
    if (!ended || !corners.empty()) refuse_damaged(file, "is cut short");
    shape.space = space_of_mesh(titles, file);
    return shape;
}

}  // namespace

Shape parse_stl(const std::string& content, const fs::path& file) {
    const bool fits_binary = content.size() == kHeaderBytes + 4 + kTriangleBytes * binary_triangles(content);
    const bool ascii = !fits_binary && content.starts_with("solid") && content.find("facet") != std::string::npos;
    return ascii ? parse_ascii_stl(content, file) : parse_binary_stl(content, file);
}

}  // namespace planlight
