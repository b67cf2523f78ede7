#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/room_kind.h"
#include "app/session.h"
#include "planning_io/types/error.h"
#include "projection/light_gate.h"

namespace planlight {

/// What a session can be asked for.
enum class SessionCall {
    scan,
    find_patient,
    confirm,
    update,
    check_skin,
    light_landmark,
    go_dark,
    light_item,
    resume,
    hide_item,
    show_item
};

/// What can be asked of a session's light gate.
enum class GateCall { step, verify, skin_checked, new_match, restart, other_light, forbids };

/// Where a session takes place, as far as it goes into what it does.
struct RoomFacts {
    std::string name;
    RoomKind kind = RoomKind::real;
    MarkerDesign markers;
    RigCalibration rig;              ///< as calibrated
    std::vector<std::string> notes;  ///< of the devices, for a person
    Instant now{};                   ///< on the room's clock
};

/// Told of everything that goes into a session and comes out of it, in order and in the session's own thread: whoever
/// does the same again with the same answers of the devices must come to the same end. None of it may take long.
class SessionObserver {
public:
    virtual ~SessionObserver() = default;

    virtual void room_entered(const RoomFacts& /*room*/) noexcept {}
    /// A button, the moment it was pressed; from any thread.
    virtual void pressed(const std::string& /*action*/) noexcept {}
    /// What the banner says: its colour as a word, its sentence, further ones.
    virtual void said(const std::string& /*kind*/, const std::string& /*headline*/,
                      const std::vector<std::string>& /*details*/) noexcept {}

    /// Before the session does it. `which`: of `light_landmark`, `light_item`, `hide_item` and `show_item`, -1 for the
    /// plan.
    virtual void asked(SessionCall /*call*/, const std::vector<PointPair>& /*landmarks*/, int /*which*/) noexcept {}

    /// Before `resume` is asked for: what the session is to go on with.
    virtual void match_offered(const KeptMatch& /*match*/) noexcept {}

    // What the devices answered.
    virtual void clock_read(Instant /*now*/) noexcept {}
    /// The next frame's shutters have closed (StereoCamera::wait_until_exposed); not told where that cannot be told.
    virtual void frame_exposed() noexcept {}
    virtual void frame_taken(const StereoFrame& /*frame*/) noexcept {}
    virtual void picture_shown(const RgbImage& /*picture*/, Instant /*valid_until*/, Instant /*lit_from*/) noexcept {}
    virtual void went_dark() noexcept {}
    /// What is wrong with the cameras (StereoCamera::doubt), when it changes; empty: nothing any more.
    virtual void cameras_doubted(const std::string& /*doubt*/) noexcept {}
    /// A device threw, or whoever asked ended it from between two pictures of a scan.
    virtual void device_failed(const Error& /*fault*/) noexcept {}
    virtual void stopped(const Error& /*why*/) noexcept {}

    /// Light that was put out is still seen (`Session::light_stays`), or no longer; told when that changes.
    virtual void light_stays(bool /*stays*/) noexcept {}

    // What came of it; of what was refused, `refused` alone.
    virtual void scanned(const Session& /*session*/) noexcept {}
    virtual void matched(const Session& /*session*/) noexcept {}
    virtual void updated(const Session& /*session*/, const Session::Update& /*update*/) noexcept {}
    virtual void skin_checked(const SkinCheck& /*check*/) noexcept {}
    virtual void resumed(const Session& /*session*/, const ResumeCheck& /*check*/) noexcept {}
    virtual void refused(SessionCall /*call*/, const std::exception& /*why*/) noexcept {}

    /// The gate: `at` of a verification, `off_mm` of a check of the skin; `ruling` null for all but `step`.
    virtual void gate(GateCall /*call*/, Instant /*at*/, double /*off_mm*/,
                      const LightGate::Ruling* /*ruling*/) noexcept {}
};

}  // namespace planlight
