#include "planning_io/dicom_slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

constexpr std::size_t kFewestSlices = 16;
constexpr double kEven_mm = 0.01;
constexpr double kSameDirection = 1e-4;

std::optional<DicomRefusal> fault_of_slice(const DicomSlice& s) {
    const auto refuse = [&](const std::string& problem) {
        return DicomRefusal{s.file + " " + problem, "Export the series again from the scanner or the archive."};
    };
    const Eigen::Vector3d &r = s.row_direction, &c = s.column_direction;
    if (!s.position_in_ct.allFinite() || s.position_in_ct.cwiseAbs().maxCoeff() > 1e5) return refuse("has no position that makes sense");
    if (!r.allFinite() || !c.allFinite() || std::abs(r.norm() - 1) > 1e-3 || std::abs(c.norm() - 1) > 1e-3 || std::abs(r.dot(c)) > 1e-3)
        return refuse("has no orientation that makes sense");
    for (const double spacing : {s.column_spacing_mm, s.row_spacing_mm})
        if (!(spacing > 0.01) || !(spacing < 20)) return refuse(fmt::format("has a pixel spacing of {} mm", spacing));
    if (s.columns < 2 || s.rows < 2) return refuse("has no picture");
    return std::nullopt;
}

std::optional<DicomRefusal> fault_of_pair(const DicomSlice& a, const DicomSlice& b) {
    const std::string one_series = "Export one series of one patient into a folder of its own.";
    if (a.patient != b.patient) return DicomRefusal{fmt::format("{} and {} are of two patients", a.file, b.file), one_series};
    if (a.frame_of_reference_uid != b.frame_of_reference_uid)
        return DicomRefusal{fmt::format("{} and {} are of two frames of reference", a.file, b.file), one_series};
    if (a.columns != b.columns || a.rows != b.rows)
        return DicomRefusal{fmt::format("{} is {} x {} pixels, {} is {} x {}", a.file, a.columns, a.rows, b.file, b.columns, b.rows), one_series};
    if (std::abs(a.column_spacing_mm - b.column_spacing_mm) > 1e-4 || std::abs(a.row_spacing_mm - b.row_spacing_mm) > 1e-4)
        return DicomRefusal{fmt::format("{} has pixels of {} mm, {} of {} mm", a.file, a.column_spacing_mm, b.file, b.column_spacing_mm), one_series};
    const double turned = std::max((a.row_direction - b.row_direction).cwiseAbs().maxCoeff(), (a.column_direction - b.column_direction).cwiseAbs().maxCoeff());
    if (turned > kSameDirection) return DicomRefusal{fmt::format("{} and {} are not parallel (directions differ by {:.2g})", a.file, b.file, turned), one_series};
    return std::nullopt;
}

/// Of slices sorted along their normal.
std::optional<DicomRefusal> fault_of_stack(const std::vector<DicomSlice>& slices, const Eigen::Vector3d& normal) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < slices.size(); ++i) gaps.push_back(normal.dot(slices[i].position_in_ct - slices[i - 1].position_in_ct));
    std::vector<double> sorted = gaps;
    std::sort(sorted.begin(), sorted.end());
    const double usual = sorted[sorted.size() / 2];
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        const std::string between = fmt::format("between {} and {}", slices[i].file, slices[i + 1].file);
        if (gaps[i] < kEven_mm)
            return DicomRefusal{fmt::format("{} and {} lie at the same place (double slice)", slices[i].file, slices[i + 1].file),
                                "Keep one of them, or name one series."};
        const double steps = std::round(gaps[i] / usual);
        if (steps >= 2 && std::abs(gaps[i] - steps * usual) < 0.1 * usual)
            return DicomRefusal{fmt::format("{} slice(s) are missing {}: the gap is {:.3f} mm, elsewhere {:.3f} mm", static_cast<int>(steps) - 1, between, gaps[i], usual),
                                "Export the whole series again."};
        if (std::abs(gaps[i] - usual) > kEven_mm)
            return DicomRefusal{fmt::format("the slices are not evenly spaced: {:.3f} mm {}, elsewhere {:.3f} mm", gaps[i], between, usual),
                                "Reconstruct or resample the series with one spacing."};
    }
    const Eigen::Vector3d first = slices.front().position_in_ct;
    const Eigen::Vector3d step = (slices.back().position_in_ct - first) / static_cast<double>(slices.size() - 1);
    for (std::size_t i = 0; i < slices.size(); ++i) {
        const double off = (slices[i].position_in_ct - first - static_cast<double>(i) * step).norm();
        if (off > 5 * kEven_mm)
            return DicomRefusal{fmt::format("{} lies {:.3f} mm off the straight line of the other slices", slices[i].file, off), "Export the series again."};
    }
    if (!(normal.dot(step.normalized()) > 0.5))
        return DicomRefusal{"the slices are shifted against each other by more than a tilted gantry does", "Export the series again."};
    return std::nullopt;
}

}  // namespace

std::optional<DicomRefusal> fault_of(std::vector<DicomSlice> slices) {
    for (const DicomSlice& s : slices)
        if (const auto fault = fault_of_slice(s)) return fault;
    if (slices.size() < kFewestSlices)
        return DicomRefusal{fmt::format("the series has {} slice(s), fewer than {}", slices.size(), kFewestSlices), "Give the whole series of thin slices."};
    for (const DicomSlice& s : slices)
        if (const auto fault = fault_of_pair(slices.front(), s)) return fault;
    const Eigen::Vector3d normal = slices.front().row_direction.cross(slices.front().column_direction).normalized();
    std::sort(slices.begin(), slices.end(),
              [&](const DicomSlice& a, const DicomSlice& b) { return normal.dot(a.position_in_ct) < normal.dot(b.position_in_ct); });
    return fault_of_stack(slices, normal);
}

Eigen::Affine3d ct_from_voxel_of(const std::vector<DicomSlice>& slices) {
    const DicomSlice& first = slices.front();
    Eigen::Affine3d affine = Eigen::Affine3d::Identity();
    affine.linear().col(0) = first.column_spacing_mm * first.row_direction;
    affine.linear().col(1) = first.row_spacing_mm * first.column_direction;
    affine.linear().col(2) = (slices.back().position_in_ct - first.position_in_ct) / static_cast<double>(slices.size() - 1);
    affine.translation() = first.position_in_ct;
    return affine;
}

}  // namespace planlight
