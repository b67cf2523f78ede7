#include "planning_io/dicom/dicom_slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "planning_io/files/header_text.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

constexpr double kEven_mm = 0.01;
constexpr double kEvenPlace_mm = 0.05, kEvenShare = 0.02;  // of a slice on the even grid: mm, and of the step
constexpr double kLongestStep_mm = 20;
constexpr double kSameDirection = 1e-4;
constexpr double kOrthonormal = 1e-3;  // of cosines that are written with three decimals
constexpr const char* kOneSeries = "Export one series of one patient into a folder of its own.";
constexpr const char* kExportAgain = "Export the series again from the scanner or the archive.";

DicomRefusal refusal(const std::string& problem, const char* remedy = kExportAgain) {
    return {problem, remedy};
}

std::string numbers(const Eigen::Vector3d& v) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x(), v.y(), v.z());
}

std::optional<DicomRefusal> fault_of_axes(const DicomSlice& s) {
    const Eigen::Vector3d &r = s.row_direction, &c = s.column_direction;
    if (!r.allFinite() || !c.allFinite()) return refusal(s.file + " has no orientation (Image Orientation, Patient)");
    if (const double off = std::max(std::abs(r.norm() - 1), std::abs(c.norm() - 1)); off > kOrthonormal)
        return refusal(fmt::format("{} has directions {} and {}, which are not of length 1 (off by {:.2g})", s.file,
                                   numbers(r), numbers(c), off));
    if (const double cosine = std::abs(r.dot(c)); cosine > kOrthonormal)
        return refusal(fmt::format(
            "{} has rows and columns that are not perpendicular (the cosine between them is {:.2g})", s.file, cosine));
    return std::nullopt;
}

std::optional<DicomRefusal> fault_of_values(const DicomSlice& s) {
    if (s.samples != 1) return refusal(s.file + " is a colour picture, not a slice", "Give a CT or MR series.");
    if (transfer_syntax_of(s.transfer_syntax) == TransferSyntax::unknown)
        return refusal(
            fmt::format("{} is packed in a way that is not understood (transfer syntax {})", s.file, s.transfer_syntax),
            "Export the series uncompressed, or with JPEG lossless, JPEG-LS or JPEG 2000.");
    if (!std::isfinite(s.slope) || !std::isfinite(s.intercept) || s.slope <= 0 || s.slope > 1e6 ||
        std::abs(s.intercept) > 1e6)
        return refusal(fmt::format("{} scales its values by {} x + {}", s.file, s.slope, s.intercept));
    if (!s.projected.empty())
        return refusal(fmt::format("{} is no slice of the patient but made of several ({})", s.file, s.projected),
                       "Give the thin slices that it was made of: the skin of a projection is swollen.");
    if (!s.defaced.empty())
        return refusal(s.file + " says that the face was taken away (" + s.defaced + ")",
                       "Give the series as the scanner made it: the light is aligned by the skin of the face.");
    return std::nullopt;
}

std::optional<DicomRefusal> fault_of_slice(const DicomSlice& s) {
    if (const auto fault = fault_of_values(s)) return fault;
    if (!s.position_in_ct.allFinite())
        return refusal(s.file + " has no position (Image Position, Patient)",
                       "Give a series of slices with positions in space.");
    if (s.position_in_ct.cwiseAbs().maxCoeff() > 1e4)
        return refusal(s.file + " lies at " + numbers(s.position_in_ct) + " mm, outside of any scanner");
    if (const auto fault = fault_of_axes(s)) return fault;
    for (const double spacing : {s.column_spacing_mm, s.row_spacing_mm}) {
        if (std::isnan(spacing)) return refusal(s.file + " has no pixel spacing");
        if (!(spacing > 0.01) || !(spacing < 20))
            return refusal(fmt::format("{} has a pixel spacing of {} mm", s.file, spacing));
    }
    if (s.columns < kFewestSlices || s.rows < kFewestSlices)
        return refusal(fmt::format("{} is {} x {} pixels, fewer than {}", s.file, s.columns, s.rows, kFewestSlices));
    return std::nullopt;
}

std::optional<DicomRefusal> fault_of_pair(const DicomSlice& a, const DicomSlice& b) {
    const std::string both = a.file + " and " + b.file;
    if (a.patient != b.patient) return refusal(both + " are of two patients", kOneSeries);
    if (a.frame_of_reference_uid != b.frame_of_reference_uid)
        return refusal(fmt::format("{} are in two frames of reference ({} and {})", both, a.frame_of_reference_uid,
                                   b.frame_of_reference_uid),
                       kOneSeries);
    if (a.patient_position != b.patient_position)
        return refusal(
            fmt::format("{} are of two patient positions ({} and {})", both, a.patient_position, b.patient_position),
            kOneSeries);
    if (a.columns != b.columns || a.rows != b.rows)
        return refusal(
            fmt::format("{} is {} x {} pixels, {} is {} x {}", a.file, a.columns, a.rows, b.file, b.columns, b.rows),
            kOneSeries);
    if (std::abs(a.column_spacing_mm - b.column_spacing_mm) > 1e-4 ||
        std::abs(a.row_spacing_mm - b.row_spacing_mm) > 1e-4)
        return refusal(fmt::format("{} has pixels of {} x {} mm, {} of {} x {}", a.file, a.column_spacing_mm,
                                   a.row_spacing_mm, b.file, b.column_spacing_mm, b.row_spacing_mm),
                       kOneSeries);
    if (a.stored_as != b.stored_as)
        return refusal(fmt::format("{} is stored with {}, {} with {}", a.file, a.stored_as, b.file, b.stored_as),
                       kOneSeries);
    if (a.has_rescale != b.has_rescale)
        return refusal(fmt::format("{} has a rescale slope and intercept, {} has none: the values have two meanings",
                                   (a.has_rescale ? a : b).file, (a.has_rescale ? b : a).file));
    const double turned = std::max((a.row_direction - b.row_direction).cwiseAbs().maxCoeff(),
                                   (a.column_direction - b.column_direction).cwiseAbs().maxCoeff());
    if (turned > kSameDirection)
        return refusal(fmt::format("{} are not parallel (directions differ by {:.2g})", both, turned), kOneSeries);
    return std::nullopt;
}

/// Of slices sorted along their normal.
std::optional<DicomRefusal> fault_of_stack(const std::vector<DicomSlice>& slices, const Eigen::Vector3d& normal,
                                           SliceGaps allowed) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < slices.size(); ++i)
        gaps.push_back(normal.dot(slices[i].position_in_ct - slices[i - 1].position_in_ct));
    std::vector<double> sorted = gaps;
    std::sort(sorted.begin(), sorted.end());
    const double usual = sorted[sorted.size() / 2];
    if (sorted.back() < kEven_mm)
        return refusal(fmt::format("all {} slices lie at one position, {} mm", slices.size(),
                                   numbers(slices.front().position_in_ct)),
                       "Give a series whose slices follow each other in space.");
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        const std::string between = fmt::format("between {} and {}", slices[i].file, slices[i + 1].file);
        if (gaps[i] < kEven_mm && slices[i].file == slices[i + 1].file)
            return refusal(fmt::format("two files named {} lie at the same place (double slice)", slices[i].file),
                           "They lie in different folders: give the folder of one copy.");
        if (gaps[i] < kEven_mm)
            return refusal(fmt::format("{} and {} lie at the same place, {:.3f} mm apart (double slice)",
                                       slices[i].file, slices[i + 1].file, gaps[i]),
                           "Keep one of them, or name one series.");
        const double steps = std::round(gaps[i] / usual);
        // A whole part of the stack with twice the step is a second spacing, not a row of missing slices.
        const auto like_this =
            std::count_if(gaps.begin(), gaps.end(), [&](double g) { return std::abs(g - gaps[i]) < 0.1 * usual; });
        const bool second_spacing = allowed == SliceGaps::resampled && like_this >= 3;
        if (steps >= 2 && std::abs(gaps[i] - steps * usual) < 0.1 * usual && !second_spacing)
            return DicomRefusal{
                fmt::format("{} missing {}: the gap is {:.3f} mm, elsewhere {:.3f} mm",
                            counted(static_cast<int>(steps) - 1, "slice") + (steps == 2 ? " is" : " are"), between,
                            gaps[i], usual),
                like_this < 3 ? "Export the whole series again."
                              : "Export the whole series again; if it was scanned with two steps, lay it onto an even "
                                "grid between the cuts (`planlight prepare --resample`)."};
        if (gaps[i] > kLongestStep_mm)
            return DicomRefusal{fmt::format("the gap {} is {:.1f} mm", between, gaps[i]),
                                "Give a series of thinner slices."};
    }
    if (allowed == SliceGaps::refused && !is_even(slices))
        return DicomRefusal{
            fmt::format(
                "the slices are not evenly spaced: steps of {:.3f} to {:.3f} mm, one lies {:.2f} mm off an even stack",
                sorted.front(), sorted.back(), unevenness_of(slices)),
            "Lay them onto an even grid between the cuts where they lie (`planlight prepare --resample`), or "
            "reconstruct the "
            "series with one spacing."};
    const std::vector<double> places = places_along_stack(slices);
    const Eigen::Vector3d first = slices.front().position_in_ct;
    const Eigen::Vector3d along = (slices.back().position_in_ct - first).normalized(), step = along * usual;
    for (std::size_t i = 0; i < slices.size(); ++i) {
        const double off = (slices[i].position_in_ct - first - places[i] * along).norm();
        if (off > std::max(kEvenPlace_mm, kEvenShare * usual))
            return DicomRefusal{
                fmt::format("{} lies {:.3f} mm off the straight line of the other slices", slices[i].file, off),
                "Export the series again."};
    }
    if (!(normal.dot(step.normalized()) > 0.5))
        return DicomRefusal{"the slices are shifted against each other by more than a tilted gantry does",
                            "Export the series again."};
    return std::nullopt;
}

}  // namespace

std::optional<DicomRefusal> fault_of(std::vector<DicomSlice> slices, SliceGaps gaps) {
    for (const DicomSlice& s : slices)
        if (const auto fault = fault_of_slice(s)) return fault;
    if (slices.size() < static_cast<std::size_t>(kFewestSlices))
        return DicomRefusal{fmt::format("the series has {}, fewer than {}",
                                        counted(static_cast<long long>(slices.size()), "slice"), kFewestSlices),
                            "Give the whole series of thin slices."};
    for (const DicomSlice& s : slices)
        if (const auto fault = fault_of_pair(slices.front(), s)) return fault;
    const Eigen::Vector3d normal = slices.front().row_direction.cross(slices.front().column_direction).normalized();
    std::sort(slices.begin(), slices.end(), [&](const DicomSlice& a, const DicomSlice& b) {
        return normal.dot(a.position_in_ct) < normal.dot(b.position_in_ct);
    });
    return fault_of_stack(slices, normal, gaps);
}

std::vector<double> places_along_stack(const std::vector<DicomSlice>& slices) {
    const Eigen::Vector3d first = slices.front().position_in_ct,
                          along = (slices.back().position_in_ct - first).normalized();
    std::vector<double> places;
    for (const DicomSlice& s : slices) places.push_back(along.dot(s.position_in_ct - first));
    return places;
}

double unevenness_of(const std::vector<DicomSlice>& slices) {
    const std::vector<double> places = places_along_stack(slices);
    double worst = 0;
    for (std::size_t i = 0; i < places.size(); ++i)
        worst = std::max(worst, std::abs(places[i] - places.back() * static_cast<double>(i) /
                                                         static_cast<double>(places.size() - 1)));
    return worst;
}

bool is_even(const std::vector<DicomSlice>& slices) {
    const std::vector<double> places = places_along_stack(slices);
    std::vector<double> steps;
    for (std::size_t i = 1; i < places.size(); ++i) steps.push_back(std::abs(places[i] - places[i - 1]));
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return unevenness_of(slices) <= std::max(kEvenPlace_mm, kEvenShare * *middle);
}

double axes_off(const DicomSlice& s) {
    return std::max({std::abs(s.row_direction.norm() - 1), std::abs(s.column_direction.norm() - 1),
                     std::abs(s.row_direction.dot(s.column_direction))});
}

Eigen::Affine3d ct_from_voxel_of(const std::vector<DicomSlice>& slices) {
    const DicomSlice& first = slices.front();
    Eigen::Affine3d affine = Eigen::Affine3d::Identity();
    Eigen::Vector3d row = first.row_direction, column = first.column_direction;
    if (axes_off(first) > kAsWritten) {  // each turned by as much as the other
        const Eigen::Vector3d r = row.normalized(), c = column.normalized(), sum = (r + c).normalized(),
                              difference = (r - c).normalized();
        row = (sum + difference) * std::sqrt(0.5);
        column = (sum - difference) * std::sqrt(0.5);
    }
    affine.linear().col(0) = first.column_spacing_mm * row;
    affine.linear().col(1) = first.row_spacing_mm * column;
    affine.linear().col(2) =
        (slices.back().position_in_ct - first.position_in_ct) / static_cast<double>(slices.size() - 1);
    affine.translation() = first.position_in_ct;
    return affine;
}

double tilt_of(const Eigen::Affine3d& ct_from_voxel) {
    const Eigen::Matrix3d axes = ct_from_voxel.linear().colwise().normalized();
    return std::acos(std::clamp(std::abs(axes.col(0).cross(axes.col(1)).normalized().dot(axes.col(2))), 0.0, 1.0));
}

TransferSyntax transfer_syntax_of(const std::string& uid) {
    static const std::map<std::string, TransferSyntax> kKnown = {
        {"", TransferSyntax::lossless},                        // no file header: implicit little endian
        {"1.2.840.10008.1.2", TransferSyntax::lossless},       // implicit little endian
        {"1.2.840.10008.1.2.1", TransferSyntax::lossless},     // explicit little endian
        {"1.2.840.10008.1.2.1.99", TransferSyntax::lossless},  // deflated
        {"1.2.840.10008.1.2.2", TransferSyntax::lossless},     // explicit big endian
        {"1.2.840.10008.1.2.5", TransferSyntax::lossless},     // RLE
        {"1.2.840.10008.1.2.4.50", TransferSyntax::lossy},     // JPEG baseline
        {"1.2.840.10008.1.2.4.51", TransferSyntax::lossy},     // JPEG extended
        {"1.2.840.10008.1.2.4.57", TransferSyntax::lossless},  // JPEG lossless
        {"1.2.840.10008.1.2.4.70", TransferSyntax::lossless},  // JPEG lossless, first-order prediction
        {"1.2.840.10008.1.2.4.80", TransferSyntax::lossless},  // JPEG-LS
        {"1.2.840.10008.1.2.4.81", TransferSyntax::lossy},     // JPEG-LS near-lossless
        {"1.2.840.10008.1.2.4.90", TransferSyntax::lossless},  // JPEG 2000 lossless
        {"1.2.840.10008.1.2.4.91", TransferSyntax::lossy}};    // JPEG 2000
    const auto known = kKnown.find(uid);
    return known == kKnown.end() ? TransferSyntax::unknown : known->second;
}

}  // namespace planlight
