#include <sstream>

#include "planning_io/surface/mesh_text.h"
#include "planning_io/surface/shape_file.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// "7", "7/2/3" or "-1": a point, counted from 1 or from the last backwards.
std::int32_t obj_index(const std::string& word, std::size_t points, const fs::path& file) {
    const double given = parse_number(std::string_view(word).substr(0, word.find('/')), file);
    const double index = given < 0 ? static_cast<double>(points) + given : given - 1;
    if (!(index >= 0) || index >= static_cast<double>(points) ||
        index != static_cast<double>(static_cast<std::int32_t>(index)))
        refuse_damaged(file, "names the point " + word.substr(0, 20) + ", which does not exist");
    return static_cast<std::int32_t>(index);
}

}  // namespace

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
        if (kind == "v") shape.points.push_back(parse_point(words, file));
        if (kind != "l" && kind != "f") continue;
        std::vector<std::int32_t> points;
        for (std::string word; words >> word;) points.push_back(obj_index(word, shape.points.size(), file));
        if (kind == "l")
            shape.lines.push_back({std::move(points), {}, name, {}, {}, {}});
        else
            for (std::size_t c = 2; c < points.size(); ++c)
                shape.triangles.push_back({points[0], points[c - 1], points[c]});
    }
    shape.space = space_of_mesh(comments, file);
    return shape;
}

}  // namespace planlight
