#include "tests/app/words/drawn_words.h"

#include <imgui.h>

#include <map>

#include "app/windows/doctor_page_model.h"
#include "app/windows/fonts.h"
#include "app/windows/guide_panels.h"
#include "app/windows/status_word.h"

namespace planlight {

DrawnWords::DrawnWords(const std::string& language, int width, int height)
    : context_(ImGui::CreateContext()), words_(words_of(language)), place(layout_of(width, height)) {
    ImGui::SetCurrentContext(context_);
    ImGui::GetIO().DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
    ImGui::GetIO().IniFilename = nullptr;
    FontLetters letters{words_->letters(), {}};
    for (int kind = 0; kind <= static_cast<int>(StatusKind::waiting); ++kind)
        letters.word += words_->say(status_word(static_cast<StatusKind>(kind)));
    for (const std::string& word : guide_words()) letters.word += words_->say(word);
    for (const std::string& word : doctor_words()) letters.word += words_->say(word);
    pen.fonts = load_fonts(*ImGui::GetIO().Fonts, find_fonts(), place.scale, letters);
    unsigned char* pixels = nullptr;
    int w = 0, h = 0;
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &w, &h);
    pen.scale = place.scale;
    pen.words = words_.get();
    pen.cut = &cut;
    pen.lacking = &lacking;
}

DrawnWords::~DrawnWords() {
    ImGui::SetCurrentContext(context_);
    end();
    ImGui::DestroyContext(context_);
}

void DrawnWords::begin() {
    ImGui::SetCurrentContext(context_);
    end();
    ImGui::NewFrame();
    ImGui::Begin("all");
    drawing_ = true;
    pen.list = ImGui::GetWindowDrawList();
    cut.clear();
    lacking.clear();
}

void DrawnWords::end() {
    if (!drawing_) return;
    ImGui::End();
    ImGui::EndFrame();
    drawing_ = false;
}

namespace {

DrawnWords& drawn_words(const std::string& language, const std::pair<int, int>& size) {
    static std::map<std::pair<std::string, std::pair<int, int>>, std::unique_ptr<DrawnWords>> made;
    auto& drawn = made[{language, size}];
    if (!drawn) drawn = std::make_unique<DrawnWords>(language, size.first, size.second);
    drawn->begin();
    return *drawn;
}

}  // namespace

DrawnInPlace::DrawnInPlace() : drawn_(drawn_words(std::get<0>(GetParam()), std::get<1>(GetParam()))) {}

void DrawnInPlace::expect_whole(const std::string& where) {
    for (const std::string& text : drawn_.cut) ADD_FAILURE() << where << ": no room for \"" << text << "\"";
    drawn_.cut.clear();
    EXPECT_TRUE(drawn_.lacking.empty()) << where << ": a letter has no sign in the font";
}

}  // namespace planlight
