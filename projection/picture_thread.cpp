#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "projection/picture_thread.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <vector>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr auto kToStart = std::chrono::seconds(5);
constexpr auto kHangs = std::chrono::milliseconds(500);     ///< a picture that is not drawn by then
constexpr int kAttempts = 3;                                ///< at a picture that does not read back
constexpr auto kExpiryPoll = std::chrono::milliseconds(3);  ///< the injected clock can only be asked, not waited for

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

struct Place {
    int x = 0, y = 0;  ///< the first row is the top one
};

/// Where a picture is told from black: at the first and the last pixel that is lit. Empty where none is.
std::vector<Place> lit_places(const RgbImage& picture) {
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

/// What is in the window's buffer at a place, against what should be. A read that fails leaves the values that were
/// there before.
bool reads_back(Place place, int height, const Rgb& expected) {
    constexpr int kRounding = 8;  // screens of 16 bits a pixel
    std::uint8_t read[4] = {};
    for (std::size_t channel = 0; channel < 3; ++channel) read[channel] = static_cast<std::uint8_t>(~expected[channel]);
    glReadPixels(place.x, height - 1 - place.y, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, read);
    for (std::size_t channel = 0; channel < 3; ++channel)
        if (std::abs(int{read[channel]} - int{expected[channel]}) > kRounding) return false;
    return true;
}

DeviceError failed(const std::string& problem) {
    return {"projector window", problem, "update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1"};
}

}  // namespace

/// The GL objects; lives on the thread.
struct PictureThread::Painter {
    Painter(GLFWwindow* w, int wide, int high) : window(w), width(wide), height(high) {
        glfwMakeContextCurrent(window);
        glfwSwapInterval(1);
        glViewport(0, 0, width, height);
        glDisable(GL_DITHER);
        glDisable(GL_FRAMEBUFFER_SRGB);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glGenVertexArrays(1, &vertices);
        glBindVertexArray(vertices);
        glGenTextures(1, &texture);
        glBindTexture(GL_TEXTURE_2D, texture);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        program = glCreateProgram();
        glAttachShader(program, compile(GL_VERTEX_SHADER, kVertexShader));
        glAttachShader(program, compile(GL_FRAGMENT_SHADER, kFragmentShader));
        glLinkProgram(program);
        GLint linked = 0;
        glGetProgramiv(program, GL_LINK_STATUS, &linked);
        if (linked == 0) throw std::runtime_error("the graphics driver refused the picture's shader");
        glUseProgram(program);
    }
    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;
    ~Painter() { glfwMakeContextCurrent(nullptr); }

    /// With `read_back` a picture, or black, that is not in the window's buffer afterwards is a failure: so a graphics
    /// driver that lost its context and quietly draws nothing is found, while what it drew last is still lit.
    void draw(const RgbImage& picture, bool read_back) {
        glfwGetError(nullptr);  // what was complained of before
        bool drawn = false;
        for (int attempt = 0; attempt < kAttempts && !drawn; ++attempt) {
            const bool answers = !read_back || draws_a_canary();
            put(picture);
            const GLenum error = glGetError();
            if (error != GL_NO_ERROR) glClear(GL_COLOR_BUFFER_BIT);  // black first, then the report
            drawn = error == GL_NO_ERROR && answers && (!read_back || is_in_buffer(picture));
            glfwSwapBuffers(window);
            glFinish();
            if (error != GL_NO_ERROR)
                throw std::runtime_error("the graphics driver reports error " + std::to_string(error));
        }
        if (!drawn) throw std::runtime_error("the graphics driver does not draw what it is told any more");
        lit_before = lit_places(picture);
        const char* complaint = nullptr;
        if (glfwGetError(&complaint) != GLFW_NO_ERROR)
            throw std::runtime_error(std::string("its picture was not shown: ") + complaint);
    }

    /// A pixel of a colour that was not there before, into the buffer that is not seen yet: black that is read back
    /// could be that of a read that never came.
    bool draws_a_canary() {
        canary = static_cast<std::uint8_t>(canary > 200 ? 60 : canary + 20);
        const Rgb colour{canary, static_cast<std::uint8_t>(255 - canary), 90};
        glClearColor(static_cast<float>(colour[0]) / 255, static_cast<float>(colour[1]) / 255,
                     static_cast<float>(colour[2]) / 255, 1);
        glScissor(width / 2, height - 1 - height / 2, 1, 1);
        glEnable(GL_SCISSOR_TEST);
        glClear(GL_COLOR_BUFFER_BIT);
        glDisable(GL_SCISSOR_TEST);
        return reads_back({width / 2, height / 2}, height, colour);
    }

    void put(const RgbImage& picture) const {
        glClearColor(0, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        if (picture.empty()) return;
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture.width, picture.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                     picture.pixels.data());
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

    /// At its own lit places, and at those of the picture before.
    bool is_in_buffer(const RgbImage& picture) const {
        const auto as_told = [&](Place at) {
            return reads_back(at, height, picture.empty() ? Rgb{} : picture.at(at.x, at.y));
        };
        const std::vector<Place> lit_now = lit_places(picture);
        return as_told({width / 2, height / 2}) && std::all_of(lit_before.begin(), lit_before.end(), as_told) &&
               std::all_of(lit_now.begin(), lit_now.end(), as_told);
    }

    /// The last that can be done once something has failed; whether it is seen nobody can tell.
    void try_black() noexcept {
        glClearColor(0, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        glfwSwapBuffers(window);
        glFinish();
    }

    GLFWwindow* window;
    int width, height;
    std::uint8_t canary = 0;
    std::vector<Place> lit_before;  ///< of the picture that was drawn last
    GLuint vertices = 0, texture = 0, program = 0;
};

PictureThread::PictureThread(GLFWwindow* window, int width, int height, const Clock& clock)
    : window_(window), width_(width), height_(height), clock_(clock) {
    wanted_ = 1;
    thread_ = std::thread([this] { run(); });
    std::unique_lock lock(mutex_);
    if (drawn_changed_.wait_for(lock, kToStart, [&] { return drawn_ >= 1 || !failure_.empty(); }) && failure_.empty())
        return;
    const std::string problem = failure_.empty() ? "the graphics driver does not answer" : failure_;
    stop_ = true;
    wanted_changed_.notify_all();
    lock.unlock();
    thread_.join();
    throw failed(problem);
}

PictureThread::~PictureThread() {
    go_dark();
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wanted_changed_.notify_all();
    thread_.join();
}

void PictureThread::show(const RgbImage& picture, Instant valid_until) {
    std::unique_lock lock(mutex_);
    picture_ = picture;
    valid_until_ = valid_until;
    lit_ = true;
    const std::uint64_t number = ++wanted_;
    wanted_changed_.notify_all();
    if (drawn_in_time(lock, number)) return;
    lit_ = false;
    picture_ = {};
    ++wanted_;
    wanted_changed_.notify_all();
    throw failed(failure_.empty() ? "the picture was not drawn within half a second" : failure_);
}

void PictureThread::go_dark() noexcept {
    std::unique_lock lock(mutex_);
    lit_ = false;
    picture_ = {};
    const std::uint64_t number = ++wanted_;
    wanted_changed_.notify_all();
    if (!drawn_in_time(lock, number) && failure_.empty()) failure_ = "black was not drawn within half a second";
}

void PictureThread::check() {
    const std::lock_guard lock(mutex_);
    if (!failure_.empty()) throw failed(failure_);
    const bool behind = wanted_ != drawn_ || (lit_ && clock_.now() >= valid_until_);
    if (!behind || (behind_since_ && behind_at_ != drawn_)) behind_since_.reset();
    if (!behind) return;
    const auto now = std::chrono::steady_clock::now();
    if (!behind_since_) {
        behind_since_ = now;
        behind_at_ = drawn_;
    }
    if (now - *behind_since_ < kHangs) return;
    failure_ = "the graphics driver does not answer any more";
    throw failed(failure_);
}

void PictureThread::redraw() {
    const std::lock_guard lock(mutex_);
    ++wanted_;
    wanted_changed_.notify_all();
}

void PictureThread::read_back(bool wanted) {
    const std::lock_guard lock(mutex_);
    read_back_ = wanted;
}

bool PictureThread::dark() const {
    const std::lock_guard lock(mutex_);
    return !lit_ || clock_.now() >= valid_until_;
}

bool PictureThread::drawn_in_time(std::unique_lock<std::mutex>& lock, std::uint64_t number) {
    return drawn_changed_.wait_for(lock, kHangs, [&] { return drawn_ >= number || !failure_.empty(); }) &&
           failure_.empty();
}

/// Waits for a request or for the expiry of what is lit, whichever comes first.
void PictureThread::wait_and_take(std::unique_lock<std::mutex>& lock) {
    while (!stop_ && wanted_ == drawn_) {
        if (lit_)
            wanted_changed_.wait_for(lock, kExpiryPoll);
        else
            wanted_changed_.wait(lock);
        if (lit_ && clock_.now() >= valid_until_) ++wanted_;
    }
    if (lit_ && clock_.now() >= valid_until_) lit_ = false;
    if (!lit_) picture_ = {};
}

void PictureThread::draw_what_is_wanted(Painter& painter) {
    std::unique_lock lock(mutex_);
    while (true) {
        wait_and_take(lock);
        if (stop_) break;
        const std::uint64_t number = wanted_;
        const RgbImage picture = picture_;
        const bool read_back = read_back_;
        lock.unlock();
        painter.draw(picture, read_back);
        lock.lock();
        drawn_ = number;
        drawn_changed_.notify_all();
    }
    lock.unlock();
    painter.draw({}, false);
}

void PictureThread::run() {
    const auto give_up = [this](const char* why) {
        const std::lock_guard lock(mutex_);
        lit_ = false;
        failure_ = why;
        drawn_changed_.notify_all();
    };
    try {
        Painter painter(window_, width_, height_);
        try {
            draw_what_is_wanted(painter);
        } catch (...) {
            painter.try_black();  // before all else: also where it failed before it drew anything
            throw;
        }
    } catch (const std::bad_alloc&) {
        give_up("there is no memory for its picture");
    } catch (const std::exception& error) {
        give_up(error.what());
    }
}

}  // namespace planlight
