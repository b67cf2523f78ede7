#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "app/live/live_view.h"
#include "app/live/not_kept.h"
#include "app/live/observed_gate.h"
#include "app/live/room.h"
#include "app/live/session_states.h"
#include "app/live/skin_check_schedule.h"
#include "app/recording/resume_offer.h"
#include "app/session.h"
#include "app/update_latency.h"
#include "app/windows/operator_model.h"
#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {

/// Who asks for what a button does. A person's press is recorded as theirs; what the program does by itself is recorded
/// by what comes of it, and darkness because the projector was lost by that name.
enum class AskedBy { person, program, lost_projector };

/// A session in a room that runs in a thread of its own, so that the windows answer while it computes.
///
/// The window thread posts what the person wants and takes the newest model and the newest light.
class LiveSession {
public:
    /// `keep_matches_in`: every match and its scan in a folder of its own there; empty: not kept. `observer` (null:
    /// nobody) is told of all that happens. `offer`: a match of an earlier session that it may go on with. `checks`:
    /// when the skin is checked by itself.
    LiveSession(MakeRoom make_room, const Case& the_case, const CaseDrawing& drawing,
                std::filesystem::path keep_matches_in, SessionObserver* observer = nullptr,
                std::optional<ResumeOffer> offer = {}, const SkinCheckScheduleSettings& checks = {});
    ~LiveSession();  ///< waits for its thread

    /// There is no light from now on, and the thread ends as soon as it can; it is not waited for.
    void end();

    /// Queued; `dark` and `stop` overtake everything that waits. The model says so at once. Returns why it does nothing
    /// in the state of now, as a sentence; empty: it is taken. `item`: of `light_item`, `hide_item` and `show_item`,
    /// empty for the whole plan. `darks`: only while DARK was pressed so often.
    std::string post(OperatorAction action, AskedBy by = AskedBy::person, std::optional<std::size_t> item = {},
                     std::optional<std::uint64_t> darks = {});

    /// Finding the patient with these landmarks (none: without), clicked on the last scan; queued.
    std::string post_find_patient(std::vector<PointPair> landmarks);

    /// `light_item`: this item of the plan alone is bright from now on (empty: all are). `hide_item`, `show_item`: it
    /// is not lit, or it is again (empty: the whole plan). Queued.
    std::string post_item(OperatorAction action, std::optional<std::size_t> which);

    /// The projector was away: before the plan is lit again a short scan looks whether all is as it was.
    void look_before_light();

    OperatorModel model() const;

    /// The newest light, and a number that changes with it. An empty picture is darkness.
    struct Light {
        std::shared_ptr<const RgbImage> picture;
        std::uint64_t number = 0;
    };
    Light light() const;

    /// False from a press of DARK on until light is asked for anew; also of a picture that is on its way then.
    bool light_permitted() const;

    /// How late the light of this session was so far.
    UpdateLatency latency() const;

    /// True once the patient is followed and light is on the skin.
    bool projecting() const;
    /// Why the last match could not be kept; empty where it was, or where none is kept.
    NotKept not_kept() const;
    /// Throws what ended the thread, if anything did.
    void rethrow_fault() const;
    /// The last sign of life of the thread, on the wall's monotonic clock.
    Instant alive_at() const { return Instant(alive_at_); }

private:
    class LightTap;
    /// What a person wants, and how often DARK had been pressed by then: an action that DARK overtook lights nothing.
    struct Press {
        OperatorAction action = OperatorAction::none;
        std::uint64_t darks = 0;
        SessionState from = SessionState::opening;  ///< in which it was pressed
        std::optional<std::size_t> item{};          ///< of what is done with one
        AskedBy by = AskedBy::person;
    };
    void run(const MakeRoom& make_room);
    std::unique_ptr<Room> make(const MakeRoom& make_room);
    void enter_room(const Room& room);
    void device_lost(const Press& press, Session& session, const DeviceError& lost);
    void refused(const Press& press, Session& session, const Error& refusal);
    void act(const Press& press, Session& session, Room& room);
    void begin_anew(Session& session, Room& room);
    bool scan_holds();
    void begin_to_follow(Session& session, Room& room);
    void answer_dark(const Press& press, Session& session);
    void scan(Session& session);
    void find_patient(Session& session, const std::vector<PointPair>& landmarks);
    void confirm(Session& session);
    void confirm_light(Session& session);
    void offer_to_resume();
    void resume(Session& session);
    ResumeCheck look_whether_it_holds(Session& session, const KeptMatch& match);
    bool look_first() const { return looked_ != looks_asked_; }
    void look_again(Session& session);
    void check_skin(Session& session, AskedBy by);
    std::string check_skin_when_due(const Session& session, Room& room, const Session::Update& update);
    void say_of_skin(const std::string& words, OperatorModel& m);
    void give_up_scan();
    bool looked_at(Instant now) const;
    void show_measured(const Session::Update& update, OperatorModel& m) const;
    void show_verification(const Session::Update& update, LightGate::Ruling& ruling);
    void end_verification(Session& session);
    void light_items(const Press& press, Session& session);
    void show_lit_items(const Session& session, OperatorModel& m) const;
    std::vector<PointPair> newest_landmarks() const;
    std::string keep(const RegistrationResult& found, const PointCloud& cloud, const std::vector<PointPair>& landmarks);
    void follow(Session& session, Room& room);
    void show_update(const Session& session, const Room& room, const Session::Update& update,
                     const LightGate::Ruling& ruling, const std::string& notice);
    void note_latency(const Session::Update& update, OperatorModel& m);
    std::optional<double> lit_per_s(const Session::Update& update);
    void play_fault(const LightGate::Ruling& ruling, Room& room);
    void stop_light(Session& session, const LightGate::Ruling& ruling);
    /// What came of something: it leads on, and `change` is made with it. False, and nothing of both, where DARK was
    /// pressed meanwhile and has led elsewhere.
    bool happened(SessionHappening happening, const std::function<void(OperatorModel&)>& change = {});
    SessionState without_waiting() const;
    static bool is_of_items(OperatorAction action);
    bool still_wanted(const Press& press) const;
    void set_progress(const std::string& headline, double share);
    void said();
    std::uint64_t darks_now() const;
    std::string refused_press(OperatorAction action) const;
    void begin(const Press& press);
    void look(Session& session, Room& room);
    void say_whether_light_stays(bool stays);
    Press next_press(Instant longest);
    void permit_light(const Press& press);
    void show_alive();
    template <class Change>
    void change_model(Change change) {
        const std::lock_guard lock(mutex_);
        change(model_);
    }

    const Case& case_;
    const CaseDrawing& drawing_;
    std::filesystem::path keep_matches_in_;
    SessionObserver* observer_;
    const SteadyClock wall_;
    LiveView view_{wall_};
    mutable std::mutex mutex_;
    SessionState state_ = SessionState::opening;
    bool scan_there_ = false;    ///< of this session
    const OperatorModel blank_;  ///< of the case alone
    std::condition_variable wake_;
    std::deque<Press> presses_;
    std::vector<PointPair> landmarks_;  ///< of the last `post_find_patient`
    OperatorModel model_;
    NotKept not_kept_;
    Light light_;
    UpdateLatency latency_;
    std::string latency_words_;  ///< as they were said last
    std::exception_ptr fault_;
    std::uint64_t darks_ = 0;           ///< DARK presses so far
    std::uint64_t darks_answered_ = 0;  ///< of these, how many the thread has come to; until then the banner says DARK
    std::uint64_t permitted_ = 0;       ///< `darks_` when the light of now was asked for; it is dark where they differ
    ObservedGate gate_;                 ///< of the session's thread
    SkinCheckSchedule checks_;          ///< of the session's thread
    std::string skin_words_;            ///< of the last check, as they stand in the evidence
    Instant seen_at_{};                 ///< of the last frame, on the room's clock
    int landmark_ = -1;                 ///< that is lit for a person to look at; -1: the plan is lit
    int landmarks_to_look_at_ = 0;
    std::optional<Instant> landmark_lit_from_;  ///< without a break since; empty: not lit yet
    std::string cannot_verify_;                 ///< why no landmarks can be looked at, in sentences; empty: they can
    std::string
        landmark_place_;  ///< of the one that is lit, in words: "at the front of the head, on the patient's left"
    std::deque<Instant> lit_at_;            ///< of the last pictures, on the room's clock
    int good_updates_ = 0;                  ///< ALIGNED so often; then the simulated fault begins
    std::optional<ResumeOffer> offer_;      ///< of the session's thread
    std::atomic<unsigned> looks_asked_{0};  ///< before light, by the window's thread
    unsigned looked_ = 0;                   ///< of these, that were done; by the session's thread
    std::optional<KeptMatch> away_;         ///< this session's own, while it is not known whether it still holds
    bool light_stays_ = false;              ///< it was put out, and the cameras still see it
    bool ending_ = false, following_ = false;
    std::atomic<bool> projecting_{false};
    std::atomic<Instant::rep> alive_at_{0};
    std::thread thread_;
};

}  // namespace planlight
