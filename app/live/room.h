#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/session.h"
#include "app/windows/operator_model.h"

namespace planlight {

/// Where a live session takes place: devices and their clock, whoever made them.
class Room {
public:
    virtual ~Room() = default;

    virtual std::string name() const = 0;
    virtual const RigCalibration& rig() const = 0;
    virtual Projector& projector() = 0;
    virtual StereoCamera& cameras() = 0;
    virtual const Clock& clock() const = 0;
    virtual MarkerDesign markers() const { return {}; }  ///< that are pasted on the patient

    /// What a person should know of the devices, a sentence each.
    virtual std::vector<std::string> notes() const { return {}; }
    /// How often a picture is taken for the window while nothing else wants one.
    virtual Instant look_interval() const { return std::chrono::milliseconds(100); }
    /// Where nothing is real the window says so in large letters. The projector window of a simulated room shows a copy
    /// of the light.
    virtual RoomKind kind() const { return RoomKind::real; }
    /// What a simulated room needs to be told: computing takes time there as well, and its patient moves on request.
    virtual void computing() {}
    /// And time goes by while nobody wants anything.
    virtual void resting(Instant) {}
    virtual void let_patient_move(bool) {}
    /// The fault that a simulated room was asked to show begins now.
    virtual void begin_fault() {}
    /// Where the light truly falls, ct; null where nobody knows.
    virtual std::shared_ptr<const std::vector<LightLine>> true_light(const PlanDrawing&, const OverlayStep&) const {
        return nullptr;
    }
};

/// Told what is being done, as a sentence, and how far it is, 0 to 1 (empty: nobody knows).
using RoomProgress = std::function<void(const std::string& doing, std::optional<double> share)>;

/// Makes the room in the session's own thread, for that may take seconds.
using MakeRoom = std::function<std::unique_ptr<Room>(const RoomProgress& progress)>;

}  // namespace planlight
