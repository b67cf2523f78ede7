#include "write_picture.h"

#include <fstream>
#include <stdexcept>

namespace planlight::test {

void write_picture(const std::filesystem::path& file, const RgbImage& picture) {
    std::ofstream out(file, std::ios::binary);
    out << "P6\n" << picture.width << ' ' << picture.height << "\n255\n";
    out.write(reinterpret_cast<const char*>(picture.pixels.data()),
              static_cast<std::streamsize>(3 * picture.pixels.size()));
    if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

RgbImage read_picture(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string magic;
    int width = 0, height = 0, largest = 0;
    in >> magic >> width >> height >> largest;
    in.get();
    if (!in || magic != "P6" || largest != 255) throw std::runtime_error(file.string() + " is not an 8-bit PPM");
    RgbImage picture(width, height);
    in.read(reinterpret_cast<char*>(picture.pixels.data()), static_cast<std::streamsize>(3 * picture.pixels.size()));
    if (!in) throw std::runtime_error(file.string() + " ends early");
    return picture;
}

}  // namespace planlight::test
