#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "app/windows/guide_window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "app/windows/camera_texture.h"
#include "app/windows/guide_panels.h"
#include "app/windows/open_window.h"
#include "app/windows/panels.h"
#include "projection/glfw_session.h"

namespace planlight {

struct GuideWindow::Parts {
    std::shared_ptr<void> session = glfw_session();
    FontFiles font_files = find_fonts();
    GLFWwindow* window = nullptr;
    ImGuiContext* gui = nullptr;
    CameraTexture left, right;
    Pen pen{};
    GuideAction pressed = GuideAction::none;

    explicit Parts(const OperatorWindowSettings& settings) : window(open_window(settings)) {
        glfwMakeContextCurrent(window);
        glfwSwapInterval(0);
        glfwSetWindowUserPointer(window, this);
        glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
            if (action != GLFW_PRESS) return;
            GuideAction& wanted = static_cast<Parts*>(glfwGetWindowUserPointer(w))->pressed;
            if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER) wanted = GuideAction::keep;
            if (key == GLFW_KEY_DELETE) wanted = GuideAction::discard;
            if (key == GLFW_KEY_ESCAPE) wanted = GuideAction::quit;
        });
        gui = ImGui::CreateContext();
        ImGui::SetCurrentContext(gui);
        ImGui::GetIO().IniFilename = nullptr;
        ImGui_ImplGlfw_InitForOpenGL(window, true);
        ImGui_ImplOpenGL3_Init("#version 330 core");
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    ~Parts() {
        glfwMakeContextCurrent(window);
        ImGui::SetCurrentContext(gui);
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext(gui);
        left.release();
        right.release();
        glfwDestroyWindow(window);
    }

    void fit_to(int width, int height) {
        const float scale = layout_of(width, height).scale;
        if (pen.scale == scale && pen.fonts.body != nullptr) return;
        ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
        atlas.Clear();
        pen.fonts = load_fonts(atlas, font_files, scale);
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
        pen.scale = scale;
    }

    GuideAction draw_buttons(const Box& box, const GuideModel& model) {
        const float gap = 16 * pen.scale, width = (box.width - gap) / 2;
        const ButtonState free{!model.result.empty(), "when it is finished"};
        GuideAction wanted = GuideAction::none;
        if (button(pen, {box.x, box.y, width, box.height}, "Keep", free)) wanted = GuideAction::keep;
        if (button(pen, {box.x + width + gap, box.y, width, box.height}, "Discard", free))
            wanted = GuideAction::discard;
        return wanted;
    }

    GuideAction draw(const GuideModel& model, float w, float h) {
        ImGui::SetNextWindowPos({0, 0});
        ImGui::SetNextWindowSize({w, h});
        ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
        ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0F);
        ImGui::Begin("all", nullptr,
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                         ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoBringToFrontOnFocus);
        pen.list = ImGui::GetWindowDrawList();
        const float s = pen.scale, gap = 16 * s, title = 64 * s, banner = std::max(152.0F, 196 * s);
        pen.line(pen.fonts.title, model.title, gap + 8 * s, gap + 14 * s, 0.6F * w, theme::kText);
        pen.line(pen.fonts.small, model.subtitle, gap + 8 * s, gap + 42 * s, 0.9F * w, theme::kQuiet);
        const float top = gap + title, bottom = h - gap - banner - gap, column = std::max(420.0F, 0.28F * w);
        const float cameras = w - 3 * gap - column, camera_width = (cameras - gap) / 2;
        const float below = (model.result.empty() ? 240 : 430) * s;  // the result has more words
        const float camera_height = std::min(bottom - top - below, 0.8F * camera_width);
        const auto texture = [](unsigned name) {
            return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(name));
        };
        draw_guide_camera(pen, {gap, top, camera_width, camera_height}, model.left,
                          texture(left.take(model.left.picture)));
        draw_guide_camera(pen, {2 * gap + camera_width, top, camera_width, camera_height}, model.right,
                          texture(right.take(model.right.picture)));
        const float low = top + camera_height + gap, small = std::min((bottom - low) * 1.5F, 0.4F * cameras);
        draw_guide_cells(pen, {gap, low, small, bottom - low}, "In the projector's light", model.projector);
        draw_guide_progress(pen, {2 * gap + small, low, cameras - small - gap, bottom - low}, model);
        const float x = w - gap - column, depth = 110 * s, buttons = std::max(76.0F, 84 * s);
        draw_guide_tilts(pen, {x, top, column, bottom - top - depth - buttons - 2 * gap}, model);
        draw_guide_depths(pen, {x, bottom - depth - buttons - gap, column, depth}, model);
        const GuideAction wanted = draw_buttons({x, bottom - buttons, column, buttons}, model);
        draw_guide_banner(pen, {gap, h - gap - banner, w - 2 * gap, banner}, model);
        ImGui::End();
        ImGui::PopStyleVar(2);
        return wanted;
    }

    void paint() {
        int width = 0, height = 0;
        glfwGetFramebufferSize(window, &width, &height);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glViewport(0, 0, width, height);
        glDisable(GL_SCISSOR_TEST);
        glClearColor(11 / 255.0F, 13 / 255.0F, 17 / 255.0F, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    }
};

GuideWindow::GuideWindow(const OperatorWindowSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}
GuideWindow::~GuideWindow() = default;

GuideAction GuideWindow::frame(const GuideModel& model) {
    Parts& parts = *parts_;
    glfwMakeContextCurrent(parts.window);
    ImGui::SetCurrentContext(parts.gui);
    glfwPollEvents();
    int width = 0, height = 0;
    glfwGetFramebufferSize(parts.window, &width, &height);
    GuideAction wanted = GuideAction::none;
    if (width > 0 && height > 0) {
        parts.fit_to(width, height);
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        wanted = parts.draw(model, static_cast<float>(width), static_cast<float>(height));
        ImGui::Render();
        parts.paint();
        glfwSwapBuffers(parts.window);
    }
    const GuideAction pressed = std::exchange(parts.pressed, GuideAction::none);
    if (glfwWindowShouldClose(parts.window) == GLFW_TRUE) return GuideAction::quit;
    if (pressed == GuideAction::quit || !model.result.empty()) return pressed == GuideAction::none ? wanted : pressed;
    return wanted;
}

RgbImage GuideWindow::screenshot() {
    Parts& parts = *parts_;
    glfwMakeContextCurrent(parts.window);
    ImGui::SetCurrentContext(parts.gui);
    int width = 0, height = 0;
    glfwGetFramebufferSize(parts.window, &width, &height);
    if (ImGui::GetDrawData() == nullptr) return RgbImage(width, height);
    parts.paint();
    return read_window(width, height);
}

}  // namespace planlight
