#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "planning_io/files/safe_write.h"
#include "tests/planning_io/synthetic_files.h"
#include "tests/planning_io/volume_cases.h"

// Files of one volume that are to be refused.
namespace planlight::test {
namespace {

namespace fs = std::filesystem;

VolumeCase file(const std::string& name, const std::string& says, const std::string& file_name,
                const std::function<std::string()>& bytes) {
    return {name,
            says,
            [=](const fs::path& folder) { return write_safely(folder / file_name, bytes()), folder / file_name; },
            "",
            true,
            "CT"};
}

VolumeCase nifti(const std::string& name, const std::string& says, const std::function<void(std::string&)>& spoil) {
    return file("NIfTI: " + name, says, "head.nii", [=] {
        std::string h = nifti_header({});
        spoil(h);
        return nifti_bytes(h, {});
    });
}

VolumeCase text(const std::string& format, const std::string& name, const std::string& says, const std::string& from,
                const std::string& to) {
    const bool nrrd = format == "NRRD";
    return file(format + ": " + name, says, nrrd ? "head.nrrd" : "head.mha", [=] {
        std::string h = nrrd ? nrrd_header({}) : metaimage_header({});
        h.replace(h.find(from), from.size(), to);
        return h + int16_bytes({});
    });
}

VolumeCase project(const std::string& name, const std::string& says, const std::string& from, const std::string& to,
                   const Grid& grid = {}) {
    return {"InVesalius: " + name,
            says,
            [=](const fs::path& folder) {
                std::string plist = invesalius_plist(grid);
                plist.replace(plist.find(from), from.size(), to);
                write_invesalius_project(folder / "head.inv3", grid, plist);
                return folder / "head.inv3";
            },
            "",
            true,
            "CT"};
}

/// A tag of FreeSurfer that holds a command line (3).
std::string command_tag(const std::string& line) {
    return std::string("\0\0\0\3\0\0\0\0\0\0\0", 11) + static_cast<char>(line.size()) + line;
}

void add_damage(std::vector<VolumeCase>& list) {
    list.push_back(file("an Analyze header", "Analyze", "head.hdr", [] { return nifti_header({}); }));
    list.push_back(file("NIfTI: cut in its voxels", "cut short", "head.nii",
                        [] { return nifti_bytes(nifti_header({}), {}).substr(0, 100000); }));
    list.push_back(file("NIfTI: gzip of two members, the second cut", "cut short", "head.nii.gz", [] {
        const std::string whole = nifti_bytes(nifti_header({}), {});
        const std::string bytes = gzipped(whole.substr(0, 50000)) + gzipped(whole.substr(50000));
        return bytes.substr(0, bytes.size() - 20);
    }));
    list.push_back(file("NIfTI: gzip of two members, the first with a wrong checksum", "damaged", "head.nii.gz", [] {
        const std::string whole = nifti_bytes(nifti_header({}), {});
        std::string first = gzipped(whole.substr(0, 50000));
        first[first.size() - 6] = static_cast<char>(first[first.size() - 6] ^ 1);
        return first + gzipped(whole.substr(50000));
    }));
    list.push_back(file("NIfTI: bytes after the last gzip member", "goes on after the end", "head.nii.gz",
                        [] { return gzipped(nifti_bytes(nifti_header({}), {})) + std::string(512, '\0') + "x"; }));
    list.push_back(file("NIfTI: gzip with a wrong checksum", "damaged", "head.nii.gz", [] {
        std::string bytes = gzipped(nifti_bytes(nifti_header({}), {}));
        bytes[bytes.size() - 6] = static_cast<char>(bytes[bytes.size() - 6] ^ 1);
        return bytes;
    }));
    list.push_back(file("NRRD: more voxels than it says", "more voxels", "head.nrrd",
                        [] { return nrrd_header({}) + int16_bytes({}) + std::string(8192, 'x'); }));
}

void add_formats(std::vector<VolumeCase>& list) {
    list.push_back(nifti("no frame (sform and qform codes 0)", "does not say its frame",
                         [](std::string& h) { put<std::int16_t>(h, 254, 0); }));
    list.push_back(nifti("sform and qform mirror each other", "mirror", [](std::string& h) {
        put<std::int16_t>(h, 252, 1), put<float>(h, 264, 1), put<float>(h, 76, -1);
        put<float>(h, 268, 94.5F), put<float>(h, 272, 97), put<float>(h, 276, -46);
    }));
    list.push_back(nifti("sform and qform 5 mm apart", "two frames", [](std::string& h) {
        put<std::int16_t>(h, 252, 1), put<float>(h, 264, 1), put<float>(h, 268, 94.5F), put<float>(h, 272, 102),
            put<float>(h, 276, -46);
    }));
    list.push_back(nifti("sheared axes", "not perpendicular", [](std::string& h) { put<float>(h, 284, 0.1F); }));
    list.push_back(nifti("a frame that is not a number", "not a number",
                         [](std::string& h) { put<float>(h, 284, std::numeric_limits<float>::quiet_NaN()); }));
    list.push_back(nifti("millimetres called metres", "spacing", [](std::string& h) { put<std::uint8_t>(h, 123, 1); }));
    list.push_back(
        nifti("pixdim is not the frame's spacing", "frame means", [](std::string& h) { put<float>(h, 80, 2); }));
    list.push_back(nifti("a spacing of zero", "spacing of 0", [](std::string& h) { put<float>(h, 88, 0); }));
    list.push_back(nifti("four time points", "4 volumes",
                         [](std::string& h) { put<std::int16_t>(h, 40, 4), put<std::int16_t>(h, 48, 4); }));
    list.push_back(nifti("colour voxels", "grey value", [](std::string& h) { put<std::int16_t>(h, 70, 128); }));
    list.push_back(nifti("a slope that is not a number", "scales its values",
                         [](std::string& h) { put<float>(h, 112, std::numeric_limits<float>::infinity()); }));
    list.push_back(nifti("an offset without a scale", "scales its values", [](std::string& h) {
        put<float>(h, 112, std::numeric_limits<float>::quiet_NaN()), put<float>(h, 116, -1024);
    }));
    list.push_back(nifti("half of a pair", "half of a pair", [](std::string& h) { h[345] = 'i'; }));
    list.push_back(nifti("a description that says it was defaced", "taken away",
                         [](std::string& h) { h.replace(148, 9, "pydefaced"); }));
    list.push_back(nifti("a description that says that its face is another's (AFNI's reface)", "taken away",
                         [](std::string& h) { h.replace(148, 8, "reface_r"); }));
    for (const int intent : {3, 1002, 1007})
        list.push_back(nifti(fmt::format("labels, statistics or vectors (intent {})", intent),
                             "not what a scanner measured",
                             [=](std::string& h) { put(h, 68, static_cast<std::int16_t>(intent)); }));
    list.push_back(text("NRRD", "colours along its first axis", "none of space", "kinds: domain", "kinds: RGB-color"));
    list.push_back(text("NRRD", "a segmentation of 3D Slicer", "is a segmentation", "encoding: raw",
                        "encoding: raw\nSegment0_ID:=Segment_1"));
    list.push_back(text("MetaImage", "of a PET", "neither CT nor MR", "ObjectType = Image",
                        "ObjectType = Image\nModality = MET_MOD_PET"));
    list.push_back(text("MetaImage", "a word that is neither true nor false", "neither True nor False", "MSB = False",
                        "MSB = Unknown"));
    list.push_back(file("FreeSurfer: a name that says it was defaced", "taken away", "T1_defaced.mgh",
                        [] { return mgh_bytes({}); }));
    list.push_back(file("FreeSurfer: made by a program that takes faces away", "taken away", "T1.mgz", [] {
        return gzipped(mgh_bytes({}, std::string(20, '\0') + command_tag("mri_convert a.dcm T1.mgz") +
                                         command_tag("/opt/freesurfer/bin/mri_deface T1.mgz b.gca c.gca T1.mgz")));
    }));
    const std::string axial = "<integer>1</integer>", no_affine = "<string></string>",
                      affine =
                          "<array><array><real>1</real><real>0</real><real>0</real><real>-90</real></array></array>";
    list.push_back(project("imported from NIfTI, which it calls coronal", "not those of axial slices", axial,
                           "<integer>2</integer>"));
    list.push_back(
        project("imported from sagittal slices", "not those of axial slices", axial, "<integer>3</integer>"));
    list.push_back(project("axial, with the affine of a NIfTI file", "not those of axial slices", no_affine, affine));
    list.push_back(
        project("an orientation that is not said", "no \"orientation\"", "orientation</key>", "direction</key>"));
    list.push_back(project("made from pictures", "which side is left", ">CT<", ">UNKNOWN<"));
    list.push_back(project("named after a defaced file", "taken away", "Phantom", "sub-01_defaced"));
    Grid six;
    six.size[2] = 6;
    list.push_back(project("6 slices", "fewer than 16", "<real>4</real>", "<real>16</real>", six));
    list.push_back(text("NRRD", "no space", "does not say its frame", "space: left-posterior-superior\n", ""));
    list.push_back(
        text("NRRD", "a space of the scanner", "not that of a patient", "left-posterior-superior", "scanner-xyz"));
    list.push_back(
        text("NRRD", "lengths in inches", "lengths in", "kinds:", "space units: \"in\" \"in\" \"in\"\nkinds:"));
    list.push_back(text("NRRD", "15 slices", "fewer than 16", "sizes: 64 64 24", "sizes: 64 64 15"));
    list.push_back(text("NRRD", "directions that are not perpendicular", "not perpendicular", "(3,0,0)", "(3,0.1,0)"));
    list.push_back(text("NRRD", "a data file outside of its folder", "not in the header's folder", "encoding: raw",
                        "encoding: raw\ndata file: ../../etc/passwd"));
    list.push_back(text("NRRD", "a list of data files", "list of files", "encoding: raw",
                        "encoding: raw\ndata file: slice%03d.raw 1 24 1"));
    list.push_back(
        text("MetaImage", "no frame", "does not say its frame", "TransformMatrix = 1 0 0 0 1 0 0 0 1\n", ""));
    list.push_back(text("MetaImage", "an orientation of question marks", "does not say its frame", "Offset",
                        "AnatomicalOrientation = ???\nOffset"));
    list.push_back(text("MetaImage", "an orientation that the matrix does not have", "TransformMatrix means", "Offset",
                        "AnatomicalOrientation = LPS\nOffset"));
    list.push_back(
        text("MetaImage", "a direction of length 2", "length 2", "TransformMatrix = 1 0 0", "TransformMatrix = 2 0 0"));
    list.push_back(
        text("MetaImage", "a data file outside of its folder", "not in the header's folder", "LOCAL", "/etc/passwd"));
}

}  // namespace

std::vector<VolumeCase> spoilt_files() {
    std::vector<VolumeCase> list;
    add_damage(list);
    add_formats(list);
    return list;
}

}  // namespace planlight::test
