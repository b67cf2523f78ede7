#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planning_io/files/safe_write.h"
#include "tests/planning_io/synthetic_files.h"
#include "tests/planning_io/volume_cases.h"

// DICOM series and folders of them that are to be refused.
namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using Objects = std::vector<DicomObject>;

constexpr std::uint32_t kPosition = 0x00200032, kOrientation = 0x00200037, kSpacing = 0x00280030, kPixels = 0x7fe00010;

VolumeCase series(const std::string& name, const std::string& says, const std::function<void(Objects&)>& spoil,
                  const std::string& transfer_syntax = {}) {
    return {name,
            says,
            [=](const fs::path& folder) {
                Objects objects = synthetic_series({});
                spoil(objects);
                write_series(objects, folder, DicomEncoding::explicit_little, transfer_syntax);
                return folder;
            },
            "",
            true,
            "CT"};
}

/// One slice, or all of them.
VolumeCase slice(const std::string& name, const std::string& says, const std::function<void(DicomObject&)>& spoil) {
    return series(name, says, [=](Objects& o) { spoil(o[9]); });
}
VolumeCase slices(const std::string& name, const std::string& says, const std::function<void(DicomObject&)>& spoil) {
    return series(name, says, [=](Objects& o) { std::for_each(o.begin(), o.end(), spoil); });
}

void put_z(DicomObject& o, double z) {
    o.decimals(kPosition, {-94.5, -97, z});
}

void fill(DicomObject& o, std::int16_t value) {
    o.pixels(std::vector<std::int16_t>(64 * 64, value));
}

void add_stack(std::vector<VolumeCase>& list) {
    list.push_back(series("a slice is missing", "missing", [](Objects& o) { o.erase(o.begin() + 9); }));
    list.push_back(series("three slices in a row are missing", "3 slices are missing",
                          [](Objects& o) { o.erase(o.begin() + 9, o.begin() + 12); }));
    list.push_back(series("a slice is there twice", "double slice", [](Objects& o) { o.push_back(o[9]); }));
    list.push_back(series("two scans of one head in one series", "double slice", [](Objects& o) {
        const Objects again = o;
        o.insert(o.end(), again.begin(), again.end());
    }));
    list.push_back(
        {"two series in one folder, none named", "several series",
         [](const fs::path& folder) {
             write_series(synthetic_series({}), folder / "a");
             write_series(
                 synthetic_series({}, {.description = "Bone", .uid = "1.2.826.0.1.3680043.9.9999.7.2", .number = "3"}),
                 folder / "b");
             return folder;
         },
         "", true, "CT"});
    list.push_back({"a series named that is not there", "no series",
                    [](const fs::path& folder) { return write_series(synthetic_series({}), folder), folder; }, "1.2.3",
                    true, "CT"});
    list.push_back(slice("two frames of reference", "frames of reference",
                         [](DicomObject& o) { o.text(0x00200052, "UI", "1.2.3.4"); }));
    list.push_back(
        slice("two patients by ID", "two patients", [](DicomObject& o) { o.text(0x00100020, "LO", "OTHER"); }));
    list.push_back(slice("two patients by name", "two patients",
                         [](DicomObject& o) { o.text(0x00100010, "PN", "Other^Person"); }));
    list.push_back(
        slice("two patient positions", "patient positions", [](DicomObject& o) { o.text(0x00185100, "CS", "HFP"); }));
    list.push_back(slice("two pixel spacings", "has pixels of", [](DicomObject& o) {
        o.decimals(kSpacing, {2.9, 2.9});
    }));
    list.push_back(slice("two orientations", "not parallel", [](DicomObject& o) {
        o.decimals(kOrientation, {std::cos(0.01), std::sin(0.01), 0, -std::sin(0.01), std::cos(0.01), 0});
    }));
    list.push_back(slice("two picture sizes", "pixels", [](DicomObject& o) {
        o.number(0x00280010, 32), o.pixels(std::vector<std::int16_t>(32 * 64, 24));
    }));
    list.push_back(slice("two ways of storing", "stored with", [](DicomObject& o) { o.number(0x00280103, 1); }));
    list.push_back(series("uneven spacing: one slice 0.2 mm off", "not evenly spaced",
                          [](Objects& o) { put_z(o[9], -46 + 36.2); }));
    list.push_back(series("uneven spacing: 4 mm below, 2.5 mm above", "evenly", [](Objects& o) {
        for (int k = 12; k < 24; ++k) put_z(o[static_cast<std::size_t>(k)], -46 + 44 + 2.5 * (k - 11));
    }));
    list.push_back(series("all slices at one position", "one position", [](Objects& o) {
        for (auto& s : o) put_z(s, 0);
    }));
    list.push_back(series("one slice beside the others", "straight line", [](Objects& o) {
        o[9].decimals(kPosition, {-93, -97, -10});
    }));
    list.push_back(series("slices shifted more than a gantry tilts", "shifted", [](Objects& o) {
        for (int k = 0; k < 24; ++k)
            o[static_cast<std::size_t>(k)].decimals(kPosition, {-94.5, -97 + 9.0 * k, -46 + 4.0 * k});
    }));
    list.push_back(series("15 slices", "fewer than 16", [](Objects& o) { o.resize(15); }));
    list.push_back(series("one slice", "fewer than 16", [](Objects& o) { o.resize(1); }));
}

void add_slices(std::vector<VolumeCase>& list) {
    list.push_back(slice("no position", "no position", [](DicomObject& o) { o.erase(kPosition); }));
    list.push_back(slice("no orientation", "no orientation", [](DicomObject& o) { o.erase(kOrientation); }));
    list.push_back(slice("no pixel spacing", "no pixel spacing", [](DicomObject& o) { o.erase(kSpacing); }));
    list.push_back(slice("a position of two numbers", "no position", [](DicomObject& o) {
        o.decimals(kPosition, {1, 2});
    }));
    list.push_back(slice("a position that is not a number", "no position",
                         [](DicomObject& o) { o.text(kPosition, "DS", "-94.5\\nan\\-10"); }));
    list.push_back(slice("a position 20 m away", "outside of any scanner", [](DicomObject& o) {
        o.decimals(kPosition, {-94.5, -97, 20000});
    }));
    list.push_back(slices("directions that are not perpendicular (2e-3)", "not perpendicular", [](DicomObject& o) {
        o.decimals(kOrientation, {1, 0, 0, 2e-3, 1, 0});
    }));
    list.push_back(slices("directions that are not of length 1 (0.99)", "not of length 1", [](DicomObject& o) {
        o.decimals(kOrientation, {0.99, 0, 0, 0, 1, 0});
    }));
    list.push_back(slices("a row direction of zero", "not of length 1", [](DicomObject& o) {
        o.decimals(kOrientation, {0, 0, 0, 0, 1, 0});
    }));
    list.push_back(slices("a pixel spacing of zero", "pixel spacing of 0", [](DicomObject& o) {
        o.decimals(kSpacing, {0, 3});
    }));
    list.push_back(slices("a negative pixel spacing", "pixel spacing of -3", [](DicomObject& o) {
        o.decimals(kSpacing, {3, -3});
    }));
    list.push_back(slices("a pixel spacing that is not a number", "no pixel spacing",
                          [](DicomObject& o) { o.text(kSpacing, "DS", "NaN\\3"); }));
    list.push_back(slices("a pixel spacing in metres", "pixel spacing of 0.003", [](DicomObject& o) {
        o.decimals(kSpacing, {0.003, 0.003});
    }));
    list.push_back(
        slices("a rescale slope of zero", "scales its values", [](DicomObject& o) { o.decimals(0x00281053, {0}); }));
    list.push_back(
        slices("a negative rescale slope", "scales its values", [](DicomObject& o) { o.decimals(0x00281053, {-1}); }));
    list.push_back(slice("a rescale slope that is not a number", "scales its values",
                         [](DicomObject& o) { o.text(0x00281053, "DS", "one"); }));
    list.push_back(slices("stored as CT, and of another modality", "is stored as CT",
                          [](DicomObject& o) { o.text(0x00080060, "CS", "PT"); }));
    list.push_back(slice("one slice of another modality", "is stored as CT",
                         [](DicomObject& o) { o.text(0x00080060, "CS", "MR"); }));
    list.push_back(slices("values by a table (Modality LUT)", "Modality LUT", [](DicomObject& o) {
        DicomObject table;
        table.text(0x00283003, "LO", "HU");
        o.erase(0x00281052), o.erase(0x00281053), o.items(0x00283000, {table});
    }));
    list.push_back(slice("rescale in some slices only", "two meanings",
                         [](DicomObject& o) { o.erase(0x00281052), o.erase(0x00281053); }));
    list.push_back(slices("colour pictures", "colour",
                          [](DicomObject& o) { o.number(0x00280002, 3), o.text(0x00280004, "CS", "RGB"); }));
    list.push_back(series(
        "an unsupported transfer syntax (HTJ2K)", "transfer syntax", [](Objects&) {}, "1.2.840.10008.1.2.4.201"));
    list.push_back(slices("an unsupported object (secondary capture)", "no CT or MR volume",
                          [](DicomObject& o) { o.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.7"); }));
    list.push_back(slices("an unsupported object (PET)", "no CT or MR volume",
                          [](DicomObject& o) { o.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.128"); }));
    list.push_back(slices("a localizer only", "no CT or MR volume",
                          [](DicomObject& o) { o.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER"); }));
    list.push_back(slices("a defaced head, by its attribute", "face was taken away",
                          [](DicomObject& o) { o.text(0x00280302, "CS", "NO"); }));
    list.push_back(slices("a defaced head, by its de-identification code", "113102", [](DicomObject& o) {
        DicomObject code;
        code.text(0x00080100, "SH", "113102");
        code.text(0x00080102, "SH", "DCM");
        code.text(0x00080104, "LO", "Clean Recognizable Visual Features Option");
        o.items(0x00120064, {code});
    }));
    for (const char* word : {"T1 defaced", "T1 MPRAGE reface", "pydefacing", "Quickshear"})
        list.push_back(slices(fmt::format("a defaced head, by its description ({})", word), "face was taken away",
                              [=](DicomObject& o) { o.text(0x0008103e, "LO", word); }));
    for (const char* type :
         {"DERIVED\\SECONDARY\\MIP", "DERIVED\\PRIMARY\\PROJECTION IMAGE\\MINIP", "DERIVED\\SECONDARY\\SUBTRACTION"})
        list.push_back(slices(fmt::format("made of several slices, by its Image Type ({})", type),
                              "no slice of the patient but made of several",
                              [=](DicomObject& o) { o.text(0x00080008, "CS", type); }));
    for (const char* words : {"AX MIP 10 mm", "MinIP lung", "Head VRT"})
        list.push_back(slices(fmt::format("made of several slices, by its description ({})", words),
                              "no slice of the patient but made of several",
                              [=](DicomObject& o) { o.text(0x0008103e, "LO", words); }));
    for (const char* storage_class : {"13.1.1", "13.1.2", "13.1.3"})
        list.push_back(slices(fmt::format("a 3D X-ray ({})", storage_class), "X-ray 3D", [=](DicomObject& o) {
            o.text(0x00080016, "UI", fmt::format("1.2.840.10008.5.1.4.1.1.{}", storage_class));
        }));
    list.push_back(slices("no skin: one value only", "no skin", [](DicomObject& o) { fill(o, 24); }));
    list.push_back(slices("no skin: nothing but air", "no skin",
                          [](DicomObject& o) { fill(o, 24), o.elements[kPixels].bytes[64 * 64] = 30; }));
    list.push_back(series(
        "no skin: the body fills the volume to all sides, air is only inside", "all six sides", [](Objects& objects) {
            for (std::size_t k = 0; k < objects.size(); ++k) {
                std::vector<std::int16_t> values(64 * 64, 1064);
                for (int at = 0; at < 64 * 64; ++at)
                    if (k > 3 && k < 20 && at % 64 > 20 && at % 64 < 40 && at / 64 > 20 && at / 64 < 40)
                        values[static_cast<std::size_t>(at)] = 24;
                objects[k].pixels(values);
            }
        }));
}

void add_damage(std::vector<VolumeCase>& list) {
    const auto cut = [](const std::string& name, double part) {
        return VolumeCase{name,
                          "",
                          [=](const fs::path& folder) {
                              const auto files = write_series(synthetic_series({}), folder);
                              const std::string whole = read_whole(files[9]);
                              write_safely(
                                  files[9],
                                  whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
                              return folder;
                          },
                          "",
                          true,
                          "CT"};
    };
    list.push_back(cut("a file cut in its pixels", 0.6)), list.back().says = "I0344: is damaged or cut short";
    list.push_back(cut("a file cut in its header", 0.02)), list.back().says = "I0344: is a DICOM file that is damaged";
    list.push_back({"a JPEG 2000 file cut in its pixels", "I0344: is damaged or cut short",
                    [](const fs::path& folder) {
                        const auto files = write_series(synthetic_series({}), folder);
                        for (const auto& f : files) pack_dicom(f, DicomPacking::jpeg_2000);
                        const std::string whole = read_whole(files[9]);
                        write_safely(files[9], whole.substr(0, whole.size() * 3 / 4));
                        return folder;
                    },
                    "", true, "CT"});
    list.push_back({"the last slice is a link to nothing", "link to a file that is not there",
                    [](const fs::path& folder) {
                        const auto files = write_series(synthetic_series({}), folder);
                        fs::remove(files.back());
                        fs::create_symlink(folder / "elsewhere", files.back());
                        return folder;
                    },
                    "", true, "CT"});
    list.push_back(
        {"an empty folder", "no DICOM images", [](const fs::path& folder) { return folder; }, "", true, "CT"});
    list.push_back(
        {"a folder without DICOM files", "no DICOM images",
         [](const fs::path& folder) { return write_safely(folder / "letter.txt", "Dear colleague"), folder; }, "", true,
         "CT"});
    list.push_back({"a slice of the series that is cut behind its series' UID", "is a DICOM file that is damaged",
                    [](const fs::path& folder) {
                        const SeriesLook look;
                        const auto files = write_series(synthetic_series({}, look), folder);
                        const std::string whole = read_whole(files.front());
                        std::string rest = whole.substr(0, whole.find(look.uid) + look.uid.size());
                        for (std::size_t at = 132; at < 140; ++at) rest[at] = 'x';  // nor can its header be read
                        write_safely(files.front(), rest);
                        return folder;
                    },
                    "", true, "CT"});
}

}  // namespace

std::vector<VolumeCase> spoilt_series() {
    std::vector<VolumeCase> list;
    add_stack(list);
    add_slices(list);
    add_damage(list);
    return list;
}

}  // namespace planlight::test
