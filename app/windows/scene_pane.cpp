#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "app/windows/scene_pane.h"

#include <GLFW/glfw3.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLState.h>
#include <vtkTextureObject.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "app/windows/render_target.h"

namespace planlight {

ScenePane::ScenePane(const FontFiles& fonts, std::function<void()> make_current)
    : target_(render_target(640, 480, 0, std::move(make_current))), scene_(std::make_unique<Scene>(*target_, fonts)) {}

ScenePane::~ScenePane() {
    scene_.reset();
    target_->Finalize();
}

std::optional<ImVec2> ScenePane::take_mouse(const char* name, const Box& sensitive) {
    constexpr double kRadiansPerPixel = 0.007;
    constexpr float kStillPixels = 5;
    const ImGuiIO& io = ImGui::GetIO();
    ImGui::SetCursorScreenPos({sensitive.x, sensitive.y});
    ImGui::InvisibleButton(
        name, {sensitive.width, sensitive.height},
        ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
    const bool still = io.MouseDragMaxDistanceSqr[0] < kStillPixels * kStillPixels;
    if (ImGui::IsItemHovered()) {
        view_.zoom = std::clamp(view_.zoom * std::pow(1.12, static_cast<double>(io.MouseWheel)), 0.3, 12.0);
        if (ImGui::IsMouseDoubleClicked(0)) view_ = first_view_;
    }
    if (ImGui::IsItemActive()) {
        if (io.MouseDown[0] && !still) {
            // Along the picture's own axes, which a view of its own may have turned.
            const Eigen::Vector2d by =
                Eigen::Rotation2Dd(view_.roll) * Eigen::Vector2d(io.MouseDelta.x, -io.MouseDelta.y);
            view_.azimuth = std::remainder(view_.azimuth + kRadiansPerPixel * by.x(), 2 * M_PI);
            view_.elevation = std::clamp(view_.elevation - kRadiansPerPixel * by.y(), -1.5, 1.5);
        } else if (!io.MouseDown[0]) {
            view_.shift_mm += scene_->mm_per_pixel() * Eigen::Vector2d(io.MouseDelta.x, -io.MouseDelta.y);
        }
    }
    if (ImGui::IsItemDeactivated() && io.MouseReleased[0] && still && ImGui::IsItemHovered()) return io.MousePos;
    return std::nullopt;
}

void ScenePane::draw(const Pen& pen, const Box& box, const SceneModel& model, const LetterInsets& insets) {
    const int width = static_cast<int>(box.width) - 4, height = static_cast<int>(box.height) - 4;
    using std::chrono::steady_clock;
    const auto began = steady_clock::now();
    const int* const size = target_->GetSize();
    const bool turned =
        !(view_ == rendered_view_) || !(insets == rendered_insets_) || size[0] != width || size[1] != height;
    behind_ = !turned && began < not_before_ && !(model == rendered_);
    if (!behind_ && scene_->update(model, view_, width, height, pen.scale, pen.words, insets)) {
        target_->SetSize(width, height);
        target_->GetState()->Reset();
        target_->GetState()->ResetFramebufferBindings();
        target_->Render();
        // What is translucent in it left a hole in its opacity, through which the window would be seen.
        target_->GetDisplayFramebuffer()->Bind(GL_FRAMEBUFFER);
        glDisable(GL_SCISSOR_TEST);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
        glClearColor(0, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        rendered_view_ = view_;
        rendered_ = model;
        rendered_insets_ = insets;
        const auto ended = steady_clock::now();
        not_before_ = ended + 2 * (ended - began);
    }
    const auto texture = target_->GetDisplayFramebuffer()->GetColorAttachmentAsTextureObject(0)->GetHandle();
    corner_ = {box.x + 2, box.y + 2};
    pen.list->AddImageRounded(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), corner_,
                              {corner_.x + static_cast<float>(width), corner_.y + static_cast<float>(height)}, {0, 1},
                              {1, 0}, IM_COL32_WHITE, 10 * pen.scale);
}

bool ScenePane::wants_frame() const {
    return behind_ && std::chrono::steady_clock::now() >= not_before_;
}

Ray ScenePane::sight(const ImVec2& pixel) const {
    return scene_->sight({static_cast<double>(pixel.x - corner_.x), static_cast<double>(pixel.y - corner_.y)});
}

ImVec2 ScenePane::pixel_of(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d at = scene_->pixel_of(p);
    return {corner_.x + static_cast<float>(at.x()), corner_.y + static_cast<float>(at.y())};
}

}  // namespace planlight
