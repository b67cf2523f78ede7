#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <stdexcept>

#include "planning_io/files/safe_write.h"
#include "tests/planning_io/synthetic_files.h"
#include "tests/planning_io/volume_cases.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using Objects = std::vector<DicomObject>;

Eigen::Matrix3d axes(const Eigen::Vector3d& row, const Eigen::Vector3d& column) {
    Eigen::Matrix3d m;
    m << row, column, row.cross(column);
    return m;
}

VolumeCase series(const std::string& name, const std::function<Objects()>& make,
                  DicomEncoding encoding = DicomEncoding::explicit_little) {
    return {
        name, "",   [make, encoding](const fs::path& folder) { return write_series(make(), folder, encoding), folder; },
        "",   true, "CT"};
}

VolumeCase packed(const std::string& name, DicomPacking packing) {
    return {name,
            "",
            [packing](const fs::path& folder) {
                for (const auto& file : write_series(synthetic_series({}), folder))
                    if (!pack_dicom(file, packing)) throw std::runtime_error("GDCM could not pack " + file.string());
                return folder;
            },
            "",
            true,
            "CT"};
}

VolumeCase packed_enhanced(const std::string& name, DicomPacking packing) {
    return {name,
            "",
            [packing](const fs::path& folder) {
                const std::string bytes = encode_packed_dicom(enhanced_object({}), packing, folder / "scratch");
                if (bytes.empty()) throw std::runtime_error("GDCM could not pack the Enhanced object");
                write_safely(folder / "enhanced", bytes);
                return folder;
            },
            "",
            true,
            "CT"};
}

VolumeCase position(const std::string& name, const Eigen::Matrix3d& turn, const std::string& patient_position,
                    double shear_mm = 0) {
    return series(name, [=] {
        SeriesLook look;
        look.position = patient_position;
        return synthetic_series(turned_grid(turn, shear_mm), look);
    });
}

VolumeCase file(const std::string& name, const std::string& file_name, const std::function<std::string()>& bytes) {
    return {name,
            "",
            [=](const fs::path& folder) { return write_safely(folder / file_name, bytes()), folder / file_name; },
            "",
            true,
            "CT"};
}

/// What else a hospital's folder holds: another patient's scout, a short second series, a secondary capture, a report,
/// a letter.
void add_company(const fs::path& folder) {
    SeriesLook scout{.description = "Scout", .uid = "1.2.826.0.1.3680043.9.9999.7.90", .number = "1"};
    Objects localizer = synthetic_series({}, scout);
    for (auto& o : localizer) o.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER");
    write_series(localizer, folder / "a");
    SeriesLook few{.patient = "Other^Person",
                   .patient_id = "P2",
                   .description = "Key images",
                   .uid = "1.2.826.0.1.3680043.9.9999.7.91",
                   .number = "5"};
    Objects five = synthetic_series({}, few);
    five.resize(5);
    write_series(five, folder / "b" / "c");
    SeriesLook capture{.description = "Screenshot", .uid = "1.2.826.0.1.3680043.9.9999.7.92", .number = "99"};
    Objects shots = synthetic_series({}, capture);
    for (auto& o : shots)
        o.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.7"), o.erase(0x00200032), o.erase(0x00200037);
    write_series(shots, folder / "d");
    SeriesLook words{
        .modality = "SR", .description = "Report", .uid = "1.2.826.0.1.3680043.9.9999.7.93", .number = "100"};
    Objects report = synthetic_series({}, words);
    report.resize(1);
    report[0].text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.88.11");
    report[0].erase(0x7fe00010);
    write_series(report, folder / "e");
    DicomObject index;
    index.text(0x00080016, "UI", "1.2.840.10008.1.3.10");
    write_safely(folder / "DICOMDIR", encode_dicom(index, DicomEncoding::explicit_little));
    write_safely(folder / "letter.txt", "Dear colleague, here is the scan.\n");
}

void add_dicom(std::vector<VolumeCase>& list) {
    const auto plain = [] { return synthetic_series({}); };
    list.push_back(series("DICOM, explicit little endian", plain));
    list.push_back(series("DICOM, implicit little endian", plain, DicomEncoding::implicit_little));
    list.push_back(series("DICOM, explicit big endian", plain, DicomEncoding::explicit_big));
    list.push_back(series("DICOM, deflated", plain, DicomEncoding::deflated));
    list.push_back(packed("DICOM, RLE", DicomPacking::rle));
    list.push_back(packed("DICOM, JPEG lossless", DicomPacking::jpeg_lossless));
    list.push_back(packed("DICOM, JPEG-LS", DicomPacking::jpeg_ls));
    list.push_back(packed("DICOM, JPEG 2000", DicomPacking::jpeg_2000));
    list.push_back(series("DICOM, Enhanced CT, frames shuffled", [] { return Objects{enhanced_object({})}; }));
    list.push_back(series(
        "DICOM, Enhanced CT, deflated", [] { return Objects{enhanced_object({})}; }, DicomEncoding::deflated));
    list.push_back(packed_enhanced("DICOM, Enhanced CT, JPEG 2000", DicomPacking::jpeg_2000));
    list.push_back(packed_enhanced("DICOM, Enhanced CT, JPEG-LS", DicomPacking::jpeg_ls));
    list.push_back(packed_enhanced("DICOM, Enhanced CT, RLE", DicomPacking::rle));
    list.push_back(
        series("DICOM, Enhanced MR, frames shuffled", [] { return Objects{enhanced_object({}, {.modality = "MR"})}; }));
    list.back().is_hu = false, list.back().modality = "MR";
    list.push_back(series("DICOM, MR without rescale", [] { return synthetic_series({}, {.modality = "MR"}); }));
    list.back().is_hu = false, list.back().modality = "MR";
    list.push_back(series("DICOM, CT whose values are not HU (0 and more, no offset)", [] {
        Objects objects = synthetic_series({});
        for (auto& o : objects) o.decimals(0x00281052, {0}), o.erase(0x00281054);
        return objects;
    }));
    list.back().is_hu = false;
    list.push_back(series("DICOM, signed CT without rescale slope and intercept", [] {
        Objects objects = synthetic_series({}, {.is_signed = true});
        for (auto& o : objects) o.erase(0x00281052), o.erase(0x00281053), o.erase(0x00281054);
        return objects;
    }));
    list.push_back(series("DICOM, CT with padding of stored 0 (water) round the picture", [] {
        Objects objects = synthetic_series({}, {.is_signed = true});
        for (auto& o : objects) {
            std::string& pixels = o.elements[0x7fe00010].bytes;  // the outermost eight columns, which are air
            for (std::size_t at = 0; at < pixels.size(); at += 2)
                if (at / 2 % 64 < 8) pixels[at] = pixels[at + 1] = 0;
            o.elements[0x00280120] = {"SS", std::string(2, '\0'), {}, {}};
        }
        return objects;
    }));
    list.push_back(series("DICOM, CT whose empty corners are 0 HU, unsaid", [] {
        Objects objects = synthetic_series({}, {.is_signed = true});
        for (auto& o : objects) {
            std::string& pixels = o.elements[0x7fe00010].bytes;
            for (std::size_t at = 0; at < pixels.size(); at += 2)
                if (at / 2 % 64 + at / 2 / 64 < 14) pixels[at] = pixels[at + 1] = 0;
        }
        return objects;
    }));
}

void add_positions(std::vector<VolumeCase>& list) {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
    list.push_back(position("DICOM, gantry tilted by -18.4 degrees (slices sheared by 4/3 mm each)",
                            Eigen::Matrix3d::Identity(), "HFS", -4.0 / 3));
    list.push_back(position("DICOM, feet first, slices from the top", axes(-x, y), "FFS"));
    list.push_back(position("DICOM, prone", axes(-x, -y), "HFP"));
    list.push_back(position("DICOM, lying on the left side", axes(y, -x), "HFDL"));
    list.push_back(position("DICOM, sagittal", axes(y, -z), "HFS"));
    list.push_back(position("DICOM, coronal", axes(x, -z), "HFS"));
    list.push_back(position(
        "DICOM, oblique", Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix(), "HFS"));
}

void add_folders(std::vector<VolumeCase>& list) {
    const auto full = [](const fs::path& folder) {
        write_series(synthetic_series({}), folder / "deep" / "er");
        add_company(folder);
        return folder;
    };
    list.push_back(
        {"DICOM folder with a scout, key images of another person, screenshots, a report, a DICOMDIR and a letter", "",
         full, "", true, "CT"});
    list.push_back({"the same folder by its DICOMDIR", "",
                    [full](const fs::path& folder) { return full(folder) / "DICOMDIR"; }, "", true, "CT"});
    list.push_back({"any slice of a series", "",
                    [](const fs::path& folder) { return write_series(synthetic_series({}), folder)[5]; }, "", true,
                    "CT"});
    const auto two = [](const fs::path& folder) {
        write_series(synthetic_series({}), folder / "thin");
        write_series(synthetic_series(turned_grid(Eigen::Matrix3d::Identity(), 0.5),
                                      {.description = "Soft", .uid = "1.2.826.0.1.3680043.9.9999.7.2", .number = "3"}),
                     folder / "soft");
        return folder;
    };
    list.push_back({"two series in a folder, one named by UID", "", two, "1.2.826.0.1.3680043.9.9999.7.1", true, "CT"});
    list.push_back({"two series in a folder, one named by number", "", two, "2", true, "CT"});
    list.push_back({"a localizer picture inside the series", "",
                    [](const fs::path& folder) {
                        Objects objects = synthetic_series({});
                        DicomObject scout = objects[3];
                        scout.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER");
                        scout.text(0x00080018, "UI", "1.2.826.0.1.3680043.9.9999.9.777");
                        scout.decimals(0x00200037, {0, 1, 0, 0, 0, -1});
                        objects.push_back(scout);
                        return write_series(objects, folder), folder;
                    },
                    "", true, "CT"});
}

/// As bgzip and pigz write it: a member for every few bytes, and an empty one at the end.
std::string gzipped_in_members(const std::string& plain, std::size_t each) {
    std::string bytes;
    for (std::size_t at = 0; at < plain.size(); at += each) bytes += gzipped(plain.substr(at, each));
    return bytes + gzipped("");
}

/// A folder of a sound series and one file of somebody else's that no program can read.
VolumeCase beside(const std::string& name, const std::function<std::string()>& broken) {
    return {"DICOM series beside " + name,
            "",
            [=](const fs::path& folder) {
                write_series(synthetic_series({}), folder);
                write_safely(folder / "A0001", broken());
                return folder;
            },
            "",
            true,
            "CT"};
}

std::string slice_of_another(const fs::path& scratch) {
    const auto files = write_series(
        synthetic_series({}, {.description = "Other", .uid = "1.2.826.0.1.3680043.9.9999.44.1", .number = "8"}),
        scratch);
    return read_whole(files.front());
}

void add_broken_company(std::vector<VolumeCase>& list) {
    for (const double part : {0.005, 0.02, 0.03, 0.6})
        list.push_back(beside(fmt::format("another's slice cut to {} of 1000", 1000 * part), [=] {
            const TemporaryFolder scratch;
            const std::string whole = slice_of_another(scratch.path());
            return whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size())));
        }));
    list.push_back(beside("nothing but the mark of DICOM", [] { return std::string(128, '\0') + "DICM"; }));
    list.push_back(beside("noise after the mark of DICOM", [] {
        std::string bytes = std::string(128, '\0') + "DICM";
        for (unsigned i = 0, x = 1; i < 20000; ++i) bytes += static_cast<char>((x = 1664525 * x + 1013904223) >> 24);
        return bytes;
    }));
    list.push_back(beside("a length that is a lie", [] {
        return std::string(128, '\0') + "DICM" + std::string("\2\0\0\0UL\4\0\xff\xff\xff\x7f", 12) +
               std::string("\x08\0\x60\0OB\0\0\xf0\xff\xff\xff", 12) + std::string(500, 'x');
    }));
    list.push_back(beside("a deflated slice that cannot be inflated", [] {
        const TemporaryFolder scratch;
        const SeriesLook look{.uid = "1.2.826.0.1.3680043.9.9999.44.2", .number = "9"};
        std::string bytes =
            read_whole(write_series(synthetic_series({}, look), scratch.path(), DicomEncoding::deflated).front());
        bytes.resize(bytes.size() / 2);
        return bytes;
    }));
}

void add_formats(std::vector<VolumeCase>& list) {
    const Grid grid;
    list.push_back(file("NIfTI, gzip of many members (bgzip)", "head.nii.gz",
                        [=] { return gzipped_in_members(nifti_bytes(nifti_header(grid), grid), 65280); }));
    list.push_back(file("NIfTI, gzip of members of 7 bytes, and zeros after them", "head.nii.gz", [=] {
        const std::string whole = nifti_bytes(nifti_header(grid), grid);
        return gzipped_in_members(whole.substr(0, 3500), 7) + gzipped(whole.substr(3500)) + std::string(512, '\0');
    }));
    list.push_back(file("NRRD, gzip of many members (bgzip)", "head.nrrd",
                        [=] { return nrrd_header(grid, "gzip") + gzipped_in_members(int16_bytes(grid), 65280); }));
    const Grid oblique = turned_grid(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix());
    Grid left_handed = grid;  // as NIfTI files of radiological order are
    left_handed.ct_from_voxel = grid.ct_from_voxel * Eigen::Translation3d(63, 0, 0) * Eigen::Scaling(-1.0, 1.0, 1.0);
    list.push_back(file("NIfTI, sform", "head.nii", [=] { return nifti_bytes(nifti_header(oblique), oblique); }));
    list.push_back(file("NIfTI, gzip, left-handed axes", "head.nii.gz",
                        [=] { return gzipped(nifti_bytes(nifti_header(left_handed), left_handed)); }));
    list.push_back(file("NIfTI, qform, third axis reversed", "head.nii", [=] {
        std::string h = nifti_header(grid);
        put<std::int16_t>(h, 254, 0);
        put<std::int16_t>(h, 252, 1);
        put<float>(h, 76, -1);  // x and y of RAS against LPS: half a turn about z; then z reversed
        put<float>(h, 264, 1);
        const Eigen::Vector3d last = grid.ct_from_voxel * Eigen::Vector3d(0, 0, 23);
        put<float>(h, 268, static_cast<float>(-last.x())), put<float>(h, 272, static_cast<float>(-last.y())),
            put<float>(h, 276, static_cast<float>(last.z()));
        Grid reversed = grid;
        reversed.ct_from_voxel = grid.ct_from_voxel * Eigen::Translation3d(0, 0, 23) * Eigen::Scaling(1.0, 1.0, -1.0);
        return nifti_bytes(h, reversed);
    }));
    list.push_back(file("NIfTI in metres, stored values / 2 - 100 scaled back by scl_slope", "head.nii", [=] {
        std::string h = nifti_header(grid);
        for (const std::size_t at : {80, 84, 88, 280, 284, 288, 292, 296, 300, 304, 308, 312, 316, 320, 324}) {
            float value = 0;
            std::copy_n(h.data() + at, 4, reinterpret_cast<char*>(&value));
            put<float>(h, at, value / 1000);
        }
        put<std::uint8_t>(h, 123, 1);
        put<float>(h, 112, 0.5F), put<float>(h, 116, 100);
        std::string bytes = nifti_bytes(h, grid);
        for (std::size_t at = 352; at < bytes.size(); at += 2) {
            std::int16_t v = 0;
            std::copy_n(bytes.data() + at, 2, reinterpret_cast<char*>(&v));
            put<std::int16_t>(bytes, at, static_cast<std::int16_t>(2 * (v - 100)));
        }
        return bytes;
    }));
    list.push_back(file("NIfTI with a scale that is not a number", "head.nii", [=] {
        std::string h = nifti_header(grid);
        const float none = std::numeric_limits<float>::quiet_NaN();
        put<float>(h, 112, none), put<float>(h, 116, none);
        return nifti_bytes(h, grid);
    }));
    list.push_back(file("NRRD, raw", "head.nrrd", [=] { return nrrd_header(oblique) + int16_bytes(oblique); }));
    list.push_back(
        file("NRRD, gzip", "head.nrrd", [=] { return nrrd_header(grid, "gzip") + gzipped(int16_bytes(grid)); }));
    list.push_back(file("NRRD in RAS, big endian", "head.nrrd", [=] {
        Grid ras = oblique;
        ras.ct_from_voxel = Eigen::Scaling(-1.0, -1.0, 1.0) * oblique.ct_from_voxel;
        std::string h = nrrd_header(ras);
        h.replace(h.find("left-posterior-superior"), 23, "right-anterior-superior");
        h.replace(h.find("endian: little"), 14, "endian: big");
        return h + int16_bytes(oblique, true);
    }));
    list.push_back({"NRRD, header and data file apart", "",
                    [=](const fs::path& folder) {
                        std::string h = nrrd_header(grid, "gzip");
                        h.insert(h.size() - 1, "data file: head.raw.gz\n");
                        write_safely(folder / "head.nhdr", h);
                        write_safely(folder / "head.raw.gz", gzipped(int16_bytes(grid)));
                        return folder / "head.nhdr";
                    },
                    "", true, "CT"});
    list.push_back(file("MetaImage", "head.mha", [=] { return metaimage_header(oblique) + int16_bytes(oblique); }));
    list.push_back(file("MetaImage, packed, left-handed axes, AnatomicalOrientation LAI", "head.mha", [=] {
        std::string h = metaimage_header(left_handed, true);
        h.insert(h.find("Offset"), "AnatomicalOrientation = LAI\n");
        return h + zlibbed(int16_bytes(left_handed));
    }));
    for (const char* yes : {"True", "1"})
        list.push_back(file(fmt::format("MetaImage, big endian (BinaryDataByteOrderMSB = {})", yes), "head.mha", [=] {
            std::string h = metaimage_header(oblique);
            h.replace(h.find("MSB = False"), 11, fmt::format("MSB = {}", yes));
            return h + int16_bytes(oblique, true);
        }));
    list.push_back(file("FreeSurfer, oblique, a face told of in the name of a folder", "head.mgh", [=] {
        return mgh_bytes(oblique, std::string(20, '\0') + "mri_convert /defaced/a.mgz head.mgh");
    }));
    list.push_back(
        file("FreeSurfer, gzip, left-handed axes", "head.mgz", [=] { return gzipped(mgh_bytes(left_handed)); }));
    list.push_back({"MetaImage, header and data file apart", "",
                    [=](const fs::path& folder) {
                        std::string h = metaimage_header(grid);
                        h.replace(h.find("LOCAL"), 5, "head.raw");
                        write_safely(folder / "head.mhd", h);
                        write_safely(folder / "head.raw", int16_bytes(grid));
                        return folder / "head.mhd";
                    },
                    "", true, "CT"});
}

}  // namespace

std::vector<VolumeCase> sound_volumes() {
    std::vector<VolumeCase> list;
    add_dicom(list);
    add_positions(list);
    add_folders(list);
    add_formats(list);
    add_broken_company(list);
    return list;
}

std::string test_name_of(const VolumeCase& c) {
    std::string name;
    bool upper = true;
    for (const char letter : c.name) {
        if (std::isalnum(static_cast<unsigned char>(letter)))
            name += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(letter))) : letter;
        upper = !std::isalnum(static_cast<unsigned char>(letter));
    }
    return name;
}

}  // namespace planlight::test
