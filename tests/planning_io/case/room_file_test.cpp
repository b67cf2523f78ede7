#include "planning_io/case/room_file.h"

#include <gtest/gtest.h>

#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

TEST(RoomFile, ReadsBackAndItsPathsAreBesideIt) {
    const test::TemporaryFolder folder;
    RoomFile room;
    room.name = "Theatre 3";
    room.rig = "rigs/rig.json";
    room.projector_file = "/somewhere/projector.json";
    room.monitor = "HDMI-2";
    room.left.device = "1234";
    room.left.line = "Line2";
    room.left.exposure_ms = 7.5;
    room.left.region = {8, 16, 1920, 1200};
    room.right.device = "192.168.7.2";
    room.right.transfer_ms = 18;
    room.right.global_shutter = true;
    room.max_apart_ms = 0.5;
    write_room(room, folder.path() / "room.json");
    const RoomFile back = read_room(folder.path() / "room.json");
    EXPECT_EQ(back.name, room.name);
    EXPECT_EQ(back.rig, folder.path() / "rigs/rig.json");
    EXPECT_EQ(back.projector_file, "/somewhere/projector.json");
    EXPECT_EQ(back.monitor, "HDMI-2");
    EXPECT_EQ(back.left.device, "1234");
    EXPECT_EQ(back.left.line, "Line2");
    EXPECT_EQ(back.left.exposure_ms, 7.5);
    EXPECT_FALSE(back.left.gain);
    EXPECT_EQ(back.left.region, room.left.region);
    EXPECT_EQ(back.right.transfer_ms, 18);
    EXPECT_EQ(back.right.global_shutter, true);
    EXPECT_FALSE(back.left.global_shutter);
    EXPECT_EQ(back.max_apart_ms, 0.5);
}

/// `trigger` stood in every room.json of a former program.
TEST(RoomFile, OfAFormerProgramIsReadAsItWasMeantOrRefusedWithWhatToDelete) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "room.json";
    const auto left = [&](const std::string& trigger) {
        write_safely(file,
                     R"({"format": "planlight room", "version": 1, "rig": "rig.json", "projector": {"monitor": "A"},)"
                     R"("cameras": {"left": {"device": "1", )" +
                         trigger + R"(}, "right": {"device": "2", "trigger": "none"}}})");
        return read_room(file).left;
    };
    EXPECT_EQ(left(R"("trigger": "none")").line, "");
    EXPECT_EQ(left(R"("trigger": "line", "line": "Line2")").line, "Line2");
    for (const char* refused : {R"("trigger": "software")", R"("trigger": "line")",
                                R"("trigger": "none", "line": "Line2")", R"("trigger": 3)"}) {
        try {
            left(refused);
            ADD_FAILURE() << refused;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("trigger"), std::string::npos) << error.what();
        }
    }
}

TEST(RoomFile, WhatIsMissingMisspeltOrImpossibleIsRefusedByName) {
    const test::TemporaryFolder folder;
    const auto refusal = [&](const std::string& cameras) {
        const auto file = folder.path() / "room.json";
        write_safely(
            file, R"({"format": "planlight room", "version": 1, "rig": "rig.json", "projector": {"monitor": "A"}, )" +
                      cameras + "}");
        try {
            read_room(file);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string two = R"("left": {"device": "1"}, "right": {"device": "2"})";
    EXPECT_EQ(refusal(R"("cameras": {)" + two + "}"), "");
    EXPECT_NE(refusal(R"("cameras": {"left": {"device": "1"}})").find("right"), std::string::npos);
    EXPECT_NE(
        refusal(R"("cameras": {"left": {"device": "1"}, "right": {"device": "1"}})").find("is the left camera as well"),
        std::string::npos);
    EXPECT_EQ(refusal(R"("cameras": {"left": {"pipeline": "v4l2src", "exposure_ms": 5}, "right": {"device": "2"}})"),
              "");
    EXPECT_NE(
        refusal(R"("cameras": {"left": {"pipeline": "v4l2src", "gain": 5}, "right": {"device": "2"}})").find("gain"),
        std::string::npos)
        << "nobody would set it";
    EXPECT_NE(refusal(R"("cameras": {"left": {"device": "1", "exposure": 5}, "right": {"device": "2"}})")
                  .find("\"exposure\""),
              std::string::npos);
    EXPECT_NE(refusal(R"("cameras": {"left": {"device": "1", "exposure_ms": 0}, "right": {"device": "2"}})")
                  .find("exposure_ms"),
              std::string::npos);
    EXPECT_NE(refusal(R"("cameras": {"left": {"device": "1", "trigger": "software"}, "right": {"device": "2"}})")
                  .find("trigger"),
              std::string::npos);
}

TEST(RoomFile, OfARecordingNamesFoldersInPlaceOfCamerasAndNeedsNoProjector) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "room.json";
    const auto read = [&](const std::string& rest) {
        write_safely(file, R"({"format": "planlight room", "version": 1, "rig": "rig.json", )" + rest + "}");
        return read_room(file);
    };
    const RoomFile room = read(R"("cameras": {"recorded": {"frames": "frames", "capture": "/there/capture"}})");
    ASSERT_TRUE(room.recorded);
    EXPECT_EQ(room.recorded->frames, folder.path() / "frames");
    EXPECT_EQ(room.recorded->capture, "/there/capture");
    EXPECT_FALSE(room.recorded->fastest);
    EXPECT_EQ(room.monitor, "");
    write_room(room, file);
    EXPECT_EQ(read_room(file).recorded->frames, room.recorded->frames);
    const RoomFile lit =
        read(R"("projector": {"monitor": "HDMI-2"}, "cameras": {"recorded": {"frames": "frames", "pace": "fastest"}})");
    EXPECT_EQ(lit.monitor, "HDMI-2");
    EXPECT_TRUE(lit.recorded->fastest);
    for (const auto& [rest, about] :
         {std::pair{R"("cameras": {"recorded": {}})", "names no recording"},
          std::pair{R"("cameras": {"recorded": {"frames": "f", "pace": "slow"}})", "pace"},
          std::pair{R"("cameras": {"recorded": {"frames": "f"}, "left": {"device": "1"}})", "beside cameras"},
          std::pair{R"("cameras": {"recorded": {"folder": "f"}})", "folder"},
          std::pair{R"("cameras": {"left": {"device": "1"}, "right": {"device": "2"}})", "projector"}}) {
        try {
            read(rest);
            ADD_FAILURE() << rest;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(about), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace planlight
