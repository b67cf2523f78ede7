#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "projection/monitor/picture_painter.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace planlight {
namespace {

constexpr int kAttempts = 3;  ///< at a picture that does not read back

const char* const kVertexShader =
    "#version 330 core\n"
    "void main() {\n"
    "  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
    "  gl_Position = vec4(corner, 0.0, 1.0);\n"
    "}\n";

// One texel per pixel without any sampler; the picture's first row is the top one, GL counts from the bottom.
const char* const kFragmentShader =
    "#version 330 core\n"
    "uniform sampler2D picture;\n"
    "out vec4 light;\n"
    "void main() {\n"
    "  ivec2 pixel = ivec2(gl_FragCoord.xy);\n"
    "  pixel.y = textureSize(picture, 0).y - 1 - pixel.y;\n"
    "  light = vec4(texelFetch(picture, pixel, 0).rgb, 1.0);\n"
    "}\n";

GLuint compile(GLenum kind, const char* source) {
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    return shader;
}

}  // namespace

PicturePainter::PicturePainter(GLFWwindow* window, int width, int height)
    : window_(window), width_(width), height_(height) {
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glViewport(0, 0, width_, height_);
    glDisable(GL_DITHER);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    GLuint vertices = 0, texture = 0;
    glGenVertexArrays(1, &vertices);
    glBindVertexArray(vertices);
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    const GLuint program = glCreateProgram();
    glAttachShader(program, compile(GL_VERTEX_SHADER, kVertexShader));
    glAttachShader(program, compile(GL_FRAGMENT_SHADER, kFragmentShader));
    glLinkProgram(program);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked == 0) throw std::runtime_error("the graphics driver refused the picture's shader");
    glUseProgram(program);
}

PicturePainter::~PicturePainter() {
    glfwMakeContextCurrent(nullptr);
}

void PicturePainter::draw(const RgbImage& picture, bool read_back) {
    glfwGetError(nullptr);  // what was complained of before
    std::vector<Place> lit_now = lit_places(picture);
    bool drawn = false;
    for (int attempt = 0; attempt < kAttempts && !drawn; ++attempt) {
        const bool answers = !read_back || draws_a_canary();
        put(picture);
        const GLenum error = glGetError();
        if (error != GL_NO_ERROR) glClear(GL_COLOR_BUFFER_BIT);  // black first, then the report
        drawn = error == GL_NO_ERROR && answers && (!read_back || is_in_buffer(picture, lit_now));
        glfwSwapBuffers(window_);
        glFinish();
        if (error != GL_NO_ERROR)
            throw std::runtime_error("the graphics driver reports error " + std::to_string(error));
    }
    if (!drawn) throw std::runtime_error("the graphics driver does not draw what it is told any more");
    lit_before_ = std::move(lit_now);
    const char* complaint = nullptr;
    if (glfwGetError(&complaint) != GLFW_NO_ERROR)
        throw std::runtime_error(std::string("its picture was not shown: ") + complaint);
}

void PicturePainter::try_black() noexcept {
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glfwSwapBuffers(window_);
    glFinish();
}

/// Where a picture is told from black: at the first and the last pixel that is lit. Empty where none is.
std::vector<PicturePainter::Place> PicturePainter::lit_places(const RgbImage& picture) {
    const auto& pixels = picture.pixels;
    const auto lit = [](const Rgb& pixel) { return pixel != Rgb{}; };
    const auto first = std::find_if(pixels.begin(), pixels.end(), lit);
    if (first == pixels.end()) return {};
    const auto last = std::find_if(pixels.rbegin(), pixels.rend(), lit).base() - 1;
    std::vector<Place> places;
    for (const auto found : {first, last}) {
        const auto index = static_cast<int>(found - pixels.begin());
        places.push_back({index % picture.width, index / picture.width});
    }
    return places;
}

void PicturePainter::put(const RgbImage& picture) const {
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    if (picture.empty()) return;
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture.width, picture.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                 picture.pixels.data());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

/// What is in the window's buffer at a place, against what should be. A read that fails leaves the values that were
/// there before.
bool PicturePainter::reads_back(Place place, const Rgb& expected) const {
    constexpr int kRounding = 8;  // screens of 16 bits a pixel
    std::uint8_t read[4] = {};
    for (std::size_t channel = 0; channel < 3; ++channel)
        read[channel] = static_cast<std::uint8_t>(expected[channel] ^ 0x80);
    glReadPixels(place.x, height_ - 1 - place.y, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, read);
    for (std::size_t channel = 0; channel < 3; ++channel)
        if (std::abs(int{read[channel]} - int{expected[channel]}) > kRounding) return false;
    return true;
}

/// A pixel of a colour that was not there before, into the buffer that is not seen yet: black that is read back could
/// be that of a read that never came.
bool PicturePainter::draws_a_canary() {
    canary_ = static_cast<std::uint8_t>(canary_ > 200 ? 60 : canary_ + 20);
    const Rgb colour{canary_, static_cast<std::uint8_t>(255 - canary_), 90};
    glClearColor(static_cast<float>(colour[0]) / 255, static_cast<float>(colour[1]) / 255,
                 static_cast<float>(colour[2]) / 255, 1);
    glScissor(width_ / 2, height_ - 1 - height_ / 2, 1, 1);
    glEnable(GL_SCISSOR_TEST);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
    return reads_back({width_ / 2, height_ / 2}, colour);
}

/// At its own lit places, and at those of the picture before.
bool PicturePainter::is_in_buffer(const RgbImage& picture, const std::vector<Place>& lit_now) const {
    const auto as_told = [&](Place at) { return reads_back(at, picture.empty() ? Rgb{} : picture.at(at.x, at.y)); };
    return as_told({width_ / 2, height_ / 2}) && std::all_of(lit_before_.begin(), lit_before_.end(), as_told) &&
           std::all_of(lit_now.begin(), lit_now.end(), as_told);
}

}  // namespace planlight
