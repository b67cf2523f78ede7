#include "planning_io/plan/plan_rtstruct.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "planning_io/dicom/rt_struct.h"
#include "planning_io/plan/contour_stack.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_settings.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double kMaxCoordinate_mm = 5000;

/// One ROI's contours into the plan.
class RoiReader {
public:
    RoiReader(const RtRoi& roi, const fs::path& file)
        : roi_(roi), file_(file), said_(roi.description, [this](const std::string& p) { refuse(p); }) {
        if (roi.colour.size() == 3)
            colour_ = Colour{static_cast<float>(roi.colour[0] / 255), static_cast<float>(roi.colour[1] / 255),
                             static_cast<float>(roi.colour[2] / 255)};
    }

    /// A word for why the ROI is nothing to draw; empty when it is.
    std::string nothing_to_draw() const {
        if (roi_.contours.empty()) return "has no contours";
        if (said_.text("kind")) return {};
        // Of targets and outlines some systems draw the borders that are wanted on the skin.
        const std::set<std::string> never{"MARKER", "ISOCENTER", "REGISTRATION", "BOLUS", "SUPPORT", "FIXATION"};
        if (const std::string what = no_organ(roi_); never.contains(roi_.interpreted_type))
            return fmt::format(
                "is {} by its type ({}), nothing to be lit (its description `kind=osteotomy_line` or `kind=borehole` "
                "says otherwise)",
                what, roi_.interpreted_type);
        // A lens lies on two slices of a usual CT.
        const bool organ = roi_.interpreted_type == "ORGAN" || roi_.interpreted_type == "AVOIDANCE";
        const std::size_t heights = count_heights();
        return heights >= (organ ? 2 : kSolidHeights)
                   ? fmt::format("has contours at {} heights: a solid, not a line (--risk takes it)", heights)
                   : std::string();
    }

    void append_to(Plan& plan) const {
        const auto kind = said_.text("kind");
        for (std::size_t c = 0; c < roi_.contours.size(); ++c) {
            const std::string name = roi_.contours.size() == 1 ? roi_.name : fmt::format("{} {}", roi_.name, c + 1);
            auto points = points_of_contour(roi_.contours[c]);
            const std::string& type = roi_.contours[c].type;
            if (type == "POINT") {
                if (points.size() != 1) refuse(fmt::format("is a POINT of {} points", points.size()));
                plan.boreholes.push_back({name, points[0], axis(), said_.length_mm("diameter_mm", kMaxDiameter_mm),
                                          said_.length_mm("depth_mm", kMaxDepth_mm), colour_});
            } else if (kind == "trajectory") {
                if (points.size() != 2 || points[0] == points[1]) refuse("is not a trajectory of two points");
                plan.trajectories.push_back(
                    {name, points[0], points[1], said_.length_mm("diameter_mm", kMaxDiameter_mm), colour_});
            } else if (kind == "cut_plane") {
                append_plane(plan, name, points);
            } else if (is_closed(roi_.contours[c]) || type == "OPEN_PLANAR" || type == "OPEN_NONPLANAR") {
                append_line(plan, name, std::move(points), is_closed(roi_.contours[c]));
            } else {
                refuse("has a contour of the type \"" + type + "\"");
            }
        }
    }

private:
    [[noreturn]] void refuse(const std::string& problem) const {
        throw InputError(file_, "ROI \"" + roi_.name + "\" " + problem,
                         "Correct this ROI, or export the plan without it.");
    }

    std::optional<Vector3d> axis() const {
        const auto given = said_.text("axis");
        if (!given) return std::nullopt;
        Vector3d a;
        if (std::sscanf(given->c_str(), "%lf,%lf,%lf", &a.x(), &a.y(), &a.z()) != 3 || !(std::abs(a.norm() - 1) < 1e-3))
            refuse("describes axis=" + *given + ", not three numbers of unit length");
        return a.normalized();
    }

    std::vector<Vector3d> points_of_contour(const RtContour& contour) const {
        std::vector<Vector3d> points;
        for (std::size_t i = 0; i + 2 < contour.numbers.size(); i += 3) {
            points.emplace_back(contour.numbers[i], contour.numbers[i + 1], contour.numbers[i + 2]);
            if (!points.back().allFinite() || points.back().cwiseAbs().maxCoeff() > kMaxCoordinate_mm)
                refuse("has a coordinate that is not a number of mm within 5 m");
        }
        if (points.empty()) refuse("has a contour without points");
        return points;
    }

    void append_line(Plan& plan, const std::string& name, std::vector<Vector3d> points, bool closed) const {
        if (points.size() > 3 && points.front() == points.back()) {
            points.pop_back();
            closed = true;
        }
        points.erase(std::unique(points.begin(), points.end()), points.end());  // contours are rounded to few digits
        if (points.size() < (closed ? 3U : 2U))
            refuse(fmt::format("has a {} contour of {} points", closed ? "closed" : "open", points.size()));
        plan.osteotomy_lines.push_back({name, std::move(points), closed, colour_});
    }

    void append_plane(Plan& plan, const std::string& name, const std::vector<Vector3d>& p) const {
        if (p.size() != 4 || (p[0] + p[2] - p[1] - p[3]).norm() > 1e-3) refuse("is not a plane of four corners");
        const Vector3d u = p[1] - p[0], v = p[2] - p[1];
        if (!(u.norm() > 1e-3) || !(v.norm() > 1e-3) || std::abs(u.normalized().dot(v.normalized())) > 1e-3)
            refuse("is not a rectangle");
        const Vector3d normal = u.cross(v).normalized();
        plan.cut_planes.push_back({name, (p[0] + p[2]) / 2, normal, u.normalized(), u.norm(), v.norm(), colour_});
    }

    std::size_t count_heights() const {
        std::vector<std::vector<Vector3d>> closed;
        for (const RtContour& contour : roi_.contours)
            if (is_closed(contour)) closed.push_back(points_of_contour(contour));
        return heights_of_contours(closed);
    }

    const RtRoi& roi_;
    const fs::path& file_;
    PlanSettings said_;
    std::optional<Colour> colour_;
};

}  // namespace

void check_frame_of_reference(const std::string& uid_of_plan, const PlanImportSettings& settings, const fs::path& file,
                              std::vector<std::string>& notes) {
    if (uid_of_plan.empty())
        throw InputError(file, "does not name its frame of reference", "Export it again, on the CT of the case.");
    if (settings.frame_of_reference_uid == uid_of_plan) return;
    if (settings.accepted_frame_uid == uid_of_plan) {
        const char* const but = !settings.frame_of_reference_uid           ? ""
                                : settings.frame_of_reference_uid->empty() ? ", which names none"
                                                                           : ", which names another";
        notes.push_back(fmt::format("{}: nothing but --accept-frame says that its frame of reference is the volume's{}",
                                    file.filename().string(), but));
        return;
    }
    if (!settings.frame_of_reference_uid && settings.accepted_frame_uid.empty()) {
        notes.push_back(fmt::format("{}: its frame of reference {} was not checked against a CT",
                                    file.filename().string(), uid_of_plan));
        return;
    }
    if (!settings.frame_of_reference_uid)
        throw InputError(file,
                         "is in the frame of reference " + uid_of_plan + ", not in " + settings.accepted_frame_uid,
                         "Give --accept-frame the frame of reference that the file is in.");
    const std::string& of_ct = *settings.frame_of_reference_uid;
    if (of_ct.empty())
        throw InputError(file, "is in the frame of reference " + uid_of_plan + ", and the volume names none",
                         "Prepare the case from the DICOM series that it was drawn on, or say --accept-frame " +
                             uid_of_plan + " if it was.");
    if (of_ct != uid_of_plan)
        throw InputError(file, "is in the frame of reference " + uid_of_plan + ", the volume in " + of_ct,
                         "Give the structure set that was drawn on this series.");
}

namespace {

bool differ(const std::string& a, const std::string& b) {
    return !a.empty() && !b.empty() && a != b;
}

/// Empty where the set was drawn on the volume's series, or it is not known.
std::string other_series(const RtStruct& set, const SeriesIdentity& volume) {
    const bool other_study = differ(set.identity.study_uid, volume.study_uid);
    if (volume.series_uid.empty() || std::ranges::count(set.referenced_series, volume.series_uid) > 0) return {};
    if (!set.referenced_series.empty())
        return fmt::format("says that it was drawn on another series than the volume{}, in the same frame of reference",
                           other_study ? ", and is of another study" : "");
    return other_study ? "does not say on which series it was drawn, and is of another study than the volume" : "";
}

}  // namespace

void check_frame_of_reference(const RtStruct& set, const PlanImportSettings& settings, const fs::path& file,
                              std::vector<std::string>& notes) {
    check_frame_of_reference(set.frame_of_reference_uid, settings, file, notes);
    if (set.ours) return;
    const std::string name = file.filename().string();
    if (differ(set.identity.patient_hash, settings.volume.patient_hash)) {
        if (settings.accepted_frame_uid != set.frame_of_reference_uid)
            throw InputError(file, "is of another patient: its Patient ID is not the volume's",
                             "Give the structure set of this patient. If it is this patient under another number, say "
                             "--accept-frame " +
                                 set.frame_of_reference_uid + ".");
        notes.push_back(name +
                        ": nothing but --accept-frame says that it is of this patient: its Patient ID is not the "
                        "volume's");
    }
    if (const std::string other = other_series(set, settings.volume); !other.empty())
        notes.push_back(name + " " + other + ": check that its items lie where they belong");
}

PlanImport read_rtstruct(const fs::path& file, const PlanImportSettings& settings) {
    PlanImport read;
    if (settings.space == Space::ras && !settings.one_of_several)
        throw InputError(file, "is DICOM, which is always LPS; --frame says RAS", "Leave --frame out.");
    space_of_plan(std::optional(Space::lps), settings, file, "", read);
    const RtStruct set = read_rt_struct(file);
    const auto& rois = set.rois;
    read.frame_of_reference_uid = set.frame_of_reference_uid;
    check_frame_of_reference(set, settings, file, read.notes);
    if (settings.frame_of_reference_uid && !settings.frame_of_reference_uid->empty())
        read.frame_of_reference_uid = *settings.frame_of_reference_uid;
    for (const RtRoi& roi : rois) {
        const RoiReader reader(roi, file);
        const std::string why_not = reader.nothing_to_draw();
        if (why_not.empty())
            reader.append_to(read.plan);
        else
            read.notes.push_back(
                fmt::format("{}: ROI \"{}\" {}; it is left out", file.filename().string(), roi.name, why_not));
    }
    if (read.plan.empty()) {
        std::string all;
        for (const auto& note : read.notes) all += "\n  " + note;
        throw InputError(file, fmt::format("holds nothing to draw; of its {} ROIs:{}", rois.size(), all),
                         "Draw the cuts as single contours and the holes as points.");
    }
    return read;
}

}  // namespace planlight
