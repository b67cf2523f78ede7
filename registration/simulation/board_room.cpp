#include "registration/simulation/board_room.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <stdexcept>

#include "planning_io/types/error.h"
#include "registration/simulation/camera_view.h"
#include "registration/simulation/hash.h"
#include "registration/simulation/light.h"
#include "registration/simulation/rig_layout.h"
#include "registration/simulation/sensor.h"
#include "registration/simulation/truth_file.h"

namespace planlight::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kRadians = M_PI / 180;
constexpr int kSamplesAcrossEdge = 6;

bool in_view(const Optics& device, const Vector3d& p_in_room) {
    const Vector2d pixel = device.pixel_of(p_in_room);
    return device.depth(p_in_room) > 0 && pixel.x() > 3 && pixel.y() > 3 && pixel.x() < device.columns - 4 &&
           pixel.y() < device.rows - 4;
}

/// The picture shifted sideways; what comes in from outside is as its rim.
void shift(GrayImage& picture, int by) {
    for (int y = 0; y < picture.height; ++y) {
        std::uint8_t* const row = &picture.at(0, y);
        if (by > 0) {
            std::copy_backward(row, row + picture.width - by, row + picture.width);
            std::fill(row, row + by, row[by]);
        } else if (by < 0) {
            std::copy(row - by, row + picture.width, row);
            std::fill(row + picture.width + by, row + picture.width, row[picture.width + by - 1]);
        }
    }
}

}  // namespace

struct SimulatedBoardRoom::Room final : Projector, StereoCamera, Clock {
    Room(const BoardSheet& print, const BoardRoomSettings& given);

    Instant now() const override { return now_; }
    int width() const override { return rig.projector.columns; }
    int height() const override { return rig.projector.rows; }
    Instant show(const RgbImage& picture, Instant valid_until) override;
    void go_dark() noexcept override { schedule.go_dark(now_); }
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override;

    RigidTransform random_pose(std::mt19937& random) const;
    double share_in_view(const RigidTransform& room_from_board) const;
    GrayImage expose(CameraView& view, const Sensor& sensor, const LightMap& light, double lamps, std::uint64_t frame);
    void look();
    void look_at(const RigidTransform& pose, int finer, CameraView& left, CameraView& right) const;
    RigidTransform posed(double way, double tilt, double turn, const Vector3d& at) const;
    std::vector<BoardStop> stops_of_a_person(std::mt19937& random) const;
    bool follow_person(Instant at);
    void carry_on();

    BoardSheet sheet;
    BoardRoomSettings settings;
    SheetSurface surface{sheet};
    SheetLook look_of_sheet{sheet};
    RigLayout rig, true_layout;
    std::vector<RigidTransform> room_from_board;
    RigidTransform room_from_board_now = RigidTransform::Identity();
    LightSchedule schedule{0, 0, {}};
    CameraView left_view, right_view;
    Sensor left_sensor, right_sensor;
    bool seen = false;
    std::optional<BoardPerson> person;
    struct Views {
        CameraView left, right;
    };
    std::future<std::unique_ptr<Views>> on_the_way;  ///< of the next place of a board that is carried
    std::vector<float> light_buffer;
    Instant now_{};
};

SimulatedBoardRoom::Room::Room(const BoardSheet& print, const BoardRoomSettings& given)
    : sheet(print), settings(given) {
    std::mt19937 random(
        static_cast<unsigned>(mixed(static_cast<std::uint64_t>(settings.seed) * 64 + 1)));  // the rig of `SimulatedRig`
    rig = true_layout = build_rig(settings.preset, random);
    random.seed(static_cast<unsigned>(mixed(static_cast<std::uint64_t>(settings.seed) * 64 + 40)));
    for (int i = 0; i < settings.poses; ++i) room_from_board.push_back(random_pose(random));
    if (!room_from_board.empty()) room_from_board_now = room_from_board.front();
    schedule = LightSchedule(rig.projector.columns, rig.projector.rows, settings.projector_delay, settings.light,
                             mixed(static_cast<std::uint64_t>(settings.seed) + 9000));
    const auto sensor = [&](const Optics& camera, double blur_px, std::uint64_t number) {
        return Sensor{camera.columns, camera.rows,
                      blur_px,        0.85,
                      settings.noise, mixed(2 * static_cast<std::uint64_t>(settings.seed) + 5000 + number)};
    };
    left_sensor = sensor(rig.left_camera, rig.left_blur_px, 0);
    right_sensor = sensor(rig.right_camera, rig.right_blur_px, 1);
}

/// Of a grid over the print: the least share that a device sees. 0 when a device looks at it too flat.
double SimulatedBoardRoom::Room::share_in_view(const RigidTransform& pose) const {
    constexpr double kFlattest = 0.5;  // cosine: 60 degrees
    double share = 1;
    for (const Optics* device : {&rig.left_camera, &rig.right_camera, &rig.projector}) {
        int seen_points = 0, points = 0;
        for (double u = 0; u <= 1.001; u += 0.1)
            for (double v = 0; v <= 1.001; v += 0.1, ++points)
                seen_points += in_view(*device, pose * Vector3d(u * sheet.width_mm(), v * sheet.height_mm(), 0));
        share = std::min(share, static_cast<double>(seen_points) / points);
        const Vector3d middle = pose * Vector3d(sheet.width_mm() / 2, sheet.height_mm() / 2, 0);
        if ((middle - device->eye).normalized().dot(pose.linear().col(2)) < kFlattest) return 0;
        if (settings.whole && device != &rig.projector && share < 1) return 0;
    }
    return share;
}

/// The board's middle at `at` (room), tilted about the axis in direction `way`, turned in its plane; radians.
RigidTransform SimulatedBoardRoom::Room::posed(double way, double tilt, double turn, const Vector3d& at) const {
    RigidTransform pose = RigidTransform::Identity();
    pose.linear() = (Eigen::AngleAxisd(tilt, Vector3d(std::cos(way), std::sin(way), 0)) *
                     Eigen::AngleAxisd(turn, Vector3d::UnitZ()))
                        .toRotationMatrix();
    pose.translation() = at - pose.linear() * Vector3d(sheet.width_mm() / 2, sheet.height_mm() / 2, 0);
    return pose;
}

RigidTransform SimulatedBoardRoom::Room::random_pose(std::mt19937& random) const {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int attempt = 0; attempt < 5000; ++attempt) {
        const double way = between(0, 2 * M_PI),
                     tilt = between(settings.min_tilt_deg, settings.max_tilt_deg) * kRadians;
        const double turn = between(0, 2 * M_PI);
        const Vector3d at(between(-settings.shift_mm, settings.shift_mm),
                          between(-settings.shift_mm, settings.shift_mm),
                          between(-settings.depth_mm, settings.depth_mm));
        const RigidTransform pose = posed(way, tilt, turn, at);
        if (share_in_view(pose) >= (settings.whole ? 0.5 : 0.6)) return pose;
    }
    throw std::invalid_argument("no pose of the board is seen by all devices: it is too large for this room");
}

/// Useful poses, tilted every way in turn as somebody would who was told to; and what goes wrong on the way.
std::vector<BoardStop> SimulatedBoardRoom::Room::stops_of_a_person(std::mt19937& random) const {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::vector<BoardStop> stops;
    const auto useful = [&](int i) {
        for (int attempt = 0; attempt < 5000; ++attempt) {
            const double way = i * M_PI / 2 + between(-0.7, 0.7), tilt = between(18, 38) * kRadians;
            const Vector3d at(between(-settings.shift_mm, settings.shift_mm),
                              between(-settings.shift_mm, settings.shift_mm),
                              (i / 2 % 2 ? 1 : -1) * between(0.2, 1) * settings.depth_mm);
            const RigidTransform pose = posed(way, tilt, between(-0.4, 0.4) + (i % 3) * M_PI / 2, at);
            if (share_in_view(pose) >= 0.6) return pose;
        }
        return random_pose(random);
    };
    const double aside = 0.15 * rig.working_distance_mm;
    const double sign = between(0, 1) < 0.5 ? -1 : 1;
    constexpr int kUseful = 24;
    for (int i = 0; i < kUseful; ++i) {
        switch (i) {
            case 1:
                stops.push_back({posed(0, 64 * kRadians, 0, {0, 0, 0}), "too aslant"});
                break;
            case 2:
                stops.push_back(
                    {posed(0, 0.35, 0, {sign * aside, 0, -0.25 * rig.working_distance_mm}), "seen by one camera"});
                break;
            case 3:
                stops.push_back(stops.back());
                stops.back().name = "the same again";
                break;
            case 4:
                stops.push_back({posed(between(0, 6), 0.02, 0, {0, 0, 0}), "flat on"});
                break;
            case 5:
                stops.push_back({posed(0.5, 0.4, 0, {0, 0, 1.2 * sheet.width_mm()}), "too far"});
                break;
            case 6:
                stops.push_back({useful(i + 1), "leaves in the light", true});
                break;
            default:
                break;
        }
        stops.push_back({useful(i), "useful"});
    }
    return stops;
}

/// The next place on the way, drawn meanwhile: coarsely until the board is laid down.
void SimulatedBoardRoom::Room::carry_on() {
    const RigidTransform pose = person->next_place();
    const int finer = person->at_last_step() ? kSamplesAcrossEdge : 1;
    room_from_board_now = pose;
    on_the_way = std::async(std::launch::async, [this, pose, finer] {
        auto views = std::make_unique<Views>();
        look_at(pose, finer, views->left, views->right);
        return views;
    });
}

/// Brings the board on when a person has it; true while it moves.
bool SimulatedBoardRoom::Room::follow_person(Instant at) {
    if (!person) return false;
    if (!on_the_way.valid()) {
        if (!person->leaves(at)) return false;
        carry_on();
    } else if (!person->time_goes_on() || on_the_way.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
        const auto views = on_the_way.get();
        left_view = std::move(views->left);
        right_view = std::move(views->right);
        person->arrive(at);
        if (person->at_rest()) return false;
        carry_on();
    }
    return true;
}

void SimulatedBoardRoom::Room::look_at(const RigidTransform& pose, int finer, CameraView& left,
                                       CameraView& right) const {
    const RigidTransform to_board = pose.inverse();
    Scene scene{surface,
                look_of_sheet,
                rig.left_camera.seen_from(to_board),
                rig.projector.seen_from(to_board),
                rig.working_distance_mm,
                finer};
    left.look(scene);
    scene.camera = rig.right_camera.seen_from(to_board);
    right.look(scene);
}

void SimulatedBoardRoom::Room::look() {
    if (seen) return;
    look_at(room_from_board_now, kSamplesAcrossEdge, left_view, right_view);
    seen = true;
}

GrayImage SimulatedBoardRoom::Room::expose(CameraView& view, const Sensor& sensor, const LightMap& light, double lamps,
                                           std::uint64_t frame) {
    const double gain = settings.brightness * (200.0 / 255 - settings.ambient) / SheetLook::kPaperAlbedo;
    const double ambient = lamps * settings.ambient / SheetLook::kPaperAlbedo;
    view.expose(light, static_cast<float>(gain), static_cast<float>(ambient), light_buffer);
    return sense(sensor, light_buffer, frame);
}

Instant SimulatedBoardRoom::Room::show(const RgbImage& picture, Instant valid_until) {
    if (picture.width != width() || picture.height != height())
        throw DeviceError("simulated projector", "a picture of another size was to be shown",
                          "Draw the picture in the projector's own size.");
    if (person) person->see_light_change(now_);
    schedule.show(picture, now_, valid_until);
    return now_ + settings.projector_delay;
}

StereoFrame SimulatedBoardRoom::Room::grab(Instant not_before, std::chrono::milliseconds patience) {
    const Instant from = std::max(not_before, now_);
    auto number = (from.count() + rig.frame_interval.count() - 1) / rig.frame_interval.count();
    while (frame_is_lost(settings.light, settings.seed, number)) ++number;
    const Instant begins = number * rig.frame_interval, ends = begins + rig.exposure;
    if (ends - now_ > patience)
        throw DeviceError("simulated cameras", "no frame came in time", "Wait longer, or ask for an earlier frame.");
    StereoFrame frame;
    frame.at = begins + rig.exposure / 2;
    frame.exposure = rig.exposure;
    frame.number = static_cast<std::uint64_t>(number);
    look();
    const bool carried = follow_person(frame.at);
    const auto light = schedule.during(begins, ends);
    const double lamps = lamps_during(settings.light, begins, ends);
    frame.left = expose(left_view, left_sensor, *light, lamps, frame.number);
    frame.right = expose(right_view, right_sensor, *light, lamps, frame.number);
    if (carried) {
        shift(frame.left, BoardPerson::shaken_px(frame.at));
        shift(frame.right, BoardPerson::shaken_px(frame.at));
    }
    now_ = ends;
    return frame;
}

SimulatedBoardRoom::SimulatedBoardRoom(const BoardSheet& sheet, const BoardRoomSettings& settings)
    : room_(std::make_unique<Room>(sheet, settings)) {}
SimulatedBoardRoom::~SimulatedBoardRoom() = default;

Projector& SimulatedBoardRoom::projector() {
    return *room_;
}
StereoCamera& SimulatedBoardRoom::cameras() {
    return *room_;
}
const Clock& SimulatedBoardRoom::clock() const {
    return *room_;
}
void SimulatedBoardRoom::wait(Instant duration) {
    room_->now_ += std::max(duration, Instant{});
}
void SimulatedBoardRoom::cover_projector(bool covered) {
    room_->schedule.cover(covered);
}
const std::vector<TrueLight>& SimulatedBoardRoom::true_lights() const {
    return room_->schedule.truth();
}
int SimulatedBoardRoom::poses() const {
    return static_cast<int>(room_->room_from_board.size());
}

void SimulatedBoardRoom::lay(int pose) {
    room_->room_from_board_now = room_->room_from_board.at(static_cast<std::size_t>(pose));
    room_->seen = false;
}

void SimulatedBoardRoom::slip(const Vector3d& by_mm) {
    room_->room_from_board_now.translation() += by_mm;
    room_->seen = false;
}

void SimulatedBoardRoom::let_person_carry(const PersonSettings& person) {
    std::mt19937 random(static_cast<unsigned>(mixed(static_cast<std::uint64_t>(room_->settings.seed) * 64 + 50)));
    room_->person.emplace(room_->stops_of_a_person(random), person);
    room_->room_from_board_now = room_->person->stops().front().room_from_board;
    room_->seen = false;
}

const BoardPerson* SimulatedBoardRoom::person() const {
    return room_->person ? &*room_->person : nullptr;
}

void SimulatedBoardRoom::knock_right_camera(double degrees) {
    room_->rig.right_camera.turn({0, degrees * kRadians, 0});
    room_->seen = false;
}

void SimulatedBoardRoom::knock_projector(double degrees) {
    room_->rig.projector.turn({0, degrees * kRadians, 0});
    room_->seen = false;
}

RigCalibration SimulatedBoardRoom::true_rig() const {
    return exported(room_->true_layout);
}

RigidTransform SimulatedBoardRoom::true_rig_from_board(int pose) const {
    return room_->true_layout.room_from_rig.inverse() * room_->room_from_board.at(static_cast<std::size_t>(pose));
}

std::string SimulatedBoardRoom::truth_json() const {
    nlohmann::json truth = {{"format", "planlight-board-truth"},
                            {"version", 1},
                            {"preset", room_->settings.preset == Preset::paper ? "paper" : "modern"},
                            {"seed", room_->settings.seed},
                            {"sag_mm", room_->sheet.sag_mm},
                            {"bend_direction", room_->sheet.bend_direction}};
    truth["true_rig"] = nlohmann::json::parse(rig_as_json(true_rig()));
    for (int i = 0; i < poses(); ++i) {
        const RigidTransform pose = true_rig_from_board(i);
        nlohmann::json rows = nlohmann::json::array();
        for (int r = 0; r < 4; ++r) rows.push_back({pose(r, 0), pose(r, 1), pose(r, 2), pose(r, 3)});
        truth["rig_from_board"].push_back(rows);
    }
    return truth.dump(2);
}

}  // namespace planlight::simulation
