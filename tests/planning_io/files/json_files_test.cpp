#include <gtest/gtest.h>

#include "planning_io/case/capture_folder.h"
#include "planning_io/case/frames_folder.h"
#include "planning_io/case/light_file.h"
#include "planning_io/case/poses_file.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/example_rig.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// The file with every name in turn changed by one letter is refused in a sentence that says both names; a person's own
/// notes are not.
template <class Read>
void expect_misspelt_names_are_refused(const fs::path& file, const Read& read) {
    const std::string whole = read_whole(file);
    std::size_t names = 0;
    for (std::size_t end = whole.find("\":"); end != std::string::npos; end = whole.find("\":", end + 1)) {
        const std::string name = whole.substr(whole.rfind('"', end - 1) + 1, end - whole.rfind('"', end - 1) - 1);
        if (name == "format" || name == "version") continue;  // has a sentence of its own
        ++names;
        std::string text = whole;
        text.insert(end, "s");
        write_safely(file, text);
        try {
            read(file);
            ADD_FAILURE() << name << "s was taken for nothing";
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find("\"" + name + "s\"; is \"" + name + "\" meant?"), std::string::npos)
                << e.what();
        }
    }
    EXPECT_GT(names, 2u);
    const auto with = [&](const std::string& more) {
        write_safely(file, "{" + more + "," + whole.substr(whole.find('{') + 1));
    };
    with(R"("notes": {"room": 3, "left_serail": "of the old camera"}, "x_exposure_ms": 20)");
    EXPECT_NO_THROW(read(file)) << "a person's own notes";
    with(R"("photographer": "R. S.")");
    EXPECT_THROW(read(file), InputError);
    write_safely(file, whole);
    EXPECT_NO_THROW(read(file));
}

TEST(JsonFiles, AMisspeltNameIsNotPassedOver) {
    const test::TemporaryFolder folder;
    const auto file = [&](const char* name) { return folder.path() / name; };
    CaptureFolder capture;
    capture.projector_width = 800, capture.projector_height = 600;
    capture.names = {"white"};
    capture.order_periods_px = {19.8};
    capture.serials = {"L", "R", "P"};
    write_capture_settings(capture, file("capture.json"));
    expect_misspelt_names_are_refused(file("capture.json"), read_capture_settings);
    // Of fringes that there are not the period need not be said.
    const std::string code =
        R"({"format": "planlight capture", "version": 1, "projector_width": 800, "projector_height": 600,
                                 "rows": true, "inverse": true, "phase_steps": )";
    write_safely(file("gray.json"), code + "0}");
    EXPECT_EQ(read_capture_settings(file("gray.json")).phase_steps, 0);
    write_safely(file("fringes.json"), code + "8}");
    EXPECT_THROW(read_capture_settings(file("fringes.json")), Error);
    RigCalibration rig = test::example_rig();
    rig.serials = {"L", "R", "P"};
    write_rig(rig, file("rig.json"));
    expect_misspelt_names_are_refused(file("rig.json"), read_partial_rig);
    std::vector<TrackedPose> poses(1);
    poses[0].rig_from_patient = RigidTransform::Identity();
    write_poses(poses, file("poses.json"));
    expect_misspelt_names_are_refused(file("poses.json"), read_poses);
    write_frames({{GrayImage(4, 4, 1), GrayImage(4, 4, 2), Instant(1), Instant(1), 7}}, file("frames"));
    expect_misspelt_names_are_refused(file("frames") / "frames.json",
                                      [&](const fs::path&) { return read_frames(file("frames")); });
    LightFile light;
    light.orders.push_back({Instant(5), Instant(6), Instant(7), Rgb{1, 2, 3}, true});
    light.frames.push_back({"000000.png", 1, Instant(5), Instant(1)});
    write_light_file(light, folder.path());
    expect_misspelt_names_are_refused(file("light.json"),
                                      [&](const fs::path&) { return read_light_file(folder.path()); });
    write_safely(file("projector.json"), R"({"format": "planlight projector", "version": 1, "made_on": "2026-01-02",
        "projector": {"width": 800, "seriall": "X7"}})");
    EXPECT_THROW(read_projector_file(file("projector.json")), InputError);
}

}  // namespace
}  // namespace planlight
