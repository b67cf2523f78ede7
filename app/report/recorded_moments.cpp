#include "app/report/recorded_moments.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/windows/camera_picture.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/types/error.h"
#include "planning_io/types/rigid_transform.h"

namespace planlight {
namespace {

using Json = nlohmann::json;

std::optional<RigidTransform> pose_in(const Json& event) {
    const auto pose = event.is_object() ? event.find("pose") : event.end();
    if (pose == event.end() || !pose->is_object()) return std::nullopt;
    const auto rows = pose->find("rig_from_patient");
    if (rows == pose->end() || !rows->is_array() || rows->size() != 16) return std::nullopt;
    RigidTransform transform;
    for (Eigen::Index i = 0; i < 16; ++i) {
        const Json& number = rows->at(static_cast<std::size_t>(i));
        if (!number.is_number()) return std::nullopt;
        transform.matrix()(i / 4, i % 4) = number.get<double>();
    }
    if (!is_rigid(transform.matrix())) return std::nullopt;
    return transform;
}

}  // namespace

RecordingChunk RecordedMoments::chunk(std::uint64_t place) {
    std::optional<RecordingChunk> chunk = reader_.chunk_at(place);
    if (!chunk)
        throw DamagedFileError(reader_.file(), "a piece of it does not read",
                               "Copy the file again from where it was written.");
    return std::move(*chunk);
}

RecordedMoment RecordedMoments::moment(std::size_t frame) {
    const auto& places = line_.places.at(frame);
    RecordedMoment moment{line_.frames_s.at(frame), unpack_frame(chunk(places.frame).payload, reader_.file()), {}};
    if (places.light != 0) moment.light = unpack_picture(chunk(places.light).payload, reader_.file());
    return moment;
}

std::optional<RigidTransform> RecordedMoments::rig_from_patient(std::size_t frame) {
    const std::uint64_t place = line_.places.at(frame).updated;
    if (place == 0) return std::nullopt;
    return pose_in(Json::parse(chunk(place).payload, nullptr, false));
}

std::optional<KeptMatch> RecordedMoments::match(std::size_t frame) {
    const std::uint64_t place = line_.places.at(frame).match;
    if (place == 0) return std::nullopt;
    return kept_match_of(chunk(place).payload, reader_.file());
}

RgbImage picture_of(const RecordedMoment& moment) {
    const GrayImage left = brightened(moment.frame.left), right = brightened(moment.frame.right);
    const int height = std::max(1, left.height), gap = 8;
    const int light_width = moment.light.height > 0 ? moment.light.width * height / moment.light.height : 0;
    RgbImage all(left.width + gap + right.width + (light_width > 0 ? gap + light_width : 0), height, {24, 26, 30});
    const auto put = [&](const GrayImage& picture, int from) {
        for (int y = 0; y < std::min(height, picture.height); ++y)
            for (int x = 0; x < picture.width; ++x) all.at(from + x, y).fill(picture.at(x, y));
    };
    put(left, 0);
    put(right, left.width + gap);
    const int from = left.width + right.width + 2 * gap;
    for (int y = 0; light_width > 0 && y < height; ++y)
        for (int x = 0; x < light_width; ++x)
            all.at(from + x, y) =
                moment.light.at(x * moment.light.width / light_width, y * moment.light.height / height);
    return all;
}

}  // namespace planlight
