#include "registration/devices/genicam_automatics.h"

#include <arv.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/steady_clock.h"
#include "registration/devices/genicam_camera.h"
#include "tests/registration/devices/one_served_camera.h"
#include "tests/support/test_data.h"

// Cameras with features of their own, opened over the loopback network as one on a cable is.
namespace planlight {
namespace {

using simulation::ServedCamera;
using simulation::ServedCameraSettings;
using test::OneAtATime;
using test::small_camera;

/// A feature of a camera, as its GenICam file describes it: choices by their names, or a switch; kept in one register.
std::string feature(const std::string& name, const std::vector<std::string>& choices, int address) {
    std::string xml = choices.empty() ? "<Boolean Name=\"" + name + "\">" : "<Enumeration Name=\"" + name + "\">";
    for (std::size_t i = 0; i < choices.size(); ++i)
        xml += fmt::format("<EnumEntry Name=\"{}\"><Value>{}</Value></EnumEntry>", choices[i], i);
    xml += "<pValue>" + name + "Register</pValue>";
    xml += choices.empty() ? "<OnValue>1</OnValue><OffValue>0</OffValue></Boolean>" : "</Enumeration>";
    return xml + fmt::format(
                     "<IntReg Name=\"{}Register\"><Address>{}</Address><Length>4</Length><AccessMode>RW</AccessMode>"
                     "<pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>",
                     name, address);
}

/// The library's plain camera with further features; those registers hold `value` when it is switched on.
class CameraWithFeatures {
public:
    CameraWithFeatures(const std::string& features, std::uint32_t address, std::uint32_t value) {
        ArvFakeCamera* plain = arv_fake_camera_new("plain");
        std::size_t size = 0;
        std::string xml(arv_fake_camera_get_genicam_xml(plain, &size));
        xml = xml.substr(0, size);
        g_object_unref(plain);
        xml.insert(xml.rfind("</RegisterDescription>"), features);
        std::ofstream(folder_.path() / "camera.xml") << xml;
        ServedCameraSettings settings = small_camera();
        settings.genicam_file = (folder_.path() / "camera.xml").string();
        camera_.emplace(settings);
        camera_->write_register(address, value);
    }
    ServedCamera& camera() { return *camera_; }
    std::vector<std::string> notes() {
        FrameBell bell;
        const SteadyClock clock;
        GenicamSettings settings;
        settings.device = "T-17";
        return GenicamCamera(settings, bell, clock).notes();
    }
    /// `said`: by room.json.
    bool global_shutter(std::optional<bool> said) {
        FrameBell bell;
        const SteadyClock clock;
        GenicamSettings settings;
        settings.device = "T-17";
        settings.global_shutter = said;
        return GenicamCamera(settings, bell, clock).global_shutter();
    }

private:
    test::TemporaryFolder folder_;
    std::optional<ServedCamera> camera_;
};

constexpr int kFree = 0x9000;  // registers that the plain camera does not use

TEST(GenicamAutomatics, AShutterThatCanBeGlobalIsSoAndOneThatCannotIsSaid) {
    const OneAtATime turn;
    {
        CameraWithFeatures can(feature("SensorShutterMode", {"Global", "Rolling"}, kFree), kFree, 1);
        EXPECT_TRUE(can.notes().empty()) << can.notes().front();
        EXPECT_EQ(can.camera().read_register(kFree), 0U) << "it is global now";
    }
    CameraWithFeatures cannot(feature("SensorShutterMode", {"Rolling"}, kFree), kFree, 0);
    const auto notes = cannot.notes();
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NE(notes[0].find("its shutter rolls"), std::string::npos) << notes[0];
}

TEST(GenicamAutomatics, AShutterIsGlobalWhereCameraOrRoomSaysSoAndNeverAgainstTheCamera) {
    const OneAtATime turn;
    {
        CameraWithFeatures says_global(feature("SensorShutterMode", {"Global"}, kFree), kFree, 0);
        EXPECT_TRUE(says_global.global_shutter({}));
        EXPECT_FALSE(says_global.global_shutter(false));
    }
    {
        CameraWithFeatures says_rolling(feature("SensorShutterMode", {"Rolling"}, kFree), kFree, 0);
        EXPECT_FALSE(says_rolling.global_shutter({}));
        EXPECT_FALSE(says_rolling.global_shutter(true));
    }
    CameraWithFeatures says_nothing("", kFree, 0);
    EXPECT_FALSE(says_nothing.global_shutter({}));
    EXPECT_TRUE(says_nothing.global_shutter(true));
}

TEST(GenicamAutomatics, ATestPictureIsSwitchedOffAndAMirroredPictureIsSaid) {
    const OneAtATime turn;
    {
        CameraWithFeatures shown(feature("TestPattern", {"Off", "GreyHorizontalRamp"}, kFree), kFree, 1);
        EXPECT_TRUE(shown.notes().empty()) << shown.notes().front();
        EXPECT_EQ(shown.camera().read_register(kFree), 0U);
    }
    {
        CameraWithFeatures stays(feature("TestPattern", {"GreyHorizontalRamp"}, kFree), kFree, 0);
        const auto notes = stays.notes();
        ASSERT_EQ(notes.size(), 1U);
        EXPECT_NE(notes[0].find("its TestPattern stays at GreyHorizontalRamp"), std::string::npos) << notes[0];
    }
    {
        CameraWithFeatures mirrored(feature("ReverseX", {}, kFree), kFree, 1);
        const auto notes = mirrored.notes();
        ASSERT_EQ(notes.size(), 1U);
        EXPECT_NE(notes[0].find("mirrored (ReverseX)"), std::string::npos) << notes[0];
    }
    CameraWithFeatures turned(feature("ReverseX", {}, kFree) + feature("ReverseY", {}, kFree), kFree, 1);
    EXPECT_TRUE(turned.notes().empty()) << "by half a turn, as of a camera that hangs upside down";
}

}  // namespace
}  // namespace planlight
