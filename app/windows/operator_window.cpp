#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "app/windows/operator_window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "app/windows/camera_texture.h"
#include "app/windows/middle_view.h"
#include "app/windows/open_window.h"
#include "app/windows/panels.h"
#include "projection/glfw_session.h"

namespace planlight {
namespace {

std::array<int, 4> whole_pixels(const Box& box) {
    return {static_cast<int>(box.x), static_cast<int>(box.y), static_cast<int>(box.width),
            static_cast<int>(box.height)};
}

bool inside(const Box& box, double x, double y) {
    return x >= box.x && x < box.right() && y >= box.y && y < box.bottom();
}

}  // namespace

struct OperatorWindow::Parts {
    std::shared_ptr<void> session = glfw_session();
    FontFiles font_files = find_fonts();
    GLFWwindow* window = nullptr;
    ImGuiContext* gui = nullptr;
    std::unique_ptr<MiddleView> middle;
    CameraTexture left, right;
    Pen pen{};
    WindowLayout place;
    bool dark_pressed = false;
    float rows_scrolled = 0;
    int rows_shown = 1;
    std::map<OperatorAction, Box> controls;

    explicit Parts(const OperatorWindowSettings& settings) : window(open_window(settings)) {
        glfwMakeContextCurrent(window);
        glfwSwapInterval(0);  // the loop that follows the patient must not wait for this screen
        listen();
        middle = std::make_unique<MiddleView>(font_files, [w = window] { glfwMakeContextCurrent(w); });
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
        glfwMakeContextCurrent(window);
        ImGui::SetCurrentContext(gui);
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext(gui);
        left.release();
        right.release();
        middle.reset();
        glfwDestroyWindow(window);
    }

    /// DARK is taken from the events themselves, so that a press shorter than a frame is not lost.
    void listen() {
        glfwSetWindowUserPointer(window, this);
        glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
            if (action == GLFW_PRESS && (key == GLFW_KEY_SPACE || key == GLFW_KEY_B || key == GLFW_KEY_ESCAPE))
                static_cast<Parts*>(glfwGetWindowUserPointer(w))->dark_pressed = true;
        });
        glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int action, int) {
            Parts& parts = *static_cast<Parts*>(glfwGetWindowUserPointer(w));
            double x = 0, y = 0;
            glfwGetCursorPos(w, &x, &y);
            if (action == GLFW_PRESS && inside(parts.place.dark, x, y)) parts.dark_pressed = true;
        });
    }

    void fit_to(int width, int height) {
        place = layout_of(width, height);
        if (pen.scale == place.scale && pen.fonts.body != nullptr) return;
        ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
        atlas.Clear();
        pen.fonts = load_fonts(atlas, font_files, place.scale);
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
        pen.scale = place.scale;
    }

    OperatorAction draw_buttons(const OperatorModel& model) {
        const std::array<std::tuple<OperatorAction, const char*, const ButtonState*>, 4> row{
            {{OperatorAction::scan, "Scan", &model.scan},
             {OperatorAction::do_register, "Register", &model.do_register},
             {OperatorAction::track, "Track", &model.track},
             {OperatorAction::stop, "Stop", &model.stop}}};
        const float gap = place.gap, width = (place.buttons.width - 3 * gap) / 4;
        OperatorAction wanted = OperatorAction::none;
        Box box = place.buttons;
        box.width = width;
        for (const auto& [action, label, state] : row) {
            controls[action] = box;
            if (button(pen, box, label, *state)) wanted = action;
            box.x += width + gap;
        }
        controls[OperatorAction::dark] = place.dark;
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        const bool hovered = inside(place.dark, mouse.x, mouse.y);
        draw_dark_button(pen, place.dark, hovered, hovered && ImGui::GetIO().MouseDown[0]);
        return wanted;
    }

    void draw_plan_table(const OperatorModel& model) {
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        const int spare = static_cast<int>(model.rows.size()) - rows_shown;
        if (inside(place.table, mouse.x, mouse.y)) rows_scrolled -= ImGui::GetIO().MouseWheel;
        rows_scrolled = std::clamp(rows_scrolled, 0.0F, static_cast<float>(std::max(0, spare)));
        const TableShown shown = draw_table(pen, place.table, model, static_cast<int>(rows_scrolled));
        rows_shown = shown.rows;
        if (!shown.all_evidence && inside(place.table, mouse.x, mouse.y)) {
            std::string all;
            for (const std::string& sentence : model.evidence) all += (all.empty() ? "" : "\n") + sentence;
            ImGui::SetTooltip("%s", all.c_str());
        }
    }

    OperatorAction draw(const OperatorModel& model) {
        const ImGuiIO& io = ImGui::GetIO();
        ImGui::SetNextWindowPos({0, 0});
        ImGui::SetNextWindowSize(io.DisplaySize);
        ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
        ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0F);
        ImGui::Begin("all", nullptr,
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                         ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoBringToFrontOnFocus);
        pen.list = ImGui::GetWindowDrawList();
        const auto texture = [](unsigned name) {
            return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(name));
        };
        draw_header(pen, place, model);
        const OperatorAction over_scene = middle->draw(pen, place.scene, model);
        draw_camera(pen, place.left_camera, model.left, texture(left.take(model.left.picture)));
        draw_camera(pen, place.right_camera, model.right, texture(right.take(model.right.picture)));
        draw_plan_table(model);
        const OperatorAction wanted = draw_buttons(model);
        draw_banner(pen, place.banner, model);
        ImGui::End();
        ImGui::PopStyleVar(2);
        return wanted == OperatorAction::none ? over_scene : wanted;
    }

    void paint() {
        int width = 0, height = 0;
        glfwGetFramebufferSize(window, &width, &height);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glViewport(0, 0, width, height);
        glDisable(GL_SCISSOR_TEST);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glClearColor(11 / 255.0F, 13 / 255.0F, 17 / 255.0F, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    }
};

OperatorWindow::OperatorWindow(const OperatorWindowSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}
OperatorWindow::~OperatorWindow() = default;

OperatorAction OperatorWindow::frame(const OperatorModel& model) {
    Parts& parts = *parts_;
    glfwMakeContextCurrent(parts.window);
    ImGui::SetCurrentContext(parts.gui);
    glfwPollEvents();
    int width = 0, height = 0;
    glfwGetFramebufferSize(parts.window, &width, &height);
    OperatorAction wanted = OperatorAction::none;
    if (width > 0 && height > 0) {
        parts.fit_to(width, height);
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        wanted = parts.draw(model);
        ImGui::Render();
        parts.paint();
        glfwSwapBuffers(parts.window);
    }
    if (std::exchange(parts.dark_pressed, false)) return OperatorAction::dark;
    if (glfwWindowShouldClose(parts.window) == GLFW_TRUE) return OperatorAction::quit;
    return wanted;
}

RgbImage OperatorWindow::screenshot() {
    Parts& parts = *parts_;
    glfwMakeContextCurrent(parts.window);
    ImGui::SetCurrentContext(parts.gui);
    int width = 0, height = 0;
    glfwGetFramebufferSize(parts.window, &width, &height);
    if (ImGui::GetDrawData() == nullptr) return RgbImage(width, height);
    parts.paint();
    return read_window(width, height);
}

SceneView OperatorWindow::view() const {
    return parts_->middle->scene().view();
}

void OperatorWindow::set_view(const SceneView& view) {
    parts_->middle->scene().set_view(view);
}

void OperatorWindow::open_landmarks(const std::vector<PointPair>& pairs) {
    glfwMakeContextCurrent(parts_->window);
    parts_->middle->open_landmarks().clicks().set_pairs(pairs);
}

std::vector<PointPair> OperatorWindow::landmarks() const {
    const LandmarkPanel* const panel = parts_->middle->landmarks();
    return panel ? panel->clicks().pairs() : std::vector<PointPair>{};
}

FitView OperatorWindow::fit_view() const {
    return parts_->middle->fit_view;
}

void OperatorWindow::set_fit_view(FitView view) {
    parts_->middle->fit_view = view;
}

std::array<int, 4> OperatorWindow::place_of(OperatorAction control) const {
    return whole_pixels(control == OperatorAction::confirm ? parts_->middle->place_of("confirm")
                                                           : parts_->controls[control]);
}

std::array<int, 4> OperatorWindow::place_of(const std::string& button) const {
    return whole_pixels(parts_->middle->place_of(button));
}

}  // namespace planlight
