#include "app/live/step_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "app/console.h"
#include "app/windows/operator_window.h"
#include "app/windows/status_word.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

std::string in_file_name(std::string words) {
    std::ranges::transform(words, words.begin(), [](unsigned char c) {
        return std::isalnum(c) != 0 ? static_cast<char>(std::tolower(c)) : '-';
    });
    return words;
}

}  // namespace

StepPictures::StepPictures(std::filesystem::path folder, std::string begin)
    : folder_(std::move(folder)), begin_(std::move(begin)) {
    if (!folder_.empty()) make_folder(folder_);
}

std::string StepPictures::take(OperatorWindow& window, const OperatorModel& model) {
    constexpr int kSettled = 8;
    if (folder_.empty()) return {};
    const std::string asked = model.confirm ? " " + model.confirm_words : "";
    const std::string state = in_file_name(status_word(model.status.kind) + asked);
    // What is said too, less its figures, which change from look to look.
    std::string said = model.status.headline;
    for (const std::string& detail : model.status.details) said += detail;
    std::erase_if(said, [](unsigned char c) { return std::isdigit(c) != 0; });
    looks_ = state + said == state_ ? looks_ + 1 : 0;
    state_ = state + said;
    if (looks_ != kSettled) return {};
    std::string name = fmt::format("{:02d}-{}.png", ++number_, state);
    return keep_or_warn(window.screenshot(), folder_ / (begin_ + "-" + name)) ? name : std::string{};
}

bool keep_or_warn(const RgbImage& picture, const std::filesystem::path& file) {
    try {
        write_png(picture, file, ReadableBy::owner);
        return true;
    } catch (const DiskError& error) {
        warn(std::string(error.what()) + ". " + error.remedy);
        return false;
    }
}

}  // namespace planlight
