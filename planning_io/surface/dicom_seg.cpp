#include "planning_io/surface/dicom_seg.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vtkDICOMDictionary.h>
#include <vtkDICOMItem.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMParser.h>
#include <vtkDICOMSequence.h>
#include <vtkNew.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "planning_io/dicom/dicom_nesting.h"
#include "planning_io/dicom/header_values.h"
#include "planning_io/files/header_text.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/files/sandboxed_process.h"
#include "planning_io/plan/plan_rtstruct.h"
#include "planning_io/surface/mask_surface.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kSegClass = "1.2.840.10008.5.1.4.1.1.66.4";
constexpr const char* kExportAgain =
    "Export the segmentation as a binary, uncompressed DICOM SEG, or as STL with its space.";
constexpr int kMostEmpty = 20;  // slices a frame: the others would be gaps
constexpr double kEven = 0.05;  // of a slice's distance

std::string text(const vtkDICOMValue& value) {
    std::string result = value.IsValid() ? value.AsUTF8String() : std::string();
    while (!result.empty() && (result.back() == ' ' || result.back() == '\0')) result.pop_back();
    return result;
}

/// As many numbers of a frame as `count`, six at most.
std::array<double, 6> numbers(vtkDICOMMetaData* meta, int frame, vtkDICOMTag tag, unsigned count, const fs::path& file,
                              const char* what) {
    const auto list = numbers_at(meta, frame, tag, count);
    if (!std::all_of(list.begin(), list.begin() + count, [](double n) { return std::abs(n) <= 1e5; }))
        throw InputError(file, fmt::format("has a frame without {} in numbers that make sense", what), kExportAgain);
    return list;
}

/// The number of the segment with this label, or of the only one.
int chosen_segment(vtkDICOMMetaData* meta, const std::string& wanted, const fs::path& file) {
    const vtkDICOMSequence segments = meta->Get(DC::SegmentSequence);
    std::vector<std::string> labels;
    for (std::size_t i = 0; i < segments.GetNumberOfItems(); ++i)
        labels.push_back(text(segments.GetItem(i).Get(DC::SegmentLabel)));
    if (labels.empty()) throw InputError(file, "names no segment", kExportAgain);
    const auto found =
        wanted.empty() && labels.size() == 1 ? labels.begin() : std::find(labels.begin(), labels.end(), wanted);
    if (found == labels.end())
        throw InputError(file,
                         wanted.empty()
                             ? fmt::format("holds {} segments: {}", labels.size(), fmt::join(labels, ", "))
                             : fmt::format("holds no segment \"{}\"; there is: {}", wanted, fmt::join(labels, ", ")),
                         "Choose one by its label (--segment LABEL).");
    if (std::count(labels.begin(), labels.end(), *found) > 1)
        throw InputError(file, "holds two segments of the label \"" + *found + "\"", kExportAgain);
    return segments.GetItem(static_cast<std::size_t>(found - labels.begin())).Get(DC::SegmentNumber).AsInt();
}

struct Frame {
    int index;
    Vector3d position_in_ct;
};

/// A stack of bits in ct: one segment's frames on even slices.
struct Stack {
    int columns = 0, rows = 0, slices = 0;
    Eigen::Affine3d ct_from_voxel = Eigen::Affine3d::Identity();
    std::vector<std::pair<int, int>> frame_and_slice;
};

Stack stack_of(vtkDICOMMetaData* meta, int segment, const fs::path& file) {
    Stack stack;
    stack.columns = meta->Get(DC::Columns).AsInt();
    stack.rows = meta->Get(DC::Rows).AsInt();
    const int count = meta->Get(DC::NumberOfFrames).AsInt();
    if (stack.columns < 2 || stack.rows < 2 || stack.columns > 4096 || stack.rows > 4096 || count < 1 || count > 100000)
        throw InputError(file, "holds no frames", kExportAgain);
    std::vector<Frame> frames;
    std::optional<Vector3d> along_row, along_column;
    double column_mm = 0, row_mm = 0;
    for (int f = 0; f < count; ++f) {
        if (meta->Get(0, f, DC::ReferencedSegmentNumber).AsInt() != segment) continue;
        const auto o = numbers(meta, f, DC::ImageOrientationPatient, 6, file, "orientation"),
                   spacing = numbers(meta, f, DC::PixelSpacing, 2, file, "pixel spacing"),
                   p = numbers(meta, f, DC::ImagePositionPatient, 3, file, "position");
        const Vector3d r(o[0], o[1], o[2]), c(o[3], o[4], o[5]);
        if (along_row && ((*along_row - r).norm() > 1e-3 || (*along_column - c).norm() > 1e-3 ||
                          std::abs(spacing[0] - row_mm) > 1e-3))
            throw InputError(file, "has frames that are not parallel, or of different spacing", kExportAgain);
        along_row = r;
        along_column = c;
        row_mm = spacing[0];
        column_mm = spacing[1];
        frames.push_back({f, {p[0], p[1], p[2]}});
    }
    if (frames.size() < 2)
        throw InputError(file, "holds " + counted(static_cast<long long>(frames.size()), "frame") + " of this segment",
                         kExportAgain);
    if (!(row_mm > 0.01) || !(column_mm > 0.01) || row_mm > 20 || column_mm > 20 ||
        std::abs(along_row->norm() - 1) > 1e-3 || std::abs(along_column->norm() - 1) > 1e-3)
        throw InputError(file, "has a pixel spacing or an orientation that makes no sense", kExportAgain);
    const Vector3d normal = along_row->cross(*along_column).normalized();
    const auto height = [&](const Frame& f) { return normal.dot(f.position_in_ct); };
    std::sort(frames.begin(), frames.end(), [&](const Frame& a, const Frame& b) { return height(a) < height(b); });
    double step = 1e9;
    for (std::size_t i = 1; i < frames.size(); ++i) step = std::min(step, height(frames[i]) - height(frames[i - 1]));
    if (!(step > 0.05)) throw InputError(file, "has two frames of one segment at one place", kExportAgain);
    const double whole = height(frames.back()) - height(frames.front());
    step = whole / std::round(whole / step);  // the smallest gap is rounded; over all of them that would add up
    for (const Frame& f : frames) {
        const double slice = (height(f) - height(frames.front())) / step;
        if (std::abs(slice - std::round(slice)) > kEven)
            throw InputError(file, "has frames that are not evenly spaced", kExportAgain);
        stack.frame_and_slice.emplace_back(f.index, static_cast<int>(std::lround(slice)));
    }
    const int last = stack.frame_and_slice.back().second;
    if (last >= kMostEmpty * static_cast<int>(frames.size()))
        throw InputError(file, fmt::format("has {} frames over {} slices", frames.size(), last + 1), kExportAgain);
    stack.slices = last + 1;
    stack.ct_from_voxel.linear().col(0) = column_mm * *along_row;
    stack.ct_from_voxel.linear().col(1) = row_mm * *along_column;
    stack.ct_from_voxel.linear().col(2) = (frames.back().position_in_ct - frames.front().position_in_ct) / last;
    stack.ct_from_voxel.translation() = frames.front().position_in_ct;
    return stack;
}

/// The segment's voxels from the packed bits of all frames, which follow each other without padding.
MaskStack mask_of(const Stack& stack, std::string_view bits, const fs::path& file) {
    MaskStack mask{{stack.columns, stack.rows, stack.slices}, stack.ct_from_voxel, {}};
    const std::size_t pixels = static_cast<std::size_t>(stack.columns) * static_cast<std::size_t>(stack.rows);
    mask.inside.assign(pixels * static_cast<std::size_t>(stack.slices), 0);
    for (const auto& [frame, slice] : stack.frame_and_slice)
        for (std::size_t i = 0; i < pixels; ++i) {
            const std::size_t bit = static_cast<std::size_t>(frame) * pixels + i;
            if (bit / 8 >= bits.size())
                throw DamagedFileError(file, "holds fewer pixels than it announces", kExportAgain);
            mask.inside[static_cast<std::size_t>(slice) * pixels + i] =
                (static_cast<unsigned char>(bits[bit / 8]) >> (bit % 8)) & 1;
        }
    return mask;
}

void parse(Parcel& parcel, const fs::path& file, const std::string& segment) {
    const std::string content = read_whole(file);
    if (!dicom_nests_to_its_end(content)) throw DamagedFileError(file, "is damaged or cut short", kExportAgain);
    vtkNew<vtkDICOMMetaData> meta;
    vtkNew<vtkDICOMParser> parser;
    parser->SetFileName(file.c_str());
    parser->SetMetaData(meta);
    parser->Update();
    if (parser->GetErrorCode() != 0) throw DamagedFileError(file, "is damaged or cut short", kExportAgain);
    const std::string kind = text(meta->Get(DC::SOPClassUID)), modality = text(meta->Get(DC::Modality)),
                      syntax = text(meta->Get(DC::TransferSyntaxUID));
    if (kind != kSegClass)
        throw InputError(
            file, "is DICOM of modality " + (modality.empty() ? "unknown" : modality) + ", not a segmentation (SEG)",
            kExportAgain);
    if (text(meta->Get(DC::SegmentationType)) != "BINARY" || meta->Get(DC::BitsAllocated).AsInt() != 1)
        throw InputError(file,
                         "is a segmentation of the type " + text(meta->Get(DC::SegmentationType)) + ", not BINARY",
                         kExportAgain);
    if (syntax != "1.2.840.10008.1.2" && syntax != "1.2.840.10008.1.2.1")
        throw InputError(file, "is compressed or big endian (" + syntax + ")", kExportAgain);
    parcel.put(text(meta->Get(DC::FrameOfReferenceUID)));
    const Stack stack = stack_of(meta, chosen_segment(meta, segment, file), file);
    if (static_cast<double>(stack.columns) * stack.rows * stack.slices > 7e8)
        throw InputError(file, "is larger than 700 million voxels", "Resample the segmentation to larger voxels.");
    const auto offset = static_cast<std::size_t>(std::max<vtkTypeInt64>(0, parser->GetFileOffset()));
    if (!parser->GetPixelDataFound() || offset >= content.size())
        throw DamagedFileError(file, "holds no pixels", kExportAgain);
    const double pixels = static_cast<double>(meta->Get(DC::NumberOfFrames).AsInt()) * stack.columns * stack.rows;
    if (pixels > 8 * static_cast<double>(content.size() - offset))
        throw DamagedFileError(file, "holds fewer pixels than it announces", kExportAgain);
    const TriangleMesh mesh = surface_of_mask(mask_of(stack, std::string_view(content).substr(offset), file));
    if (mesh.triangles.empty()) throw InputError(file, "has an empty segment", "Choose another segment.");
    std::vector<double> coordinates;
    for (const auto& p : mesh.vertices_in_ct) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
    parcel.put(coordinates);
    parcel.put(mesh.triangles);
}

}  // namespace

bool is_dicom_file(const fs::path& file) {
    std::string head(132, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    return in.gcount() == 132 && head.compare(128, 4, "DICM") == 0;
}

TriangleMesh read_dicom_seg(const fs::path& file, const std::string& segment, const PlanImportSettings& settings,
                            std::vector<std::string>& notes) {
    Parcel parcel = parse_in_child(file, {"DICOM file"}, [&](Parcel& p) { parse(p, file, segment); });
    check_frame_of_reference(parcel.get_text(), settings, file, notes);
    TriangleMesh mesh;
    const auto coordinates = parcel.get_list<double>();
    for (std::size_t i = 0; i + 2 < coordinates.size(); i += 3)
        mesh.vertices_in_ct.emplace_back(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
    mesh.triangles = parcel.get_list<std::array<std::int32_t, 3>>();
    return mesh;
}

}  // namespace planlight
