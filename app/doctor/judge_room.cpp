#include "app/doctor/judge_room.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

namespace planlight {
namespace {

DoctorLine line(std::string subject, Health health, std::string said, std::string remedy) {
    if (health == Health::good) remedy.clear();
    return {std::move(subject), health, std::move(said), std::move(remedy)};
}

/// Good up to the first limit, look up to the second, else stop.
Health rising(double value, double look_above, double stop_above) {
    if (!(value <= stop_above)) return Health::stop;
    return value <= look_above ? Health::good : Health::look;
}

double share(std::size_t part, std::size_t of) {
    return of == 0 ? 0 : static_cast<double>(part) / static_cast<double>(of);
}

DoctorLine judge_identity(const CameraFigures& camera, const std::string& calibrated_serial,
                          const CameraModel& calibrated) {
    const std::string subject = camera.side + ", identity",
                      said = fmt::format("serial {}, {} x {}", camera.serial.empty() ? "not told" : camera.serial,
                                         camera.width, camera.height);
    if (!camera.serial.empty() && !calibrated_serial.empty() && camera.serial != calibrated_serial)
        return line(subject, Health::stop,
                    fmt::format("serial {}, and the rig was calibrated with {}", camera.serial, calibrated_serial),
                    "Connect that camera, exchange the devices in room.json if they stand the other way, or calibrate "
                    "the rig anew.");
    if (camera.width != calibrated.width || camera.height != calibrated.height)
        return line(subject, Health::stop,
                    fmt::format("{} x {} pixels, and it was calibrated with {} x {}", camera.width, camera.height,
                                calibrated.width, calibrated.height),
                    "Set its resolution or region back, or calibrate the rig anew.");
    if (camera.serial.empty() || calibrated_serial.empty())
        return line(subject, Health::look, said + "; whether it is the calibrated one cannot be told",
                    "Calibrate with cameras that tell their serial, or label them.");
    return line(subject, Health::good, said, {});
}

DoctorLine judge_rate(const CameraFigures& camera) {
    // A picture expires 75 ms after it was drawn (65 where they come often): frames further apart leave darkness
    // between.
    constexpr double kLeast_hz = 1 / 0.075, kComfortable_hz = 20, kOff = 0.05;
    const std::string subject = camera.side + ", rate", said = fmt::format("{:.1f} frames a second", camera.rate_hz);
    if (camera.rate_hz < kLeast_hz)
        return line(subject, Health::stop, said + ": the light would go out between two",
                    "Raise its frame rate, shorten its exposure, or look at its trigger.");
    if (camera.asked_hz && std::abs(camera.rate_hz / *camera.asked_hz - 1) > kOff)
        return line(subject, Health::look, said + fmt::format(", and {:.1f} were asked for", *camera.asked_hz),
                    "Look at its exposure and its trigger, and whether the network carries it.");
    return line(subject, camera.rate_hz < kComfortable_hz ? Health::look : Health::good, said,
                "Raise its frame rate: light follows a head the better the more often it is seen.");
}

DoctorLine judge_loss(const CameraFigures& camera) {
    constexpr double kSome = 0.0, kMany = 0.05;
    const std::size_t all = camera.received + camera.incomplete;
    const double lost = share(camera.incomplete, all);
    return line(camera.side + ", loss", all == 0 ? Health::stop : rising(lost, kSome, kMany),
                fmt::format("{} of {} frames with packets lost", camera.incomplete, all),
                "Look at the network: its receive buffer (net.core.rmem_max), jumbo frames, other traffic on that "
                "wire.");
}

/// Whether it sends pictures again under new times, as no camera does and some pipelines do.
DoctorLine judge_repeats(const CameraFigures& camera) {
    return line(camera.side + ", repeats", camera.repeated == 0 ? Health::good : Health::look,
                fmt::format("{} of {} pictures were the one before, sent again", camera.repeated,
                            camera.received + camera.repeated),
                "They are left out. Take out of its pipeline what repeats pictures (`videorate`).");
}

DoctorLine judge_clock(const CameraFigures& camera) {
    constexpr double kUsual = 200e-6, kMost = 500e-6, kSure_ms = 2, kUnsure_ms = 10;
    const std::string subject = camera.side + ", clock";
    if (!camera.own_clock)
        return line(subject, Health::look, "its frames have no time of their own",
                    "A camera that stamps its frames lets light follow a moving head better.");
    if (camera.clock_jumps > 0)
        return line(subject, Health::stop, fmt::format("it jumped {} times", camera.clock_jumps),
                    "Look at who sets its clock (PTP), or exchange the camera.");
    const Health health = std::max(rising(std::abs(camera.clock_drift), kUsual, kMost),
                                   rising(camera.clock_sigma_ms, kSure_ms, kUnsure_ms));
    return line(subject, health,
                fmt::format("runs {:.0f} millionths {}, known to {:.1f} ms", 1e6 * std::abs(camera.clock_drift),
                            camera.clock_drift > 0 ? "slow" : "fast", camera.clock_sigma_ms),
                "Close other programs: frames that come late blur its clock. If it stays, exchange the camera.");
}

}  // namespace

const char* text_of(Health health) {
    return health == Health::good ? "good" : health == Health::look ? "look" : "stop";
}

Health worst_of(const std::vector<DoctorLine>& lines) {
    Health worst = Health::good;
    for (const DoctorLine& one : lines) worst = std::max(worst, one.health);
    return worst;
}

std::vector<DoctorLine> judge_camera(const CameraFigures& camera, const std::string& calibrated_serial,
                                     const CameraModel* calibrated) {
    std::vector<DoctorLine> lines;
    if (calibrated) lines.push_back(judge_identity(camera, calibrated_serial, *calibrated));
    for (const auto& judge : {judge_rate, judge_loss, judge_repeats, judge_clock}) lines.push_back(judge(camera));
    for (const std::string& note : camera.notes)
        lines.push_back(
            line(camera.side + ", settings", Health::look, note,
                 "Set it in the camera's own program, or in room.json: pictures of a scan must be alike in all but the "
                 "light."));
    return lines;
}

std::vector<DoctorLine> judge_network(const NetworkFigures& network) {
    constexpr int kSmall = 1000;
    if (network.packet_bytes == 0) return {};
    std::vector<DoctorLine> lines;
    lines.push_back(line(network.side + ", packets", network.packet_bytes < kSmall ? Health::look : Health::good,
                         fmt::format("{} bytes each, {} a frame", network.packet_bytes,
                                     (network.frame_bytes + static_cast<std::size_t>(network.packet_bytes) - 1) /
                                         static_cast<std::size_t>(network.packet_bytes)),
                         "Allow larger packets on the way: jumbo frames in the network card and in the switch."));
    if (!network.buffer_bytes_max) return lines;
    const bool small = *network.buffer_bytes_max < network.frame_bytes;
    lines.push_back(line(network.side + ", receive buffer", small ? Health::look : Health::good,
                         fmt::format("net.core.rmem_max allows {} kB, a frame has {} kB",
                                     *network.buffer_bytes_max / 1000, network.frame_bytes / 1000),
                         fmt::format("As root: `sysctl -w net.core.rmem_max={}`; a busy moment would lose packets.",
                                     std::max<std::size_t>(4 * network.frame_bytes, 1 << 24))));
    return lines;
}

std::vector<DoctorLine> judge_pairs(const PairFigures& pairs) {
    constexpr double kMost = 0.9, kHalf = 0.5, kSameRate = 0.03, kEnds = 3;
    const std::string subject = "cameras, pairing";
    if (!pairs.problem.empty()) return {line(subject, Health::stop, pairs.problem, pairs.remedy)};
    const double paired = share(pairs.pairs, std::min(pairs.left, pairs.right));
    const std::string said = fmt::format("{:.0f} % of the frames have a partner, {:.2f} ms apart ({:.2f} allowed)",
                                         100 * paired, pairs.apart_ms, pairs.allowed_ms);
    Health health = paired < kHalf ? Health::stop : paired < kMost ? Health::look : Health::good;
    // Of a short while the first and the last frame of either may be missing.
    const std::size_t fewer = std::min(pairs.left, pairs.right), more = std::max(pairs.left, pairs.right);
    if (static_cast<double>(more - fewer) > kEnds + kSameRate * static_cast<double>(fewer))
        health = std::max(health, Health::look);
    return {line(subject, health, said,
                 "Let one camera trigger the other, or both by one line, with the same exposure and frame rate, and "
                 "say \"together\" in room.json.")};
}

std::optional<double> blur_of_fringe(double fringe_share, double period_px) {
    if (!(fringe_share > 0) || !(fringe_share < 1)) return std::nullopt;
    return period_px / (2 * std::numbers::pi) * std::sqrt(-2 * std::log(fringe_share));
}

std::vector<DoctorLine> judge_picture(const PictureFigures& picture) {
    constexpr double kLeast_lit = 0.02, kSome_saturated = 0.05, kMuch_saturated = 0.5, kDark_grey = 60,
                     kBlack_grey = 25;
    constexpr double kSoft = 0.7, kBlurred = 0.4;  // a sixteenth of a fringe's period, a fifth
    const std::string exposure = picture.side + ", exposure";
    if (picture.lit_share < kLeast_lit)
        return {line(exposure, Health::stop,
                     fmt::format("it sees almost nothing of the projector's light ({:.1f} % of its picture)",
                                 100 * picture.lit_share),
                     "Look where the projector shines and whether a lid is on, lay something there, and lengthen the "
                     "exposure.")};
    std::vector<DoctorLine> lines;
    if (picture.saturated_share > kSome_saturated)
        lines.push_back(line(exposure, picture.saturated_share > kMuch_saturated ? Health::stop : Health::look,
                             fmt::format("{:.0f} % of what it sees lit is saturated", 100 * picture.saturated_share),
                             "Shorten its exposure, by whole cycles of the projector, or close its iris."));
    else
        lines.push_back(line(exposure,
                             picture.brightest_lit_grey < kBlack_grey  ? Health::stop
                             : picture.brightest_lit_grey < kDark_grey ? Health::look
                                                                       : Health::good,
                             fmt::format("white light is grey {:.0f} of 255, {:.0f} % saturated",
                                         picture.brightest_lit_grey, 100 * picture.saturated_share),
                             "Lengthen its exposure, by whole cycles of the projector, or open its iris."));
    if (!picture.fringe_share) return lines;
    const auto blur = blur_of_fringe(*picture.fringe_share, picture.fringe_period_px);
    lines.push_back(
        line(picture.side + ", focus",
             *picture.fringe_share < kBlurred ? Health::stop
             : *picture.fringe_share < kSoft  ? Health::look
                                              : Health::good,
             fmt::format("fine stripes keep {:.0f} % of their contrast (blur {:.1f} pixels of the projector)",
                         100 * *picture.fringe_share, blur.value_or(0)),
             "Focus the projector first, then both cameras, at the patient's distance, and calibrate the "
             "rig anew."));
    return lines;
}

namespace {

constexpr const char* kOtherMonitor =
    "Connect that projector, set its resolution back (`xrandr`), or calibrate and measure this one.";

DoctorLine judge_mode(const Monitor& m, const CameraModel& projector, const ProjectorFacts& measured) {
    const std::string mode = fmt::format("{}: {} x {}{}", m.name, m.width, m.height,
                                         m.refresh_hz > 0 ? fmt::format(", {:g} Hz", m.refresh_hz) : "");
    const auto differs = [&](int width, int height) { return width > 0 && (m.width != width || m.height != height); };
    if (differs(projector.width, projector.height))
        return line("projector, mode", Health::stop,
                    mode + fmt::format(", and the rig was calibrated with {} x {}", projector.width, projector.height),
                    kOtherMonitor);
    if (differs(measured.width, measured.height))
        return line("projector, mode", Health::stop,
                    mode + fmt::format(", and its delay was measured at {} x {}", measured.width, measured.height),
                    kOtherMonitor);
    return line("projector, mode", m.refresh_hz > 0 ? Health::good : Health::look,
                mode + (m.refresh_hz > 0 ? "" : ", refresh rate not told"),
                "Look in the projector's menu which refresh rate it runs at.");
}

DoctorLine judge_identity(const Monitor& m, const ProjectorFacts& measured) {
    if (!measured.serial.empty() && !m.serial.empty() && m.serial != measured.serial)
        return line("projector, identity", Health::stop,
                    fmt::format("its serial is {}, and {} was measured", m.serial, measured.serial), kOtherMonitor);
    if (!measured.monitor.empty() && m.name != measured.monitor)
        return line("projector, identity", Health::stop,
                    fmt::format("it is connected to {}, and {} was measured", m.name, measured.monitor), kOtherMonitor);
    const bool nameless = m.model.empty() && m.serial.empty();
    return line("projector, identity", Health::good,
                nameless ? "it tells no name (EDID)" : fmt::format("{} {}", m.model, m.serial), {});
}

/// What Planlight's window covers while it is there, and who draws it.
DoctorLine judge_desktop(const MonitorFigures& monitor) {
    constexpr double kSome = 0.001;
    if (monitor.wayland)
        return line("projector, desktop", Health::stop,
                    "this is a Wayland desktop: what covers the light, or keeps it, cannot be seen",
                    "Log in to one of X11 (\"on Xorg\"), best without a compositor (openbox).");
    if (monitor.desktop_lit.value_or(0) > kSome)
        return line("projector, desktop", Health::look,
                    fmt::format("the desktop lights {:.0f} % of the projector's monitor: it falls on the patient when "
                                "Planlight has ended",
                                std::max(1.0, 100 * *monitor.desktop_lit)),
                    "Make its background black there, and keep icons, panels and notifications off it.");
    if (monitor.composited)
        return line("projector, desktop", Health::look,
                    "a compositor draws the desktop, and may move, delay or cover the light",
                    "Log in to a desktop without one (openbox), or switch it off.");
    return line("projector, desktop", Health::good,
                monitor.desktop_lit ? "black, and nothing draws over it" : "nothing draws over it", {});
}

}  // namespace

std::vector<DoctorLine> judge_monitor(const MonitorFigures& monitor, const CameraModel& projector) {
    if (!monitor.found)
        return {line("projector, monitor", Health::stop, "there is no monitor " + monitor.wanted,
                     "Connect the projector and switch it on; `planlight devices` lists what is there.")};
    return {judge_mode(*monitor.found, projector, monitor.measured), judge_identity(*monitor.found, monitor.measured),
            line("projector, window", monitor.covered ? Health::good : Health::stop,
                 monitor.covered ? "covers its monitor exactly" : monitor.problem, monitor.remedy),
            judge_desktop(monitor)};
}

std::vector<DoctorLine> judge_delay(const DelayFigures& delay) {
    constexpr double kOff_ms = 8, kFarOff_ms = 25;  // half a picture of 60 Hz; at 20 mm/s half a millimetre
    // A pose is carried on by 160 ms, and is some 50 ms old when it is drawn with. Beyond, a head that moves is dark.
    constexpr double kSlow_ms = 100, kFarTooSlow_ms = 250;
    const std::string subject = "projector, delay";
    if (!delay.problem.empty()) return {line(subject, Health::stop, delay.problem, delay.remedy)};
    std::vector<DoctorLine> lines;
    const std::string measured =
        fmt::format("light comes {:.0f} ms after its order (+-{:.0f})", delay.measured_ms, delay.sigma_ms);
    const std::string remedy = "Measure it: `planlight projector --room room.json --out projector.json`.";
    if (!delay.told_ms)
        lines.push_back(line(subject, Health::look, measured + ", and no projector.json says what is usual", remedy));
    else
        lines.push_back(line(subject,
                             rising(std::max(0.0, std::abs(delay.measured_ms - *delay.told_ms) - 2 * delay.sigma_ms),
                                    kOff_ms, kFarOff_ms),
                             measured + fmt::format(", projector.json says {:.0f}", *delay.told_ms),
                             "Look whether the projector's picture mode was changed, then measure it anew: `planlight "
                             "projector --room room.json --out projector.json`."));
    const Health slow = rising(delay.measured_ms - 2 * delay.sigma_ms, kSlow_ms, kFarTooSlow_ms);
    if (slow != Health::good)
        lines.push_back(line("projector, speed", slow,
                             measured + ": light cannot follow a head that moves, and goes out when it does",
                             "Switch off what the projector does to its picture (keystone, noise reduction, motion), "
                             "choose its game mode, or take another projector."));
    if (delay.right_later_ms && delay.frame_interval_ms > 0) {
        const double apart = std::abs(*delay.right_later_ms);
        const bool frame = apart > delay.frame_interval_ms / 2;
        lines.push_back(line(
            "cameras, same moment",
            frame        ? Health::stop
            : apart > 10 ? Health::look
                         : Health::good,
            fmt::format("the {} camera sees a flash {:.1f} ms later{}", *delay.right_later_ms < 0 ? "left" : "right",
                        apart, frame ? ": it runs a frame behind" : ""),
            "Switch that camera off and on. If it stays, give its own transfer_ms in room.json, or look at its "
            "trigger."));
    }
    return lines;
}

std::vector<DoctorLine> judge_rig(const DriftCheck& check, std::optional<double> age_days) {
    constexpr double kOld_days = 90;
    std::vector<DoctorLine> lines;
    const Health health = check.verdict == DriftCheck::Verdict::good          ? Health::good
                          : check.verdict == DriftCheck::Verdict::cannot_tell ? Health::look
                                                                              : Health::stop;
    lines.push_back(line("rig, moved since", health,
                         health == Health::good
                             ? fmt::format("{} points, epipolar error {:.2f} px, projector {:.2f} px", check.points,
                                           check.epipolar_px, check.projector_rms_px)
                             : check.reason,
                         check.remedy));
    if (age_days)
        lines.push_back(line("rig, age", *age_days > kOld_days ? Health::look : Health::good,
                             fmt::format("calibrated {:.0f} days ago", *age_days), "Calibrate it anew."));
    return lines;
}

namespace {

/// The light is a monitor: what makes one dark because nobody touches the keyboard puts it out.
DoctorLine judge_monitors_that_go_dark(const MonitorsDarkAfter& dark) {
    const std::string subject = "computer, screen saver";
    if (!dark.unused_s) return line(subject, Health::good, "no monitor goes dark by itself", {});
    if (dark.can_be_kept_on)
        return line(subject, Health::good,
                    fmt::format("waits while Planlight's windows are open; else monitors go dark after {} s unused",
                                *dark.unused_s),
                    {});
    return line(subject, Health::stop,
                fmt::format("monitors go dark after {} s unused, the projector too, and it cannot be told to wait",
                            *dark.unused_s),
                "Switch that off: `xset s off -dpms`.");
}

}  // namespace

std::vector<DoctorLine> judge_machine(const MachineFigures& machine) {
    constexpr double kGb = 1e9, kFew_gb = 10, kNone_gb = 1;
    std::vector<DoctorLine> lines;
    if (machine.free_bytes) {
        const double free_gb = static_cast<double>(*machine.free_bytes) / kGb;
        lines.push_back(line("computer, disk",
                             free_gb < kNone_gb  ? Health::stop
                             : free_gb < kFew_gb ? Health::look
                                                 : Health::good,
                             fmt::format("{:.0f} GB free in {}", free_gb, machine.folder),
                             "Make room: matches, captures and recordings of a session are kept there."));
    }
    std::string renderer = machine.gl_renderer;
    std::transform(renderer.begin(), renderer.end(), renderer.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto names = [&](const char* word) { return renderer.find(word) != std::string::npos; };
    if (renderer.empty())
        lines.push_back(line("computer, OpenGL", Health::stop, machine.gl_problem, machine.gl_remedy));
    else
        lines.push_back(line("computer, OpenGL",
                             names("llvmpipe") || names("softpipe") || names("swrast") || names("software")
                                 ? Health::look
                                 : Health::good,
                             machine.gl_renderer,
                             "Install the graphics card's driver: by software pictures come late, and the more so the "
                             "busier the computer is."));
    if (machine.dark_after) lines.push_back(judge_monitors_that_go_dark(*machine.dark_after));
    std::string slow;
    for (const std::string& governor : machine.governors)
        if (governor == "powersave" || governor == "conservative") slow = governor;
    std::string all;
    for (const std::string& governor : machine.governors) all += (all.empty() ? "" : ", ") + governor;
    lines.push_back(line("computer, processor", slow.empty() ? Health::good : Health::look,
                         all.empty() ? "governor not told" : "governor " + all,
                         "As root: `cpupower frequency-set -g performance`; saving power delays pictures."));
    lines.push_back(
        line("computer, priority", machine.realtime_priority ? Health::good : Health::look,
             machine.realtime_priority ? "the light goes before all that other programs compute"
                                       : "while other programs compute, the light may go out late",
             "As root, write `USER - rtprio 1` (this user's name) into /etc/security/limits.d/planlight.conf, "
             "and log in anew."));
    return lines;
}

}  // namespace planlight
