#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "app/live/room.h"
#include "app/live/skin_check_schedule.h"
#include "app/recording/resume_offer.h"
#include "app/session.h"
#include "app/windows/operator_window.h"
#include "app/words/words.h"
#include "planning_io/case/light_file.h"
#include "planning_io/types/point_pair.h"

namespace planlight {

/// What a recording of the session holds of the patient.
enum class PatientRecorded { no, with_face, blurred };

/// What `planlight session` was asked for.
struct LiveOptions {
    std::string
        projector_monitor;  ///< name or number; empty: the first monitor that is not the primary one, if there is one
    ProjectorFacts projector;               ///< what was measured of the projector; empty fields are not compared
    std::string operator_monitor;           ///< empty: the primary one
    bool autoplay = false;                  ///< scan, register and track without a person
    double idle_first_s = 0;                ///< so long after the room is there nothing is pressed by itself
    double end_after_s = 0;                 ///< of projecting, wall time; 0 = until the window is closed
    std::filesystem::path keep_matches_in;  ///< folder for every match and its scan; empty = none
    bool json = false;                      ///< at the end print how late the light was, as JSON
    std::optional<ResumeOffer> resume;      ///< a match of an earlier session to go on with
    SessionObserver* observer = nullptr;    ///< told of all that happens; null: nobody
    PatientRecorded recorded = PatientRecorded::no;  ///< said before the first press, and on the page of evidence
    SkinCheckScheduleSettings skin_checks;           ///< by the session itself
    std::function<std::string()> trouble;            ///< of the recording, to be said beside all else; may be empty
    std::filesystem::path screenshots;  ///< folder for a picture of the operator window a step; empty = none
};

/// True when a window could be opened.
bool display_is_there();

/// What the window says beside that something is being made.
struct SaidMeanwhile {
    const char* detail = "The projector is dark.";
    const char* no_press = "the case is being read";    ///< why no button does anything
    const char* no_picture = "when the room is there";  ///< of the cameras
};

/// The operator window of a session, from before there is one: it says what is being made, and how far that is.
class SessionWindow {
public:
    /// Opens it where there is a display. `operator_monitor` empty: the primary one. Throws DeviceError.
    /// `words`: its language; null: English.
    explicit SessionWindow(const std::string& operator_monitor, std::shared_ptr<const Words> words = {},
                           ThemeKind theme = ThemeKind::dark);

    /// What `make` makes in a thread of its own, while the window says so. Throws what it throws.
    template <class Make>
    auto while_made(const std::string& words, double share, Make make, const SaidMeanwhile& said = {}) {
        auto made = std::async(std::launch::async, std::move(make));
        while (made.wait_for(std::chrono::seconds(0)) != std::future_status::ready) show(words, share, said);
        return made.get();
    }

    /// Throws DeviceError without a display.
    OperatorWindow& window();
    bool closed() const { return closed_; }  ///< by the person, while something was made; from any thread
    /// After a session that was ended by closing it: it is there until it is closed once more.
    void stay() { closed_ = false; }

private:
    void show(const std::string& words, double share, const SaidMeanwhile& said = {});

    std::string monitor_;
    std::shared_ptr<const Words> words_;
    ThemeKind theme_;
    std::unique_ptr<OperatorWindow> window_;
    std::atomic<bool> closed_{false};
};

/// Makes the room of a session; a real one lights the projector that it is given, a simulated one has its own.
/// `projector`: null where the session has no monitor for it.
using MakeRoomWith = std::function<std::unique_ptr<Room>(Projector* projector, const RoomProgress& progress)>;

/// Both windows on a live session in the simulated room, until the operator window is closed. Gives the exit code.
/// Throws DeviceError when a monitor is missing or a window does not land where it should.
int run_live_simulated(SessionWindow& screen, MakeRoom make_room, const Case& the_case, const CaseDrawing& drawing,
                       const LiveOptions& options);

/// The same in a real room, whose light is that of the projector's monitor; without a name of one there is no light but
/// what the room has itself (recorded).
int run_live(SessionWindow& screen, const MakeRoomWith& make_room, const Case& the_case, const CaseDrawing& drawing,
             const LiveOptions& options);

/// The operator window on a model that does not change, until it is closed. Throws DeviceError without a display.
void show_model(const OperatorModel& model, FitView view, const WindowSettings& settings);

/// The same, with landmarks to be clicked from the start (the model has them), until they are used or the window is
/// closed. Returns what was clicked on both sides.
std::vector<PointPair> click_landmarks(const OperatorModel& model, const std::vector<PointPair>& already,
                                       const WindowSettings& settings);

}  // namespace planlight
