#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/devices/projector.h"
#include "registration/devices/stereo_camera.h"
#include "registration/simulation/board_person.h"
#include "registration/simulation/board_sheet.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::simulation {

/// The room of a calibration, with what may be wrong in it.
struct BoardRoomSettings {
    Preset preset = Preset::modern;
    unsigned seed = 1;
    int poses = 15;
    double min_tilt_deg = 12, max_tilt_deg = 38;  ///< of the board against the projector's axis
    double depth_mm = 70, shift_mm = 50;          ///< how far from the working point, either way
    bool whole = false;                           ///< both cameras see all of the print (a chessboard needs that)
    double ambient = 0.12;                        ///< share of full scale on white paper
    double brightness = 1;                        ///< 1: white paper at the working point is about 200 grey
    bool noise = true;
    Instant projector_delay = std::chrono::milliseconds(25);
    LightSettings light;
};

/// The simulated rig of `build_rig` with a printed board before it, in random poses: the captures of a calibration.
///
/// Light, lens and sensor are those of `SimulatedRig`; the print is known to it only as the picture that was printed.
class SimulatedBoardRoom {
public:
    SimulatedBoardRoom(const BoardSheet& sheet, const BoardRoomSettings& settings);
    ~SimulatedBoardRoom();

    Projector& projector();
    StereoCamera& cameras();
    const Clock& clock() const;

    void wait(Instant duration);         ///< lets simulated time pass
    void cover_projector(bool covered);  ///< a lid before its lens: not even the leak of a black picture comes out

    int poses() const;
    void lay(int pose);                       ///< puts the board into a pose
    void slip(const Eigen::Vector3d& by_mm);  ///< shifts the board (room frame) from now on, until the next `lay`
    /// From now on a person carries the board, with mistakes on the way: places that help, and between them such as do
    /// not (BoardPerson).
    void let_person_carry(const PersonSettings& person = {});
    /// Who carries it; null: nobody.
    const BoardPerson* person() const;

    void knock_right_camera(double degrees);  ///< turns the right camera about its upright axis from now on
    void knock_projector(double degrees);

    // ---- truth: nothing of the product reads what follows ----
    RigCalibration true_rig() const;                    ///< before any knock
    const std::vector<TrueLight>& true_lights() const;  ///< when every order to the projector became light
    RigidTransform true_rig_from_board(int pose) const;
    std::string truth_json() const;

private:
    struct Room;
    std::unique_ptr<Room> room_;
};

}  // namespace planlight::simulation
