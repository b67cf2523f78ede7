#include "tests/app/guided_room.h"

#include "registration/calibration/draw_board.h"

namespace planlight::test {

GuidedRoom guide_in_room(simulation::Preset preset, unsigned seed, const PoseGuideSettings& settings) {
    constexpr int kPxPerSquare = 256;
    const BoardSpec board = parse_board("charuco 10x7 25 mm");
    simulation::BoardSheet sheet;
    sheet.print = draw_board(board, kPxPerSquare);
    sheet.px_per_mm = kPxPerSquare / board.square_mm;
    simulation::BoardRoomSettings room_settings;
    room_settings.preset = preset;
    room_settings.seed = seed;
    simulation::SimulatedBoardRoom room(sheet, room_settings);
    simulation::PersonSettings person;
    person.hold = std::chrono::milliseconds(1500);  // by a clock that costs computing: no longer than it takes
    room.let_person_carry(person);
    GuidedRoom result;
    GuidedSettings guided_settings;
    guided_settings.guide = settings;
    GuidedCalibration guided(
        room.projector(), room.cameras(), room.clock(), board, guided_settings, [&](const GuideEvent& event) {
            result.took_s = seconds(event.at);
            result.predicted_mm = event.predicted_mm;
            if (event.kind != GuideEvent::Kind::refused) return;
            const bool by_pose = event.fault != PoseFault::none;
            ++result.refused[by_pose ? text_of(event.fault) : "its pictures"];
            result.every_reason_said = result.every_reason_said && !event.why.empty() && !event.what.empty();
        });
    guided.run({});
    result.poses = guided.poses().size();
    result.calibration = guided.calibrate();
    if (result.calibration.refusal) return result;
    std::vector<Eigen::Vector3d> points;
    for (int pose = 0; pose < room.poses(); ++pose) add_board_points(room.true_rig_from_board(pose), points);
    result.error = rig_error(rig_calibration_of(result.calibration, "2024-01-01"), room.true_rig(), points);
    return result;
}

}  // namespace planlight::test
