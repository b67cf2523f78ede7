// Codes of two cameras from a Gray code of 88 pictures: OpenCV's structured_light, ours, and reading the pictures once.
// compare_decoders [ROUNDS] [ours]
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/structured_light.hpp>
#include <string>
#include <thread>

#include "planning_io/types/processor_clones.h"
#include "planning_io/types/statistics.h"
#include "registration/scan/decode/decode_gray_pairs.h"
#include "tests/benchmarks/time_round.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;

constexpr int kWidth = 1280, kHeight = 800;  // of the projector
constexpr double kWrong_px = 2.5;            // the code counts whole pixels, and a camera pixel covers some of them

struct Scene {
    std::string name;
    Room room;
    std::vector<std::vector<GrayImage>> frames;  // per camera: the code, white, black
    std::vector<Truth> truth;
    ScanCapture fringes;  // the default sequence
    double megabytes = 0;
};

Scene make_scene(const std::string& name, Surface surface) {
    Scene scene{name, modern_room(std::move(surface)), {}, {}, {}, 0};
    for (Optics* camera : {&scene.room.left, &scene.room.right}) camera->height = 1080, camera->cy -= 60;
    Optics& projector = scene.room.projector;
    projector.width = kWidth;
    projector.height = kHeight;
    for (double* value : {&projector.fx, &projector.fy, &projector.cx, &projector.cy}) *value *= 2.0 / 3;
    cv::structured_light::GrayCodePattern::Params size;
    size.width = kWidth;
    size.height = kHeight;
    std::vector<cv::Mat> patterns;
    const auto code = cv::structured_light::GrayCodePattern::create(size);
    code->generate(patterns);
    patterns.push_back(cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(255)));
    patterns.push_back(cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(0)));
    std::vector<Shown> pictures;
    for (const cv::Mat& pattern : patterns) {
        Shown shown{RgbImage(kWidth, kHeight),
                    pattern.at<std::uint8_t>(0, 0) == pattern.at<std::uint8_t>(0, kWidth - 1) &&
                        cv::countNonZero(pattern.row(0)) % kWidth == 0};
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) shown.picture.at(x, y).fill(pattern.at<std::uint8_t>(y, x));
        pictures.push_back(std::move(shown));
    }
    for (const Optics* camera : {&scene.room.left, &scene.room.right}) {
        scene.frames.push_back(
            photograph(scene.room, *camera, pictures, 1 + static_cast<unsigned>(scene.frames.size())));
        scene.truth.push_back(truth_of(scene.room, *camera));
        for (const GrayImage& frame : scene.frames.back())
            scene.megabytes += static_cast<double>(frame.pixels.size()) / 1e6;
    }
    scene.fringes = capture(scene.room, stripes_of(scene.room));
    return scene;
}

struct Contestant {
    std::string name;
    std::function<void()> run;
    std::vector<double> wall_s{}, processor_s{};
    std::function<std::string()> tell = [] { return std::string(); };

    static double least(const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); }
    static double mean(const std::vector<double>& v) {
        return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
    }
    /// The median over the rounds of this one's time by the other's of the same round: what else the machine did then
    /// slowed both.
    double by(const Contestant& other) const {
        std::vector<double> ratios;
        for (std::size_t r = 0; r < wall_s.size(); ++r) ratios.push_back(wall_s[r] / other.wall_s[r]);
        return median(ratios);
    }
};

void time(Contestant& one) {
    test::time_round(one.run, one.wall_s, one.processor_s);
}

PLANLIGHT_CLONES std::uint64_t sum_words(const std::uint8_t* bytes, std::size_t count) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < count / 8; ++i) {
        std::uint64_t word;
        std::memcpy(&word, bytes + 8 * i, 8);
        sum += word;
    }
    return sum;
}

/// Every byte of every frame once, on all processors: nothing that looks at the pictures can be faster.
std::uint64_t read_all(const std::vector<std::vector<GrayImage>>& frames) {
    std::vector<std::span<const std::uint8_t>> pieces;
    constexpr std::size_t kPiece = 1 << 18;
    for (const auto& camera : frames)
        for (const GrayImage& frame : camera)
            for (std::size_t at = 0; at < frame.pixels.size(); at += kPiece)
                pieces.push_back(std::span(frame.pixels).subspan(at, std::min(kPiece, frame.pixels.size() - at)));
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, pieces.size()), std::uint64_t{0},
        [&](const tbb::blocked_range<std::size_t>& range, std::uint64_t sum) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                sum += sum_words(pieces[i].data(), pieces[i].size());
            return sum;
        },
        std::plus<>());
}

/// The least time of each stage of the scans so far.
struct Stages {
    double sequence_s = 1, decode_s = 1, triangulate_s = 1, outliers_s = 1;

    void take(const ScanResult& scan) {
        sequence_s = std::min(sequence_s, scan.sequence_s);
        decode_s = std::min(decode_s, scan.decode_s);
        triangulate_s = std::min(triangulate_s, scan.triangulate_s);
        outliers_s = std::min(outliers_s, scan.outliers_s);
    }
};

/// Codes found, as (column, row) with NaN for none, against the truth.
struct Score {
    std::size_t lit = 0, decoded = 0, wrong = 0, unlit = 0;

    void add(const Eigen::Vector2d& found, const Eigen::Vector2d& truth) {
        const bool is_lit = !std::isnan(truth.x());
        lit += is_lit;
        if (std::isnan(found.x())) return;
        ++decoded;
        if (!is_lit)
            ++unlit;
        else
            wrong += (found - truth).cwiseAbs().maxCoeff() > kWrong_px;
    }
    std::string tell() const {
        return fmt::format("{} of {} lit, {} wrong, {} at unlit places", decoded - unlit, lit, wrong, unlit);
    }
};

Score score_of(const std::vector<DecodedView>& views, const std::vector<Truth>& truth) {
    Score score;
    for (std::size_t c = 0; c < views.size(); ++c)
        for (std::size_t i = 0; i < truth[c].code.size(); ++i)
            score.add({views[c].column[i], views[c].row[i]}, truth[c].code[i]);
    return score;
}

std::vector<DecodedView> our_codes(const Scene& scene) {
    std::vector<DecodedView> views;
    for (const auto& frames : scene.frames) {
        const std::span<const GrayImage> all(frames);
        views.push_back(decode_gray_pairs(
            {frames[frames.size() - 2], frames.back(), all.subspan(0, 22), all.subspan(22, 20), kWidth, kHeight}));
    }
    return views;
}

/// OpenCV's way to a single code, for every pixel that its own mask of lit ones would keep.
struct OpenCvCodes {
    cv::Ptr<cv::structured_light::GrayCodePattern> code;
    std::vector<std::vector<cv::Mat>> frames;
    std::vector<cv::Mat> white, black, column, row;

    explicit OpenCvCodes(const Scene& scene) {
        cv::structured_light::GrayCodePattern::Params size;
        size.width = kWidth;
        size.height = kHeight;
        code = cv::structured_light::GrayCodePattern::create(size);
        code->setWhiteThreshold(5);
        code->setBlackThreshold(40);
        for (const auto& camera : scene.frames) {
            std::vector<cv::Mat> all;
            for (const GrayImage& f : camera)
                all.emplace_back(f.height, f.width, CV_8U, const_cast<std::uint8_t*>(f.pixels.data()));
            black.push_back(all.back());
            white.push_back(all[all.size() - 2]);
            all.resize(all.size() - 2);
            frames.push_back(all);
        }
    }
    void pixel_by_pixel() {
        column.clear();
        row.clear();
        for (std::size_t c = 0; c < frames.size(); ++c) {
            column.push_back(cv::Mat(white[c].size(), CV_32F, cv::Scalar(NAN)));
            row.push_back(column.back().clone());
            for (int y = 0; y < white[c].rows; ++y)
                for (int x = 0; x < white[c].cols; ++x) {
                    cv::Point found;
                    if (white[c].at<std::uint8_t>(y, x) - black[c].at<std::uint8_t>(y, x) <= 40) continue;
                    if (code->getProjPixel(frames[c], x, y, found)) continue;  // true: an error
                    column[c].at<float>(y, x) = static_cast<float>(found.x);
                    row[c].at<float>(y, x) = static_cast<float>(found.y);
                }
        }
    }
    void disparity() {
        cv::Mat result;
        code->decode(frames, result, black, white, cv::structured_light::DECODE_3D_UNDERWORLD);
    }
    std::string tell(const std::vector<Truth>& truth) const {
        Score score;
        for (std::size_t c = 0; c < column.size(); ++c)
            for (std::size_t i = 0; i < truth[c].code.size(); ++i)
                score.add({column[c].ptr<float>()[i], row[c].ptr<float>()[i]}, truth[c].code[i]);
        return score.tell();
    }
};

void compare(const Scene& scene, int rounds, bool with_peers) {
    std::vector<DecodedView> views;
    OpenCvCodes peer(scene);
    ScanResult scan;
    Stages stages;
    volatile std::uint64_t sink = 0;
    const RigCalibration rig = rig_of(scene.room);
    std::vector<Contestant> all;
    all.push_back({"every picture read once", [&] { sink = read_all(scene.frames); }});
    all.push_back({"ours, codes", [&] { views = our_codes(scene); }});
    all.back().tell = [&] { return score_of(views, scene.truth).tell(); };
    all.push_back({"ours, fringes to clean cloud", [&] {
                       scan = scan_from_capture(scene.fringes, rig);
                       stages.take(scan);
                   }});
    all.back().tell = [&] {
        return fmt::format(
            "{} pictures; {} points (best: check {:.1f}, decode {:.1f}, triangulate {:.1f}, outliers {:.1f} ms)",
            2 * scene.fringes.left.size(), scan.clean.kept.size(), 1e3 * stages.sequence_s, 1e3 * stages.decode_s,
            1e3 * stages.triangulate_s, 1e3 * stages.outliers_s);
    };
    if (with_peers) {
        all.push_back({"OpenCV getProjPixel", [&] { peer.pixel_by_pixel(); }});
        all.back().tell = [&] { return peer.tell(scene.truth); };
        all.push_back({"OpenCV decode (disparity)", [&] { peer.disparity(); }});
    }
    for (int r = 0; r < rounds; ++r)  // each time another one begins
        for (std::size_t c = 0; c < all.size(); ++c) {
            Contestant& one = all[(c + static_cast<std::size_t>(r)) % all.size()];
            if (one.name.starts_with("OpenCV") && r >= 3) continue;
            time(one);
        }
    fmt::print("\n{}: {} pictures of 1920 x 1080, {:.0f} MB; {} rounds (OpenCV: {})\n", scene.name,
               2 * scene.frames[0].size(), scene.megabytes, rounds, std::min(rounds, 3));
    fmt::print("{:30} {:>9} {:>9} {:>9} {:>9}\n", "", "least ms", "by least", "x read", "mean CPU");
    for (const Contestant& one : all)
        fmt::print("{:30} {:>9.1f} {:>9.2f} {:>9.2f} {:>9.1f}  {}\n", one.name, 1e3 * Contestant::least(one.wall_s),
                   Contestant::least(one.wall_s) / Contestant::least(all[0].wall_s), one.by(all[0]),
                   1e3 * Contestant::mean(one.processor_s), one.tell());
}

}  // namespace
}  // namespace planlight

int main(int count, char** words) {
    using namespace planlight;
    const int rounds = count > 1 ? std::max(1, std::atoi(words[1])) : 20;
    const bool with_peers = !(count > 2 && std::string(words[2]) == "ours");
    fmt::print("{} processors\n", std::thread::hardware_concurrency());
    const Eigen::Vector3d centre(120, -40, 360), place(120, -40, 300);
    compare(make_scene("ball of 80 mm radius", sphere(centre, 80)), rounds, with_peers);
    compare(make_scene("plane over the whole picture", plane(place, Eigen::Vector3d(0.35, 0.2, -1).normalized())),
            rounds, with_peers);
    return 0;
}
