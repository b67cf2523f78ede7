#include "planning_io/surface/roi_surface.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planning_io/dicom/rt_struct.h"
#include "planning_io/plan/contour_stack.h"
#include "planning_io/plan/plan_rtstruct.h"
#include "planning_io/surface/contour_solid.h"
#include "planning_io/surface/mask_surface.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Loop = std::vector<Vector3d>;

constexpr double kPixel_mm = 1;
constexpr double kMostAcross_mm = 1000;
constexpr double kOneHeight_mm = 0.1;
constexpr int kMostEmpty = 20;
constexpr const char* kExportAgain = "Export the ROI with contours on every slice of one series.";

std::vector<Loop> loops_of(const RtRoi& roi, const fs::path& file) {
    std::vector<Loop> loops;
    for (const RtContour& contour : roi.contours) {
        if (!is_closed(contour) || contour.numbers.size() < 9) continue;
        Loop loop;
        for (std::size_t i = 0; i + 2 < contour.numbers.size(); i += 3) {
            loop.emplace_back(contour.numbers[i], contour.numbers[i + 1], contour.numbers[i + 2]);
            if (!loop.back().allFinite() || loop.back().cwiseAbs().maxCoeff() > 5000)
                throw InputError(file,
                                 "ROI \"" + roi.name + "\" has a coordinate that is not a number of mm within 5 m",
                                 kExportAgain);
        }
        loops.push_back(std::move(loop));
    }
    return loops;
}

/// Turns the pixels of one slice over wherever a straight way to the left crosses the loop (even-odd rule).
void draw(MaskStack& mask, const Loop& loop, int slice, const Vector3d& low) {
    const auto columns = static_cast<std::size_t>(mask.size[0]), rows = static_cast<std::size_t>(mask.size[1]);
    for (std::size_t j = 0; j < rows; ++j) {
        const double y = low.y() + kPixel_mm * static_cast<double>(j);
        std::vector<double> crossings;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Vector3d &a = loop[i], &b = loop[(i + 1) % loop.size()];
            if ((a.y() <= y) == (b.y() <= y)) continue;
            crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t c = 0; c + 1 < crossings.size(); c += 2)
            for (auto i = static_cast<std::size_t>(std::max(0.0, std::ceil((crossings[c] - low.x()) / kPixel_mm)));
                 i < columns && low.x() + kPixel_mm * static_cast<double>(i) < crossings[c + 1]; ++i)
                mask.inside[(static_cast<std::size_t>(slice) * rows + j) * columns + i] ^= 1;
    }
}

MaskStack mask_of(std::vector<Loop> loops, const std::string& name, const fs::path& file) {
    const auto refuse = [&](const std::string& problem) {
        throw InputError(file, "ROI \"" + name + "\" " + problem, kExportAgain);
    };
    const Eigen::Matrix3d axes = axes_of_contours(loops);
    Vector3d low = Vector3d::Constant(INFINITY), high = -low;
    std::vector<double> heights;
    for (Loop& loop : loops) {
        double least = INFINITY, most = -INFINITY;
        for (Vector3d& p : loop) {
            p = axes.transpose() * p;
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
            least = std::min(least, p.z());
            most = std::max(most, p.z());
        }
        if (!(most - least < kOneHeight_mm)) refuse("has contours that are not parallel");
        heights.push_back((least + most) / 2);
    }
    if (!((high - low).maxCoeff() < kMostAcross_mm))
        refuse(fmt::format("is {:.0f} mm across", (high - low).maxCoeff()));
    std::vector<double> sorted = heights;
    std::sort(sorted.begin(), sorted.end());
    double step = INFINITY;
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i] - sorted[i - 1] > kOneHeight_mm) step = std::min(step, sorted[i] - sorted[i - 1]);
    const double whole = sorted.back() - sorted.front();
    step = whole / std::round(whole / step);  // the smallest gap is rounded; over all of them that would add up
    const double slices = std::round(whole / step) + 1;
    if (!(slices < kMostEmpty * static_cast<double>(loops.size()))) refuse("has contours that are not evenly spaced");
    const Vector3d first(low.x(), low.y(), sorted.front());
    MaskStack mask;
    mask.size = {static_cast<int>((high.x() - low.x()) / kPixel_mm) + 2,
                 static_cast<int>((high.y() - low.y()) / kPixel_mm) + 2, static_cast<int>(slices)};
    mask.ct_from_voxel.linear() = axes * Vector3d(kPixel_mm, kPixel_mm, step).asDiagonal();
    mask.ct_from_voxel.translation() = axes * first;
    mask.inside.assign(static_cast<std::size_t>(mask.size[0]) * static_cast<std::size_t>(mask.size[1]) *
                           static_cast<std::size_t>(mask.size[2]),
                       0);
    for (std::size_t i = 0; i < loops.size(); ++i) {
        const double slice = (heights[i] - sorted.front()) / step;
        if (std::abs(slice - std::round(slice)) > 0.1) refuse("has contours that are not evenly spaced");
        draw(mask, loops[i], static_cast<int>(std::lround(slice)), first);
    }
    return mask;
}

}  // namespace

TriangleMesh read_roi_surface(const fs::path& file, const std::string& roi, const PlanImportSettings& settings,
                              std::vector<std::string>& notes) {
    const RtStruct set = read_rt_struct(file);
    check_frame_of_reference(set, settings, file, notes);
    std::vector<std::string> names;
    const RtRoi* chosen = nullptr;
    for (const RtRoi& candidate : set.rois) {
        if (heights_of_contours(loops_of(candidate, file)) < kSolidHeights) continue;
        names.push_back(candidate.name);
        if (roi.empty() || candidate.name == roi) chosen = &candidate;
    }
    if (names.empty())
        throw InputError(file, "holds no solid: no ROI has closed contours at three heights", kExportAgain);
    if (!chosen || (roi.empty() && names.size() > 1))
        throw InputError(file,
                         roi.empty() ? fmt::format("holds {} solids: {}", names.size(), fmt::join(names, ", "))
                                     : fmt::format("holds no solid \"{}\"; there is: {}", roi, fmt::join(names, ", ")),
                         "Choose one by its name (--segment NAME).");
    return surface_of_mask(mask_of(loops_of(*chosen, file), chosen->name, file));
}

std::vector<RiskStructure> read_roi_solids(const fs::path& file, const PlanImportSettings& settings,
                                           std::vector<std::string>& notes) {
    const RtStruct set = read_rt_struct(file);
    check_frame_of_reference(set, settings, file, notes);
    std::vector<RiskStructure> solids;
    for (const RtRoi& roi : set.rois) {
        if (const std::string what = no_organ(roi); !what.empty()) {
            notes.push_back(fmt::format("{}: ROI \"{}\" is {} ({}) and is left out of the risk structures",
                                        file.filename().string(), roi.name, what, roi.interpreted_type));
            continue;
        }
        auto loops = loops_of(roi, file);
        if (heights_of_contours(loops) < kSolidHeights) {
            notes.push_back(
                fmt::format("{}: ROI \"{}\" is no solid (closed contours at {} heights or more); it is left "
                            "out of the risk structures",
                            file.filename().string(), roi.name, kSolidHeights));
            continue;
        }
        solids.push_back({roi.name, contour_solid(std::move(loops), roi.name, file, notes)});
    }
    if (solids.empty())
        throw InputError(file, "holds no solid that is a risk structure: no organ has closed contours at three heights",
                         kExportAgain);
    return solids;
}

}  // namespace planlight
