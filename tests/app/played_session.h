#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "app/live/live_session.h"
#include "app/recording/session_recorder.h"
#include "app/session.h"
#include "planning_io/types/volume.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::test {

/// The example patient, prepared once; `there` is false where its package is not installed.
struct ExampleCase {
    bool there = false;
    Volume volume;
    Case prepared;
};
const ExampleCase& example_case();

#ifdef __SANITIZE_ADDRESS__
inline constexpr std::chrono::minutes kPatience{60};  // such a session is twenty times as slow
#else
inline constexpr std::chrono::minutes kPatience{5};
#endif

/// Looks at the session until it holds of its model. A session that does not come to it in `kPatience` has failed: this
/// throws std::runtime_error with what was waited for, or what the session itself has thrown. Returns that model.
template <class Holds>
OperatorModel wait_for(LiveSession& session, const char* what, Holds holds) {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    for (;;) {
        const OperatorModel model = session.model();
        if (holds(model)) return model;
        session.rethrow_fault();
        if (std::chrono::steady_clock::now() > until)
            throw std::runtime_error(std::string("waited in vain for ") + what + ": " + model.status.headline);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

/// Presses Scan, Register and Track, each as soon as it can be pressed.
void begin_to_follow(LiveSession& session);

/// Says once of each landmark that is lit that the light on it is right. To be shown every model.
class LandmarkWitness {
public:
    explicit LandmarkWitness(LiveSession& session) : session_(session) {}
    void look(const OperatorModel& model);
    const std::string& said() const { return said_; }  ///< last: the words of the button

private:
    LiveSession& session_;
    std::string said_;
};

/// How a session in the simulated room is played without a window.
struct PlayedSession {
    simulation::Preset preset = simulation::Preset::paper;
    unsigned seed = 1;
    simulation::ThingsSettings things{};  ///< that lie before or round the head
    /// Of `simulated_faults`; "hand-over-markers": for eight frames none is seen; "camera-away": it fails three times;
    /// "projector-away": it fails until DARK, and before the plan is lit again all is looked at. Empty: none.
    std::string fault;
    int fault_after = 0;  ///< frames that the patient is followed in; 0: when the live session lets it begin
    double speed_mm_s = 20;
    int updates = 60;               ///< while the plan is followed, about
    bool dark_in_scan = false;      ///< DARK is pressed in the middle of the first scan
    bool moves_in_scan = false;     ///< the patient moves in each scan
    bool check_skin = false;        ///< in the middle
    bool hide_items = false;        ///< the first is hidden, the second lit alone, then the whole plan again
    std::vector<std::string> card;  ///< lit with the plan until it is verified
    bool landmarks = false;         ///< clicked landmarks go into the match, and are wrong
    /// Landmarks are clicked 6 mm aside, so that the match needs a person's look; the person says yes, or no.
    enum class Look { not_needed, confirmed, refused } look = Look::not_needed;
    bool exposures_told = false;  ///< the cameras tell the end of an exposure before they give its frame
    std::string doubt;            ///< what the cameras say of themselves while the patient is followed, now and then
};

/// How it went.
struct PlayedResult {
    std::string headline;  ///< the last words of the banner
    int updates = 0;
    int doubted = 0;              ///< updates whose words on the banner hold the doubt
    std::vector<double> told_ms;  ///< that the observer took of each update's thread
};

/// Presses the buttons one after the other: scan, register, track, the light on both landmarks, DARK, track again.
/// `observer` is told of it. With an `offer` it goes on with that match instead of scan and register.
PlayedResult play_session(const PlayedSession& how, const ExampleCase& patient, SessionObserver* observer,
                          const std::optional<ResumeOffer>& offer = {});

/// The same into a recording.
PlayedResult record_session(const PlayedSession& how, const ExampleCase& patient, RecordMode mode,
                            const std::filesystem::path& file);

}  // namespace planlight::test
