#include "app/report/operation_comparison.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "app/windows/camera_picture.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr int kSubPixels = 4;  // bits

cv::Scalar colour_of(const SeenSegment& place) {
    if (!place.seen) return {138, 143, 152};
    const double off = std::abs(place.off_mm);
    return off > kOperationStop_mm   ? cv::Scalar(224, 48, 58)
           : off > kOperationLook_mm ? cv::Scalar(255, 171, 26)
                                     : cv::Scalar(53, 196, 111);
}

/// Where pixels of the picture lie in the part of it that is shown, enlarged to the whole size.
struct Enlarged {
    double scale = 1;
    Eigen::Vector2d first = Eigen::Vector2d::Zero();

    Enlarged(const std::array<double, 4>& box, const GrayImage& picture) {
        const Eigen::Vector2d whole(picture.width, picture.height), part(box[2], box[3]);
        scale = std::max(1.0, (whole.array() / part.array().max(1)).minCoeff());
        const Eigen::Vector2d middle = Eigen::Vector2d(box[0], box[1]) + part / 2;
        first = (middle - whole / (2 * scale)).cwiseMax(0).cwiseMin(whole - whole / scale);
    }
    cv::Point at(const Eigen::Vector2d& pixel) const {
        const Eigen::Vector2d there = (1 << kSubPixels) * scale * (pixel - first);
        return {static_cast<int>(std::lround(there.x())), static_cast<int>(std::lround(there.y()))};
    }
};

}  // namespace

RgbImage compared_picture(const MomentComparison& moment, const GrayImage& picture, std::size_t camera) {
    constexpr double kRadius_px = 4;
    RgbImage shown = rgb_of(brightened(picture));
    const Enlarged enlarged(round_the_plan(moment.plan[camera], picture), picture);
    const cv::Mat whole = cv::Mat(shown.height, shown.width, CV_8UC3, shown.pixels.data()).clone();
    cv::Mat part(shown.height, shown.width, CV_8UC3, shown.pixels.data());
    const double s = enlarged.scale;
    const cv::Matx23d to_part(s, 0, -s * enlarged.first.x(), 0, s, -s * enlarged.first.y());
    cv::warpAffine(whole, part, to_part, part.size());
    for (const LineInPicture& line : moment.plan[camera]) {
        std::vector<cv::Point> points;
        for (const Eigen::Vector2d& pixel : line) points.push_back(enlarged.at(pixel));
        cv::polylines(part, points, false, cv::Scalar(41, 197, 255), 1, cv::LINE_AA, kSubPixels);
    }
    for (const auto& place : moment.places)
        if (const auto& pixel = place.pixel[camera])
            cv::circle(part, enlarged.at(*pixel), static_cast<int>(kRadius_px) << kSubPixels, colour_of(place.seen), 1,
                       cv::LINE_AA, kSubPixels);
    return shown;
}

void compare_moment(OperationFacts& facts, const std::filesystem::path& recording, const Case& the_case) {
    check_case(facts.head, the_case, recording);
    if (!facts.moment) return;
    OperationMoment& shown = *facts.moment;
    const RecordingTimeLine line = time_line_of(recording);
    RecordedMoments moments(recording, line);
    const std::size_t frame = frame_near(line, shown.at_s);
    const RecordedMoment pictures = moments.moment(frame);
    const MomentComparison moment = MomentComparer(the_case, line, recording).compare(moments, frame, pictures);
    shown.compared_words = moment.why_not.empty() ? sum_of(moment) : moment.why_not;
    if (!moment.why_not.empty()) return;
    shown.compared = {compared_picture(moment, pictures.frame.left, 0),
                      compared_picture(moment, pictures.frame.right, 1)};
}

void compare_moment(OperationFacts& facts, const std::filesystem::path& recording, const std::function<void()>& go_on) {
    if (!facts.moment) return;
    if (facts.head.anonymous) {
        facts.moment->compared_words = kAnonymousKeepsNoPlan;
        return;
    }
    try {
        const Case the_case = read_case(facts.head.case_folder);
        if (go_on) go_on();
        compare_moment(facts, recording, the_case);
        if (go_on) go_on();
    } catch (const Error& fault) {
        facts.moment->compared_words = std::string("Plan and light are not compared: ") + fault.what() + ".";
    }
}

}  // namespace planlight
