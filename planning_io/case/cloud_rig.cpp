#include "planning_io/case/cloud_rig.h"

#include <algorithm>

#include "planning_io/case/rig_json.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr std::string_view kLine = "PLANLIGHT-RIG ", kEnd = "PLANLIGHT-RIG-XXH128 ";
constexpr std::size_t kLineLength = 160;  // readers of PLY have been seen to take 1024 bytes, and 255

}  // namespace

std::vector<std::string> comments_of(const RigState& state) {
    const std::string text = json_of(state).dump();
    std::vector<std::string> lines;
    for (std::size_t begin = 0; begin < text.size(); begin += kLineLength)
        lines.push_back(std::string(kLine) + "|" + text.substr(begin, kLineLength) + "|");
    lines.push_back(std::string(kEnd) + content_hash(text));
    return lines;
}

std::optional<RigState> rig_state_in(const std::vector<std::string>& comments, const std::filesystem::path& file) {
    const auto damaged = [&]() -> DamagedFileError {
        return {file, "says which rig it was made with in lines that were changed",
                "Scan again, or copy the file again."};
    };
    std::string text, checksum;
    for (const std::string& comment : comments) {
        if (comment.starts_with(kEnd)) checksum = comment.substr(kEnd.size());
        if (!comment.starts_with(kLine)) continue;
        const std::size_t begin = comment.find('|'), end = comment.rfind('|');
        if (begin == std::string::npos || end <= begin) throw damaged();
        text += comment.substr(begin + 1, end - begin - 1);
    }
    while (!checksum.empty() && (checksum.back() == '\r' || checksum.back() == ' ')) checksum.pop_back();
    if (text.empty() && checksum.empty()) return std::nullopt;
    if (content_hash(text) != checksum) throw damaged();
    const Json json = parse_json(text, file);
    return rig_state_of(JsonValue(json, file));
}

}  // namespace planlight
