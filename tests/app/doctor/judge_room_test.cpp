#include "app/doctor/judge_room.h"

#include <gtest/gtest.h>

#include <cmath>

// Each rule of the doctor on figures alone: what must pass passes, and what must not is said with its remedy.
namespace planlight {
namespace {

CameraModel model(int width, int height) {
    CameraModel camera;
    camera.width = width;
    camera.height = height;
    camera.focal_x = 1000;
    return camera;
}

/// The line about `subject`; fails where there is none.
DoctorLine about(const std::string& subject, const std::vector<DoctorLine>& lines) {
    for (const DoctorLine& line : lines)
        if (line.subject.find(subject) != std::string::npos) return line;
    ADD_FAILURE() << "nothing is said about " << subject;
    return {};
}

/// Whatever is not good has a remedy, and what is good has none.
void expect_remedies(const std::vector<DoctorLine>& lines) {
    for (const DoctorLine& line : lines) {
        EXPECT_EQ(line.remedy.empty(), line.health == Health::good) << line.subject << ": " << line.said;
        EXPECT_FALSE(line.said.empty()) << line.subject;
    }
}

CameraFigures good_camera() {
    CameraFigures camera;
    camera.side = "left camera";
    camera.serial = "A1";
    camera.width = 744;
    camera.height = 576;
    camera.rate_hz = 25;
    camera.received = 75;
    camera.own_clock = true;
    camera.clock_drift = 50e-6;
    camera.clock_sigma_ms = 0.3;
    return camera;
}
std::vector<DoctorLine> judged(const CameraFigures& camera) {
    const CameraModel calibrated = model(744, 576);
    auto lines = judge_camera(camera, "A1", &calibrated);
    expect_remedies(lines);
    return lines;
}

TEST(Doctor, ACameraThatIsWellIsGood) {
    EXPECT_EQ(worst_of(judged(good_camera())), Health::good);
    CameraFigures fast = good_camera();
    fast.rate_hz = 400;
    EXPECT_EQ(worst_of(judged(fast)), Health::good);
}

TEST(Doctor, AnotherCameraOrResolutionThanCalibratedStops) {
    CameraFigures camera = good_camera();
    camera.serial = "B2";
    EXPECT_EQ(about("identity", judged(camera)).health, Health::stop);
    EXPECT_NE(about("identity", judged(camera)).said.find("B2"), std::string::npos);
    camera = good_camera();
    camera.width = 640;
    EXPECT_EQ(about("identity", judged(camera)).health, Health::stop);
    camera = good_camera();
    camera.serial.clear();
    EXPECT_EQ(about("identity", judged(camera)).health, Health::look) << "it cannot be told";
}

TEST(Doctor, FramesFurtherApartThanAPictureLivesStop) {
    CameraFigures camera = good_camera();
    camera.rate_hz = 10;
    EXPECT_EQ(about("rate", judged(camera)).health, Health::stop);
    camera.rate_hz = 0;
    EXPECT_EQ(about("rate", judged(camera)).health, Health::stop);
    camera.rate_hz = 15;
    EXPECT_EQ(about("rate", judged(camera)).health, Health::look);
    camera.rate_hz = 30;
    camera.asked_hz = 60;
    EXPECT_EQ(about("rate", judged(camera)).health, Health::look) << "half of what was asked for";
    camera.asked_hz = 30.5;
    EXPECT_EQ(about("rate", judged(camera)).health, Health::good);
}

TEST(Doctor, LostPacketsAreLookedAtAndManyStop) {
    CameraFigures camera = good_camera();
    camera.incomplete = 1;
    EXPECT_EQ(about("loss", judged(camera)).health, Health::look);
    camera.incomplete = 10;
    EXPECT_EQ(about("loss", judged(camera)).health, Health::stop);
    camera.received = camera.incomplete = 0;
    EXPECT_EQ(about("loss", judged(camera)).health, Health::stop) << "nothing at all came";
}

TEST(Doctor, PicturesThatAreSentAgainAreLookedAt) {
    CameraFigures camera = good_camera();
    EXPECT_EQ(about("repeats", judged(camera)).health, Health::good);
    camera.repeated = 1;
    EXPECT_EQ(about("repeats", judged(camera)).health, Health::look);
}

TEST(Doctor, AClockThatNobodyCanFollowStops) {
    CameraFigures camera = good_camera();
    camera.clock_drift = -800e-6;
    EXPECT_EQ(about("clock", judged(camera)).health, Health::stop);
    camera.clock_drift = 0;
    camera.clock_sigma_ms = 4;
    EXPECT_EQ(about("clock", judged(camera)).health, Health::look);
    camera.clock_jumps = 1;
    EXPECT_EQ(about("clock", judged(camera)).health, Health::stop);
    camera.own_clock = false;
    EXPECT_EQ(about("clock", judged(camera)).health, Health::look) << "a webcam may be used";
}

TEST(Doctor, WhatACameraDoesByItselfIsSaid) {
    CameraFigures camera = good_camera();
    camera.notes = {"its gamma stays at 0.45"};
    EXPECT_EQ(about("settings", judged(camera)).said, "its gamma stays at 0.45");
}

TEST(Doctor, ASmallReceiveBufferOrPacketIsLookedAt) {
    EXPECT_TRUE(judge_network({"left camera", 0, 0, 212992}).empty()) << "USB has neither";
    EXPECT_EQ(worst_of(judge_network({"left camera", 8000, 428544, 1 << 25})), Health::good);
    const auto small = judge_network({"left camera", 576, 428544, 212992});
    expect_remedies(small);
    EXPECT_EQ(about("packets", small).health, Health::look);
    EXPECT_EQ(about("receive buffer", small).health, Health::look);
    EXPECT_NE(about("receive buffer", small).remedy.find("sysctl -w net.core.rmem_max="), std::string::npos);
}

TEST(Doctor, CamerasThatDoNotExposeTogetherStop) {
    PairFigures pairs{75, 75, 75, 0.4, 10, {}, {}};
    EXPECT_EQ(worst_of(judge_pairs(pairs)), Health::good);
    pairs.pairs = 60;
    EXPECT_EQ(worst_of(judge_pairs(pairs)), Health::look);
    pairs.pairs = 20;
    EXPECT_EQ(worst_of(judge_pairs(pairs)), Health::stop);
    pairs = {75, 150, 75, 0.4, 10, {}, {}};
    EXPECT_EQ(worst_of(judge_pairs(pairs)), Health::look) << "one runs at twice the rate of the other";
    pairs = {48, 51, 47, 0.4, 10, {}, {}};
    EXPECT_EQ(worst_of(judge_pairs(pairs)), Health::good) << "the ends of two seconds";
    pairs.problem = "Cameras: the two do not expose together";
    pairs.remedy = "Let one camera trigger the other.";
    EXPECT_EQ(worst_of(judge_pairs(pairs)), Health::stop);
}

TEST(Doctor, TooDarkTooBrightAndNothingSeen) {
    const auto health = [](double lit, double saturated, double grey) {
        const auto lines = judge_picture({"left camera", lit, saturated, grey, std::nullopt, 16});
        expect_remedies(lines);
        return worst_of(lines);
    };
    EXPECT_EQ(health(0.5, 0.01, 200), Health::good);
    EXPECT_EQ(health(0.001, 0, 0), Health::stop);
    EXPECT_EQ(health(0.5, 0.2, 255), Health::look);
    EXPECT_EQ(health(0.5, 0.8, 255), Health::stop);
    EXPECT_EQ(health(0.5, 0, 40), Health::look);
    EXPECT_EQ(health(0.5, 0, 15), Health::stop);
}

TEST(Doctor, FocusIsABlurOfTheFinestStripes) {
    // A Gaussian of sigma takes exp(-2 (pi sigma / period)^2) of a sine's contrast.
    for (const double sigma_px : {0.5, 1.0, 2.5}) {
        const double left = std::exp(-2 * std::pow(M_PI * sigma_px / 16, 2));
        EXPECT_NEAR(*blur_of_fringe(left, 16), sigma_px, 1e-9);
    }
    EXPECT_FALSE(blur_of_fringe(0, 16) || blur_of_fringe(1.02, 16));
    const auto health = [](double share) {
        return about("focus", judge_picture({"right camera", 0.5, 0, 200, share, 16})).health;
    };
    EXPECT_EQ(health(0.9), Health::good);
    EXPECT_EQ(health(0.6), Health::look);
    EXPECT_EQ(health(0.2), Health::stop);
}

MonitorFigures good_monitor() {
    MonitorFigures monitor;
    monitor.wanted = "HDMI-2";
    monitor.found = Monitor{"HDMI-2", 1920, 0, 800, 600, false, 60, "PJ", "X7K2"};
    monitor.measured.width = 800;
    monitor.measured.height = 600;
    monitor.measured.serial = "X7K2";
    monitor.covered = true;
    return monitor;
}
std::vector<DoctorLine> judged(const MonitorFigures& monitor) {
    auto lines = judge_monitor(monitor, model(800, 600));
    expect_remedies(lines);
    return lines;
}

// It is there before Planlight, after it, and for a moment when a projector process is lost.
TEST(Doctor, ADesktopThatIsNotBlackOrIsDrawnByACompositorIsSaid) {
    MonitorFigures monitor = good_monitor();
    monitor.desktop_lit = 0;
    EXPECT_EQ(about("desktop", judged(monitor)).health, Health::good);
    monitor.composited = true;
    EXPECT_EQ(about("desktop", judged(monitor)).health, Health::look);
    monitor.desktop_lit = 0.01;
    EXPECT_EQ(about("desktop", judged(monitor)).health, Health::look);
    EXPECT_NE(about("desktop", judged(monitor)).said.find("falls on the patient"), std::string::npos);
    monitor = good_monitor();
    monitor.wayland = true;
    EXPECT_EQ(about("desktop", judged(monitor)).health, Health::stop);
}

TEST(Doctor, TheProjectorIsTheOneThatWasCalibratedAndMeasured) {
    EXPECT_EQ(worst_of(judged(good_monitor())), Health::good);
    MonitorFigures monitor = good_monitor();
    monitor.found.reset();
    EXPECT_EQ(worst_of(judged(monitor)), Health::stop);
    monitor = good_monitor();
    monitor.found->width = 1024;
    EXPECT_EQ(about("mode", judged(monitor)).health, Health::stop);
    monitor = good_monitor();
    monitor.found->refresh_hz = 0;
    EXPECT_EQ(about("mode", judged(monitor)).health, Health::look);
    monitor = good_monitor();
    monitor.found->serial = "Q1";
    EXPECT_EQ(about("identity", judged(monitor)).health, Health::stop);
    monitor = good_monitor();
    monitor.measured.monitor = "HDMI-1";
    EXPECT_EQ(about("identity", judged(monitor)).health, Health::stop);
    monitor = good_monitor();
    monitor.covered = false;
    monitor.problem = "the window is 800x580 at 1920,20";
    monitor.remedy = "Switch the panel off.";
    EXPECT_EQ(about("window", judged(monitor)).health, Health::stop);
}

TEST(Doctor, ADelayThatIsNotTheMeasuredOne) {
    DelayFigures delay;
    delay.measured_ms = 60;
    delay.sigma_ms = 2;
    delay.frame_interval_ms = 40;
    EXPECT_EQ(worst_of(judge_delay(delay)), Health::look) << "none was measured before";
    delay.told_ms = 55;
    EXPECT_EQ(worst_of(judge_delay(delay)), Health::good);
    delay.told_ms = 45;
    EXPECT_EQ(worst_of(judge_delay(delay)), Health::look);
    delay.told_ms = 20;
    EXPECT_EQ(worst_of(judge_delay(delay)), Health::stop);
    delay.told_ms = 110;
    EXPECT_EQ(worst_of(judge_delay(delay)), Health::stop) << "earlier than told as well";
    delay.problem = "nothing is seen of the projector";
    delay.remedy = "Look whether a lid is on.";
    EXPECT_EQ(worst_of(judge_delay(delay)), Health::stop);
}

TEST(Doctor, AProjectorTooSlowToFollowAHeadIsSaidThoughItIsAsMeasured) {
    DelayFigures delay;
    delay.sigma_ms = 2;
    for (const auto& [ms, health] : {std::pair{60.0, Health::good}, {110.0, Health::look}, {400.0, Health::stop}}) {
        delay.measured_ms = ms;
        delay.told_ms = ms;
        EXPECT_EQ(worst_of(judge_delay(delay)), health) << ms;
    }
}

TEST(Doctor, ACameraOfARigThatCannotBeReadIsNotSaidToBeAnother) {
    for (const DoctorLine& one : judge_camera(good_camera(), "", nullptr))
        EXPECT_EQ(one.subject.find("identity"), std::string::npos) << one.said;
}

TEST(Doctor, ACameraThatRunsAFrameBehindStops) {
    DelayFigures delay;
    delay.measured_ms = 60;
    delay.told_ms = 60;
    delay.frame_interval_ms = 40;
    delay.right_later_ms = 1.5;
    EXPECT_EQ(worst_of(judge_delay(delay)), Health::good);
    delay.right_later_ms = -40;
    EXPECT_EQ(about("same moment", judge_delay(delay)).health, Health::stop);
    EXPECT_NE(about("same moment", judge_delay(delay)).said.find("left camera"), std::string::npos);
    delay.right_later_ms = 14;
    EXPECT_EQ(about("same moment", judge_delay(delay)).health, Health::look);
}

TEST(Doctor, ARigThatMovedStopsAndAnOldOneIsLookedAt) {
    DriftCheck check;
    check.verdict = DriftCheck::Verdict::good;
    EXPECT_EQ(worst_of(judge_rig(check, 10)), Health::good);
    EXPECT_EQ(worst_of(judge_rig(check, std::nullopt)), Health::good);
    EXPECT_EQ(about("age", judge_rig(check, 400)).health, Health::look);
    check.reason = "the projector moved by 2.1 mm";
    check.remedy = "Calibrate again.";
    for (const auto verdict : {DriftCheck::Verdict::projector_moved, DriftCheck::Verdict::cameras_moved,
                               DriftCheck::Verdict::lens_changed, DriftCheck::Verdict::distortion_wrong}) {
        check.verdict = verdict;
        EXPECT_EQ(worst_of(judge_rig(check, 10)), Health::stop);
    }
    check.verdict = DriftCheck::Verdict::cannot_tell;
    EXPECT_EQ(worst_of(judge_rig(check, 10)), Health::look);
}

TEST(Doctor, TheComputer) {
    MachineFigures machine{std::uint64_t{80'000'000'000}, "/data", "NVIDIA T400/PCIe/SSE2", "", {"performance"}};
    machine.realtime_priority = true;
    EXPECT_EQ(worst_of(judge_machine(machine)), Health::good);
    machine.free_bytes = 3'000'000'000;
    EXPECT_EQ(about("disk", judge_machine(machine)).health, Health::look);
    machine.free_bytes = 100'000'000;
    EXPECT_EQ(about("disk", judge_machine(machine)).health, Health::stop);
    machine.gl_renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
    EXPECT_EQ(about("OpenGL", judge_machine(machine)).health, Health::look);
    machine.gl_renderer.clear();
    machine.gl_problem = "no window can be opened";
    machine.gl_remedy = "Start the program in a desktop session, or set DISPLAY.";
    EXPECT_EQ(about("OpenGL", judge_machine(machine)).health, Health::stop);
    EXPECT_EQ(about("OpenGL", judge_machine(machine)).remedy, machine.gl_remedy) << "not that of another problem";
    machine.governors = {"performance", "powersave"};
    EXPECT_EQ(about("processor", judge_machine(machine)).health, Health::look);
    machine.governors.clear();
    EXPECT_EQ(about("processor", judge_machine(machine)).health, Health::good) << "a virtual machine tells none";
    machine.realtime_priority = false;
    EXPECT_EQ(about("priority", judge_machine(machine)).health, Health::look);
    expect_remedies(judge_machine(machine));
}

TEST(Doctor, MonitorsThatGoDarkByThemselvesStopUnlessTheyCanBeKeptOn) {
    MachineFigures machine{std::uint64_t{80'000'000'000}, "/data", "NVIDIA T400/PCIe/SSE2", "", {"performance"}};
    for (const DoctorLine& one : judge_machine(machine))
        EXPECT_EQ(one.subject.find("saver"), std::string::npos) << "without a display nothing is known";
    machine.dark_after = MonitorsDarkAfter{std::nullopt, false};
    EXPECT_EQ(about("saver", judge_machine(machine)).health, Health::good);
    machine.dark_after = MonitorsDarkAfter{600, true};
    EXPECT_EQ(about("saver", judge_machine(machine)).health, Health::good);
    EXPECT_NE(about("saver", judge_machine(machine)).said.find("600 s"), std::string::npos);
    machine.dark_after = MonitorsDarkAfter{600, false};
    EXPECT_EQ(about("saver", judge_machine(machine)).health, Health::stop);
    expect_remedies(judge_machine(machine));
}

}  // namespace
}  // namespace planlight
