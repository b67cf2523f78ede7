#include "tests/planning_io/mutate_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <random>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_import.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/surface/shape_file.h"
#include "planning_io/surface/surface_file.h"
#include "planning_io/types/error.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

struct Seed {
    std::string ending, content;
    std::size_t header;  ///< bytes in which most damage is done
};

template <class T>
std::string bytes_of(T value, bool big) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (big) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

/// Elements and columns that another program might write: a list among the vertex's columns, an element that is
/// unknown.
Seed odd_ply(bool big) {
    std::string content = fmt::format(
        "ply\nformat binary_{}_endian 1.0\ncomment SPACE=RAS\ncomment FRAME=rig\nobj_info made by hand\n"
        "element camera 1\nproperty double focal\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property list uchar short seen_by\nproperty float z\nproperty uchar flags\nelement face 2\n"
        "property list uchar int vertex_indices\nproperty uchar red\nend_header\n",
        big ? "big" : "little");
    content += bytes_of(3.5, big);
    for (int i = 0; i < 4; ++i) {
        content += bytes_of(60.0F * static_cast<float>(i % 2), big) + bytes_of(60.0F * static_cast<float>(i / 2), big);
        content += bytes_of(std::uint8_t{2}, big) + bytes_of(std::int16_t{1}, big) + bytes_of(std::int16_t{2}, big);
        content += bytes_of(1.0F, big) + bytes_of(std::uint8_t{1}, big);
    }
    for (const std::array<std::int32_t, 3>& t : {std::array{0, 1, 2}, std::array{1, 3, 2}}) {
        content += bytes_of(std::uint8_t{3}, big);
        for (const std::int32_t corner : t) content += bytes_of(corner, big);
        content += bytes_of(std::uint8_t{200}, big);
    }
    return {".ply", content, content.find("end_header")};
}

Seed text_ply(bool faces_first) {
    const std::string vertices =
                          "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
                          "property float ny\nproperty float nz\nproperty float sigma\n",
                      faces = "element face 2\nproperty list uchar int vertex_index\n",
                      rows = "0 0 0 0 0 1 .1\n60 0 0 0 0 1 .1\n60 60 0 0 0 1 .1\n0 60 0 0 0 1 .1\n",
                      corners = "3 0 1 2\n4 0 1 2 3\n";
    const std::string head = "ply\nformat ascii 1.0\ncomment SPACE=LPS FRAME=rig\n";
    return {".ply",
            faces_first ? head + faces + vertices + "end_header\n" + corners + rows
                        : head + vertices + faces + "end_header\n" + rows + corners,
            400};
}

std::string stl(bool text) {
    const TriangleMesh mesh = analytic_head_mesh(40);
    std::string content = text ? "solid SPACE=LPS\n" : std::string("SPACE=LPS").append(71, ' ');
    if (!text) content += bytes_of(static_cast<std::uint32_t>(mesh.triangles.size()), false);
    for (const auto& t : mesh.triangles) {
        if (text)
            content += "facet normal 0 0 1\nouter loop\n";
        else
            content.append(12, '\0');
        for (const std::int32_t corner : t) {
            const Eigen::Vector3f p = mesh.vertices_in_ct[static_cast<std::size_t>(corner)].cast<float>();
            if (text)
                content += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
            else
                for (int axis = 0; axis < 3; ++axis) content += bytes_of(p[axis], false);
        }
        if (text)
            content += "endloop\nendfacet\n";
        else
            content.append(2, '\0');
    }
    return text ? content + "endsolid\n" : content;
}

std::string obj() {
    const TriangleMesh mesh = analytic_head_mesh(40);
    std::string content = "# SPACE=LPS\no head\n";
    for (const auto& p : mesh.vertices_in_ct) content += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    for (const auto& t : mesh.triangles) content += fmt::format("f {}/1/1 {}//2 {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    return content + "g line\nl 1 2 3 -1\nf 1 2 3 4 5\n";
}

std::vector<Seed> seeds_in(const fs::path& folder) {
    std::vector<Seed> seeds{odd_ply(false), odd_ply(true), text_ply(false), text_ply(true)};
    TriangleMesh mesh = analytic_head_mesh(40);
    mesh.flags.assign(mesh.vertices_in_ct.size(), 1);
    mesh.thickness_mm.assign(mesh.vertices_in_ct.size(), 3.5F);
    write_mesh(mesh, folder / "mesh.ply");
    PointCloud cloud;
    for (int i = 0; i < 12; ++i) {
        cloud.points_in_rig.emplace_back(i, 2 * i, 3);
        cloud.sigma_mm.push_back(0.1F);
        cloud.pixels_in_projector.emplace_back(i, i);
    }
    write_cloud(cloud, folder / "cloud.ply", {{0, 1, 2}, {2, 3, 4}});
    for (const char* name : {"mesh.ply", "cloud.ply"}) seeds.push_back({".ply", read_whole(folder / name), 400});
    seeds.push_back({".stl", stl(true), 400});
    seeds.push_back({".stl", stl(false), 100});
    seeds.push_back({".obj", obj(), 400});
    seeds.push_back(
        {".vtk",
         "# vtk DataFile Version 3.0\nSPACE=LPS\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 60 0 0 60 60 "
         "0 60 60 60\nLINES 2 7\n2 0 1\n3 1 2 3\nPOLYGONS 1 5\n4 0 1 2 3\nCELL_DATA 3\nSCALARS a float\n"
         "LOOKUP_TABLE default\n1 2 3\n",
         300});
    seeds.push_back({".vtp",
                     "<VTKFile type=\"PolyData\" version=\"0.1\"><PolyData><FieldData><Array type=\"String\" "
                     "Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 0</Array></FieldData><Piece "
                     "NumberOfPoints=\"3\" NumberOfLines=\"1\"><Points><DataArray type=\"Float32\" "
                     "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 60 0 0 60 60 0</DataArray></Points><Lines>"
                     "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray><DataArray "
                     "type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Lines></Piece></PolyData>"
                     "</VTKFile>\n",
                     900});
    return seeds;
}

class Mutator {
public:
    explicit Mutator(unsigned seed) : random_(seed) {}

    std::string mutated(const Seed& seed) {
        std::string content = seed.content;
        for (std::size_t times = 1 + below(3); times > 0 && content.size() > 8; --times)
            below(2) == 0 ? change_bytes(content, seed.header) : change_lines(content, seed.header);
        return content;
    }

private:
    std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }
    std::size_t place(const std::string& content, std::size_t header) {
        return below(below(4) != 0 ? std::min(header, content.size()) : content.size());
    }

    void change_bytes(std::string& content, std::size_t header) {
        const std::size_t count = std::size_t{1} << below(6), at = place(content, header);
        switch (below(6)) {
            case 0:
                content[at] = static_cast<char>(content[at] ^ (1 << below(8)));
                break;
            case 1:
                for (std::size_t n = 0; n < count; ++n) content[place(content, header)] = static_cast<char>(below(256));
                break;
            case 2:
                content.resize(below(4) == 0 ? at : content.size() - below(8));
                break;
            case 3:
                content.erase(at, count);
                break;
            case 4:
                content.insert(at, content.substr(at, count));
                break;
            default:
                for (std::size_t n = 0; n < 4 && at + n < content.size(); ++n)
                    content[at + n] = static_cast<char>(below(2) ? 0xff : 0x7f);
        }
    }

    /// The line that `at` is in, with its end.
    static std::pair<std::size_t, std::size_t> line_at(const std::string& content, std::size_t at) {
        const auto before = content.rfind('\n', at), after = content.find('\n', at);
        const std::size_t begin = before == std::string::npos || before == at ? at : before + 1;
        return {begin, (after == std::string::npos ? content.size() : after + 1) - begin};
    }

    void change_lines(std::string& content, std::size_t header) {
        static const char* const kWords[] = {"nan",        "inf",  "-1", "1e308",      "99999999999999999999",
                                             "4294967295", "0",    "",   "2147483648", "list",
                                             "vertex",     "face", "x",  "double"};
        const auto [begin, length] = line_at(content, place(content, header));
        const std::string line = content.substr(begin, std::min<std::size_t>(length, 4096));
        switch (below(4)) {
            case 0:
                content.insert(begin, line);
                break;
            case 1:
                content.erase(begin, line.size());
                break;
            case 2:
                content.insert(line_at(content, place(content, header)).first, line);
                break;
            default: {  // a word of it
                const std::size_t at = begin + below(std::max<std::size_t>(line.size(), 1));
                const auto from = content.find_last_of(" \n", at), to = content.find_first_of(" \n", at);
                if (from == std::string::npos || to == std::string::npos || from >= to) return;
                content.replace(from + 1, to - from - 1, kWords[below(std::size(kWords))]);
            }
        }
    }

    std::mt19937 random_;
};

double processor_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

class Readings {
public:
    Readings(ShapeMutationCounts& counts, fs::path keep_in) : counts_(counts), keep_in_(std::move(keep_in)) {}

    void read(const char* reader, const fs::path& file, const std::function<void()>& reading) {
        ++counts_.readings;
        const double began = processor_s();
        try {
            reading();
            ++counts_.read;
            ++counts_.read_by_format[file.extension().string() + " " + reader];
        } catch (const Error& e) {
            ++(e.exit_code == ExitCode::file_damaged ? counts_.damaged : counts_.refused);
            counts_.child_crashes += std::string(e.what()).find("crash") != std::string::npos;
            if (e.remedy.empty()) fault(reader, file, "has no remedy");
        } catch (const std::exception& e) {
            fault(reader, file, e.what());
        }
        counts_.slowest_s = std::max(counts_.slowest_s, processor_s() - began);
    }

private:
    void fault(const char* reader, const fs::path& file, const std::string& what) {
        ++counts_.not_an_error;
        counts_.faults.push_back(fmt::format("{} of a {}: {}", reader, file.extension().string(), what));
        if (!keep_in_.empty())
            fs::copy_file(file, keep_in_ / fmt::format("fault-{}{}", counts_.not_an_error, file.extension().string()),
                          fs::copy_options::overwrite_existing);
    }
    ShapeMutationCounts& counts_;
    fs::path keep_in_;
};

}  // namespace

ShapeMutationCounts mutate_shapes(int files, unsigned seed, const fs::path& keep_in) {
    const TemporaryFolder folder;
    const auto seeds = seeds_in(folder.path());
    Mutator mutator(seed);
    ShapeMutationCounts counts;
    Readings readings(counts, keep_in);
    CloudOrigin in_rig;
    in_rig.in_rig = true;
    for (int n = 0; n < files; ++n) {
        const Seed& of = seeds[static_cast<std::size_t>(n) % seeds.size()];
        const fs::path file = folder.path() / ("a" + of.ending);
        std::ofstream(file, std::ios::binary | std::ios::trunc) << mutator.mutated(of);
        if (!keep_in.empty()) fs::copy_file(file, keep_in / ("last" + of.ending), fs::copy_options::overwrite_existing);
        ++counts.files;
        readings.read("read_shape", file, [&] { welded(read_shape(file)); });
        readings.read("read_surface", file, [&] { read_surface(file); });
        readings.read("import_plan", file, [&] { import_plan(file); });
        if (of.ending != ".ply") continue;
        readings.read("read_mesh", file, [&] { read_mesh(file); });
        readings.read("read_cloud", file, [&] { read_cloud(file, in_rig); });
    }
    return counts;
}

}  // namespace planlight::test
