// Is what must not be accepted refused? Mirrored heads, things that are no head, other patients, too little skin, wrong
// scale. measure_hard_trials [TRIALS [SEED]] [--ch2 FILE] [--mannequin FILE] [--ct-head FOLDER] [--log FILE] [--picture
// roc.png] Default 5000 trials, seed 1. With a log the run can be cut and goes on; tables and picture are of all trials
// in the log.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/moved_skin.h"
#include "tests/registration/matching/roc_picture.h"
#include "tests/registration/matching/trial_counts.h"
#include "tests/registration/matching/trial_heads.h"
#include "tests/registration/matching/trial_objects.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

enum class Kind {
    plain,
    mirrored,
    sphere,
    cylinder,
    egg,
    lump,
    other_patient,
    small,
    featureless,
    half_draped,
    wrong_scale,
    nonsense
};
const std::vector<std::string> kNames{"control: a plain scan",
                                      "mirrored head",
                                      "sphere",
                                      "cylinder",
                                      "egg",
                                      "lump",
                                      "other patient",
                                      "40 to 90 mm wide",
                                      "featureless: crown, back of the head",
                                      "half under a cloth",
                                      "head 2 to 5 % too large or small",
                                      "nonsense: scattered points, waves, strays only"};

/// Numbers of one trial, drawn in a fixed order.
class Draw {
public:
    explicit Draw(unsigned seed) : random_(seed) {}
    double between(double low, double high) { return low + (high - low) * unit_(random_); }
    std::size_t below(std::size_t count) { return random_() % count; }

private:
    std::mt19937 random_;
    std::uniform_real_distribution<double> unit_;
};

Vector3d direction(double azimuth, double up) {
    return {std::sin(azimuth) * std::cos(up), -std::cos(azimuth) * std::cos(up), std::sin(up)};
}

/// From anywhere a rig may look from, 110 to 230 mm wide, as good as a clean scan is.
TrialScanSettings ordinary(Draw& draw, unsigned seed) {
    TrialScanSettings scan;
    const double azimuth = draw.between(-std::numbers::pi, std::numbers::pi), up = draw.between(-0.2, 0.8);
    scan.from_in_ct = direction(azimuth, up);
    scan.roll = draw.between(-std::numbers::pi, std::numbers::pi);
    scan.aside_mm.x() = draw.between(-20, 20);
    scan.aside_mm.y() = draw.between(-20, 20);
    scan.width_mm = draw.between(110, 230);
    scan.noise_mm = draw.between(0.05, 0.6);
    scan.stray_share = draw.between(0, 0.2);
    const auto& movements = skin_movements();
    scan.movement = movements[draw.below(movements.size())].name;
    scan.movement_mm = draw.between(0, 1.2);
    scan.seed = seed;
    return scan;
}

TrialScan nonsense(Draw& draw, unsigned seed) {
    TrialScan scan;
    scan.rig_from_ct = random_pose(seed);
    scan.targets_in_ct = {Vector3d::Zero()};
    const std::size_t form = draw.below(3);
    const double wide = draw.between(100, 220), high = draw.between(3, 40), wave = draw.between(15, 80);
    for (int i = 0; i < 15000; ++i) {
        const double x = draw.between(-wide / 2, wide / 2), y = draw.between(-wide / 2, wide / 2),
                     z = draw.between(-wide / 2, wide / 2);
        const double a = std::sin(x / wave) * high, b = std::cos(y / wave + 1) * high;
        const Vector3d n =
            Vector3d(-std::cos(x / wave) * high / wave, std::sin(y / wave + 1) * high / wave, 1).normalized();
        const Vector3d any = Vector3d(draw.between(-1, 1), draw.between(-1, 1), draw.between(-1, 1)).normalized();
        if (form == 0) scan.cloud.points_in_rig.emplace_back(x, y, z), scan.cloud.normals_in_rig.push_back(any);
        if (form == 1) scan.cloud.points_in_rig.emplace_back(x, y, a + b), scan.cloud.normals_in_rig.push_back(n);
        if (form == 2) scan.cloud.points_in_rig.push_back(0.5 * wide * any), scan.cloud.normals_in_rig.push_back(any);
    }
    scan.cloud = moved(scan.cloud, scan.rig_from_ct);
    return scan;
}

/// What is scanned in this trial, and how.
TrialScan hard_scan(Kind kind, const std::vector<TrialHead>& heads, std::size_t head, Draw& draw, unsigned seed,
                    TrialRecord& record) {
    TrialScanSettings scan = ordinary(draw, seed);
    if (kind == Kind::mirrored) scan.mirrored = true;
    if (kind == Kind::small) scan.width_mm = draw.between(40, 90);
    if (kind == Kind::featureless) {
        const bool crown = draw.below(2) == 0;
        scan.from_in_ct = direction(crown ? draw.between(-3.1, 3.1) : draw.between(2.7, 3.6),
                                    crown ? draw.between(1.2, 1.57) : draw.between(0.1, 0.6));
        scan.aside_mm.setZero();
        scan.width_mm = draw.between(90, 150);
    }
    if (kind == Kind::half_draped) {
        scan.drape_share = draw.between(0.4, 0.65);
        scan.drape_height_mm = draw.between(3, 25);
    }
    if (kind == Kind::wrong_scale) scan.scale = 1 + (draw.below(2) == 0 ? -1 : 1) * draw.between(0.02, 0.05);
    record.width_mm = scan.width_mm;
    record.noise_mm = scan.noise_mm;
    record.strays = scan.stray_share;
    record.drape = scan.drape_share;
    record.movement = scan.movement;
    record.movement_mm = scan.movement_mm;
    record.view = "any";
    const double size_mm = draw.between(60, 110), other_mm = draw.between(65, 115), third_mm = draw.between(65, 115);
    switch (kind) {
        case Kind::sphere:
            return trial_scan(sphere_object(size_mm), scan);
        case Kind::cylinder:
            return trial_scan(cylinder_object(size_mm, 300), scan);
        case Kind::egg:
            return trial_scan(egg_object({size_mm, other_mm, third_mm}), scan);
        case Kind::lump:
            return trial_scan(lump_object(size_mm, seed), scan);
        case Kind::nonsense:
            return nonsense(draw, seed);
        case Kind::other_patient: {
            std::size_t other = (head + 1 + draw.below(heads.size() - 1)) % heads.size();
            // Two of the heads are the same person, whose CT ends at different places.
            if (heads[other].name.starts_with("long") && heads[head].name.starts_with("long")) other = 0;
            return trial_scan(heads[other].surface, scan);
        }
        default:
            return trial_scan(heads[head].surface, scan);
    }
}

TrialRecord run(const std::vector<TrialHead>& heads, unsigned seed) {
    Draw draw(seed);
    const auto kind = static_cast<Kind>(seed % kNames.size());
    const std::size_t head = (seed / kNames.size()) % heads.size();
    TrialRecord record;
    record.seed = seed;
    record.kind = kNames[static_cast<std::size_t>(kind)];
    record.head = heads[head].name;
    record.right_object = kind == Kind::plain || kind == Kind::small || kind == Kind::featureless ||
                          kind == Kind::half_draped || kind == Kind::wrong_scale;
    run_trial(hard_scan(kind, heads, head, draw, seed, record), heads[head].lut, record);
    return record;
}

void print_table(const std::vector<TrialRecord>& all) {
    fmt::print(
        "| scan of | trials | yes | ask | no | **wrong yes** | wrong ask | worst error of a yes, mm | largest "
        "confidence of a wrong one |\n"
        "|---|---|---|---|---|---|---|---|---|\n");
    std::vector<std::string> names = kNames;
    names.push_back("**all**");
    for (const std::string& name : names) {
        std::size_t n = 0, verdicts[3] = {0, 0, 0}, wrong[3] = {0, 0, 0};
        double worst_mm = 0, surest = -INFINITY;
        for (const TrialRecord& r : all) {
            if (name != "**all**" && r.kind != name) continue;
            ++n;
            ++verdicts[r.verdict];
            wrong[r.verdict] += r.wrong();
            if (r.verdict == 0 && r.right_object) worst_mm = std::max(worst_mm, r.final.target_mm);
            if (r.wrong()) surest = std::max(surest, confidence(r));
        }
        fmt::print("| {} | {} | {} | {} | {} | {} | {} | {:.1f} | {:.2f} |\n", name, n, verdicts[0], verdicts[1],
                   verdicts[2], wrong[0], wrong[1], worst_mm, surest);
    }
    fmt::print(
        "\nWrong: a pose more than 5 mm off at a target 60 mm deep, or any pose of what is not this patient. Wrong "
        "ones with a yes:\n");
    for (const TrialRecord& r : all)
        if (r.verdict == 0 && r.wrong())
            fmt::print(
                "  seed {}: {}, table of {}, {:.0f} mm, {:.1f} mm off, runner-up {:.2f}, mirror {:.2f}, on skin {:.0f} "
                "%, rms {:.2f}, scale {:.3f}, bound {:.1f}\n",
                r.seed, r.kind, r.head, r.width_mm, r.final.target_mm, r.runner_up, r.mirror, 100 * r.inliers, r.rms_mm,
                r.scale, r.bound_mm);
}

/// The whole certificate as one number in two ways, and each measure alone.
std::vector<RocCurve> curves_of(const std::vector<TrialRecord>& all) {
    using Measure = double (*)(const TrialRecord&);
    const std::vector<std::pair<std::string, Measure>> measures{
        {"rivals and predicted error", confidence},
        {"least margin of all limits", least_margin},
        {"runner-up ratio", [](const TrialRecord& r) { return r.runner_up; }},
        {"mirror ratio", [](const TrialRecord& r) { return r.mirror; }},
        {"predicted 95 % bound", [](const TrialRecord& r) { return -r.bound_mm; }},
        {"share on the skin", [](const TrialRecord& r) { return r.inliers; }},
        {"rms of the inliers", [](const TrialRecord& r) { return -r.rms_mm; }}};
    std::vector<RocCurve> curves;
    for (const auto& [name, measure] : measures) {
        RocCurve& curve = curves.emplace_back(RocCurve{name, {}, {}});
        for (const TrialRecord& r : all) {
            const double value = r.searched ? measure(r) : -INFINITY;
            (r.wrong() ? curve.wrong : curve.right).push_back(value);
        }
    }
    return curves;
}

/// What the verdict takes, of the right and of the wrong ones.
std::vector<RocPoint> verdicts_of(const std::vector<TrialRecord>& all) {
    std::vector<RocPoint> points{{"yes", 0, 0}, {"yes or ask", 0, 0}};
    double right = 0, wrong = 0;
    for (const TrialRecord& r : all) {
        ++(r.wrong() ? wrong : right);
        for (int i = 0; i < 2; ++i)
            if (r.verdict <= i)
                ++(r.wrong() ? points[static_cast<std::size_t>(i)].wrong_share
                             : points[static_cast<std::size_t>(i)].right_share);
    }
    for (RocPoint& point : points) {
        point.right_share /= std::max(right, 1.);
        point.wrong_share /= std::max(wrong, 1.);
    }
    return points;
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    using namespace planlight::test;
    const TrialOptions options = trial_options(argc, argv, 5000);
    const std::vector<TrialHead> heads = trial_heads(options.files);
    const auto all = run_trials(options, [&](unsigned seed) { return run(heads, seed); });
    print_table(all);
    const auto curves = curves_of(all);
    fmt::print(
        "\n| measure, {} right and {} wrong | area under its ROC | right ones accepted at no wrong one | at 1 % |\n"
        "|---|---|---|---|\n",
        curves[0].right.size(), curves[0].wrong.size());
    for (const RocCurve& curve : curves)
        fmt::print("| {} | {:.3f} | {:.1f} % | {:.1f} % |\n", curve.name, area_under(curve),
                   100 * accepted_at(curve, 0), 100 * accepted_at(curve, 0.01));
    if (!options.picture.empty())
        write_roc(curves, verdicts_of(all), "Certificate: right against wrong matches", options.picture);
}
