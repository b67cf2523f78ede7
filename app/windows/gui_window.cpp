#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "app/windows/gui_window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "app/windows/layout.h"
#include "app/windows/status_word.h"
#include "app/windows/x11_window_state.h"
#include "planning_io/types/error.h"
#include "projection/monitor/glfw_session.h"
#include "projection/monitor/monitors_kept_on.h"
#include "projection/monitor/projector_window.h"

namespace planlight {
namespace {

constexpr int kLeastLong = 800, kLeastShort = 600;  // sides of a window, upright or on end
constexpr int kFramesAfterInput = 3;  ///< until Dear ImGui has settled: what is under the mouse is known a frame later

Monitor monitor_for(const WindowSettings& settings) {
    const std::vector<Monitor> monitors = list_monitors();
    for (std::size_t i = 0; i < monitors.size(); ++i)
        if (settings.monitor ? monitors[i].name == *settings.monitor || std::to_string(i) == *settings.monitor
                             : monitors[i].primary)
            return monitors[i];
    if (settings.monitor || monitors.empty())
        throw DeviceError("Operator window", "there is no monitor \"" + settings.monitor.value_or("primary") + "\"",
                          "Name one of those that `planlight projector --identify` shows.");
    return monitors.front();
}

/// A window with an OpenGL 3.3 context on the monitor that is asked for, shown.
GLFWwindow* open_window(const WindowSettings& settings) {
    const Monitor monitor = monitor_for(settings);
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_DECORATED, settings.fill_monitor ? GLFW_FALSE : GLFW_TRUE);
    const bool on_end = monitor.height > monitor.width || settings.height > settings.width;
    const auto [shorter, longer] = std::minmax(settings.width, settings.height);
    const int wanted_width = on_end ? shorter : longer, wanted_height = on_end ? longer : shorter;
    const int least_width = on_end ? kLeastShort : kLeastLong, least_height = on_end ? kLeastLong : kLeastShort;
    const int width =
        settings.fill_monitor ? monitor.width : std::max(std::min(wanted_width, monitor.width), least_width);
    const int height =
        settings.fill_monitor ? monitor.height : std::max(std::min(wanted_height, monitor.height), least_height);
    GLFWwindow* const window = glfwCreateWindow(width, height, settings.title.c_str(), nullptr, nullptr);
    if (window == nullptr)
        throw DeviceError("Operator window", "it could not be opened (" + last_window_error() + ")",
                          "Install an OpenGL 3.3 driver, or set LIBGL_ALWAYS_SOFTWARE=1.");
    glfwSetWindowPos(window, monitor.x + std::max(0, (monitor.width - width) / 2),
                     monitor.y + std::max(0, (monitor.height - height) / 2));
    glfwShowWindow(window);
    glfwSetWindowSizeLimits(window, least_width, least_height, GLFW_DONT_CARE, GLFW_DONT_CARE);
    return window;
}

/// GLFW names keys by their place on an American keyboard; here by what stands on them, where that is a Latin letter:
/// a German Z lies where an American Y is.
int key_by_label(int key, int scan_code) {
    const char* const label = glfwGetKeyName(key, scan_code);
    if (label == nullptr || label[0] == '\0' || label[1] != '\0') return key;
    if (label[0] >= 'a' && label[0] <= 'z') return GLFW_KEY_A + (label[0] - 'a');
    return label[0] >= 'A' && label[0] <= 'Z' ? GLFW_KEY_A + (label[0] - 'A') : key;
}

}  // namespace

struct GuiWindow::Parts {
    std::shared_ptr<void> session = glfw_session();
    const MonitorsKeptOn kept_on;
    FontFiles font_files = find_fonts();
    WindowListener listener;
    GLFWwindow* window = nullptr;
    ImGuiContext* gui = nullptr;
    Pen pen{};
    std::shared_ptr<const Words> words;
    FontLetters letters;
    std::set<unsigned> lacking, hopeless;  ///< letters: to be loaded, and those that no font has
    int to_settle = kFramesAfterInput;     ///< frames

    Parts(const WindowSettings& settings, WindowListener told)
        : listener(std::move(told)), window(open_window(settings)), words(settings.words) {
        pen.words = words.get();
        pen.theme = &theme_of(settings.theme);
        pen.lacking = &lacking;
        if (words) letters.text = words->letters();
        for (int kind = 0; words && kind <= static_cast<int>(StatusKind::waiting); ++kind)
            letters.word += words->say(status_word(static_cast<StatusKind>(kind)));
        for (const std::string& word : settings.large_words) letters.word += words ? words->say(word) : word;
        glfwMakeContextCurrent(window);
        glfwSwapInterval(0);  // the loop that follows the patient must not wait for this screen
        listen();             // before Dear ImGui, which calls these and its own
        gui = ImGui::CreateContext();
        ImGui::SetCurrentContext(gui);
        ImGui::GetIO().IniFilename = nullptr;
        ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
        ImGui_ImplGlfw_InitForOpenGL(window, true);
        ImGui_ImplOpenGL3_Init("#version 330 core");
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    ~Parts() {
        make_current();
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext(gui);
        glfwDestroyWindow(window);
    }

    void make_current() {
        glfwMakeContextCurrent(window);
        ImGui::SetCurrentContext(gui);
    }

    static Parts& of(GLFWwindow* w) { return *static_cast<Parts*>(glfwGetWindowUserPointer(w)); }

    void listen() {
        glfwSetWindowUserPointer(window, this);
        glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int scan_code, int action, int modifiers) {
            of(w).to_settle = kFramesAfterInput;
            if (action == GLFW_PRESS && of(w).listener.key) of(w).listener.key(key_by_label(key, scan_code), modifiers);
            if (action == GLFW_REPEAT && of(w).listener.key_held) of(w).listener.key_held(key_by_label(key, scan_code));
        });
        glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int action, int) {
            of(w).to_settle = kFramesAfterInput;
            double x = 0, y = 0;
            glfwGetCursorPos(w, &x, &y);
            if (action == GLFW_PRESS && of(w).listener.mouse_pressed) of(w).listener.mouse_pressed(x, y);
        });
        glfwSetCursorPosCallback(window, [](GLFWwindow* w, double, double) { of(w).to_settle = kFramesAfterInput; });
        glfwSetScrollCallback(window, [](GLFWwindow* w, double, double) { of(w).to_settle = kFramesAfterInput; });
        glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w).to_settle = kFramesAfterInput; });
        glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { of(w).to_settle = kFramesAfterInput; });
        glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int) { of(w).to_settle = kFramesAfterInput; });
    }

    /// Letters that were to be drawn and are not loaded: a name in another script. True when there are new ones.
    bool take_lacking() {
        bool more = false;
        for (const unsigned code : std::exchange(lacking, {})) {
            if (!hopeless.insert(code).second) continue;  // it was asked for once, and is not there
            letters.text += utf8_of(code);
            more = true;
        }
        if (more) to_settle = kFramesAfterInput;
        return more;
    }

    void fit_to(int width, int height) {
        const float scale = layout_of(width, height).scale;
        const bool more = take_lacking();
        if (pen.scale == scale && pen.fonts.body != nullptr && !more) return;
        ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
        atlas.Clear();
        pen.fonts = load_fonts(atlas, font_files, scale, letters);
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
        pen.scale = scale;
    }

    void draw_over_all(const Draw& draw) {
        const ImVec2 size = ImGui::GetIO().DisplaySize;
        ImGui::SetNextWindowPos({0, 0});
        ImGui::SetNextWindowSize(size);
        ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
        ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0F);
        ImGui::Begin("all", nullptr,
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                         ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoBringToFrontOnFocus);
        pen.list = ImGui::GetWindowDrawList();
        draw(pen, size.x, size.y);
        ImGui::End();
        ImGui::PopStyleVar(2);
    }

    void paint() {
        int width = 0, height = 0;
        glfwGetFramebufferSize(window, &width, &height);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glViewport(0, 0, width, height);
        glDisable(GL_SCISSOR_TEST);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        const ImVec4 behind = ImGui::ColorConvertU32ToFloat4(pen.theme->background);
        glClearColor(behind.x, behind.y, behind.z, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    }
};

GuiWindow::GuiWindow(const WindowSettings& settings, WindowListener listener)
    : parts_(std::make_unique<Parts>(settings, std::move(listener))) {}
GuiWindow::~GuiWindow() = default;

void GuiWindow::take_input(double longest_s) {
    make_current();
    if (longest_s > 0)
        glfwWaitEventsTimeout(longest_s);
    else
        glfwPollEvents();
}

bool GuiWindow::touched() const {
    return parts_->to_settle > 0;
}

void GuiWindow::frame(const Draw& draw) {
    make_current();
    if (parts_->to_settle > 0) --parts_->to_settle;
    int width = 0, height = 0;
    glfwGetFramebufferSize(parts_->window, &width, &height);
    if (width <= 0 || height <= 0) return;
    parts_->fit_to(width, height);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    parts_->draw_over_all(draw);
    ImGui::Render();
    parts_->paint();
    glfwSwapBuffers(parts_->window);
}

void GuiWindow::forget_presses() {
    make_current();
    if (!ImGui::GetIO().Fonts->IsBuilt()) return;  // nothing was drawn yet that could be pressed
    // A frame without a button: Dear ImGui takes the presses that wait, and lets go of the button that is held.
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    ImGui::EndFrame();
    parts_->to_settle = kFramesAfterInput;
}

RgbImage GuiWindow::screenshot() {
    make_current();
    int width = 0, height = 0;
    glfwGetFramebufferSize(parts_->window, &width, &height);
    if (ImGui::GetDrawData() == nullptr) return RgbImage(width, height);
    parts_->paint();
    RgbImage upside_down(width, height), picture(width, height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadBuffer(GL_BACK);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, upside_down.pixels.data());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) picture.at(x, y) = upside_down.at(x, height - 1 - y);
    return picture;
}

void GuiWindow::make_current() {
    parts_->make_current();
}

bool GuiWindow::asked_to_close() const {
    return glfwWindowShouldClose(parts_->window) == GLFW_TRUE;
}

bool GuiWindow::put_away() const {
    return glfwGetWindowAttrib(parts_->window, GLFW_ICONIFIED) == GLFW_TRUE || on_other_workspace(parts_->window);
}

bool GuiWindow::keyboard_is_elsewhere() const {
    return planlight::keyboard_is_elsewhere(parts_->window);
}

void GuiWindow::keep_open() {
    glfwSetWindowShouldClose(parts_->window, GLFW_FALSE);
}

const FontFiles& GuiWindow::font_files() const {
    return parts_->font_files;
}

}  // namespace planlight
